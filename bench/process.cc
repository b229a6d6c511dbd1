// SPDX-License-Identifier: BSD-3-Clause
#include "bench/process.h"

#include <fcntl.h>
#include <sched.h>
#include <sys/wait.h>
#include <unistd.h>

#include "slamdb/base/error.h"

namespace slamdb::bench {
namespace {

void PinToFirstCore() {
  cpu_set_t allowed, first;
  CPU_ZERO(&first);
  sched_getaffinity(0, sizeof(allowed), &allowed);
  std::size_t core = 0;
  while (core < CPU_SETSIZE - 1 && !CPU_ISSET(core, &allowed)) ++core;
  CPU_SET(core, &first);
  sched_setaffinity(0, sizeof(first), &first);
}

[[noreturn]] void BecomeProgram(const std::vector<std::string>& arguments, Cores cores, int output) {
  dup2(output, STDOUT_FILENO);
  if (cores == Cores::kOne) PinToFirstCore();
  std::vector<char*> pointers;
  for (const std::string& argument : arguments) pointers.push_back(const_cast<char*>(argument.c_str()));
  pointers.push_back(nullptr);
  execvp(pointers[0], pointers.data());
  _exit(127);
}

std::string ReadAll(int descriptor) {
  std::string all;
  char buffer[4096];
  for (ssize_t size; (size = read(descriptor, buffer, sizeof(buffer))) > 0;)
    all.append(buffer, static_cast<std::size_t>(size));
  return all;
}

}  // namespace

std::string RunProgram(const std::vector<std::string>& arguments, Cores cores, Output output) {
  int ends[2] = {-1, -1};
  if (output == Output::kDiscard)
    ends[1] = open("/dev/null", O_WRONLY | O_CLOEXEC);
  else if (pipe2(ends, O_CLOEXEC) != 0)
    throw SystemError(arguments[0], "cannot make a pipe");
  const pid_t child = fork();
  if (child < 0) throw SystemError(arguments[0], "cannot start a process");
  if (child == 0) BecomeProgram(arguments, cores, ends[1]);
  close(ends[1]);
  std::string printed;
  if (output == Output::kKeep) {
    printed = ReadAll(ends[0]);
    close(ends[0]);
  }
  int status = 0;
  waitpid(child, &status, 0);
  if (WIFEXITED(status) && WEXITSTATUS(status) == 0) return printed;
  std::string command;
  for (const std::string& argument : arguments) command += (command.empty() ? "" : " ") + argument;
  throw Error(ErrorKind::kInternal, command + " failed");
}

}  // namespace slamdb::bench
