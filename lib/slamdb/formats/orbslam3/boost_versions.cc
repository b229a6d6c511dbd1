// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/formats/orbslam3/boost_versions.h"

#include <algorithm>

#include "slamdb/base/detail/concat.h"
#include "slamdb/base/detail/text.h"

namespace slamdb {
namespace {

using detail::Concat;

// Releases 1.first to 1.last write archives of this version (schema/orbslam3.md).
struct Releases {
  std::uint32_t version;
  int first, last;
};
constexpr Releases kReleases[] = {{10, 53, 55}, {11, 56, 57}, {12, 58, 58}, {13, 59, 59}, {14, 60, 63}, {15, 64, 65},
                                  {16, 66, 67}, {17, 68, 72}, {18, 73, 75}, {19, 76, 83}, {20, 84, 85}};

// The Boost 1.x that a system or a distribution of ROS has.
struct System {
  std::string_view name;
  int boost;
};
constexpr System kSystems[] = {
    {"ubuntu16.04", 58}, {"ubuntu18.04", 65}, {"ubuntu20.04", 71}, {"ubuntu22.04", 74}, {"ubuntu24.04", 83},
    {"debian9", 62},     {"debian10", 67},    {"debian11", 74},    {"debian12", 74},    {"debian13", 83},
    {"stretch", 62},     {"trixie", 83},      {"xenial", 58},      {"bionic", 65},      {"focal", 71},
    {"jammy", 74},       {"noble", 83},       {"buster", 67},      {"bullseye", 74},    {"bookworm", 74},
    {"kinetic", 58},     {"melodic", 65},     {"noetic", 71},      {"foxy", 71},        {"galactic", 71},
    {"humble", 74},      {"iron", 74},        {"jazzy", 83},       {"kilted", 83},
};

std::optional<std::uint32_t> VersionOfRelease(int minor) {
  const auto found = std::ranges::find_if(
      kReleases, [minor](const Releases& releases) { return releases.first <= minor && minor <= releases.last; });
  return found == std::end(kReleases) ? std::nullopt : std::optional(found->version);
}

}  // namespace

std::optional<std::uint32_t> BoostVersionByName(std::string_view name) {
  if (const auto number = detail::ParseNumber<std::uint32_t>(name)) {
    const auto known = std::ranges::find(kReleases, *number, &Releases::version);
    return known == std::end(kReleases) ? std::nullopt : number;
  }
  const auto parts = detail::Split(name, '.');  // 1.71 and 1.71.0
  if (parts.front() == "1" && (parts.size() == 2 || parts.size() == 3)) {
    const auto minor = detail::ParseNumber<int>(parts[1]);
    return minor && parts[1] == std::to_string(*minor) ? VersionOfRelease(*minor) : std::nullopt;
  }
  const auto system = std::ranges::find_if(kSystems, [name](const System& known) {
    return known.name == name || (known.name.starts_with("ubuntu") && known.name.substr(6) == name);  // 18.04
  });
  return system == std::end(kSystems) ? std::nullopt : VersionOfRelease(system->boost);
}

std::vector<std::string> NamesOfSystems() {
  std::vector<std::string> names;
  for (const System& system : kSystems) names.emplace_back(system.name);
  return names;
}

std::string WhyNoBoostVersion(std::string_view name) {
  const Releases &oldest = kReleases[0], &newest = *(std::end(kReleases) - 1);
  return Concat("expected a release of Boost (1.", oldest.first, " to 1.", newest.last,
                "), a system (ubuntu20.04, debian12, noetic, "
                "and others of their kind) or a version of the archive library (",
                oldest.version, " to ", newest.version, "), found '", name, "'");
}

std::string BoostReleases(std::uint32_t version) {
  const auto found = std::ranges::find(kReleases, version, &Releases::version);
  if (found == std::end(kReleases)) return {};
  const auto& [number, first, last] = *found;
  if (first == last) return Concat("Boost 1.", first);
  return Concat("Boost 1.", first, last == first + 1 ? ", 1." : " to 1.", last);
}

}  // namespace slamdb
