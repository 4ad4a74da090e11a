// SPDX-License-Identifier: MIT
// The program as a process of its own.
#pragma once

#include <sys/types.h>

#include <cstdio>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace batten::internal {

// A run of this program with other words. What it writes is kept in files without a name. It is
// asked to end when this process does, and when the object is destroyed.
class ChildProcess {
 public:
  // Throws std::runtime_error with the system's reason where it can't be started.
  explicit ChildProcess(const std::vector<std::string>& words);
  ~ChildProcess();
  ChildProcess(const ChildProcess&) = delete;
  ChildProcess& operator=(const ChildProcess&) = delete;

  // The exit code, 128 + its number where a signal ended it; nothing while it runs.
  std::optional<int> Ended();

  // Asks it to stop, as Ctrl-C does.
  void Interrupt() const;

  // What it has written to standard output and standard error.
  std::string Output() const { return TextOf(output_.get()); }
  std::string Errors() const { return TextOf(errors_.get()); }

 private:
  struct Closer {
    void operator()(std::FILE* file) const { std::fclose(file); }
  };
  using File = std::unique_ptr<std::FILE, Closer>;
  static File Nameless();
  static std::string TextOf(std::FILE* file);

  File output_, errors_;
  pid_t process_ = -1;
  std::optional<int> code_;
};

}  // namespace batten::internal
