// SPDX-License-Identifier: MIT
// Bytes in memory under a path, as a file and as a pipe.
#pragma once

#include <fcntl.h>
#include <sys/mman.h>
#include <unistd.h>

#include <stdexcept>
#include <string>
#include <string_view>

namespace batten::internal {

// The path of a descriptor.
inline std::string DescriptorPath(int descriptor) {
  return "/proc/self/fd/" + std::to_string(descriptor);
}

// A file that has no name and takes no disk.
class MemoryFile {
 public:
  explicit MemoryFile(std::string_view bytes) : descriptor_(::memfd_create("bytes", MFD_CLOEXEC)) {
    const auto size = static_cast<ssize_t>(bytes.size());
    if (descriptor_ < 0 || ::write(descriptor_, bytes.data(), bytes.size()) != size) {
      throw std::runtime_error("no file in memory can be made");
    }
  }
  ~MemoryFile() {
    if (descriptor_ >= 0) ::close(descriptor_);
  }
  MemoryFile(const MemoryFile&) = delete;
  MemoryFile& operator=(const MemoryFile&) = delete;

  std::string path() const { return DescriptorPath(descriptor_); }

 private:
  int descriptor_;
};

// A pipe that holds the bytes, whose number its reader can't know. Read it once.
class MemoryPipe {
 public:
  static constexpr std::size_t kMostBytes = std::size_t{1} << 15;  // a pipe takes twice as many

  explicit MemoryPipe(std::string_view bytes) {
    if (bytes.size() > kMostBytes || ::pipe2(descriptors_, O_CLOEXEC) != 0) {
      throw std::runtime_error("no pipe can be made");
    }
    const ssize_t written = ::write(descriptors_[1], bytes.data(), bytes.size());
    ::close(descriptors_[1]);
    if (written != static_cast<ssize_t>(bytes.size())) {
      ::close(descriptors_[0]);
      throw std::runtime_error("the pipe is too small");
    }
  }
  ~MemoryPipe() { ::close(descriptors_[0]); }
  MemoryPipe(const MemoryPipe&) = delete;
  MemoryPipe& operator=(const MemoryPipe&) = delete;

  std::string path() const { return DescriptorPath(descriptors_[0]); }

 private:
  int descriptors_[2];
};

}  // namespace batten::internal
