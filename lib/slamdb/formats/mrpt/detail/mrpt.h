// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include "slamdb/formats/format.h"

namespace slamdb::detail {

// Landmarks as MRPT keeps them: streams of mrpt::maps::CLandmarksMap objects, plain or, where the name ends in `.gz`,
// compressed. Reading takes either layout by its content and any number of objects; each map object becomes a map
// without keyframes, and the next id of a point is above all ids. Salvaging gives the landmarks in front of what is
// damaged or cut. schema/mrpt.md has the bytes.
extern const Format kMrptFormat;      // mrpt: MRPT 2
extern const Format kMrpt3Format;     // mrpt3: MRPT 3, whose landmarks have no features, normals and times
extern const Format kMrptTextFormat;  // mrpt-text: what CLandmarksMap::saveToTextFile of MRPT 2 writes; write only

}  // namespace slamdb::detail
