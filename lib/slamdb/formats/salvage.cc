// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/salvage.h"

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"
#include "slamdb/formats/orbslam3/salvage.h"
#include "slamdb/formats/sqlite/salvage.h"

namespace slamdb {

Salvage SalvageAtlas(const Location& location, const ReadOptions& options, std::string_view from) {
  const Format& format = FormatOfInput(location, from);
  if (format.id == "orbslam3" || format.id == "orbslam3-text") return SalvageOrbslam3(location.path, options);
  if (format.id == "store") return SalvageStore(location.path, location.name, options);
  throw Error(location.path, "",
              "is a " + std::string(format.title) + "; only ORB-SLAM3 files and stores are recovered");
}

}  // namespace slamdb
