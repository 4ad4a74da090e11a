// SPDX-License-Identifier: MIT
// Text in memory as a stream, without a copy. Not installed.
#pragma once

#include <streambuf>
#include <string>

namespace batten::internal {

class TextBuffer : public std::streambuf {
 public:
  explicit TextBuffer(std::string& text) {
    setg(text.data(), text.data(), text.data() + text.size());
  }
};

}  // namespace batten::internal
