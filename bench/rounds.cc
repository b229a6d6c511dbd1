// SPDX-License-Identifier: BSD-3-Clause
#include "bench/rounds.h"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>
#include <stdexcept>

#include "slamdb/base/error.h"

namespace slamdb::bench {
namespace {

// A row: one measurement held against another. A ratio above 1 means that ours is faster.
struct Row {
  std::string_view title, ours;
  std::string_view against, theirs;
  std::string_view goal_on_one, goal_on_all;  // of the ratio; empty: none
};

constexpr Row kRows[] = {
    {"binary read", "read-binary", "copy into fresh memory", "copy", ">= 1/1.5", ">= 1/1.3"},
    {"binary read", "read-binary", "plain Boost", "boost-read-binary", "", ""},
    {"binary write", "write-binary", "writing the bytes to a new file", "copy-to-file", ">= 1/1.15", ">= 1/1.15"},
    {"binary write", "write-binary", "plain Boost", "boost-write-binary", "", ""},
    {"binary read by v1.0's layout file", "read-layout", "binary read", "read-binary", "", ""},
    {"text read", "read-text", "plain Boost", "boost-read-text", ">= 12", ">= 12"},
    {"text read", "read-text", "from_chars of its numbers", "parse-numbers", "", ""},
    {"text write", "write-text", "plain Boost", "boost-write-text", ">= 12", ">= 12"},
    {"info, within the process", "info", "binary read", "read-binary", ">= 1/1.3", ">= 1/1.3"},
    {"check", "check", "binary read", "read-binary", ">= 1", ""},
    {"extract every second keyframe", "extract", "binary read", "read-binary", ">= 1", ""},
    {"cull", "cull", "binary read", "read-binary", ">= 1", ""},
    {"shrink to half the size", "shrink", "binary read", "read-binary", ">= 1", ""},
    {"transform", "transform", "binary read", "read-binary", ">= 1", ""},
    {"diff", "diff", "binary read", "read-binary", ">= 1", ""},
    {"merge of two", "merge", "reading both and writing the result", "merge-input-output", ">= 1/1.5", ""},
    {"store save", "store-save", "plain Boost's write", "boost-write-binary", ">= 1", ">= 1"},
    {"store save", "store-save", "SQLite's insert of the rows", "sqlite-insert", "", ""},
    {"store load", "store-load", "plain Boost's read", "boost-read-binary", ">= 5", ">= 5"},
    {"store load", "store-load", "SQLite's select of the rows", "sqlite-select", "", ""},
    {"store save after 1 %", "store-save-again", "store save", "store-save", ">= 20", ">= 20"},
    {"store save of what is there", "store-save-unchanged", "store save", "store-save", ">= 50", ">= 50"},
    {"store load, the revision before", "store-load-earlier", "store load", "store-load", "", ""},
    {"stella export, one thread", "export-stella", "writing its bytes", "export-stella-bytes", ">= 0.33", ""},
    {"stella database, one thread", "export-stella-sqlite", "writing its bytes", "export-stella-sqlite-bytes", "", ""},
    {"COLMAP export, one thread", "export-colmap", "writing its bytes", "export-colmap-bytes", ">= 0.33", ""},
    {"process: slamdb version", "run-version", "process: true", "true", "5 ms", "5 ms"},
    {"process: slamdb check -h", "run-help", "process: true", "true", "5 ms", "5 ms"},
    {"process: slamdb info", "run-info", "binary read", "read-binary", ">= 1/1.3", ">= 1/1.3"},
    {"process: slamdb check", "run-check", "binary read", "read-binary", "", ""},
    {"process: slamdb convert, to .osa", "run-convert", "process: cp", "cp", "", ""},
    {"copy into fresh memory", "copy", "plain Boost's read", "boost-read-binary", "", ""},
    {"copy into touched memory", "copy-touched", "copy into fresh memory", "copy", "", ""},
    {"process: cat to /dev/null", "cat", "copy into fresh memory", "copy", "", ""},
    {"process: cp", "cp", "writing the bytes to a new file", "copy-to-file", "", ""},
    {"copy_file_range to a new file", "copy-file-range", "writing the bytes to a new file", "copy-to-file", "", ""},
};

// Peak memory beside the size of the file.
struct MemoryRow {
  std::string_view title, id, goal;
};
constexpr MemoryRow kMemoryRows[] = {
    {"peak memory of a read", "read-memory", "<= 1.3"},
    {"peak memory of plain Boost's read", "boost-read-memory", ""},
};

// How a row is measured.
struct Setting {
  Cores cores;
  bool cold;
};

// What was measured, in order.
class Sorted {
 public:
  explicit Sorted(std::vector<double> values) : values_(std::move(values)) { std::ranges::sort(values_); }
  double At(double share) const {
    const double place = share * static_cast<double>(values_.size() - 1);
    const auto below = static_cast<std::size_t>(place);
    const std::size_t above = std::min(below + 1, values_.size() - 1);
    return values_[below] + (place - static_cast<double>(below)) * (values_[above] - values_[below]);
  }
  double median() const { return At(0.5); }

 private:
  std::vector<double> values_;
};

// Takes the file out of the page cache, which lets go only of what is on the disk.
void Forget(const std::string& path) {
  const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) throw SystemError(path, "cannot open");
  fsync(file);
  posix_fadvise(file, 0, 0, POSIX_FADV_DONTNEED);
  close(file);
}

class Runner {
 public:
  Runner(const Workplace& workplace, const RoundOptions& options, std::ostream& out)
      : at_(workplace), options_(options), out_(out) {}

  void Measure(const Row& row) const {
    for (const Cores cores : options_.cores) Measure(row, {cores, false});
    if (!options_.cold || MeasurementById(row.ours).from_file == FromFile::kNo) return;
    for (const Cores cores : options_.cores) Measure(row, {cores, true});
  }

  void Measure(const MemoryRow& row) const {
    const double peak = Run(row.id, {Cores::kAll, false}).peak_megabytes;
    Print(row.title, "the file", "all, warm", "%.0f MB | %.0f MB | **%.2f** | | | %s |\n", peak, megabytes_,
          peak / megabytes_, row.goal.data());
  }

 private:
  Sample Run(std::string_view id, const Setting& setting) const {
    if (setting.cold) std::ranges::for_each(at_.inputs(), Forget);
    std::istringstream printed(RunProgram({options_.program, "--measure", std::string(id), "--folder", at_.folder,
                                           "--name", at_.name, "--slamdb", at_.slamdb},
                                          setting.cores));
    Sample sample;
    if (!(printed >> sample.seconds >> sample.peak_megabytes))
      throw Error(ErrorKind::kInternal, "measurement " + std::string(id) + " printed no result");
    return sample;
  }

  void Measure(const Row& row, const Setting& setting) const {
    Run(row.ours, setting);  // warms the page cache
    Run(row.theirs, setting);
    std::vector<double> ours, theirs, ratios;
    for (int round = 0; round < options_.rounds; ++round) {
      const bool ours_first = round % 2 == 0;
      const double first = Run(ours_first ? row.ours : row.theirs, setting).seconds;
      const double second = Run(ours_first ? row.theirs : row.ours, setting).seconds;
      ours.push_back(ours_first ? first : second);
      theirs.push_back(ours_first ? second : first);
      ratios.push_back(theirs.back() / ours.back());
    }
    const bool one = setting.cores == Cores::kOne;
    const Sorted ratio(std::move(ratios));
    Print(row.title, row.against, std::string(one ? "1" : "all") + (setting.cold ? ", cold" : ", warm"),
          "%.4f s | %.4f s | **%.2f** | %.2f – %.2f | %.2f – %.2f | %s |\n", Sorted(std::move(ours)).median(),
          Sorted(std::move(theirs)).median(), ratio.median(), ratio.At(0.25), ratio.At(0.75), ratio.At(0), ratio.At(1),
          (one ? row.goal_on_one : row.goal_on_all).data());
  }

  template <class... Values>
  void Print(std::string_view title, std::string_view against, const std::string& setting, const char* format,
             Values... values) const {
    char line[256];
    std::snprintf(line, sizeof(line), format, values...);
    out_ << "| " << at_.name << " | " << title << " | " << against << " | " << setting << " | " << line << std::flush;
  }

  const Workplace& at_;
  const RoundOptions& options_;
  std::ostream& out_;
  const double megabytes_ = static_cast<double>(std::filesystem::file_size(at_.binary())) * 1e-6;
};

}  // namespace

void PrintTableHead(std::ostream& out) {
  out << "| atlas | measurement | held against | cores, cache | slamdb | against | ratio | quartiles | least – "
         "greatest "
         "| goal |\n|---|---|---|---|---|---|---|---|---|---|\n";
}

void MeasureRows(const Workplace& workplace, const RoundOptions& options, std::ostream& out) {
  const Runner runner(workplace, options, out);
  for (const std::string& id : options.only)
    if (std::ranges::count(kRows, id, &Row::ours) == 0 && std::ranges::count(kMemoryRows, id, &MemoryRow::id) == 0)
      throw std::invalid_argument("--only: no row measures " + id);
  const auto wanted = [&](std::string_view id) {
    return options.only.empty() || std::ranges::count(options.only, id) > 0;
  };
  for (const Row& row : kRows)
    if (wanted(row.ours)) runner.Measure(row);
  for (const MemoryRow& row : kMemoryRows)
    if (wanted(row.id)) runner.Measure(row);
}

}  // namespace slamdb::bench
