// SPDX-License-Identifier: BSD-3-Clause
#include "cli/report/evaluate_text.h"

#include <algorithm>
#include <cmath>

#include "cli/report/layout.h"
#include "cli/report/similarity.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/many/estimates.h"

namespace slamdb::cli {
namespace {

std::string AlignmentText(const AppliedAlignment& alignment) {
  const std::string over = " over " + Counted(alignment.pairs, "pair");
  const std::string how = ": " + SimilarityText(alignment.reference_from_estimate);
  switch (alignment.kind) {
    case AlignmentKind::kNone:
      return "none";
    case AlignmentKind::kOrigin:
      return "the first pose onto that of the truth" + how;
    case AlignmentKind::kScale:
      return "scale alone" + over + how;
    case AlignmentKind::kSe3:
      return "SE3 (rotation, translation)" + over + how;
    case AlignmentKind::kSim3:
      break;
  }
  return "Sim3 (rotation, translation, scale)" + over + how;
}

std::string Share(double share) { return Percent(static_cast<std::uint64_t>(std::lround(share * 1e4)), 10'000); }

std::string PairsText(const TrajectoryCoverage& coverage, double time_offset) {
  std::string text = Grouped(coverage.pairs) + " of " + Counted(coverage.estimate_poses, "pose") + " with " +
                     Grouped(coverage.reference_poses) + " of the truth";
  if (coverage.largest_time_difference > 0)
    text += ", at most " + Short(coverage.largest_time_difference, 2) + " s apart";
  if (time_offset != 0) text += "; the truth's clock is ahead by " + detail::Fixed(time_offset, 4) + " s";
  return text;
}

std::string CoverageText(const TrajectoryCoverage& coverage) {
  std::string text = Share(coverage.duration_share()) + " of the truth's " +
                     Short(coverage.reference_end - coverage.reference_begin) + " s, " +
                     Share(coverage.length_share()) + " of its " + LengthText(coverage.reference_length, "m");
  if (coverage.gaps.empty()) return text;
  const auto duration = [](const CoverageGap& gap) { return gap.end_time - gap.begin_time; };
  const CoverageGap& longest = *std::ranges::max_element(coverage.gaps, {}, duration);
  return text + "; " + Counted(coverage.gaps.size(), "gap") + ", the longest " + Short(duration(longest), 3) +
         " s from " + detail::Fixed(longest.begin_time, 3) + " s";
}

// The table of errors: one row for each relation.
class ErrorRows {
 public:
  explicit ErrorRows(bool in_full) : in_full_(in_full) {
    std::vector<std::string> head = {"error", "", "rmse", "mean", "median", "95%", "max"};
    if (in_full) head.insert(head.end(), {"min", "std", "25%", "75%", "90%", "99%", "sse"});
    head.emplace_back("of");
    table_.Add(std::move(head));
  }

  template <class Errors>
  void Add(std::string name, const Errors& errors) {
    Add(std::move(name), "m", errors.translation);
    Add("", "degrees", errors.rotation_degrees);
    if (!in_full_) return;
    Add("", "|R - I|", errors.rotation_part);
    Add("", "|[R T] - I|", errors.full_transformation);
    if constexpr (requires { errors.point_distance; }) {
      Add("", "m of distance", errors.point_distance);
      Add("", "% of distance", errors.point_distance_ratio);
    }
  }
  std::string ToString() const { return table_.ToString(); }

 private:
  void Add(std::string name, std::string unit, const ErrorStatistics& of) {
    std::vector<std::string> cells = {std::move(name), std::move(unit)};
    std::vector<double> numbers = {of.rmse, of.mean, of.median, of.p95, of.max};
    if (in_full_) numbers.insert(numbers.end(), {of.min, of.std, of.p25, of.p75, of.p90, of.p99, of.sse});
    for (const double number : numbers) cells.push_back(of.count == 0 ? "-" : Short(number));
    cells.push_back(Grouped(of.count));
    table_.Add(std::move(cells));
  }

  static std::vector<Table::Align> Columns() {
    std::vector<Table::Align> columns(15, Table::Align::kRight);
    columns[0] = columns[1] = Table::Align::kLeft;
    return columns;
  }

  bool in_full_;
  Table table_{Columns(), 2};
};

std::string TextOf(const TrajectoryEvaluation& evaluation, bool in_full) {
  Table facts({Table::Align::kLeft, Table::Align::kLeft}, 2);
  facts.Add({"paired", PairsText(evaluation.coverage, evaluation.time_offset)});
  facts.Add({"covered", CoverageText(evaluation.coverage)});
  facts.Add({"aligned", AlignmentText(evaluation.alignment)});
  ErrorRows rows(in_full);
  rows.Add("absolute", evaluation.absolute);
  for (const RelativeErrors& relative : evaluation.relative) rows.Add("over " + ToString(relative.delta), relative);
  const std::string maps = MapsText(evaluation);
  return (maps.empty() ? "" : maps + "\n") + facts.ToString() + "\n" + rows.ToString();
}

}  // namespace

std::string EvaluateText(const EvaluationReport& report, bool in_full) {
  std::string text;
  for (const TrajectoryEvaluation& evaluation : report.evaluations)
    text += (text.empty() ? "" : "\n") + TextOf(evaluation, in_full);
  for (const UnevaluatedMap& map : report.unevaluated)
    text +=
        "\n" + (map.map ? ToString(map.map) : std::string("a trajectory")) + "\n  not evaluated: " + map.reason + "\n";
  return text;
}

}  // namespace slamdb::cli
