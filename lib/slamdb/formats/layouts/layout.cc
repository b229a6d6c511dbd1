// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/layout.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/base/file.h"
#include "slamdb/formats/layouts/detail/known.h"
#include "slamdb/formats/layouts/detail/layout_json.h"

namespace slamdb {
namespace {

std::vector<Layout> ParseKnownLayouts() {
  std::vector<Layout> layouts;
  for (const char* const text : detail::KnownLayoutTexts())
    layouts.push_back(detail::ParseLayoutOver(text, "known layout", layouts));
  return layouts;
}

}  // namespace

const LayoutClass* Layout::Find(std::string_view name) const {
  const auto found = std::ranges::find(classes, name, &LayoutClass::name);
  return found == classes.end() ? nullptr : &*found;
}
LayoutClass* Layout::Find(std::string_view name) {
  const auto found = std::ranges::find(classes, name, &LayoutClass::name);
  return found == classes.end() ? nullptr : &*found;
}

bool SameBytes(const Layout& a, const Layout& b) {
  return a.header == b.header && a.root == b.root && a.classes.size() == b.classes.size() &&
         std::ranges::all_of(a.classes, [&](const LayoutClass& of) {
           const LayoutClass* other = b.Find(of.name);
           return other != nullptr && *other == of;
         });
}

Layout ParseLayout(std::string_view json, const std::string& path) {
  return detail::ParseLayoutOver(json, path, KnownLayouts());
}

std::span<const Layout> KnownLayouts() {
  static const std::vector<Layout> kLayouts = ParseKnownLayouts();
  return kLayouts;
}

const Layout* FindKnownLayout(std::string_view id) {
  const auto found = std::ranges::find(KnownLayouts(), id, &Layout::id);
  return found == KnownLayouts().end() ? nullptr : &*found;
}

Layout LayoutOf(std::string_view id_or_json) {
  if (const Layout* known = FindKnownLayout(id_or_json)) return *known;
  return ParseLayout(id_or_json, "layout");
}

Layout LoadLayout(const std::string& id_or_path) {
  if (const Layout* known = FindKnownLayout(id_or_path)) return *known;
  try {
    const WholeFile file(Source{id_or_path});
    return ParseLayout(file.text(), id_or_path);
  } catch (const Error& error) {
    if (error.kind() != ErrorKind::kNotFound) throw;
    std::string ids;
    for (const Layout& layout : KnownLayouts()) ids += (ids.empty() ? "" : ", ") + layout.id;
    throw Error(ErrorKind::kNotFound, id_or_path, "",
                detail::Concat("neither a file with a layout nor one that is known; known are ", ids));
  }
}

}  // namespace slamdb
