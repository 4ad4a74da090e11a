// SPDX-License-Identifier: MIT
// Words and numbers of a .brep file, copied on as they are read. Not installed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>

namespace batten::internal {

class BrepScanner {
 public:
  // Reads the text from the byte `at` on. Errors name `path` and the line.
  BrepScanner(std::string_view text, size_t at, const std::string& path)
      : text_(text), at_(at), word_at_(at), path_(path) {}

  // The next word between blanks, or number; `what` it is stands in the error where there is none.
  std::string_view Word(const char* what);
  double Real(const char* what);  // at most 1e150 in magnitude
  std::int64_t Integer(const char* what, std::int64_t least, std::int64_t most);
  bool Flag(const char* what) { return Integer(what, 0, 1) != 0; }
  void Expect(std::string_view word);

  // The next word is read once more.
  std::string_view Peek();

  // What is read from here on is copied to what Copied gives, or left out.
  void Copy(bool copies) { copies_ = copies; }
  void Emit(std::string_view text) { copied_ += text; }
  std::string& copied() { return copied_; }

  [[noreturn]] void Fail(const std::string& why) const;

 private:
  std::string_view Next(const char* what);

  std::string_view text_;
  size_t at_, word_at_;
  const std::string& path_;
  bool copies_ = true;
  std::string copied_;
};

}  // namespace batten::internal
