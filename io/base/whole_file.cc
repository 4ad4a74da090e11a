// SPDX-License-Identifier: MIT
#include "io/base/whole_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstddef>
#include <cstring>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

constexpr size_t kLargestFile = size_t{4} << 30;
constexpr size_t kChunk = size_t{1} << 20;

// Closes on every way out.
struct Descriptor {
  int number;
  ~Descriptor() {
    if (number > STDERR_FILENO) ::close(number);
  }
};

ReadError Failure(const std::string& path, int reason) {
  return ReadError(path, std::string("can't be read: ") + std::strerror(reason));
}

}  // namespace

std::string ReadWholeFile(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  const Descriptor file{path == "-" ? STDIN_FILENO : ::open(path.c_str(), O_RDONLY | O_CLOEXEC)};
  if (file.number < 0) throw Failure(name, errno);
  struct stat status = {};
  if (::fstat(file.number, &status) != 0) throw Failure(name, errno);
  if (S_ISDIR(status.st_mode)) throw ReadError(name, "is a directory, not a file");

  const size_t promised = S_ISREG(status.st_mode) ? static_cast<size_t>(status.st_size) : 0;
  if (promised > kLargestFile) throw ReadError(name, "is larger than 4 GiB");
  std::string text;
  text.reserve(promised + 1);
  for (size_t size = 0;;) {
    // One byte beyond the promised size shows the end without growing the buffer.
    const size_t room = size < promised + 1 ? promised + 1 - size : kChunk;
    text.resize(size + room);
    const ssize_t got = ::read(file.number, text.data() + size, room);
    if (got < 0 && errno != EINTR) throw Failure(name, errno);
    if (got > 0) size += static_cast<size_t>(got);
    text.resize(size);
    if (got == 0) break;
    if (size > kLargestFile) throw ReadError(name, "is larger than 4 GiB");
  }
  if (text.empty()) throw ReadError(name, "is empty");
  return text;
}

}  // namespace batten::internal
