// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <optional>
#include <string>
#include <utility>

#include "python/src/arguments.h"
#include "python/src/arrays.h"
#include "slamdb/base/error.h"

// Arguments that tell a part of an atlas: map=, keyframes=, time=, box=.
namespace slamdb::python {

// (first, last), both included; None at either end: it is open.
template <class Number>
void TakeRange(Arguments& given, const char* name, Number& first, Number& last) {
  if (!given.Has(name)) return;
  const auto ends = given.Get<std::pair<std::optional<Number>, std::optional<Number>>>(name);
  first = ends.first.value_or(first);
  last = ends.second.value_or(last);
  if (!(first <= last))  // NaN is not
    throw Error(ErrorKind::kUsage, std::string(name) + "= is (first, last), and the first is behind the last");
}

// Two corners, in either order.
inline void TakeBox(Arguments& given, const char* name, std::optional<Eigen::AlignedBox3f>& into) {
  if (!given.Has(name)) return;
  RequireNumpy();
  const auto [one, other] = given.Get<std::pair<Eigen::Vector3f, Eigen::Vector3f>>(name);
  if (one.hasNaN() || other.hasNaN()) throw Error(ErrorKind::kUsage, std::string(name) + "= has a corner that is NaN");
  into = Eigen::AlignedBox3f(one).extend(other);
}

// Selection, or SelectOptions.
template <class Part>
void TakePart(Arguments& given, Part& part) {
  if (given.Has("map")) part.map = MapId(given.Get<std::uint64_t>("map"));
  TakeRange(given, "keyframes", part.first_keyframe, part.last_keyframe);
  TakeRange(given, "time", part.begin_time, part.end_time);
  TakeBox(given, "box", part.box);
}

}  // namespace slamdb::python
