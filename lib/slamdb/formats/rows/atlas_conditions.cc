// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/atlas_conditions.h"

#include <cmath>
#include <utility>

#include "slamdb/base/detail/concat.h"

namespace slamdb::rows {
namespace {

using detail::Concat;

std::string_view ColumnOf(AtlasQuery::Number number) {
  using enum AtlasQuery::Number;
  switch (number) {
    case kMaps:
      return "maps";
    case kKeyframes:
      return "keyframes";
    case kPoints:
      return "points";
    case kObservations:
      return "observations";
    case kLandmarks:
      return "landmarks";
    case kLength:
      return "trajectory_length";
    case kDuration:
      return "duration";
    case kBytes:
      return "bytes";
    case kRevision:
      return "revision";
  }
  return "maps";
}

bool IsPattern(std::string_view text) { return text.find_first_of("*?") != std::string_view::npos; }

class Builder {
 public:
  explicit Builder(const Dialect& dialect) : dialect_(dialect) {}

  void Add(const AtlasQuery::Range& range) {
    const std::string column = Concat("atlas.", ColumnOf(range.number));
    if (std::isfinite(range.low)) And(conditions_.sql, Concat(column, " >= ", Put(range.low)));
    if (std::isfinite(range.high)) And(conditions_.sql, Concat(column, " <= ", Put(range.high)));
  }
  // One revision that meets all.
  void AddRevision(const AtlasQuery& query) {
    std::string of_it;
    if (query.who.find('@') != std::string::npos)
      And(of_it, Matches("history.who", query.who));
    else if (!query.who.empty())
      And(of_it,
          Concat("(", Matches("history.who", query.who + "@*"), " OR ", Matches("history.who", "*@" + query.who), ")"));
    if (!query.provenance.empty())
      And(of_it, Matches("history.provenance",
                         IsPattern(query.provenance) ? query.provenance : Concat("*", query.provenance, "*")));
    if (!query.tag.empty())
      And(of_it,
          Concat("EXISTS (SELECT 1 FROM tag WHERE tag.atlas = revision.atlas AND tag.number = revision.number AND ",
                 Matches("tag.name", query.tag), ")"));
    if (!of_it.empty())
      And(conditions_.sql, Concat("EXISTS (SELECT 1 FROM revision JOIN history ON history.row = revision.history WHERE "
                                  "revision.atlas = atlas.row AND ",
                                  of_it, ")"));
  }
  AtlasConditions Take() {
    if (conditions_.sql.empty()) conditions_.sql = "1 = 1";
    return std::move(conditions_);
  }

 private:
  static void And(std::string& sql, const std::string& condition) {
    sql += Concat(sql.empty() ? "" : " AND ", condition);
  }
  std::string Put(std::variant<double, std::string> value) {
    conditions_.parameters.push_back(std::move(value));
    return Concat(std::string(1, dialect_.parameter), conditions_.parameters.size());
  }
  std::string Matches(std::string_view column, std::string_view pattern) {
    return Concat(column, " ", dialect_.matches, " ", Put(dialect_.pattern(pattern)));
  }

  const Dialect& dialect_;
  AtlasConditions conditions_;
};

}  // namespace

AtlasConditions ConditionsOf(const AtlasQuery& query, const Dialect& dialect) {
  Builder builder(dialect);
  for (const AtlasQuery::Range& range : query.ranges) builder.Add(range);
  builder.AddRevision(query);
  return builder.Take();
}

}  // namespace slamdb::rows
