// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/layout_text.h"

#include "slamdb/formats/layouts/detail/layout_json.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Dumped;
using detail::Json;

std::string ClassText(const std::string& name, const Json& of) {
  std::string text = Concat("    ", Dumped(name), ": {");
  for (const auto& [key, value] : of.items())
    if (key != "fields") text += Concat(Dumped(key), ": ", Dumped(value), ", ");
  text += "\"fields\": [";
  const char* separator = "\n";
  for (const Json& member : of["fields"]) {
    text += Concat(separator, "      [", Dumped(member[0]), ", ", Dumped(member[1]), "]");
    separator = ",\n";
  }
  return text + "\n    ]}";
}

}  // namespace

std::string LayoutText(const Layout& layout) {
  const Json json = detail::JsonOf(layout);
  std::string text = "{\n";
  for (const auto& [key, value] : json.items())
    if (key != "classes") text += Concat("  ", Dumped(key), ": ", Dumped(value), ",\n");
  text += "  \"classes\": {";
  const char* separator = "\n";
  for (const auto& [name, of] : json["classes"].items()) {
    text += Concat(separator, ClassText(name, of));
    separator = ",\n";
  }
  return text + "\n  }\n}\n";
}

std::string LayoutNamed(const std::string& id_or_path) {
  if (id_or_path.empty()) return {};
  const Layout layout = LoadLayout(id_or_path);
  const Layout* known = FindKnownLayout(layout.id);
  return known != nullptr && SameBytes(*known, layout) ? known->id : ToJson(layout);
}

}  // namespace slamdb
