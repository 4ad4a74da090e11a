// SPDX-License-Identifier: MIT
// The real program, run from outside.
#pragma once

#include <fcntl.h>
#include <signal.h>
#include <spawn.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cstdint>
#include <cstring>
#include <optional>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "../io/temporary_folder.h"

namespace batten::internal {

struct ProgramRun {
  int code = -1;  // 128 + the signal's number where one ended it
  std::string out, err;
  double seconds = 0;
  std::int64_t peak_bytes = 0;  // resident memory

  std::ptrdiff_t error_lines() const { return std::count(err.begin(), err.end(), '\n'); }
};

struct ProgramInput {
  std::string standard_input;
  std::optional<double> interrupt_after = {};  // seconds until SIGINT
  std::optional<std::string> killed_at = {};   // the file whose appearance is followed by SIGKILL
};

// Kills the process, which stays to be waited for, when the file is there.
inline void KillAt(const std::string& path, pid_t process) {
  siginfo_t ended{};
  while (::access(path.c_str(), F_OK) != 0 &&
         ::waitid(P_PID, static_cast<id_t>(process), &ended, WEXITED | WNOHANG | WNOWAIT) == 0 &&
         ended.si_pid == 0)
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  ::kill(process, SIGKILL);
}

// Runs `batten` with the arguments and waits for its end.
inline ProgramRun Batten(const std::vector<std::string>& arguments,
                         const ProgramInput& input = {}) {
  const TemporaryFolder folder;
  const std::string in = folder.With("in", input.standard_input);
  const std::string out = folder.File("out"), err = folder.File("err");

  std::string program = BATTEN_PROGRAM;
  std::vector<std::string> words = arguments;
  std::vector<char*> argv{program.data()};
  for (std::string& word : words) argv.push_back(word.data());
  argv.push_back(nullptr);

  posix_spawn_file_actions_t files;
  ::posix_spawn_file_actions_init(&files);
  ::posix_spawn_file_actions_addopen(&files, STDIN_FILENO, in.c_str(), O_RDONLY, 0);
  ::posix_spawn_file_actions_addopen(&files, STDOUT_FILENO, out.c_str(), O_WRONLY | O_CREAT, 0600);
  ::posix_spawn_file_actions_addopen(&files, STDERR_FILENO, err.c_str(), O_WRONLY | O_CREAT, 0600);
  const auto start = std::chrono::steady_clock::now();
  pid_t process = 0;
  const int failure =
      ::posix_spawn(&process, program.c_str(), &files, nullptr, argv.data(), environ);
  ::posix_spawn_file_actions_destroy(&files);
  if (failure != 0) throw std::runtime_error(program + ": " + std::strerror(failure));
  if (input.interrupt_after) {
    std::this_thread::sleep_for(std::chrono::duration<double>(*input.interrupt_after));
    ::kill(process, SIGINT);
  }
  if (input.killed_at) KillAt(*input.killed_at, process);
  int status = 0;
  rusage usage{};
  if (::wait4(process, &status, 0, &usage) != process) throw std::runtime_error("wait4 failed");

  ProgramRun run;
  run.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  run.code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  run.out = folder.Text("out");
  run.err = folder.Text("err");
  run.peak_bytes = std::int64_t{usage.ru_maxrss} * 1024;
  return run;
}

// What the program takes before it has done anything.
inline std::int64_t MemoryAtStart() {
  static const std::int64_t bytes = Batten({"--version"}).peak_bytes;
  return bytes;
}

}  // namespace batten::internal
