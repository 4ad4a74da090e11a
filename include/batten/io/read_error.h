// SPDX-License-Identifier: MIT
// What a file that can't be used throws.
#pragma once

#include <cstdint>
#include <stdexcept>
#include <string>

namespace batten {

// A file that can't be read or does not hold what its format promises. what() is one line: the
// path, the line or byte where it went wrong, the value and the rule.
class ReadError : public std::runtime_error {
 public:
  ReadError(const std::string& path, const std::string& reason)
      : std::runtime_error(path + ": " + reason) {}

  static ReadError AtLine(const std::string& path, std::int64_t line, const std::string& reason) {
    return ReadError(path, "line " + std::to_string(line) + ": " + reason);
  }
  static ReadError AtByte(const std::string& path, std::int64_t byte, const std::string& reason) {
    return ReadError(path, "byte " + std::to_string(byte) + ": " + reason);
  }
};

// An output that can't be written: the path and the system's reason.
class WriteError : public std::runtime_error {
 public:
  WriteError(const std::string& path, const std::string& reason)
      : std::runtime_error(path + ": " + reason) {}
};

// A request no file can satisfy: an unknown extension, a column that does not exist by that name.
// The program answers with its usage exit code.
class UsageError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace batten
