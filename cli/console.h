// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <mutex>
#include <stdexcept>
#include <string>
#include <string_view>

#include "cli/report/paint.h"
#include "cli/terminal.h"
#include "slamdb/base/notices.h"
#include "slamdb/base/progress.h"

namespace slamdb::cli {

// What every verb takes: see AddConsoleOptions in options.h.
struct ConsoleOptions {
  bool quiet = false;    // no notes, warnings and losses
  bool verbose = false;  // findings of notes, timing and memory
  int threads = 0;       // 0: every core
  int progress = 0;      // 1 asked for, -1 forbidden, 0 on a terminal
  ColourChoice colour = ColourChoice::kAuto;
};

// What Ctrl-C, SIGTERM and SIGHUP throw out of the library. No Error, so that nothing takes it for one of a file.
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

  // A result for people: what would steer their terminal or hide is escaped (base/detail/visible.h). Throws Error when
  // standard output cannot take it. With colours where standard output has them and there is a painter.
  void Print(std::string_view text, Painter painter = nullptr);
  // JSON, tables and files for programs, as they are. Throws Error likewise.
  void PrintData(std::string_view text);

  void Note(std::string_view text) { Diagnose("note", text, !options_.quiet); }
  void Warn(std::string_view text) { Diagnose("warning", text, !options_.quiet); }
  void Fail(std::string_view text) { Diagnose("error", text, true); }

  // All of them, each behind `prefix`. When quiet, of a loss the exit status alone tells.
  void Report(const Notices& notices, const std::string& prefix = {});

  // Says where the output went, and what of the atlas when that is an export; `details` is for what holds an atlas:
  // `wrote map.osa (orbslam3) from 1 map`, `wrote map.ply: 3,162 points`. Of standard output only what an export holds,
  // on standard error.
  void PrintWritten(const std::string& output, const Notices& notices, const std::string& details = {});

  // For the library. Throws Interrupted out of it when a signal came, so that nothing half-written stays behind. With
  // `show` false it does only that, and may be called from several threads.
  Progress MakeProgress(bool show = true);

  // From now on Ctrl-C, SIGTERM (`docker stop`) and SIGHUP (a closed terminal) let the work end tidily for a moment,
  // and then end the process; temporary files are removed in either case. What the parent process ignores stays
  // ignored.
  static void CatchSignals();
  static bool interrupted();
  // With the status of the signal that came, as a shell expects.
  static void EndIfInterrupted();

  // Pushes out what was printed and ends the progress bar. Throws Error like Print.
  void Finish();

  int threads() const { return options_.threads; }
  bool quiet() const { return options_.quiet; }
  bool verbose() const { return options_.verbose; }
  ColourChoice colour_choice() const { return options_.colour; }
  std::size_t width() const { return width_; }  // columns of standard output

 private:
  void Diagnose(std::string_view severity, std::string_view text, bool show);
  void ShowProgress(std::string_view stage, double fraction);
  void ClearProgress();

  using Clock = std::chrono::steady_clock;
  ConsoleOptions options_;
  std::size_t width_;
  bool colour_, paints_;  // on standard error, on standard output
  bool progress_;
  bool bar_shown_ = false;
  Clock::time_point start_ = Clock::now(), drawn_{};
  std::mutex mutex_;
};

}  // namespace slamdb::cli
