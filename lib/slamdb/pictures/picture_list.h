// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "slamdb/export.h"

namespace slamdb {

// A picture that was named, or that a folder or a list holds.
struct PictureFile {
  std::string path;
  double timestamp = 0;   // seconds: of the list, or of a name that is a number, else the place in the order, from 1
  bool has_time = false;  // it is not the place in the order
};

// What each name stands for:
//   a folder            its files with the suffix of a picture, by name; folders in it are not entered
//   a list (.txt .csv)  a picture a line, with its time before it or not: `1305031102.175304 rgb/1.png` (TUM),
//                       `1403636579763555584,1403636579763555584.png` (EuRoC), `a.png`; a table's other columns are
//                       passed over, and so are lines that begin with #. Paths are relative to the list, or to `data`
//                       beside it
//   anything else       itself
// Names that are numbers are seconds; whole numbers of 16 digits or more are nanoseconds.
//
// Throws Error: as WholeFile does for a list; kNotFound for a folder without pictures; kDamaged, with the line, for a
// list that names none; kOutOfResources beyond a million pictures.
[[nodiscard]] SLAMDB_EXPORT std::vector<PictureFile> FindPictures(std::span<const std::string> named);

}  // namespace slamdb
