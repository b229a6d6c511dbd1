// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/report_json.h"

#include "slamdb/align/detail/report_json.h"
#include "slamdb/align/merge_branches.h"
#include "slamdb/edit/merge/detail/report_json.h"
#include "slamdb/optimize/detail/report_json.h"

namespace slamdb {
namespace {

using detail::Json;

Json JsonOf(const AlignmentEvidence& evidence) {
  return {{"own_vocabulary", evidence.own_vocabulary},
          {"candidates", evidence.candidates},
          {"agreeing_pairs", evidence.agreeing},
          {"agreeing_keyframes", evidence.keyframes},
          {"contradicting_pairs", evidence.contradicting},
          {"matched_points", evidence.points},
          {"extent", evidence.extent},
          {"found_share", evidence.found_share},
          {"cell_share", evidence.cell_share},
          {"front_share", evidence.front_share},
          {"views", evidence.views},
          {"agreeing_views", evidence.agreeing_views},
          {"overlap", evidence.overlap},
          {"rmse", evidence.rms}};
}

Json JsonOf(const Alignment& alignment) {
  Json json = {{"verdict", NameOf(alignment.verdict)}, {"reason", alignment.reason}};
  json["first_from_second"] = alignment.first_from_second ? detail::JsonOf(*alignment.first_from_second) : Json();
  if (alignment.first_from_second) {
    const AlignmentPrecision precision = PrecisionOf(alignment);
    json["precision"] = {{"rotation_degrees", precision.rotation_degrees},
                         {"translation", precision.translation},
                         {"scale", precision.scale}};
    json["covariance"] = detail::MatrixJson(alignment.covariance);
    json["center"] = {alignment.center.x(), alignment.center.y(), alignment.center.z()};
  }
  json["scale_is_free"] = alignment.scale_is_free;
  json["evidence"] = JsonOf(alignment.evidence);
  json["pairs"] = detail::PairsJson(alignment.pairs);
  return json;
}

Json JsonOf(const OptimizedJoin& round) {
  Json json = detail::OptimizationJson(round.optimization);
  json["added_observations"] = round.observations;
  json["fused"] = detail::FuseJson(round.fused);
  return json;
}

Json RoundsOf(const std::vector<OptimizedJoin>& rounds) {
  Json json = Json::array();
  for (const OptimizedJoin& round : rounds) json.push_back(JsonOf(round));
  return json;
}

Json JsonOf(const MapName& name) { return {{"input", name.input}, {"map", detail::JsonId(name.map)}}; }

Json LinksOf(const AlignedMaps& aligned, const std::vector<MapName>& names) {
  Json links = Json::array();
  for (const MapLink& link : aligned.links) {
    Json entry = {
        {"first", JsonOf(names[link.first])}, {"second", JsonOf(names[link.second])}, {"use", NameOf(link.use)}};
    entry.update(JsonOf(link.alignment));
    links.push_back(entry);
  }
  return links;
}

}  // namespace

std::string ToJson(const AlignedMaps& aligned, const std::vector<MapName>& names,
                   const std::optional<SearchedStore>& store) {
  Json json = detail::ReportHead("align");
  json["inputs"] = Json::array();
  for (std::size_t map = 0; map < names.size(); ++map) {
    Json entry = JsonOf(names[map]);
    entry["group"] = aligned.places[map].group;
    entry["group_from_map"] = detail::JsonOf(aligned.places[map].group_from_map);
    json["inputs"].push_back(entry);
  }
  json["links"] = LinksOf(aligned, names);
  json["searched"] = nullptr;
  if (store)
    json["searched"] = {{"input", store->path},
                        {"unlike", store->unlike},
                        {"unknown", store->unknown},
                        {"unreachable", store->unreachable}};
  return detail::JsonText(json);
}

std::string ToJson(const MergeReport& merged, const JoinAlignedReport& joined,
                   const std::vector<OptimizedJoin>& optimized, const std::vector<MapName>& names,
                   const std::string& output) {
  Json json = detail::MergeJson(merged, output);
  json["links"] = LinksOf(joined.aligned, names);
  json["joins"] = Json::array();
  for (const JoinReport& join : joined.joins) json["joins"].push_back(detail::JoinJson(join));
  json["optimizations"] = RoundsOf(optimized);
  return detail::JsonText(json);
}

std::string ToJson(const MergeBranchesResult& result, const std::string& output) {
  Json json = detail::ThreeWayJson(result.merged.report, output);
  json["optimizations"] = RoundsOf(result.tightened);
  return detail::JsonText(json);
}

std::string NameText(const MapName& name) { return (name.input.empty() ? "" : name.input + " ") + ToString(name.map); }

}  // namespace slamdb
