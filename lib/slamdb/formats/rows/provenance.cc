// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/rows/detail/provenance.h"

#include <unistd.h>

#include <array>
#include <cstdlib>

#include "slamdb/base/detail/concat.h"
#include "slamdb/version.h"

namespace slamdb::rows {

std::string HostName() {
  std::array<char, 256> name{};
  return ::gethostname(name.data(), name.size() - 1) == 0 ? name.data() : "unknown";
}

// By the environment: asking the system would need its libraries, which a static program lacks.
std::string Who() {
  const char* user = std::getenv("LOGNAME");
  if (user == nullptr || *user == '\0') user = std::getenv("USER");
  const std::string name = user != nullptr && *user != '\0' ? std::string(user)
                           : ::geteuid() == 0               ? std::string("root")
                                                            : detail::Concat("uid ", ::geteuid());
  return detail::Concat(name, "@", HostName());
}

std::string ToolName() { return detail::Concat("slamdb ", Version()); }

}  // namespace slamdb::rows
