// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "slamdb/edit/merge/detail/branch_landmarks.h"
#include "slamdb/edit/merge/detail/point_classes.h"
#include "slamdb/model/atlas.h"

// What the format of a side has no place for, as an .osa file for landmarks: nobody deleted it there.
namespace slamdb::detail {

// What the base has, and a side has nowhere.
struct Unrecorded {
  bool landmarks = false;
  bool tracking = false;  // counts and origin maps of points
  bool members = false;   // of the fork whose layout the base has; the side has another one

  bool Any() const { return landmarks || tracking || members; }
};

bool HasMembersOfAFork(const Atlas& atlas);

Unrecorded UnrecordedIn(const Atlas& side, const Atlas& base);

// The base as the format of the side holds it.
Atlas Without(const Unrecorded& what, Atlas base, const Atlas& side);

// Gives a side what it could not record of what it still has, as the base has it; ids are those of UnifyIds. Landmarks
// lie in the frame of the side where they lie in the base: for FollowPoints, by row of the side's maps, where their
// points lay then. Maps of landmarks alone are there again, behind the others.
//
// Cost: linear.
std::vector<PlacesOfPoints> TakeOver(const Unrecorded& what, const Atlas& base, const PointClasses& classes,
                                     int threads, Atlas& side);

}  // namespace slamdb::detail
