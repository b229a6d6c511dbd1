// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/evaluate/limits.h"

#include "slamdb/base/detail/concat.h"

namespace slamdb {
namespace {

std::string NameOf(const TrajectoryEvaluation& evaluation) {
  return evaluation.maps.size() == 1 ? ToString(evaluation.maps.front()) + ": " : std::string();
}

// NaN is on neither side of a limit, and so breaks it.
class Judge {
 public:
  Judge(const std::string& name, std::vector<std::string>& breaches) : name_(name), breaches_(breaches) {}

  void AtMost(double measured, const std::optional<double>& limit, std::string_view what, std::string_view unit) {
    if (limit && !(measured <= *limit)) Tell(what, measured, unit, ", above the limit of ", *limit);
  }
  void AtLeast(double measured, const std::optional<double>& limit, std::string_view what, std::string_view unit) {
    if (limit && !(measured >= *limit)) Tell(what, measured, unit, ", below the limit of ", *limit);
  }

  // Nothing is measured, and so no limit held.
  void Without(const std::optional<double>& limit, std::string_view what) {
    if (limit) breaches_.push_back(detail::Concat(name_, what, " has no pair of poses, and so holds no limit"));
  }

 private:
  void Tell(std::string_view what, double measured, std::string_view unit, std::string_view side, double limit) {
    breaches_.push_back(detail::Concat(name_, what, " is ", measured, unit, side, limit, unit));
  }

  const std::string& name_;
  std::vector<std::string>& breaches_;
};

}  // namespace

bool EvaluationLimits::any() const {
  return max_ate_rmse || max_ate || max_rotation_rmse || max_rpe_rmse || min_paired || min_coverage;
}

std::vector<std::string> BreachesOf(const EvaluationReport& report, const EvaluationLimits& limits) {
  std::vector<std::string> breaches;
  if (!limits.any()) return breaches;
  for (const TrajectoryEvaluation& evaluation : report.evaluations) {
    const std::string name = NameOf(evaluation);
    Judge judge(name, breaches);
    const AbsoluteErrors& absolute = evaluation.absolute;
    judge.AtMost(absolute.translation.rmse, limits.max_ate_rmse, "the absolute error of positions (rmse)", " m");
    judge.AtMost(absolute.translation.max, limits.max_ate, "the largest absolute error of positions", " m");
    judge.AtMost(absolute.rotation_degrees.rmse, limits.max_rotation_rmse, "the absolute error of rotations (rmse)",
                 " degrees");
    for (const RelativeErrors& relative : evaluation.relative)
      if (relative.errors.empty())
        judge.Without(limits.max_rpe_rmse, detail::Concat("the relative error over ", relative.delta));
      else
        judge.AtMost(relative.translation.rmse, limits.max_rpe_rmse,
                     detail::Concat("the relative error over ", relative.delta, " (rmse)"), " m");
    judge.AtLeast(100 * evaluation.coverage.paired_share(), limits.min_paired, "the share of poses that are paired",
                  "%");
    judge.AtLeast(100 * evaluation.coverage.duration_share(), limits.min_coverage,
                  "the share of the truth's time that is covered", "%");
  }
  for (const UnevaluatedMap& map : report.unevaluated)
    breaches.push_back(detail::Concat(map.map, ": could not be evaluated, and so holds no limit"));
  return breaches;
}

}  // namespace slamdb
