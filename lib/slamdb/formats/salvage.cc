// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/salvage.h"

#include <algorithm>

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/mrpt/detail/mrpt.h"
#include "slamdb/formats/orbslam3/detail/salvage.h"
#include "slamdb/formats/orbslam3/orbslam3.h"
#include "slamdb/formats/sqlite/detail/salvage.h"

namespace slamdb {

namespace {

// Whether nothing but its name says what the file is: a disk that was not written in time holds zeros.
bool IsArchiveThatBeginsWithZeros(const Location& location) {
  if (!location.path.ends_with(".osa")) return false;
  const std::string head = Probe::Of(location.path).head;
  return !head.empty() && std::all_of(head.begin(), head.end(), [](char byte) { return byte == 0; });
}

}  // namespace

Salvage SalvageAtlas(const Location& location, const ReadOptions& options, std::string_view from) {
  if (from.empty() && IsArchiveThatBeginsWithZeros(location)) from = kOrbslam3Format.id;
  const Format& format = FormatOfInput(location, from);
  if (format.id == "orbslam3" || format.id == "orbslam3-text") return SalvageOrbslam3(location.path, options);
  if (format.id == "store") return SalvageStore(location.path, location.name, options);
  if (format.id == "mrpt" || format.id == "mrpt3") return SalvageMrpt(location.path);
  throw Error(location.path, "",
              "is a " + std::string(format.title) + "; only ORB-SLAM3 files, stores and MRPT landmarks are recovered");
}

}  // namespace slamdb
