// SPDX-License-Identifier: BSD-3-Clause
#include "cli/console.h"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <csignal>
#include <cstdio>
#include <fstream>

#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/words.h"
#include "slamdb/base/detail/temporary_file.h"
#include "slamdb/base/detail/visible.h"
#include "slamdb/base/error.h"
#include "slamdb/base/memory.h"

namespace slamdb::cli {
namespace {

constexpr auto kQuietTime = std::chrono::seconds(1);
constexpr auto kRedrawTime = std::chrono::milliseconds(100);
constexpr int kBarColumns = 40;
constexpr unsigned int kPatience = 1;  // seconds for ending tidily

std::atomic<int> signal_seen = 0;  // the first that asked this process to end

// Ends as the signal would have it, at once. What a store was in the middle of is undone when it is opened next.
void EndNow(int) {
  detail::RemoveTemporaryFiles();
  ::signal(signal_seen, SIG_DFL);
  ::raise(signal_seen);
  ::_exit(128 + signal_seen);  // the first process of a container, which signals end only where it handles them
}

// The first signal cancels at the next progress call. Where none comes soon, or a second signal does, the process ends
// wherever it is.
void EndSoon(int signal) {
  int none = 0;
  if (!signal_seen.compare_exchange_strong(none, signal)) return EndNow(signal);
  ::signal(SIGALRM, EndNow);
  ::alarm(kPatience);
}

void WriteError(const std::string& text) { std::fwrite(text.data(), 1, text.size(), stderr); }

// What this process has read, of files and streams; empty where the system does not count it.
std::string BytesReadText() {
  std::ifstream counts("/proc/self/io");
  std::string name;
  std::uint64_t bytes = 0;
  return counts >> name >> bytes && name == "rchar:" ? HumanBytes(bytes) : std::string();
}

Colour ColourOf(std::string_view severity) {
  if (severity == "error") return Colour::kRed;
  return severity == "note" ? Colour::kBold : Colour::kYellow;
}

}  // namespace

Console::Console(ConsoleOptions options)
    : options_(options),
      width_(PageWidth(STDOUT_FILENO)),
      colour_(UsesColour(STDERR_FILENO, options.colour)),
      paints_(UsesColour(STDOUT_FILENO, options.colour)) {
  const bool terminal = ::isatty(STDERR_FILENO) != 0;
  progress_ = options_.progress > 0 || (options_.progress == 0 && terminal && !options_.quiet);
}

Console::~Console() { ClearProgress(); }

void Console::Print(std::string_view text, Painter painter) {
  const std::string visible = detail::VisibleText(text);
  PrintData(paints_ && painter != nullptr ? painter(visible) : visible);
}

void Console::PrintData(std::string_view text) {
  ClearProgress();
  if (std::fwrite(text.data(), 1, text.size(), stdout) != text.size()) throw SystemError("-", "cannot write results");
}

void Console::Finish() {
  ClearProgress();
  if (std::fflush(stdout) != 0) throw SystemError("-", "cannot write results");
  if (!options_.verbose) return;
  const double seconds = std::chrono::duration<double>(Clock::now() - start_).count();
  rusage usage{};
  ::getrusage(RUSAGE_SELF, &usage);
  const Spilled spilled = SpilledNow();
  const std::string read = BytesReadText();
  Diagnose("note",
           Short(seconds, 3) + " s, at most " + HumanBytes(static_cast<std::uint64_t>(usage.ru_maxrss) * 1024) +
               " of memory" + (spilled.most == 0 ? "" : " and " + HumanBytes(spilled.most) + " in " + spilled.folder) +
               (read.empty() ? "" : ", " + read + " read"),
           true);
}

void Console::Report(const Notices& notices, const std::string& prefix) {
  for (const Notice& notice : notices.items()) {
    const bool loss = notice.kind == Notice::Kind::kLoss;
    const char* severity = loss ? "loss" : notice.kind == Notice::Kind::kWarning ? "warning" : "note";
    Diagnose(severity, prefix + notice.text, !options_.quiet);
  }
}

void Console::PrintWritten(const std::string& output, const Notices& notices, const std::string& details) {
  const std::string& written = notices.written();
  if (IsStandardOutput(output)) {
    if (!written.empty()) Note("wrote " + written);
  } else if (!options_.quiet) {
    Print("wrote " + detail::Visible(output + (written.empty() ? details : ": " + written)) + "\n");
  }
}

void Console::Diagnose(std::string_view severity, std::string_view text, bool show) {
  if (!show) return;
  ClearProgress();
  const std::string label = std::string(severity) + ":";
  std::string line = "slamdb: " + (colour_ ? Painted(label, ColourOf(severity)) : label);
  line.append(" ").append(detail::Visible(InCommandWords(text))).append("\n");
  const std::lock_guard lock(mutex_);
  WriteError(line);
}

Progress Console::MakeProgress(bool show) {
  return [this, show = show && progress_](std::string_view stage, double fraction) {
    if (interrupted()) throw Interrupted();
    if (show) ShowProgress(stage, fraction);
  };
}

void Console::CatchSignals() {
  std::signal(SIGXFSZ, SIG_IGN);  // a file beyond its limit is an error like a full disk
  for (const int signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT, SIGXCPU, SIGUSR1, SIGUSR2, SIGALRM}) {
    struct sigaction action {};
    ::sigaction(signal, nullptr, &action);
    if (action.sa_handler == SIG_IGN) continue;  // as nohup has it
    action.sa_handler = EndSoon;
    action.sa_flags = static_cast<int>(SA_NODEFER);
    ::sigaction(signal, &action, nullptr);
  }
}

bool Console::interrupted() { return signal_seen != 0; }

void Console::EndIfInterrupted() {
  if (interrupted()) EndNow(signal_seen);
}

void Console::ShowProgress(std::string_view stage, double fraction) {
  const std::lock_guard lock(mutex_);
  const Clock::time_point now = Clock::now();
  if (now - start_ < kQuietTime && options_.progress <= 0) return;
  if (bar_shown_ && now - drawn_ < kRedrawTime) return;
  const double clamped = std::clamp(std::isfinite(fraction) ? fraction : 0.0, 0.0, 1.0);
  const int full = static_cast<int>(clamped * kBarColumns);
  std::string bar(kBarColumns, ' ');
  std::fill_n(bar.begin(), full, '=');
  std::string line = "\r\033[K[";
  line.append(bar)
      .append("] ")
      .append(std::to_string(static_cast<int>(clamped * 100)))
      .append("% ")
      .append(detail::Visible(stage));
  WriteError(line);
  bar_shown_ = true;
  drawn_ = now;
}

void Console::ClearProgress() {
  const std::lock_guard lock(mutex_);
  if (bar_shown_) WriteError("\r\033[K");
  bar_shown_ = false;
}

}  // namespace slamdb::cli
