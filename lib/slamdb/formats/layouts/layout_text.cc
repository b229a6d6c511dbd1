// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/layout_text.h"

#include "slamdb/base/detail/json.h"

namespace slamdb {
namespace {

using detail::Concat;
using detail::Json;

std::string Value(const Json& json) { return detail::Dumped(json); }

// `"registers": [...], `, what there is of it.
std::string HeadOf(const LayoutClass& of) {
  std::string text;
  if (of.abstract) text += "\"abstract\": true, ";
  if (!of.exported.empty()) text += Concat("\"export\": ", Value(of.exported), ", ");
  if (!of.registers.empty()) text += Concat("\"registers\": ", Value(of.registers), ", ");
  return text;
}

std::string ClassText(const LayoutClass& of) {
  std::string text = Concat("    ", Value(of.name), ": {", HeadOf(of), "\"fields\": [");
  for (std::size_t i = 0; i < of.members.size(); ++i) {
    const LayoutMember& member = of.members[i];
    text += Concat(i == 0 ? "\n" : ",\n", "      [", Value(member.name), ", ", Value(member.type), "]");
  }
  return text + "\n    ]}";
}

}  // namespace

std::string LayoutText(const Layout& layout) {
  constexpr int kHeaderBytes = 40;
  std::string text = "{\n";
  if (!layout.id.empty()) text += Concat("  \"id\": ", Value(layout.id), ",\n");
  if (!layout.title.empty()) text += Concat("  \"title\": ", Value(layout.title), ",\n");
  if (!layout.who.empty()) text += Concat("  \"who\": ", Value(layout.who), ",\n");
  text += Concat("  \"header\": ", layout.header ? kHeaderBytes : 0, ",\n  \"root\": ", Value(layout.root),
                 ",\n  \"classes\": {");
  for (std::size_t i = 0; i < layout.classes.size(); ++i)
    text += Concat(i == 0 ? "\n" : ",\n", ClassText(layout.classes[i]));
  return text + "\n  }\n}\n";
}

}  // namespace slamdb
