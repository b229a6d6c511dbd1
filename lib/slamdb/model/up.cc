// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/model/up.h"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/error.h"
#include "slamdb/model/derive.h"
#include "slamdb/model/detail/is_pose.h"
#include "slamdb/model/index.h"

namespace slamdb {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

double DegreesBetween(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  return std::atan2(a.cross(b).norm(), a.dot(b)) / kDegree;
}

// An axis or the opposite one, as the sign says; the same on every machine where nothing decides.
Eigen::Vector3d Pointing(const Eigen::Vector3d& axis, double along) {
  constexpr double kDecides = 1e-6;
  Eigen::Index largest = 0;
  axis.cwiseAbs().maxCoeff(&largest);
  const double sign = std::abs(along) > kDecides ? along : axis[largest];
  return (sign < 0 ? Eigen::Vector3d(-axis) : axis) + Eigen::Vector3d::Zero();  // no negative zeros
}

// ---- Inertia

// One interval between keyframes: what its change of velocity owes to gravity, world, m/s.
struct Fall {
  Eigen::Vector3d change;
  double seconds;
};

// The change of velocity that the accelerometer felt since the keyframe before, by that one's newest bias; body frame.
Eigen::Vector3d FeltChange(const ImuPreintegration& imu, const ImuBias& bias) {
  const Eigen::Vector3f change = imu.velocity + imu.velocity_by_gyro * (bias.gyroscope - imu.bias.gyroscope) +
                                 imu.velocity_by_acc * (bias.accelerometer - imu.bias.accelerometer);
  return change.cast<double>();
}

std::vector<Fall> FallsOf(const Map& map) {
  std::vector<Fall> falls;
  if (!map.imu_initialized) return falls;
  const IdTable rows = KeyFrameTable(map);
  for (const KeyFrame& keyframe : map.keyframes) {
    const std::uint32_t row = rows.Find(keyframe.previous.value());
    const ImuPreintegration& imu = keyframe.preintegration;
    if (row == kNoRow || !(imu.duration > 0) || !keyframe.imu_calibration.is_set) continue;
    const KeyFrame& previous = map.keyframes[row];
    const Eigen::Quaterniond world_from_body = WorldFromBody(previous).rotation.cast<double>().normalized();
    const Eigen::Vector3d change =
        (keyframe.velocity - previous.velocity).cast<double>() - world_from_body * FeltChange(imu, previous.imu_bias);
    if (change.allFinite() && std::isfinite(imu.duration)) falls.push_back({change, imu.duration});
  }
  return falls;
}

std::optional<Eigen::Vector3d> GravityOf(const std::vector<Fall>& falls) {
  constexpr std::size_t kFewestIntervals = 2;
  Eigen::Vector3d change = Eigen::Vector3d::Zero();
  double seconds = 0;
  for (const Fall& fall : falls) change += fall.change, seconds += fall.seconds;
  if (falls.size() < kFewestIntervals || !(change.norm() > 0) || !change.allFinite()) return std::nullopt;
  return change / seconds;
}

std::optional<Up> ByInertia(const Map& map) {
  const std::vector<Fall> falls = FallsOf(map);
  const std::optional<Eigen::Vector3d> gravity = GravityOf(falls);
  if (!gravity) return std::nullopt;
  double squares = 0, seconds = 0;
  for (const Fall& fall : falls) {
    squares += fall.seconds * std::pow(DegreesBetween(fall.change, *gravity), 2);
    seconds += fall.seconds;
  }
  return Up{.direction = -gravity->normalized(),
            .method = UpMethod::kInertia,
            .spread = std::sqrt(squares / seconds),
            .gravity = gravity->norm()};
}

// ---- Cameras and their path

// What all cameras have in common.
struct Cameras {
  std::vector<Eigen::Vector3d> centers;
  Eigen::Vector3d mean_y = Eigen::Vector3d::Zero(), mean_z = Eigen::Vector3d::Zero();  // of their axes, world
  Eigen::Matrix3d squares_x = Eigen::Matrix3d::Zero(), squares_z = Eigen::Matrix3d::Zero();
};

Cameras CamerasOf(const Map& map) {
  Cameras cameras;
  for (const KeyFrame& keyframe : map.keyframes) {
    const Rigid3f& pose = keyframe.camera_from_world;
    if (keyframe.bad || !detail::IsPose(pose)) continue;
    const Eigen::Matrix3d axes = pose.rotation.cast<double>().normalized().conjugate().toRotationMatrix();
    cameras.centers.push_back(CameraCenter(keyframe).cast<double>());
    cameras.mean_y += axes.col(1);
    cameras.mean_z += axes.col(2);
    cameras.squares_x += axes.col(0) * axes.col(0).transpose();
    cameras.squares_z += axes.col(2) * axes.col(2).transpose();
  }
  const double count = std::max<double>(1, static_cast<double>(cameras.centers.size()));
  cameras.mean_y /= count;
  cameras.mean_z /= count;
  cameras.squares_x /= count;
  cameras.squares_z /= count;
  return cameras;
}

// A direction with the side that cameras say: their upper edges are up, or, where they look straight down, their backs.
struct Sided {
  Eigen::Vector3d up;
  bool is_clear;
};
Sided SideOf(const Cameras& cameras, const Eigen::Vector3d& normal) {
  constexpr double kUpperEdge = 0.3, kLooksDown = 0.7;  // of means of unit vectors
  const double upper = -cameras.mean_y.dot(normal), back = -cameras.mean_z.dot(normal);
  const bool looks_down = std::abs(upper) < kUpperEdge && std::abs(back) > kLooksDown;
  return {Pointing(normal, looks_down ? back : upper), looks_down || std::abs(upper) >= kUpperEdge};
}

// Level x axes fix up where cameras turn about it. Where they hardly do, what they roll decides, and that most look
// level must keep up from what is ahead.
Eigen::Vector3d NormalOfLevel(const Cameras& cameras) {
  constexpr double kAhead = 0.1;  // measured where truth is known: of 0.01 to 0.2 the least wrong, at most by 5 degrees
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(cameras.squares_x + kAhead * cameras.squares_z);
  return solver.eigenvectors().col(0);
}

// Whether they agree is `clear`.
Up ByCameras(const Cameras& cameras, bool* clear = nullptr) {
  constexpr double kMostRoll = 25;  // degrees
  const Eigen::Vector3d normal = NormalOfLevel(cameras);
  const Sided sided = SideOf(cameras, normal);
  const double roll = std::asin(std::min(1.0, std::sqrt(std::max(0.0, normal.dot(cameras.squares_x * normal)))));
  const Up up{.direction = sided.up, .method = UpMethod::kCameras, .spread = roll / kDegree};
  if (clear != nullptr) *clear = sided.is_clear && up.spread <= kMostRoll;
  return up;
}

// nullopt where the path is a line.
std::optional<Up> ByPath(const Cameras& cameras) {
  constexpr double kLine = 1e-4;  // of the variances, middle to largest
  const auto count = static_cast<double>(cameras.centers.size());
  Eigen::Vector3d mean = Eigen::Vector3d::Zero();
  for (const Eigen::Vector3d& center : cameras.centers) mean += center / count;
  Eigen::Matrix3d covariance = Eigen::Matrix3d::Zero();
  for (const Eigen::Vector3d& center : cameras.centers)
    covariance += (center - mean) * (center - mean).transpose() / count;
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> solver(covariance);
  const Eigen::Vector3d variances = solver.eigenvalues().cwiseMax(0);  // ascending
  if (!covariance.allFinite() || !(variances[1] > kLine * variances[2])) return std::nullopt;
  return Up{.direction = SideOf(cameras, solver.eigenvectors().col(0)).up,
            .method = UpMethod::kPath,
            .spread = std::atan(std::sqrt(variances[0] / variances[1])) / kDegree,
            .off_path = std::sqrt(variances[0])};
}

// ---- All of them

// What the map itself tells, if anything does.
std::optional<Up> Told(const Map& map, const Cameras& cameras) {
  if (auto up = ByInertia(map)) return up;
  if (cameras.centers.empty()) return std::nullopt;
  bool agree = false;
  const Up up = ByCameras(cameras, &agree);
  if (agree) return up;
  constexpr double kPlane = 12;  // degrees
  constexpr std::size_t kFewestStops = 4;
  auto path = ByPath(cameras);
  return path && path->spread <= kPlane && cameras.centers.size() >= kFewestStops ? path : std::nullopt;
}

Error CannotTell(const Map& map, std::string_view why) {
  return {ErrorKind::kNotPossible, detail::Concat(map.id, why)};
}

}  // namespace

std::string_view NameOf(UpMethod method) {
  constexpr std::array<std::string_view, 5> kNames = {"inertia", "frame", "cameras", "path", "convention"};
  return kNames.at(static_cast<std::size_t>(method));
}

Up UpOf(const Map& map) {
  constexpr double kLevelled = 3;  // degrees: about what cameras that turn are wrong by
  std::optional<Up> up = Told(map, CamerasOf(map));
  if (!up) return {.direction = map.imu_initialized ? Eigen::Vector3d::UnitZ() : Eigen::Vector3d(0, -1, 0)};
  if (up->method == UpMethod::kCameras && DegreesBetween(up->direction, Eigen::Vector3d::UnitZ()) <= kLevelled) {
    up->direction = Eigen::Vector3d::UnitZ();
    up->method = UpMethod::kFrame;
  }
  return *up;
}

std::vector<Up> UpsOf(const std::vector<const Map*>& maps, bool in_one_frame) {
  constexpr double kErrorOfInertia = 3, kErrorOfOthers = 15;  // degrees
  std::vector<Up> ups;
  for (const Map* map : maps) ups.push_back(UpOf(*map));
  std::vector<std::size_t> surest(maps.size());
  std::iota(surest.begin(), surest.end(), std::size_t{0});
  std::ranges::stable_sort(surest, [&](std::size_t a, std::size_t b) {
    if (ups[a].method != ups[b].method) return ups[a].method < ups[b].method;
    return maps[a]->keyframes.size() > maps[b]->keyframes.size();
  });
  std::vector<Up> shared;
  for (const std::size_t row : surest) {
    const auto is_that = [&](const Up& other) {
      const bool both = ups[row].method == UpMethod::kInertia && other.method == UpMethod::kInertia;
      return in_one_frame || ups[row].method == UpMethod::kConvention ||
             DegreesBetween(ups[row].direction, other.direction) <= (both ? kErrorOfInertia : kErrorOfOthers);
    };
    const auto found = std::ranges::find_if(shared, is_that);
    if (found == shared.end())
      shared.push_back(ups[row]);
    else
      ups[row] = *found;
  }
  return ups;
}

Up FindUp(const Map& map, std::optional<UpMethod> method) {
  const Cameras cameras = CamerasOf(map);
  if (cameras.centers.empty()) throw CannotTell(map, " has no keyframe that could tell which way is up");
  if (!method) {
    if (auto up = Told(map, cameras)) return *up;
    throw CannotTell(map,
                     "'s cameras are held every way, and do not move in a plane: they do not tell which way is up");
  }
  switch (*method) {
    case UpMethod::kInertia:
      if (auto up = ByInertia(map)) return *up;
      throw CannotTell(map, " has no initialised IMU to tell which way is up; find it by the cameras or by the path");
    case UpMethod::kCameras:
      return ByCameras(cameras);
    case UpMethod::kPath:
      if (auto up = ByPath(cameras)) return *up;
      throw Error(ErrorKind::kNotPossible, detail::Concat("the cameras of ", map.id,
                                                          " lie on one line, which no plane fits; find up by the "
                                                          "cameras instead"));
    case UpMethod::kFrame:
    case UpMethod::kConvention:
      break;
  }
  throw Error(ErrorKind::kUsage, "up is found by inertia, by the cameras or by their path");
}

Eigen::Quaterniond UprightFromMap(const Eigen::Vector3d& up) {
  constexpr double kNearlyDown = -0.98;  // cosine
  const auto smallest = [](const Eigen::Vector3d& direction) {
    return Eigen::Quaterniond::FromTwoVectors(direction, Eigen::Vector3d::UnitZ());
  };
  const Eigen::Quaterniond half_turn(0, 1, 0, 0);
  return up.z() < kNearlyDown * up.norm() ? smallest(half_turn * up) * half_turn : smallest(up);
}

std::optional<std::string> NearAxis(const Eigen::Vector3d& direction) {
  static const double kNear = std::cos(10 * kDegree);
  Eigen::Index axis = 0;
  if (!(direction.cwiseAbs().maxCoeff(&axis) >= kNear * direction.norm())) return std::nullopt;
  return detail::Concat(direction[axis] < 0 ? "-" : "", "xyz"[axis]);
}

std::string FrameText(const Up& up) {
  const std::optional<std::string> axis = NearAxis(up.direction);
  const auto digits = [&](Eigen::Index i) { return detail::Digits(std::round(100 * up.direction[i]) / 100 + 0.0); };
  return detail::Concat(!axis                  ? detail::Concat("up along ", digits(0), " ", digits(1), " ", digits(2))
                        : axis->front() == '-' ? axis->substr(1) + " down"
                                               : *axis + " up",
                        " (by ", NameOf(up.method), ")");
}

std::optional<Eigen::Vector3d> GravityByInertia(const Map& map) { return GravityOf(FallsOf(map)); }

}  // namespace slamdb
