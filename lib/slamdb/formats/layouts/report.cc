// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/layouts/report.h"

#include "slamdb/formats/layouts/detail/layout_json.h"

namespace slamdb {

using detail::Json;

std::string ToJson(std::span<const Layout> layouts) {
  Json json = detail::ReportHead("layouts");
  Json& list = json["layouts"] = Json::array();
  for (const Layout& layout : layouts)
    list.push_back({{"id", layout.id}, {"title", layout.title}, {"who", layout.who}});
  return detail::JsonText(json);
}

std::string ToJson(const InferredLayout& inferred, const ReportFiles& files) {
  Json json = detail::ReportHead("layouts-infer", files);
  json["known"] = detail::TextOrNull(inferred.known ? inferred.layout.id : std::string());
  json["differences"] = inferred.differences;
  json["alternatives"] = inferred.alternatives;
  json["doubts"] = inferred.doubts;
  json["keyframes"] = inferred.keyframes;
  json["points"] = inferred.points;
  json["same_bytes"] = inferred.same_bytes;
  json["layout"] = detail::JsonOf(inferred.layout);
  return detail::JsonText(json);
}

std::string ToJson(const DerivedLayout& derived, const ReportFiles& files) {
  Json json = detail::ReportHead("layouts-from-source", files);
  json["known"] = detail::TextOrNull(derived.known);
  json["sources"] = derived.files;
  Json& questions = json["questions"] = Json::array();
  for (const LayoutQuestion& question : derived.questions) questions.push_back(ToString(question));
  json["unknown_types"] = CountUnknownTypes(derived.layout);
  json["lacks"] = derived.missing;
  json["layout"] = detail::JsonOf(derived.layout);
  return detail::JsonText(json);
}

std::string ToString(const LayoutQuestion& question) {
  return question.file.empty() ? question.text : detail::Concat(question.file, ":", question.line, ": ", question.text);
}

std::uint64_t CountUnknownTypes(const Layout& layout) {
  std::uint64_t count = 0;
  for (const LayoutClass& of : layout.classes)
    for (const LayoutMember& member : of.members) count += member.type.find('?') != std::string::npos ? 1 : 0;
  return count;
}

}  // namespace slamdb
