// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/align/close_loops.h"
#include "slamdb/align/detail/report_json.h"
#include "slamdb/edit/merge/detail/report_json.h"
#include "slamdb/optimize/detail/report_json.h"

namespace slamdb {
namespace {

using detail::Json;

Json JsonOf(const LoopEvidence& evidence) {
  return {{"agreeing_pairs", evidence.agreeing},
          {"first_keyframes", evidence.first_keyframes},
          {"second_keyframes", evidence.second_keyframes},
          {"contradicting_pairs", evidence.contradicting},
          {"matched_points", evidence.points},
          {"extent", evidence.extent},
          {"found_share", evidence.found_share},
          {"cell_share", evidence.cell_share},
          {"front_share", evidence.front_share},
          {"views", evidence.views},
          {"agreeing_views", evidence.agreeing_views}};
}

Json JsonOf(const Loop& loop) {
  return {{"verdict", NameOf(loop.verdict)},
          {"reason", loop.reason},
          {"gap",
           {{"translation", loop.gap.translation},
            {"path", loop.gap.path},
            {"rotation_degrees", loop.gap.degrees},
            {"scale", loop.gap.scale}}},
          {"evidence", JsonOf(loop.evidence)},
          {"pairs", detail::PairsJson(loop.pairs)}};
}

Json JsonOf(const ClosedMap& closed) {
  Json json = detail::OptimizationJson(closed.optimization);
  json["candidates"] = closed.search.candidates;
  json["loops"] = Json::array();
  for (const Loop& loop : closed.search.loops) json["loops"].push_back(JsonOf(loop));
  json["constraints"] = closed.constraints;
  json["fused"] = closed.constraints > 0 ? detail::FuseJson(closed.fused) : Json();
  return json;
}

}  // namespace

std::string ToJson(const CloseLoopsReport& report, const ReportFiles& files) {
  Json json = detail::ReportHead("close-loops", files);
  json["closed"] = report.closed;
  json["maps"] = Json::array();
  for (const ClosedMap& closed : report.maps) json["maps"].push_back(JsonOf(closed));
  return detail::JsonText(json);
}

}  // namespace slamdb
