// SPDX-License-Identifier: BSD-3-Clause
#include "bench/rounds.h"

#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <filesystem>
#include <sstream>

#include "slamdb/base/error.h"

namespace slamdb::bench {
namespace {

// A row: one measurement against another. A ratio above 1 means that ours is better.
struct Row {
  std::string_view title, ours, theirs;
  std::string_view goal;
  bool memory = false;  // peak memory against the file's size instead of time
};

constexpr Row kRows[] = {
    {"binary read", "read-binary", "read-binary-reference", ">= 10"},
    {"binary write, atomic, no fsync", "write-binary", "write-binary-reference", ">= 6"},
    {"binary read by v1.0's layout file, against ours", "read-layout", "read-binary", ">= 0.1"},
    {"text read", "read-text", "read-text-reference", ">= 5"},
    {"text write", "write-text", "write-text-reference", ">= 5"},
    {"info, against our read", "info", "read-binary", ">= 1"},
    {"check, against reference read", "check", "read-binary-reference", ">= 2"},
    {"extract every second keyframe, against our read", "extract", "read-binary", ""},
    {"cull, against our read", "cull", "read-binary", ""},
    {"shrink to half the size, against our read", "shrink", "read-binary", ""},
    {"transform, against our read", "transform", "read-binary", ""},
    {"diff, against our read", "diff", "read-binary", ""},
    {"store save, against reference write", "store-save", "write-binary-reference", ">= 0.33"},
    {"store load, against reference read", "store-load", "read-binary-reference", ">= 1"},
    {"store save after 1 %, against store save", "store-save-again", "store-save", ">= 10"},
    {"merge of two, against reading both and writing the result", "merge", "merge-input-output", ">= 0.67"},
    {"stella export on one core, against writing its bytes", "export-stella", "export-stella-bytes", ">= 0.33"},
    {"stella database on one core, against writing its bytes", "export-stella-sqlite", "export-stella-sqlite-bytes",
     ""},
    {"COLMAP export on one core, against writing its bytes", "export-colmap", "export-colmap-bytes", ">= 0.33"},
    {"limit: copy on one core, against reference read", "copy", "read-binary-reference", ""},
    {"limit: copy on all cores, against reference read", "copy-parallel", "read-binary-reference", ""},
    {"limit: copy to a file, against reference write", "copy-to-file", "write-binary-reference", ""},
    {"peak memory of a read / file", "read-memory", "", "<= 1.3", true},
    {"peak memory of a reference read / file", "read-memory-reference", "", "", true},
};

double Median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t middle = values.size() / 2;
  return values.size() % 2 == 1 ? values[middle] : (values[middle - 1] + values[middle]) / 2;
}

class Runner {
 public:
  Runner(const Workplace& workplace, const RoundOptions& options) : at_(workplace), options_(options) {}

  Sample Run(std::string_view id) const {
    std::istringstream printed(
        RunProgram({options_.program, "--measure", std::string(id), "--folder", at_.folder, "--name", at_.name}));
    Sample sample;
    if (!(printed >> sample.seconds >> sample.peak_megabytes))
      throw Error(ErrorKind::kInternal, "measurement " + std::string(id) + " printed no result");
    return sample;
  }

  void Measure(const Row& row, double file_megabytes, std::ostream& out) const {
    char line[256];
    if (row.memory) {
      const double peak = Run(row.ours).peak_megabytes;
      std::snprintf(line, sizeof(line), "| %s | %.1f | %s | %.0f MB | | **%.2f** | | %s |\n", at_.name.c_str(),
                    file_megabytes, row.title.data(), peak, peak / file_megabytes, row.goal.data());
      out << line << std::flush;
      return;
    }
    Run(row.ours);  // warms the page cache
    Run(row.theirs);
    std::vector<double> ours, theirs, ratios;
    for (int round = 0; round < options_.rounds; ++round) {
      const bool ours_first = round % 2 == 0;
      const double first = Run(ours_first ? row.ours : row.theirs).seconds;
      const double second = Run(ours_first ? row.theirs : row.ours).seconds;
      ours.push_back(ours_first ? first : second);
      theirs.push_back(ours_first ? second : first);
      ratios.push_back(theirs.back() / ours.back());
    }
    const auto [least, greatest] = std::minmax_element(ratios.begin(), ratios.end());
    std::snprintf(line, sizeof(line), "| %s | %.1f | %s | %.4f s | %.4f s | **%.2f** | %.2f – %.2f | %s |\n",
                  at_.name.c_str(), file_megabytes, row.title.data(), Median(ours), Median(theirs), Median(ratios),
                  *least, *greatest, row.goal.data());
    out << line << std::flush;
  }

 private:
  const Workplace& at_;
  const RoundOptions& options_;
};

}  // namespace

void PrintTableHead(std::ostream& out) {
  out << "| atlas | MB | measurement | slamdb | against | ratio | least – greatest | goal |\n"
         "|---|---|---|---|---|---|---|---|\n";
}

void MeasureRows(const Workplace& workplace, const RoundOptions& options, std::ostream& out) {
  const double megabytes = static_cast<double>(std::filesystem::file_size(workplace.binary())) * 1e-6;
  const Runner runner(workplace, options);
  for (const Row& row : kRows) {
    const bool wanted =
        options.only.empty() || std::find(options.only.begin(), options.only.end(), row.ours) != options.only.end();
    if (wanted) runner.Measure(row, megabytes, out);
  }
}

std::string RunProgram(const std::vector<std::string>& arguments) {
  int ends[2];
  if (pipe(ends) != 0) throw SystemError(arguments[0], "cannot make a pipe");
  const pid_t child = fork();
  if (child < 0) throw SystemError(arguments[0], "cannot start a process");
  if (child == 0) {
    dup2(ends[1], STDOUT_FILENO);
    close(ends[0]);
    close(ends[1]);
    std::vector<char*> pointers;
    for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
    pointers.push_back(nullptr);
    execv(pointers[0], pointers.data());
    _exit(127);
  }
  close(ends[1]);
  std::string printed;
  char buffer[4096];
  for (ssize_t size; (size = read(ends[0], buffer, sizeof(buffer))) > 0;)
    printed.append(buffer, static_cast<std::size_t>(size));
  close(ends[0]);
  int status = 0;
  waitpid(child, &status, 0);
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0)
    throw Error(ErrorKind::kInternal, arguments[0] + " " + arguments[1] + " " + arguments[2] + " failed");
  return printed;
}

}  // namespace slamdb::bench
