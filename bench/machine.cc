// SPDX-License-Identifier: BSD-3-Clause
#include "bench/machine.h"

#include <sched.h>
#include <sys/mman.h>
#include <sys/statfs.h>
#include <sys/utsname.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <functional>
#include <string_view>
#include <utility>
#include <vector>

#include "slamdb/base/error.h"

namespace slamdb::bench {
namespace {

std::string FirstLine(const std::string& path) {
  std::ifstream stream(path);
  std::string line;
  std::getline(stream, line);
  return line;
}

// The value behind `name` and a colon in a file of such lines.
std::string ValueIn(const std::string& path, std::string_view name) {
  std::ifstream stream(path);
  for (std::string line; std::getline(stream, line);)
    if (line.starts_with(name)) return line.substr(line.find_first_not_of(" \t", line.find(':') + 1));
  return "unknown";
}

int AllowedCores() {
  cpu_set_t allowed;
  sched_getaffinity(0, sizeof(allowed), &allowed);
  return CPU_COUNT(&allowed);
}

std::string Caches() {
  std::string text;
  for (int i = 0;; ++i) {
    const std::string cache = "/sys/devices/system/cpu/cpu0/cache/index" + std::to_string(i) + "/";
    const std::string size = FirstLine(cache + "size");
    if (size.empty()) return text.empty() ? "unknown" : text;
    if (FirstLine(cache + "type") == "Instruction") continue;
    text += (text.empty() ? "L" : ", L") + FirstLine(cache + "level") + " " + size;
  }
}

std::string Kernel() {
  utsname names{};
  uname(&names);
  return std::string(names.sysname) + " " + names.release + ", " + names.machine;
}

std::string FileSystem(const std::string& folder) {
  struct statfs found {};
  if (statfs(folder.c_str(), &found) != 0) return "unknown";
  for (const auto& [number, name] : {std::pair{0xEF53L, "ext4"},
                                     {0x794C7630L, "overlay"},
                                     {0x01021994L, "tmpfs"},
                                     {0x58465342L, "xfs"},
                                     {0x9123683EL, "btrfs"}})
    if (found.f_type == number) return name;
  return "number " + std::to_string(found.f_type);
}

std::string Compiler() {
#ifdef __clang__
  return __VERSION__;
#else
  return "g++ " __VERSION__;
#endif
}

constexpr std::size_t kBytes = std::size_t{64} << 20, kHugePage = std::size_t{2} << 20, kSmallPage = 4096;

// Fresh memory that begins at a huge page and is backed by pages of the kind wanted, as far as the system gives them.
class Memory {
 public:
  explicit Memory(int advice) {
    if (mapped_ == MAP_FAILED) throw SystemError("memory", "cannot map it");
    const auto address = reinterpret_cast<std::uintptr_t>(mapped_);
    begin_ = reinterpret_cast<char*>((address + kHugePage - 1) / kHugePage * kHugePage);
    madvise(begin_, kBytes, advice);
  }
  ~Memory() { munmap(mapped_, kBytes + kHugePage); }
  Memory(const Memory&) = delete;
  Memory& operator=(const Memory&) = delete;

  char* begin() const { return begin_; }

 private:
  void* mapped_ = mmap(nullptr, kBytes + kHugePage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  char* begin_ = nullptr;
};

double Seconds(const std::function<void()>& work) {
  const auto begin = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

// The median of several turns.
double Usually(const std::function<double()>& turn) {
  std::vector<double> turns(15);
  std::ranges::generate(turns, turn);
  std::ranges::nth_element(turns, turns.begin() + 7);
  return turns[7];
}

// Of touching fresh memory once a page.
double SecondsOfFault(int advice, std::size_t page) {
  return Usually([&] {
    const Memory fresh(advice);
    return Seconds([&] {
             for (std::size_t at = 0; at < kBytes; at += page) *static_cast<volatile char*>(fresh.begin() + at) = 1;
           }) /
           static_cast<double>(kBytes / page);
  });
}

double SecondsOfCopy(int advice, bool touched) {
  const Memory from(MADV_HUGEPAGE);
  std::memset(from.begin(), 1, kBytes);
  return Usually([&] {
    const Memory to(advice);
    if (touched) std::memset(to.begin(), 2, kBytes);
    return Seconds([&] { std::memcpy(to.begin(), from.begin(), kBytes); });
  });
}

std::string PageCosts() {
  char text[256];
  std::snprintf(
      text, sizeof(text),
      "a fault of 4 KiB takes %.0f ns, of 2 MiB where they are to be had %.0f ns; copying 64 MiB takes %.1f ms "
      "into touched memory, %.1f ms into fresh huge pages, %.1f ms into fresh pages of 4 KiB",
      SecondsOfFault(MADV_NOHUGEPAGE, kSmallPage) * 1e9, SecondsOfFault(MADV_HUGEPAGE, kHugePage) * 1e9,
      SecondsOfCopy(MADV_HUGEPAGE, true) * 1e3, SecondsOfCopy(MADV_HUGEPAGE, false) * 1e3,
      SecondsOfCopy(MADV_NOHUGEPAGE, false) * 1e3);
  return text;
}

}  // namespace

void PrintMachine(const std::string& folder, std::ostream& out) {
  out << "- processor: " << ValueIn("/proc/cpuinfo", "model name") << ", " << AllowedCores() << " cores; " << Caches()
      << "\n- memory: " << ValueIn("/proc/meminfo", "MemTotal") << ", available "
      << ValueIn("/proc/meminfo", "MemAvailable")
      << "; transparent huge pages: " << FirstLine("/sys/kernel/mm/transparent_hugepage/enabled")
      << "\n- kernel: " << Kernel() << "; file system of the files: " << FileSystem(folder)
      << "\n- compiler: " << Compiler() << "\n- pages: " << PageCosts() << "\n- load: " << FirstLine("/proc/loadavg")
      << "\n\n";
}

}  // namespace slamdb::bench
