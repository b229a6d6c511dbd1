// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>
#include <vector>

namespace slamdb::bench {

enum class Cores { kOne, kAll };
enum class Output { kKeep, kDiscard };

// Starts the program, pinned to the first core that this process may use or on all of them, and waits. Returns what it
// printed, if that is kept. Throws Error when it fails.
std::string RunProgram(const std::vector<std::string>& arguments, Cores cores = Cores::kAll,
                       Output output = Output::kKeep);

}  // namespace slamdb::bench
