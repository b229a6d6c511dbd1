// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/edit/words/words.h"
#include "slamdb/model/detail/json.h"

namespace slamdb {

std::string ToJson(const RecomputeWordsReport& report, const ReportFiles& files) {
  detail::Json json = detail::ReportHead("vocabulary-recompute", files);
  json["keyframes"] = report.keyframes;
  json["recomputed"] = report.recomputed;
  json["equal"] = report.equal;
  json["missing"] = report.missing;
  json["words"] = report.words;
  json["vocabulary"] = {{"before", detail::JsonOf(report.before)}, {"after", detail::JsonOf(report.after)}};
  return detail::JsonText(json);
}

}  // namespace slamdb
