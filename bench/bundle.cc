// SPDX-License-Identifier: BSD-3-Clause
// slamdb_bundle_bench [FILE... | KEYFRAMES POINTS]: bundle adjustment of an atlas's first map beside plain Ceres on the
// same problem, as one would write it straight: automatic derivatives, a quaternion manifold, one thread or all.
// The problem is shaken first, the same for both, so that there is something to do.
#include <ceres/autodiff_cost_function.h>
#include <ceres/loss_function.h>
#include <ceres/manifold.h>
#include <ceres/problem.h>
#include <ceres/product_manifold.h>
#include <ceres/solver.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <thread>
#include <vector>

#include "slamdb/formats/formats.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/index.h"
#include "slamdb/model/reprojection.h"
#include "slamdb/optimize/bundle_adjustment.h"
#include "slamdb/synthetic/synthesize.h"

namespace slamdb {
namespace {

// A sighting of a pinhole camera, with the column in the right picture where there is one.
struct Sighting {
  double x, y, right_x, inverse_sigma, fx, fy, cx, cy, baseline_fx;

  template <class T>
  bool operator()(const T* pose, const T* point, T* residuals) const {
    const Eigen::Map<const Eigen::Quaternion<T>> rotation(pose);
    const Eigen::Matrix<T, 3, 1> seen =
        rotation * Eigen::Map<const Eigen::Matrix<T, 3, 1>>(point) + Eigen::Map<const Eigen::Matrix<T, 3, 1>>(pose + 4);
    const T column = fx * seen.x() / seen.z() + cx;
    residuals[0] = (column - x) * inverse_sigma;
    residuals[1] = (fy * seen.y() / seen.z() + cy - y) * inverse_sigma;
    if (right_x >= 0) residuals[2] = (column - baseline_fx / seen.z() - right_x) * inverse_sigma;
    return true;
  }
};

struct Problem {
  std::vector<std::array<double, 7>> poses;
  std::vector<Eigen::Vector3d> points;
};

Sighting SightingOf(const AtlasIndex& index, const KeyFrame& keyframe, std::int32_t row) {
  const Keypoint& keypoint = *ObservedKeypoint(keyframe, row);
  const std::vector<float>& camera = index.FindCamera(keyframe.camera)->parameters;
  const auto at = static_cast<std::size_t>(row);
  const auto wide = [](float value) { return static_cast<double>(value); };
  const Features& features = keyframe.features;
  return {.x = wide(keypoint.x),
          .y = wide(keypoint.y),
          .right_x = at < features.right_x.size() ? wide(features.right_x[at]) : -1,
          .inverse_sigma = std::sqrt(wide(keyframe.pyramid.inverse_sigma2[static_cast<std::size_t>(keypoint.octave)])),
          .fx = wide(camera[0]),
          .fy = wide(camera[1]),
          .cx = wide(camera[2]),
          .cy = wide(camera[3]),
          .baseline_fx = wide(keyframe.intrinsics.baseline_fx)};
}

void AddSightings(const AtlasIndex& index, Problem& states, ceres::Problem& problem) {
  const Map& map = index.atlas().maps[0];
  for (const KeyFrame& keyframe : map.keyframes) {
    const Rigid3f pose = keyframe.camera_from_world.Normalized();
    std::array<double, 7>& values = states.poses.emplace_back();
    Eigen::Map<Eigen::Quaterniond>{values.data()} = pose.rotation.cast<double>();
    Eigen::Map<Eigen::Vector3d>{values.data() + 4} = pose.translation.cast<double>();
  }
  for (const MapPoint& point : map.points) states.points.emplace_back(point.position.cast<double>());
  for (std::size_t row = 0; row < map.points.size(); ++row)
    for (const Observation& observation : map.points[row].observations) {
      const std::uint32_t keyframe = index.KeyFrameRow(0, observation.keyframe);
      if (keyframe == kNoRow || observation.left < 0) continue;
      const auto* sighting = new Sighting(SightingOf(index, map.keyframes[keyframe], observation.left));
      ceres::CostFunction* cost = nullptr;
      ceres::LossFunction* loss = nullptr;
      if (sighting->right_x >= 0) {
        cost = new ceres::AutoDiffCostFunction<Sighting, 3, 7, 3>(const_cast<Sighting*>(sighting));
        loss = new ceres::HuberLoss(std::sqrt(7.815));
      } else {
        cost = new ceres::AutoDiffCostFunction<Sighting, 2, 7, 3>(const_cast<Sighting*>(sighting));
        loss = new ceres::HuberLoss(std::sqrt(5.991));
      }
      problem.AddResidualBlock(cost, loss, states.poses[keyframe].data(), states.points[row].data());
    }
}

double PlainCeres(Atlas& atlas, int threads) {
  const auto begin = std::chrono::steady_clock::now();
  const AtlasIndex index(atlas);
  Problem states;
  states.poses.reserve(atlas.maps[0].keyframes.size());
  states.points.reserve(atlas.maps[0].points.size());
  ceres::Problem problem;
  AddSightings(index, states, problem);
  auto* manifold = new ceres::ProductManifold<ceres::EigenQuaternionManifold, ceres::EuclideanManifold<3>>();
  for (auto& pose : states.poses)
    if (problem.HasParameterBlock(pose.data())) problem.SetManifold(pose.data(), manifold);
  problem.SetParameterBlockConstant(states.poses[0].data());
  ceres::Solver::Options options;
  options.linear_solver_type = ceres::SPARSE_SCHUR;
  options.max_num_iterations = 100;
  options.function_tolerance = 1e-7;
  options.num_threads = threads;
  options.logging_type = ceres::SILENT;
  ceres::Solver::Summary summary;
  ceres::Solve(options, &problem, &summary);
  Map& map = atlas.maps[0];
  for (std::size_t row = 0; row < states.poses.size(); ++row) {
    const auto& values = states.poses[row];
    map.keyframes[row].camera_from_world = {Quaternionf(Eigen::Quaterniond(values.data()).cast<float>()),
                                            Eigen::Vector3d(values[4], values[5], values[6]).cast<float>()};
  }
  for (std::size_t row = 0; row < states.points.size(); ++row)
    map.points[row].position = states.points[row].cast<float>();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double Ours(Atlas& atlas) {
  const auto begin = std::chrono::steady_clock::now();
  AdjustBundle(atlas, atlas.maps[0].id, {.iterations = 100});
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

void Shake(Map& map) {
  std::mt19937 random(7);
  const auto step = [&](float size) {
    const auto number = [&] {
      return size * (static_cast<float>(random()) / static_cast<float>(std::mt19937::max()) * 2 - 1);
    };
    return Eigen::Vector3f(number(), number(), number());
  };
  for (KeyFrame& keyframe : map.keyframes)
    if (keyframe.id != map.keyframes[0].id) keyframe.camera_from_world.translation += step(0.02F);
  for (MapPoint& point : map.points) point.position += step(0.02F);
}

double MeanError(const Atlas& atlas) {
  const Reprojection reprojection(atlas, atlas.maps[0]);
  double sum = 0, count = 0;
  for (const MapPoint& point : atlas.maps[0].points)
    if (const float mean = reprojection.Mean(point); std::isfinite(mean)) {
      sum += static_cast<double>(mean);
      ++count;
    }
  return sum / count;
}

// In a process of its own, so that its memory is its own.
template <class Work>
void Measure(const char* name, Atlas& atlas, const Work& work) {
  std::fflush(stdout);
  if (const pid_t child = ::fork(); child != 0) {
    ::waitpid(child, nullptr, 0);
    return;
  }
  struct rusage before {};
  ::getrusage(RUSAGE_SELF, &before);
  const double seconds = work(atlas);
  struct rusage after {};
  ::getrusage(RUSAGE_SELF, &after);
  std::printf("  %-28s %8.2f s  %6ld MB more  %.4f px\n", name, seconds, (after.ru_maxrss - before.ru_maxrss) / 1024,
              MeanError(atlas));
  std::fflush(stdout);
  ::_exit(0);
}

void Compare(const std::string& name, Atlas atlas) {
  if (!atlas.maps.empty()) Shake(atlas.maps[0]);
  std::printf("%s: %zu keyframes, %zu points, shaken to %.3f px\n", name.c_str(), atlas.maps[0].keyframes.size(),
              atlas.maps[0].points.size(), MeanError(atlas));
  Measure("slamdb, two rounds", atlas, Ours);
  Measure("plain Ceres, 1 thread", atlas, [](Atlas& a) { return PlainCeres(a, 1); });
  const int cores = static_cast<int>(std::thread::hardware_concurrency());
  Measure("plain Ceres, all threads", atlas, [=](Atlas& a) { return PlainCeres(a, cores); });
}

}  // namespace
}  // namespace slamdb

int main(int argc, char** argv) {
  const std::vector<std::string> arguments(argv + 1, argv + argc);
  if (arguments.size() == 2 && std::atoi(arguments[0].c_str()) > 0) {
    const auto keyframes = static_cast<std::size_t>(std::atoi(arguments[0].c_str()));
    const auto points = static_cast<std::size_t>(std::atoi(arguments[1].c_str()));
    slamdb::Compare("synthetic",
                    slamdb::SynthesizeAtlas(
                        {.sensor = slamdb::Sensor::kRgbd, .keyframes = keyframes, .points = points, .features = 1000}));
    return 0;
  }
  for (const std::string& path : arguments) slamdb::Compare(path, slamdb::ReadAtlas(path));
  return 0;
}
