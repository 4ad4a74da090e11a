// SPDX-License-Identifier: MIT
// The real program on a terminal of its own: what a person at the keyboard sees.
#pragma once

#include <fcntl.h>
#include <poll.h>
#include <pty.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace batten::internal {

struct TerminalSetting {
  int columns = 80;
  std::vector<std::pair<std::string, std::string>> environment = {};
  // Files in place of the terminal, for one of the two streams.
  std::string output_file = {}, errors_file = {};
};

// `batten` as the only process of a pseudo terminal. Standard input is a pipe: it stays open until
// CloseInput, and who reads it waits.
class TerminalRun {
 public:
  TerminalRun(const std::vector<std::string>& arguments, const TerminalSetting& setting = {}) {
    int input[2];
    if (::pipe2(input, O_CLOEXEC) != 0) throw std::runtime_error("pipe2 failed");
    winsize size{};
    size.ws_col = static_cast<unsigned short>(setting.columns);
    size.ws_row = 24;
    std::string program = BATTEN_PROGRAM;
    std::vector<std::string> words = arguments;
    std::vector<char*> argv{program.data()};
    for (std::string& word : words) argv.push_back(word.data());
    argv.push_back(nullptr);
    process_ = ::forkpty(&terminal_, nullptr, nullptr, &size);
    if (process_ < 0) throw std::runtime_error("forkpty failed");
    if (process_ == 0) {
      ::dup2(input[0], STDIN_FILENO);
      Redirect(setting.output_file, STDOUT_FILENO);
      Redirect(setting.errors_file, STDERR_FILENO);
      ::setenv("TERM", "xterm", 1);
      ::unsetenv("NO_COLOR");
      for (const auto& [name, value] : setting.environment)
        ::setenv(name.c_str(), value.c_str(), 1);
      ::execv(program.c_str(), argv.data());
      ::_exit(127);
    }
    ::close(input[0]);
    input_ = input[1];
  }
  TerminalRun(const TerminalRun&) = delete;
  TerminalRun& operator=(const TerminalRun&) = delete;
  ~TerminalRun() {
    CloseInput();
    if (!ended_) {
      ::kill(process_, SIGKILL);
      ::waitpid(process_, nullptr, 0);
    }
    ::close(terminal_);
  }

  // Gives the program this to read.
  void Feed(const std::string& text) {
    if (::write(input_, text.data(), text.size()) != static_cast<ssize_t>(text.size()))
      throw std::runtime_error("the pipe took less than was given");
  }
  void CloseInput() {
    if (input_ >= 0) ::close(input_);
    input_ = -1;
  }

  // Keys, as ^C.
  void Type(const std::string& keys) { Check(::write(terminal_, keys.data(), keys.size())); }

  // Reads until what was seen in all holds what is wanted, or so many seconds are over. Whether it
  // does.
  bool ReadUntil(const std::function<bool(const std::string&)>& wanted, double seconds) {
    const auto end = std::chrono::steady_clock::now() + std::chrono::duration<double>(seconds);
    while (!wanted(seen_)) {
      const auto left = std::chrono::duration_cast<std::chrono::milliseconds>(
          end - std::chrono::steady_clock::now());
      if (left.count() <= 0 || !ReadSome(static_cast<int>(left.count()))) return wanted(seen_);
    }
    return true;
  }

  // Reads to the end and returns the exit code, 128 + the signal's number where one ended it.
  int Wait() {
    while (ReadSome(-1)) {
    }
    int status = 0;
    Check(::waitpid(process_, &status, 0));
    ended_ = true;
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
  }

  // All that was sent to the terminal.
  const std::string& seen() const { return seen_; }

  // What stands on it: carriage returns go back in the line, later letters take the place of
  // earlier ones. Lines lose the blanks at their end.
  std::string Screen() const {
    std::string screen, line;
    size_t column = 0;
    const auto end_line = [&] {
      line.erase(line.find_last_not_of(' ') + 1);
      screen += line;
      line.clear();
      column = 0;
    };
    for (const char letter : seen_) {
      if (letter == '\r') {
        column = 0;
      } else if (letter == '\n') {
        end_line();
        screen += '\n';
      } else {
        if (column == line.size()) line += ' ';
        line[column++] = letter;
      }
    }
    end_line();
    return screen;
  }

 private:
  static void Redirect(const std::string& path, int stream) {
    if (path.empty()) return;
    const int file = ::open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
    ::dup2(file, stream);
    ::close(file);
  }

  static void Check(ssize_t result) {
    if (result < 0) throw std::runtime_error("the terminal does not answer");
  }

  // Whether there was anything: the other side's end is no more.
  bool ReadSome(int milliseconds) {
    pollfd wait{terminal_, POLLIN, 0};
    if (::poll(&wait, 1, milliseconds) <= 0) return false;
    char some[4096];
    const ssize_t count = ::read(terminal_, some, sizeof some);
    if (count <= 0) return false;
    seen_.append(some, static_cast<size_t>(count));
    return true;
  }

  pid_t process_ = -1;
  int terminal_ = -1, input_ = -1;
  bool ended_ = false;
  std::string seen_;
};

}  // namespace batten::internal
