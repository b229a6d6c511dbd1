// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/error.h"

#include <cerrno>
#include <system_error>

namespace slamdb {
namespace {

std::string Sentence(const std::string& path, const std::string& place, const std::string& problem) {
  std::string text;
  for (const std::string* part : {&path, &place, &problem}) {
    if (part->empty()) continue;
    if (!text.empty()) text += ": ";
    text += *part;
  }
  return text;
}

}  // namespace

Error::Error(std::string path, std::string place, std::string problem)
    : std::runtime_error(Sentence(path, place, problem)),
      path_(std::move(path)),
      place_(std::move(place)),
      problem_(std::move(problem)) {}

Error SystemError(const std::string& path, const std::string& problem) {
  return Error(path, "", problem + ": " + std::generic_category().message(errno));
}

}  // namespace slamdb
