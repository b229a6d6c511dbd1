// SPDX-License-Identifier: BSD-3-Clause
#include "cli/exports.h"

#include <algorithm>
#include <filesystem>

#include "slamdb/base/error.h"
#include "slamdb/formats/formats.h"

namespace slamdb::cli {
namespace {

// By its first bytes; stores are guarded where files are replaced.
bool ReadsAsAtlas(const std::string& path) {
  std::error_code missing;
  if (!std::filesystem::is_regular_file(path, missing)) return false;
  try {
    const Probe probe = Probe::Of(path);
    const auto format = std::ranges::find_if(
        Formats(), [&](const Format& known) { return known.sniff != nullptr && known.sniff(probe); });
    // ndjson, which tells all, is what `dump` prints too, and made again.
    return format != Formats().end() && !format->named && format->id != "ndjson" &&
           HasAny(format->reads, Content::kObservations | Content::kLandmarks);
  } catch (const Error&) {
    return false;  // whoever writes there will say what is wrong with it
  }
}

}  // namespace

void RefuseAtlas(const std::string& output) {
  if (ReadsAsAtlas(output))
    throw Error(ErrorKind::kAlreadyExists, output, "",
                "is an atlas, which only an atlas replaces; name another output, or remove it first");
}

void GuardDefaultName(const std::string& output) {
  std::error_code missing;
  if (std::filesystem::is_symlink(std::filesystem::symlink_status(output, missing)))
    throw Error(ErrorKind::kUsage, output, "",
                "is a symbolic link, which is followed only where -o/--output names it; name the output");
  RefuseAtlas(output);
}

}  // namespace slamdb::cli
