// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

// Files written by ORB-SLAM3 itself, most of them too large for the repository.
namespace slamdb {

inline constexpr std::array kRealAtlases = {
    "mono_small",      "mono_small_text", "mono_small_twice", "mono_small_newmap", "mono_dist",
    "stereo_inertial", "fisheye_stereo",  "multimap_rgbd",    "session_small_a",   "session_small_b",
    "race_mono",       "session_a",       "session_b"};

// The path of an atlas: in the folder that SLAMDB_ATLASES names, or among the fixtures; empty when it is in neither.
inline std::string RealAtlas(const std::string& name) {
  const char* folder = std::getenv("SLAMDB_ATLASES");
  const std::filesystem::path fixture = std::filesystem::path(SLAMDB_FIXTURES) / name / (name + ".osa");
  const std::filesystem::path path = std::filesystem::path(folder ? folder : "") / (name + ".osa");
  if (folder && std::filesystem::exists(path)) return path.string();
  return std::filesystem::exists(fixture) ? fixture.string() : std::string();
}

inline std::string ReadWhole(const std::string& path) {
  std::ifstream stream(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
}

}  // namespace slamdb

// Leaves the test as skipped, by name, when the file is not there.
#define SLAMDB_REQUIRE_REAL_ATLAS(path, name)       \
  const std::string path = slamdb::RealAtlas(name); \
  if (path.empty()) GTEST_SKIP() << (name) << ".osa: not a fixture, and SLAMDB_ATLASES names no folder that holds it"
