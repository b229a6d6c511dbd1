// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "tests/support/temporary_folder.h"

namespace slamdb::testing {

// What a process left behind.
struct ProcessResult {
  int exit_code = -1;  // 128 + signal when one ended it
  std::string out, err;
};

// Runs the slamdb command that was built, without a shell, feeding `input` to its standard input, and waits for its
// end.
ProcessResult RunSlamdb(const std::vector<std::string>& arguments, std::string_view input = {});

// Runs any program the same way; exit code 127 when it is not installed.
ProcessResult RunProgram(const std::vector<std::string>& words, std::string_view input = {});

// Runs it on a terminal of its own, of so many columns, on which everything comes out in `out`. Nothing where the
// system has no pseudo-terminals, as a bare chroot.
std::optional<ProcessResult> RunOnTerminal(const std::vector<std::string>& words, int columns = 80);

using slamdb::TemporaryFolder;

std::string ReadWholeFile(const std::string& path);
void WriteWholeFile(const std::string& path, std::string_view content);

}  // namespace slamdb::testing
