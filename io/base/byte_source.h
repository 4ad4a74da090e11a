// SPDX-License-Identifier: MIT
// A file read once from front to back through one small buffer.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace batten::internal {

// The bytes of a file or, for the path "-", of standard input. Holds one block of memory whatever
// the size of the file. Throws ReadError with the system's reason where the file can't be opened or
// read.
class ByteSource {
 public:
  static constexpr std::size_t kBlockBytes = std::size_t{1} << 18;

  // `progress`, unless empty, gets the fraction read from time to time (zero where the size is not
  // known) and may throw to cancel.
  explicit ByteSource(const std::string& path, std::function<void(double)> progress = {});
  ~ByteSource();
  ByteSource(const ByteSource&) = delete;
  ByteSource& operator=(const ByteSource&) = delete;

  // What messages call the file.
  const std::string& name() const { return name_; }

  // The offset in the file of the next byte.
  std::int64_t position() const { return position_; }

  // How many bytes follow position(); none for pipes, whose size is not known.
  std::optional<std::int64_t> remaining() const;

  // The next bytes: at least `wanted` (≤ kBlockBytes) of them unless the file ends before. They
  // stay valid until the next call of Peek, Skip past them, or Read.
  std::string_view Peek(std::size_t wanted) {
    if (end_ - begin_ < wanted) Fill(wanted);
    return {buffer_.get() + begin_, end_ - begin_};
  }

  // Moves on; returns false when the file ends before.
  bool Skip(std::int64_t bytes) {
    if (bytes > static_cast<std::int64_t>(end_ - begin_)) return SkipFar(bytes);
    begin_ += static_cast<std::size_t>(bytes);
    position_ += bytes;
    return true;
  }

  // Copies the next bytes; returns how many there were.
  std::size_t Read(char* target, std::size_t bytes);

 private:
  void Fill(std::size_t wanted);
  bool SkipFar(std::int64_t bytes);
  std::size_t ReadSome(char* target, std::size_t bytes);

  std::string name_;
  std::function<void(double)> progress_;
  int descriptor_ = -1;
  std::int64_t size_ = -1;     // of the file; negative where not known
  std::int64_t position_ = 0;  // of begin_
  std::int64_t reported_ = 0;  // position of the last call of progress_
  std::unique_ptr<char[]> buffer_;
  std::size_t begin_ = 0, end_ = 0;  // what is unread in the buffer
  bool at_end_ = false;
};

}  // namespace batten::internal
