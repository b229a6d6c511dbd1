// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/output_name.h"

#include <filesystem>

#include "slamdb/base/atomic_file.h"
#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/server.h"
#include "slamdb/base/error.h"

namespace slamdb {

namespace fs = std::filesystem;

bool NamesFolder(const std::string& output) {
  if (detail::IsServer(output)) return false;
  std::error_code missing;
  if (output.ends_with('/') || fs::is_directory(output, missing)) return true;
  const bool plain = !output.empty() && output != "-" && !fs::exists(output, missing);
  return plain && fs::path(output).extension().empty() && output.find_first_of("#{") == std::string::npos;
}

void MakeFolder(const std::string& folder) {
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) throw Error(ErrorKind::kPermission, folder, "", "cannot be made: " + error.message());
}

std::string WhyNoPage(const std::string& output) {
  const std::string suffix = fs::path(output).extension().string();
  if (output == "-" || IsSpecialFile(output) || suffix == ".html" || suffix == ".htm") return {};
  return detail::Concat("a page is an .html, which ", output, " does not say; name it ",
                        fs::path(output).replace_extension(".html").string());
}

}  // namespace slamdb
