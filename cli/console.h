// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>

#include "slamdb/base/notices.h"
#include "slamdb/base/progress.h"

namespace slamdb::cli {

// What every verb takes: see AddConsoleOptions in options.h.
struct ConsoleOptions {
  bool quiet = false;    // no notes and warnings
  bool verbose = false;  // findings of notes, timing and memory
  int threads = 0;       // 0: every core
  int progress = 0;      // 1 asked for, -1 forbidden, 0 on a terminal
};

// What the user's Ctrl-C throws out of the library. No Error, so that nothing takes it for one of a file.
class Interrupted : public std::runtime_error {
 public:
  Interrupted() : std::runtime_error("interrupted") {}
};

// Where a verb speaks: results on standard output, diagnostics on standard error, progress there too when it is a
// terminal and the work lasts longer than a second. What the library says is told in the words of the command.
// Thread-safe but for Print.
class Console {
 public:
  explicit Console(ConsoleOptions options);
  ~Console();
  Console(const Console&) = delete;
  Console& operator=(const Console&) = delete;

  // A result, as it is. Throws Error when standard output cannot take it.
  void Print(std::string_view text);

  void Note(std::string_view text) { Diagnose("note", text, !options_.quiet); }
  void Warn(std::string_view text) { Diagnose("warning", text, !options_.quiet); }
  void Fail(std::string_view text) { Diagnose("error", text, true); }

  // All of them, each behind `prefix`; losses are shown even when quiet.
  void Report(const Notices& notices, const std::string& prefix = {});

  // Says where the output went, and what of the atlas when that is an export; `details` is for what holds an atlas:
  // `wrote map.osa (orbslam3) from 1 map`, `wrote map.ply: 3,162 points`. Of standard output only what an export holds,
  // on standard error.
  void PrintWritten(const std::string& output, const Notices& notices, const std::string& details = {});

  // For the library. Throws Interrupted out of it when the user pressed Ctrl-C, so that nothing half-written stays
  // behind. With `show` false it does only that, and may be called from several threads.
  Progress MakeProgress(bool show = true);

  // Whether the user pressed Ctrl-C since.
  static bool interrupted();

  // Pushes out what was printed and ends the progress bar. Throws Error like Print.
  void Finish();

  int threads() const { return options_.threads; }
  bool quiet() const { return options_.quiet; }
  bool verbose() const { return options_.verbose; }

 private:
  void Diagnose(std::string_view severity, std::string_view text, bool show);
  void ShowProgress(std::string_view stage, double fraction);
  void ClearProgress();

  using Clock = std::chrono::steady_clock;
  ConsoleOptions options_;
  bool colour_;
  bool progress_;
  bool bar_shown_ = false;
  Clock::time_point start_ = Clock::now(), drawn_{};
  std::mutex mutex_;
};

}  // namespace slamdb::cli
