// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/progress.h"
#include "slamdb/evaluate/error_statistics.h"
#include "slamdb/export.h"
#include "slamdb/model/similarity.h"
#include "slamdb/model/trajectory_pose.h"

// How far a trajectory is from the truth: absolute and relative pose errors.
// Definitions are those of evo (github.com/MichaelGrupp/evo, v1.36), after Kuemmerle et al. 2009 and Sturm et al. 2012;
// figures are equal but for rounding. docs/evaluate.md says where slamdb goes further.
//
// Units: of the truth, as a rule metres; degrees; seconds.
namespace slamdb {

// How an estimate is laid onto the truth before errors are measured.
enum class AlignmentKind {
  kNone,    // it stays where it is
  kOrigin,  // its first paired pose comes onto that of the truth
  kScale,   // only its positions are multiplied, by the scale of kSim3
  kSe3,     // turned and moved, with the least squared distance of pairs (Umeyama)
  kSim3,    // and scaled
};
// `none`, `origin`, `scale`, `se3`, `sim3`.
[[nodiscard]] SLAMDB_EXPORT std::string_view NameOf(AlignmentKind kind);

// How far apart the two poses are that a relative error is of.
enum class DeltaUnit { kFrames, kMetres, kSeconds, kDegrees };
struct Delta {
  double value = 1;
  DeltaUnit unit = DeltaUnit::kFrames;
};
// `1 frame`, `10 frames`, `0.5 m`, `2 s`, `90 degrees`.
[[nodiscard]] SLAMDB_EXPORT std::string ToString(const Delta& delta);
// The way back, and `10f`, `0.5m`, `2s`, `90deg`, `90d`.
//
// Throws Error (kUsage) for anything else, also when no poses can be that far apart.
[[nodiscard]] SLAMDB_EXPORT Delta ParseDelta(std::string_view text);

struct EvaluationOptions {
  std::optional<AlignmentKind> alignment;  // by default kSim3 where the scale is open, and kSe3 elsewhere
  std::size_t align_first = 0;             // the alignment is solved from so many pairs, from the first; 0: from all

  double max_time_difference = 0.01;  // seconds, between the poses of a pair
  double time_offset = 0;             // seconds that the truth's clock is ahead of the estimate's
  bool estimate_time_offset = false;  // find it instead
  bool by_index = false;              // pair the first with the first and so on, whatever the times

  // Of relative errors.
  std::vector<Delta> deltas = {{1, DeltaUnit::kFrames}, {1, DeltaUnit::kMetres}, {1, DeltaUnit::kSeconds}};
  double delta_tolerance = 0.1;       // share of the delta that the distance may be off, where it is looked for
  bool all_pairs = false;             // from every pose, not one behind the other
  bool pairs_from_reference = false;  // distances are those of the truth, not of the estimate

  bool joint = false;  // all trajectories are one, in one frame, instead of each by itself
  int threads = 0;     // 0: every core
  Progress progress;   // may be empty
};

// A trajectory to be evaluated.
struct Estimate {
  MapId map;  // none: of no map
  std::vector<TrajectoryPose> poses;
  bool open_scale = false;  // it has no scale of its own, see IsMetric
};

// Two poses of one time, and the error between them.
struct PairedPose {
  double timestamp = 0, reference_timestamp = 0;  // seconds, each by its own clock
  Eigen::Vector3d position, reference_position;   // the estimate's as it was aligned
  Eigen::Quaterniond rotation, reference_rotation;
  double translation_error = 0, rotation_error_degrees = 0;
};

// The error of the motion from one pair to another.
struct RelativeError {
  std::size_t from = 0, to = 0;  // TrajectoryEvaluation::poses
  double translation = 0, rotation_degrees = 0;
};

// Statistics of errors. T and R are the translation and the rotation between estimate and truth.
struct AbsoluteErrors {
  ErrorStatistics translation;          // |T|
  ErrorStatistics rotation_degrees;     // angle of R
  ErrorStatistics rotation_part;        // |R - I|, Frobenius norm
  ErrorStatistics full_transformation;  // |[R T] - I|, Frobenius norm: mixes units
};
struct RelativeErrors {
  Delta delta;
  ErrorStatistics translation, rotation_degrees, rotation_part, full_transformation;  // of motions, as above
  ErrorStatistics point_distance;        // difference of the distances that were gone
  ErrorStatistics point_distance_ratio;  // in percent of the truth's, where that is not 0
  std::vector<RelativeError> errors;     // in order of time
};

// A stretch of the truth of which the estimate has nothing.
struct CoverageGap {
  double begin_time = 0, end_time = 0;  // seconds, the truth's clock
  double length = 0;                    // of the truth's path
};

// How much of each other the two trajectories cover.
struct TrajectoryCoverage {
  std::size_t estimate_poses = 0, reference_poses = 0, pairs = 0;
  double estimate_begin = 0, estimate_end = 0, reference_begin = 0, reference_end = 0;  // seconds, each by its clock
  double largest_time_difference = 0;  // of a pair, with the time offset taken away
  double estimate_length = 0;          // of the path through all poses, after the alignment
  double reference_length = 0;
  double gap_limit = 0;  // seconds: pairs farther apart leave a gap; five times their median distance, 1 s at least
  double covered_duration = 0, covered_length = 0;  // of the truth, between pairs, without gaps
  std::vector<CoverageGap> gaps;                    // in order of time, before the first and behind the last pair too

  double paired_share() const { return Share(static_cast<double>(pairs), static_cast<double>(estimate_poses)); }
  double duration_share() const { return Share(covered_duration, reference_end - reference_begin); }
  double length_share() const { return Share(covered_length, reference_length); }

 private:
  static double Share(double part, double whole) { return whole > 0 ? part / whole : part == whole ? 1 : 0; }
};

struct AppliedAlignment {
  AlignmentKind kind = AlignmentKind::kNone;
  Similarity3d reference_from_estimate;
  std::size_t pairs = 0;  // that it was solved from
  bool on_line = false;   // they lie on one line: the rotation about it is arbitrary
};

struct TrajectoryEvaluation {
  std::vector<MapId> maps;  // of the estimate: one, all of them when it is joint, none when it is of no map
  AppliedAlignment alignment;
  double time_offset = 0;  // as given or estimated
  TrajectoryCoverage coverage;
  AbsoluteErrors absolute;
  std::vector<RelativeErrors> relative;  // one for each delta
  std::vector<PairedPose> poses;         // in order of time
  std::vector<std::string> warnings;
};

// A trajectory that could not be evaluated.
struct UnevaluatedMap {
  MapId map;
  std::string reason;
};

struct EvaluationReport {
  std::vector<TrajectoryEvaluation> evaluations;
  std::vector<UnevaluatedMap> unevaluated;
};

// Each pose of the shorter trajectory is paired with the pose of the other one that is nearest in time, if it is near
// enough, as evo's associate_trajectories does; a pose of the longer one may so be in two pairs.
// Both may be in any order of time, unless they are paired by index. Poses that are not finite are left out.
//
// Throws Error:
//   kUsage        options make no sense, or trajectories that are paired by index differ in length
//   kNotPossible  too few pairs for the alignment (naming both time spans and what may help), or all in one place
// Cost: O(n log n); all pairs that are so many degrees apart are as many as n^2, and refused for more than 4,000 poses.
// The result is the same for any number of threads.
[[nodiscard]] SLAMDB_EXPORT TrajectoryEvaluation EvaluateTrajectory(const Estimate& estimate,
                                                                    std::span<const TrajectoryPose> reference,
                                                                    const EvaluationOptions& options = {});

// The same of several, each by itself or all jointly. One that cannot be evaluated is named in the report.
//
// Throws Error as above when none can be, or there is none.
[[nodiscard]] SLAMDB_EXPORT EvaluationReport EvaluateTrajectories(std::vector<Estimate> estimates,
                                                                  std::span<const TrajectoryPose> reference,
                                                                  const EvaluationOptions& options = {});

// What a report as JSON tells besides.
struct EvaluationReportOptions {
  std::string input, reference;  // names of files
  std::vector<std::string> breaches;
  bool with_errors = false;  // of every pose
};
// As schema/evaluate.schema.json describes it.
[[nodiscard]] SLAMDB_EXPORT std::string ToJson(const EvaluationReport& report,
                                               const EvaluationReportOptions& options = {});

// The paired poses and their errors as CSV, a row each behind a header.
[[nodiscard]] SLAMDB_EXPORT std::string ErrorTable(const EvaluationReport& report);

// The paired poses of the estimate, aligned, as a TUM trajectory; `# map ID` before each where there are several.
[[nodiscard]] SLAMDB_EXPORT std::string AlignedTrajectory(const EvaluationReport& report);

}  // namespace slamdb
