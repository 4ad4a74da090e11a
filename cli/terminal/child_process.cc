// SPDX-License-Identifier: MIT
#include "cli/terminal/child_process.h"

#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <stdexcept>

namespace batten::internal {
namespace {

constexpr int kCannotStart = 127;

// Between fork and exec only what is safe beside threads: no memory is asked for.
[[noreturn]] void Become(char* const* words, int output, int errors, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGTERM);
  if (::getppid() != parent) _exit(kCannotStart);
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(output, STDOUT_FILENO);
  ::dup2(errors, STDERR_FILENO);
  ::execv("/proc/self/exe", words);
  _exit(kCannotStart);
}

}  // namespace

ChildProcess::ChildProcess(const std::vector<std::string>& words)
    : output_(Nameless()), errors_(Nameless()) {
  std::vector<std::string> all{"batten"};
  all.insert(all.end(), words.begin(), words.end());
  std::vector<char*> pointers;
  for (std::string& word : all) pointers.push_back(word.data());
  pointers.push_back(nullptr);
  const int output = ::fileno(output_.get()), errors = ::fileno(errors_.get());
  const pid_t parent = ::getpid();
  process_ = ::fork();
  if (process_ == 0) Become(pointers.data(), output, errors, parent);
  if (process_ < 0)
    throw std::runtime_error(std::string("a job can't be started: ") + std::strerror(errno));
}

ChildProcess::~ChildProcess() {
  if (code_) return;
  Interrupt();
  while (::waitpid(process_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

std::optional<int> ChildProcess::Ended() {
  int status = 0;
  if (!code_ && ::waitpid(process_, &status, WNOHANG) == process_) {
    constexpr int kSignal = 128;
    code_ = WIFEXITED(status) ? WEXITSTATUS(status) : kSignal + WTERMSIG(status);
  }
  return code_;
}

void ChildProcess::Interrupt() const {
  if (!code_) ::kill(process_, SIGINT);
}

ChildProcess::File ChildProcess::Nameless() {
  File file(std::tmpfile());
  if (!file)
    throw std::runtime_error(std::string("no temporary file can be made: ") + std::strerror(errno));
  ::fcntl(::fileno(file.get()), F_SETFD, FD_CLOEXEC);
  return file;
}

std::string ChildProcess::TextOf(std::FILE* file) {
  std::string text;
  char block[1 << 14];
  std::rewind(file);
  for (size_t got; (got = std::fread(block, 1, sizeof block, file)) > 0;) text.append(block, got);
  return text;
}

}  // namespace batten::internal
