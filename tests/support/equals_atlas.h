// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gmock/gmock.h>

#include <string>

#include "slamdb/model/atlas.h"

namespace slamdb {

// Where two atlases differ first, in the file's order: `map 0, kf 77, descriptors[12]: 3f.. instead of 40..`, empty
// when they are equal. Floats are compared by bits, so NaNs of the same payload are equal and 0 and -0 are not.
// Everything counts, the encoding of the file included. Thread-safe.
std::string FirstDifference(const Atlas& actual, const Atlas& expected);

// EXPECT_THAT(actual, EqualsAtlas(expected)). Keeps a reference to `expected`.
::testing::Matcher<const Atlas&> EqualsAtlas(const Atlas& expected);

}  // namespace slamdb
