// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <new>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "slamdb/base/error.h"
#include "slamdb/base/notices.h"
#include "slamdb/export.h"
#include "slamdb/formats/format.h"
#include "slamdb/many/inputs.h"

// The same work on each of many atlases: one that fails does not stop the others.
namespace slamdb {

// What became of one of several inputs.
template <class Result>
struct Outcome {
  std::string path;
  Result result{};
  std::string error;  // empty: it worked
  Notices notices;    // what its reader had to say

  bool ok() const { return error.empty(); }
};

// Calls work(row, read options) for each of `count` inputs, several at a time. One input alone has all threads, and a
// progress of its own; of several it is told how many are done.
// Throws what `work` and the progress throw.
SLAMDB_EXPORT void ForEachRow(std::size_t count, const ReadOptions& read,
                              const std::function<void(std::size_t row, const ReadOptions& read)>& work);

// Likewise; and calls take(row) for each, in their order, one at a time, on the threads that work: as soon as the row
// and those before it are done. Work runs at most some rows a thread ahead, so that what waits is bounded.
SLAMDB_EXPORT void ForEachRow(std::size_t count, const ReadOptions& read,
                              const std::function<void(std::size_t row, const ReadOptions& read)>& work,
                              const std::function<void(std::size_t row)>& take);

// By input: whether its file is more than the share of one of `threads` threads (0: every core) in all bytes, so that
// the others would wait for that one.
SLAMDB_EXPORT std::vector<std::uint8_t> FindLarge(std::span<const AtlasInput> inputs, int threads);

// What becomes of one input: what work(input, read options, notices) gives, or the Error that it throws.
template <class Result, class Work>
Outcome<Result> OutcomeOf(const AtlasInput& input, const ReadOptions& read, const Work& work) {
  Outcome<Result> outcome{.path = input.location.ToString(), .error = input.failure};
  try {
    if (outcome.ok()) outcome.result = work(input, read, outcome.notices);
  } catch (const Error& error) {
    outcome.error =
        error.path().empty() ? Error(error.kind(), outcome.path, error.place(), error.problem()).what() : error.what();
  } catch (const std::bad_alloc&) {
    outcome.error = Error(ErrorKind::kOutOfResources, outcome.path, "", "memory does not suffice").what();
  }
  return outcome;
}

// Calls work(input, read options, notices) for every input, several at a time; a large one has all threads. Calls
// take(outcome) for each, in the order of the inputs, one at a time: memory does not grow with their number.
template <class Result, class Work, class Take>
void ForEachInput(std::span<const AtlasInput> inputs, const ReadOptions& read, const Work& work, const Take& take) {
  std::vector<std::unique_ptr<Outcome<Result>>> outcomes(inputs.size());
  const std::vector<std::uint8_t> is_large = FindLarge(inputs, read.threads);
  ForEachRow(
      inputs.size(), read,
      [&](std::size_t row, ReadOptions own) {
        if (is_large[row]) own.threads = read.threads;
        outcomes[row] = std::make_unique<Outcome<Result>>(OutcomeOf<Result>(inputs[row], own, work));
      },
      [&](std::size_t row) {
        const std::unique_ptr<Outcome<Result>> outcome = std::move(outcomes[row]);
        take(std::move(*outcome));
      });
}

// Likewise; outcomes are in the order of the inputs.
template <class Result, class Work>
std::vector<Outcome<Result>> ForEachInput(std::span<const AtlasInput> inputs, const ReadOptions& read,
                                          const Work& work) {
  std::vector<Outcome<Result>> outcomes;
  outcomes.reserve(inputs.size());
  ForEachInput<Result>(inputs, read, work, [&](Outcome<Result>&& outcome) { outcomes.push_back(std::move(outcome)); });
  return outcomes;
}

// The atlas of an input, whole: read, or the one that is in memory.
//
// Throws Error as ReadAtlas does.
[[nodiscard]] SLAMDB_EXPORT std::shared_ptr<const Atlas> AtlasOf(const AtlasInput& input, ReadOptions read,
                                                                 Notices& notices);

}  // namespace slamdb
