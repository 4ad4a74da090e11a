// SPDX-License-Identifier: MIT
#include "io/base/byte_source.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <utility>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

constexpr std::int64_t kProgressBytes = std::int64_t{1} << 22;

}  // namespace

ByteSource::ByteSource(const std::string& path, std::function<void(double)> progress)
    : name_(path == "-" ? "standard input" : path),
      progress_(std::move(progress)),
      descriptor_(path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC)) {
  if (descriptor_ < 0) {
    throw ReadError(name_, std::string("can't be opened: ") + std::strerror(errno));
  }
  struct stat status {};
  const bool known = ::fstat(descriptor_, &status) == 0;
  if (known && S_ISDIR(status.st_mode)) {
    if (descriptor_ != STDIN_FILENO) ::close(descriptor_);
    throw ReadError(name_, "is a directory, not a file");
  }
  // Files of the kernel say 0 and hold something.
  if (known && S_ISREG(status.st_mode) && status.st_size > 0) size_ = status.st_size;
  // Standard input may have been read from before.
  if (size_ >= 0 && path == "-") {
    size_ -= std::clamp<std::int64_t>(::lseek(descriptor_, 0, SEEK_CUR), 0, size_);
  }
  buffer_ = std::make_unique_for_overwrite<char[]>(kBlockBytes);
}

ByteSource::~ByteSource() {
  if (descriptor_ > STDIN_FILENO) ::close(descriptor_);
}

std::optional<std::int64_t> ByteSource::remaining() const {
  if (size_ < 0) return std::nullopt;
  return std::max<std::int64_t>(0, size_ - position_);
}

std::size_t ByteSource::ReadSome(char* target, std::size_t bytes) {
  for (;;) {
    const ssize_t count = ::read(descriptor_, target, bytes);
    if (count >= 0) return static_cast<std::size_t>(count);
    if (errno != EINTR) {
      throw ReadError(name_, std::string("can't be read: ") + std::strerror(errno));
    }
  }
}

void ByteSource::Fill(std::size_t wanted) {
  std::memmove(buffer_.get(), buffer_.get() + begin_, end_ - begin_);
  end_ -= std::exchange(begin_, 0);
  while (end_ < wanted && !at_end_) {
    const std::size_t count = ReadSome(buffer_.get() + end_, kBlockBytes - end_);
    at_end_ = count == 0;
    end_ += count;
  }
  if (progress_ && position_ >= reported_ + kProgressBytes) {
    reported_ = position_;
    progress_(size_ > 0 ? std::min(1.0, static_cast<double>(position_) / static_cast<double>(size_))
                        : 0.0);
  }
}

bool ByteSource::SkipFar(std::int64_t bytes) {
  while (bytes > 0) {
    const auto step = std::min<std::int64_t>(bytes, static_cast<std::int64_t>(Peek(1).size()));
    if (step == 0) return false;
    Skip(step);
    bytes -= step;
  }
  return true;
}

std::size_t ByteSource::Read(char* target, std::size_t bytes) {
  std::size_t done = std::min(bytes, end_ - begin_);
  std::memcpy(target, buffer_.get() + begin_, done);
  begin_ += done;
  while (done < bytes && !at_end_) {
    const std::size_t count = ReadSome(target + done, bytes - done);
    at_end_ = count == 0;
    done += count;
  }
  position_ += static_cast<std::int64_t>(done);
  return done;
}

}  // namespace batten::internal
