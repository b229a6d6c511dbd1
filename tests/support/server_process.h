// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <sys/types.h>

#include <filesystem>
#include <string>
#include <vector>

namespace slamdb {

// What servers of tests have in common. They do not run for root: started by root they run as the user postgres, or as
// nobody.

// An empty folder of that user's, whose path is short enough for sockets in it.
std::filesystem::path MakeServerFolder();
// Gives a file or a folder to that user.
void GiveToServer(const std::filesystem::path& path);
// A port of 127.0.0.1 that nobody listens at.
int FreePort();
// Starts a program, which ends with this one. Its output goes behind what `log` holds.
pid_t LaunchServer(const std::vector<std::string>& command, const std::filesystem::path& log);
// Runs a program to its end. Throws std::runtime_error with the log when it fails.
void RunForServer(const std::vector<std::string>& command, const std::filesystem::path& log);

}  // namespace slamdb
