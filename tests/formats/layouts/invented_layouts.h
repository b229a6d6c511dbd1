// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <random>
#include <string>
#include <string_view>
#include <vector>

#include "slamdb/base/file.h"
#include "slamdb/formats/layouts/layout.h"
#include "slamdb/model/atlas.h"

// Forks that nobody wrote: ORB-SLAM3 v1.0 with members more or less, and files of them with values that programs write.
namespace slamdb::testing {

struct Invention {
  Layout layout;                     // members that are new are called x1, x2, ...
  std::vector<std::string> changes;  // for people
};

struct InventionOptions {
  int insertions = 1, removals = 0;
  // Classes that are changed; empty: any of those that a fork changes.
  std::vector<std::string> classes;
};

// Changes of v1.0, each a line: `+Class.member name:type` puts one in behind it, `-Class.member` takes it out,
// `~Class.member name:type` writes it so, `^Class.member` puts it in front of its neighbour.
Layout Changed(std::string_view changes);

Invention InventLayout(std::mt19937_64& random, const InventionOptions& options);

// The bytes of the atlas in the layout: values for all that is new.
std::string Forge(const Atlas& atlas, const Layout& layout, std::mt19937_64& random);

// fixtures/session_small_a, of ORB-SLAM3 v1.0.
const Atlas& RealSession();

Source In(const std::string& bytes);
Atlas ReadAs(const std::string& bytes, const std::string& layout);

// What two readings of one file have in common when both are right: all that v1.0 holds.
std::string OwnBytes(Atlas atlas);
// Keyframes with times, poses and matches, points with positions and observations.
bool SameCore(const Atlas& a, const Atlas& b);

}  // namespace slamdb::testing
