// SPDX-License-Identifier: BSD-3-Clause
#include "cli/exports.h"

#include <filesystem>

#include "cli/options.h"
#include "slamdb/base/error.h"
#include "slamdb/base/output_name.h"

namespace slamdb::cli {

void GuardDefaultName(const std::string& output) {
  std::error_code missing;
  if (std::filesystem::is_symlink(std::filesystem::symlink_status(output, missing)))
    throw Error(ErrorKind::kUsage, output, "",
                "is a symbolic link, which is followed only where -o/--output names it; name the output");
  RefuseAtlas(output);
}

void RequirePageName(const std::string& output) {
  if (const std::string why = WhyNoPage(output); !why.empty()) RefuseUsage(why);
}

PlotFormat PictureFormatOf(const std::string& output) try {
  return output == "-" ? PlotFormat::kSvg : PlotFormatOf(output);
} catch (const Error& error) {
  RefuseUsage(error.problem());
}

}  // namespace slamdb::cli
