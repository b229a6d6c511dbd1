// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sqlite3.h>

#include <Eigen/Geometry>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

// Makes databases as the versions of RTAB-Map did.
namespace slamdb {

using Blob = std::vector<std::uint8_t>;

// 12 floats, the rows of [R|t].
Blob PoseBlob(const Eigen::Isometry3d& pose);
// A zlib stream, rows, columns, type.
Blob MatrixBlob(const void* data, std::size_t bytes, int rows, int columns, int type);

// fx, fy, cx, cy, width, height, baseline (0: one camera) as that version writes them; the camera looks ahead.
struct ForgedCamera {
  float f = 100, cx = 64, cy = 48;
  int width = 128, height = 96;
  float baseline = 0;
  Eigen::Isometry3d local = Optical();
  static Eigen::Isometry3d Optical();  // x right, y down, z ahead
};
Blob CalibrationBlob(const std::string& version, const std::vector<ForgedCamera>& cameras);

struct ForgedFeature {
  int node, word;
  float x, y;
  Eigen::Vector3f place;  // in the robot's frame; not finite: none
  Blob descriptor;
  int descriptor_size = 32;
};

class Forge {
 public:
  Forge(const std::string& path, const std::string& version);

  void Execute(const std::string& sql);
  void AddNode(int id, int session, double stamp, const Eigen::Isometry3d& odometry, const Blob& calibration);
  void AddLink(int from, int to, int type);
  void AddFeature(const ForgedFeature& feature);
  void AddWord(int id, const Blob& descriptor);
  void SetOptimized(const std::vector<std::pair<int, Eigen::Isometry3d>>& poses);
  // Runs `sql` with one blob.
  void Bind(const std::string& sql, const Blob& blob);

 private:
  struct Close {
    void operator()(sqlite3* handle) const { sqlite3_close(handle); }
  };
  int minor_, patch_;  // of version 0
  std::unique_ptr<sqlite3, Close> handle_;
};

// A robot that drives ahead, 10 cm a node, towards a wall of points 4 m from where it began; node 4 closes a loop with
// node 1. Every node sees every point. `drift`: how far odometry is off at each further node, in metres along y.
inline constexpr int kNodes = 4, kPoints = 12;
Eigen::Vector3d WallPoint(int index);
Eigen::Isometry3d BaseAt(int node, double drift = 0);
ForgedFeature FeatureOf(int node, int point, const ForgedCamera& camera = {});
void AddDrive(Forge& forge, const std::string& version, const ForgedCamera& camera = {}, double drift = 0);

}  // namespace slamdb
