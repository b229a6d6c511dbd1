// SPDX-License-Identifier: BSD-3-Clause
#include "tests/support/cli.h"

#include <fcntl.h>
#include <spawn.h>
#include <sys/ioctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <stdexcept>

extern char** environ;

namespace slamdb::testing {
namespace {

int WaitFor(pid_t process) {
  int status = 0;
  while (::waitpid(process, &status, 0) < 0)
    if (errno != EINTR) return -1;
  return WIFSIGNALED(status) ? 128 + WTERMSIG(status) : WEXITSTATUS(status);
}

}  // namespace

// Standard streams are files, so that no pipe can fill up and stall either side.
ProcessResult RunProgram(const std::vector<std::string>& words, std::string_view input) {
  const TemporaryFolder folder;
  WriteWholeFile(folder / "in", input);
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  const std::string in = folder / "in", out = folder / "out", err = folder / "err";
  ::posix_spawn_file_actions_addopen(&actions, STDIN_FILENO, in.c_str(), O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  pid_t process = 0;
  const int error = ::posix_spawnp(&process, arguments[0], &actions, nullptr, arguments.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) return {.exit_code = 127, .out = {}, .err = {}};
  ProcessResult result;
  result.exit_code = WaitFor(process);
  result.out = ReadWholeFile(out);
  result.err = ReadWholeFile(err);
  return result;
}

namespace {

// The master side of a new pseudo-terminal, or -1.
int OpenTerminal(int columns) {
  const int master = ::posix_openpt(O_RDWR | O_NOCTTY | O_CLOEXEC);
  if (master < 0) return -1;
  const winsize size{.ws_row = 50, .ws_col = static_cast<unsigned short>(columns), .ws_xpixel = 0, .ws_ypixel = 0};
  if (::grantpt(master) == 0 && ::unlockpt(master) == 0 && ::ioctl(master, TIOCSWINSZ, &size) == 0) return master;
  ::close(master);
  return -1;
}

[[noreturn]] void BecomeOn(const std::string& terminal, const std::vector<std::string>& words) {
  std::vector<char*> arguments;
  for (const std::string& word : words) arguments.push_back(const_cast<char*>(word.c_str()));
  arguments.push_back(nullptr);
  ::setsid();
  const int side = ::open(terminal.c_str(), O_RDWR);
  for (const int stream : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO})
    if (side < 0 || ::dup2(side, stream) < 0) ::_exit(126);
  ::execvp(arguments[0], arguments.data());
  ::_exit(127);
}

}  // namespace

std::optional<ProcessResult> RunOnTerminal(const std::vector<std::string>& words, int columns) {
  const int master = OpenTerminal(columns);
  if (master < 0) return std::nullopt;
  const char* name = ::ptsname(master);
  const std::string terminal = name == nullptr ? "" : name;
  if (terminal.empty() || ::access(terminal.c_str(), R_OK | W_OK) != 0) {
    ::close(master);
    return std::nullopt;
  }
  const pid_t process = ::fork();
  if (process == 0) BecomeOn(terminal, words);
  ProcessResult result;
  std::array<char, 4096> buffer{};
  for (ssize_t got = 0; (got = ::read(master, buffer.data(), buffer.size())) != 0;) {
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) break;  // the other side is closed
    result.out.append(buffer.data(), static_cast<std::size_t>(got));
  }
  result.exit_code = WaitFor(process);
  ::close(master);
  std::erase(result.out, '\r');
  return result;
}

ProcessResult RunSlamdb(const std::vector<std::string>& arguments, std::string_view input) {
  std::vector<std::string> words = {SLAMDB_COMMAND};
  words.insert(words.end(), arguments.begin(), arguments.end());
  return RunProgram(words, input);
}

std::string ReadWholeFile(const std::string& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

void WriteWholeFile(const std::string& path, std::string_view content) {
  std::ofstream file(path, std::ios::binary);
  file.write(content.data(), static_cast<std::streamsize>(content.size()));
}

}  // namespace slamdb::testing
