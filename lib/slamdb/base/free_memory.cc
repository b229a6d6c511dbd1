// SPDX-License-Identifier: BSD-3-Clause
#include "slamdb/base/detail/free_memory.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <limits>
#include <optional>
#include <sstream>
#include <string_view>

#include "slamdb/base/detail/text.h"

namespace slamdb::detail {
namespace {

constexpr std::uint64_t kUnlimited = std::numeric_limits<std::uint64_t>::max();

// Empty where there is no such file: whose size /proc and /sys do not tell.
std::string TextOf(const std::string& path) {
  std::ifstream file(path);
  std::ostringstream text;
  if (file) text << file.rdbuf();
  return std::move(text).str();
}

std::optional<std::uint64_t> NumberIn(const std::string& path) {
  const std::string text = TextOf(path);
  std::string_view rest = text;
  return ParseNumber<std::uint64_t>(TakeLine(rest));  // `max` is none
}

// The number behind a name: `MemAvailable:   23743572 kB`, `inactive_file 123`.
std::optional<std::uint64_t> NumberBehind(std::string_view text, std::string_view name) {
  while (!text.empty()) {
    std::string_view line = TakeLine(text);
    if (TakeWord(line, kBlanks) == name) return ParseNumber<std::uint64_t>(TakeWord(line, kBlanks));
  }
  return std::nullopt;
}

// What version 1 and 2 of control groups call the same.
struct GroupFiles {
  const char *limit, *used;
  const char* cached[2];  // in memory.stat
};
constexpr GroupFiles kVersion1{
    "memory.limit_in_bytes", "memory.usage_in_bytes", {"total_active_file", "total_inactive_file"}};
constexpr GroupFiles kVersion2{"memory.max", "memory.current", {"active_file", "inactive_file"}};

std::uint64_t FreeInGroup(const std::string& folder, const GroupFiles& files) {
  const auto limit = NumberIn(folder + "/" + files.limit);
  auto used = NumberIn(folder + "/" + files.used);
  if (!limit || !used) return kUnlimited;
  const std::string statistics = TextOf(folder + "/memory.stat");
  for (const char* cached : files.cached) *used -= std::min(*used, NumberBehind(statistics, cached).value_or(0));
  return *limit - std::min(*limit, *used);
}

// In a group and all those that it is in. In a container its path may be that outside, and its own folder the root.
std::uint64_t FreeInGroups(const std::string& mount, std::string_view group, const GroupFiles& files) {
  std::uint64_t free = FreeInGroup(mount, files);
  for (std::filesystem::path path = group; path.has_relative_path(); path = path.parent_path())
    free = std::min(free, FreeInGroup(mount + path.string(), files));
  return free;
}

}  // namespace

std::uint64_t FreeMemory(const std::string& root) {
  const auto kilobytes = NumberBehind(TextOf(root + "/proc/meminfo"), "MemAvailable:");
  std::uint64_t free = kilobytes ? *kilobytes * 1024 : kUnlimited;
  // Lines such as `0::/user.slice` (version 2) and `4:memory:/docker/1f3a` (version 1).
  const std::string groups = TextOf(root + "/proc/self/cgroup");
  for (std::string_view rest = groups; !rest.empty();) {
    std::string_view line = TakeLine(rest);
    line.remove_prefix(std::min(line.find(':'), line.size() - 1) + 1);
    const std::size_t colon = std::min(line.find(':'), line.size());
    const std::string_view controllers = line.substr(0, colon), group = line.substr(std::min(colon + 1, line.size()));
    if (controllers.empty()) free = std::min(free, FreeInGroups(root + "/sys/fs/cgroup", group, kVersion2));
    if (controllers == "memory") free = std::min(free, FreeInGroups(root + "/sys/fs/cgroup/memory", group, kVersion1));
  }
  return free;
}

}  // namespace slamdb::detail
