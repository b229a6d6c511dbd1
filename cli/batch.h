// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

#include "cli/command.h"
#include "cli/console.h"
#include "cli/options.h"
#include "cli/report/layout.h"
#include "cli/words.h"
#include "slamdb/many/each.h"

namespace slamdb::cli {

// The same work on each of many inputs (many/each.h), as the console has it; what went wrong in words of the command.
template <class Result, class Work>
std::vector<Outcome<Result>> ForEachInput(const InputOptions& inputs, Console& console, const Work& work) {
  std::vector<AtlasInput> atlases;
  for (const std::string& path : inputs.paths) atlases.push_back({.location = path});
  auto outcomes = slamdb::ForEachInput<Result>(atlases, MakeReadOptions(console, inputs.from),
                                               [&](const AtlasInput& input, const ReadOptions& read, Notices& notices) {
                                                 return work(input.location.ToString(), read, notices);
                                               });
  for (auto& outcome : outcomes) outcome.error = InCommandWords(outcome.error);
  return outcomes;
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
