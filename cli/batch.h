// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <functional>
#include <mutex>
#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/words.h"
#include "slamdb/base/detail/parallel.h"
#include "slamdb/many/inputs.h"

namespace slamdb::cli {

// What became of one of several inputs.
template <class Result>
struct Outcome {
  std::string path;
  Result result{};
  std::string error;  // empty: it worked
  Notices notices;

  bool ok() const { return error.empty(); }
};

// Calls work(path, read options, notices) for every input, several at a time; an input that fails does not stop the
// others. Outcomes are in the order of the inputs. One input alone has all threads and a progress bar of its own.
template <class Result, class Work>
std::vector<Outcome<Result>> ForEachInput(const std::vector<AtlasInput>& inputs, const InputFormat& from,
                                          Console& console, const Work& work) {
  std::vector<Outcome<Result>> outcomes(inputs.size());
  ReadOptions options = MakeReadOptions(console, from);
  const Progress progress = options.progress;
  if (inputs.size() > 1) {
    options.progress = console.MakeProgress(/*show=*/false);
    options.threads = std::max(1, detail::ThreadCount(console.threads()) / static_cast<int>(inputs.size()));
  }
  std::mutex mutex;
  std::size_t done = 0;
  detail::ParallelFor(inputs.size(), 1, console.threads(), [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      Outcome<Result>& outcome = outcomes[i];
      outcome.path = inputs[i].location.ToString();
      outcome.error = InCommandWords(inputs[i].failure);
      try {
        if (outcome.ok()) outcome.result = work(outcome.path, options, outcome.notices);
      } catch (const Interrupted&) {
        throw;
      } catch (const std::exception& error) {
        outcome.error = InCommandWords(error.what());
      }
      if (inputs.size() == 1) continue;
      const std::lock_guard lock(mutex);
      ++done;
      progress(std::to_string(done) + " of " + std::to_string(inputs.size()),
               static_cast<double>(done) / static_cast<double>(inputs.size()));
    }
  });
  return outcomes;
}

// The same for inputs that are an atlas each, as they were named.
template <class Result, class Work>
std::vector<Outcome<Result>> ForEachInput(const InputOptions& inputs, Console& console, const Work& work) {
  std::vector<AtlasInput> atlases;
  for (const std::string& path : inputs.paths) atlases.push_back({.location = path});
  return ForEachInput<Result>(atlases, inputs.from, console, work);
}

// Of inputs whose results say why they could not be read.
inline void FailUnreadable(std::uint64_t unreadable, std::uint64_t inputs, Console& console) {
  if (unreadable > 0) console.Fail(Grouped(unreadable) + " of " + Grouped(inputs) + " could not be read");
}

// Tells what went wrong and what the readers had to say, each line with its path when there are several inputs; where
// results say already what went wrong (`told`), only of how many. Returns kFailed when an input failed.
template <class Result>
ExitCode ReportOutcomes(const std::vector<Outcome<Result>>& outcomes, Console& console, bool told = false) {
  std::uint64_t failed = 0;
  for (const Outcome<Result>& outcome : outcomes) {
    console.Report(outcome.notices, outcomes.size() > 1 ? outcome.path + ": " : "");
    if (outcome.ok()) continue;
    if (!told) console.Fail(outcome.error);
    ++failed;
  }
  if (told) FailUnreadable(failed, outcomes.size(), console);
  return failed > 0 ? ExitCode::kFailed : ExitCode::kDone;
}

}  // namespace slamdb::cli
