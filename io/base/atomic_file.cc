// SPDX-License-Identifier: MIT
#include "batten/io/atomic_file.h"

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <mutex>
#include <set>
#include <stdexcept>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"

namespace batten {
namespace {

constexpr size_t kBufferBytes = size_t{1} << 20;

// A file that is whole and waits for its name.
struct Waiting {
  std::string temporary, replaced, target;
};

// The temporary files that exist now, and those of a batch.
struct Register {
  std::mutex mutex;
  std::set<std::string> paths;
  bool in_batch = false;
  std::vector<Waiting> batch;
};

Register& OpenFiles() {
  static Register files;
  return files;
}

void Enter(const std::string& path) {
  const std::lock_guard lock(OpenFiles().mutex);
  OpenFiles().paths.insert(path);
}

void Leave(const std::string& path) {
  const std::lock_guard lock(OpenFiles().mutex);
  OpenFiles().paths.erase(path);
}

// Whether a batch takes the file.
bool TakenByBatch(const Waiting& file) {
  const std::lock_guard lock(OpenFiles().mutex);
  if (OpenFiles().in_batch) OpenFiles().batch.push_back(file);
  return OpenFiles().in_batch;
}

WriteError Failed(const std::string& target, int reason) {
  return WriteError(target, std::string("can't be written: ") + std::strerror(reason));
}

void Rename(const Waiting& file) {
  if (::rename(file.temporary.c_str(), file.replaced.c_str()) != 0)
    throw Failed(file.target, errno);
}

void WriteAll(int descriptor, std::string_view text, const std::string& target) {
  while (!text.empty()) {
    const ssize_t written = ::write(descriptor, text.data(), text.size());
    if (written < 0) {
      if (errno == EINTR) continue;
      throw Failed(target, errno);
    }
    text.remove_prefix(static_cast<size_t>(written));
  }
}

}  // namespace

AtomicFile::AtomicFile(std::string target) : target_(std::move(target)) {
  if (target_ == "-") return;
  std::error_code ignored, unknown;
  const auto status = std::filesystem::status(target_, unknown);
  // The temporary name is short: only the rename would find it out.
  if (unknown == std::errc::filename_too_long) throw Failed(target_, ENAMETOOLONG);
  if (std::filesystem::is_directory(status))
    throw WriteError(target_, "is a directory, not a file to write");
  if (std::filesystem::exists(status) && ::access(target_.c_str(), W_OK) != 0)
    throw Failed(target_, errno);
  // Devices and pipes are written, not replaced.
  if (std::filesystem::exists(status) && !std::filesystem::is_regular_file(status)) {
    descriptor_ = ::open(target_.c_str(), O_WRONLY | O_CLOEXEC);
    if (descriptor_ < 0) throw Failed(target_, errno);
    return;
  }
  // A link stays, and what it points to is replaced.
  std::filesystem::path path(target_);
  if (std::filesystem::is_symlink(path, ignored) && std::filesystem::exists(status)) {
    path = std::filesystem::canonical(path);
  }
  replaced_ = path.string();
  // Beside the target, so that the rename stays on one file system; the ending stays the target's,
  // because libraries choose by it.
  temporary_ = (path.parent_path() / (".batten-XXXXXX" + path.extension().string())).string();
  descriptor_ =
      ::mkostemps(temporary_.data(), static_cast<int>(path.extension().string().size()), O_CLOEXEC);
  if (descriptor_ < 0) {
    temporary_.clear();
    throw Failed(target_, errno);
  }
  Enter(temporary_);
}

AtomicFile::~AtomicFile() {
  if (descriptor_ >= 0) ::close(descriptor_);
  if (temporary_.empty()) return;
  ::unlink(temporary_.c_str());
  Leave(temporary_);
}

void AtomicFile::RemoveTemporaries() {
  const std::lock_guard lock(OpenFiles().mutex);
  for (const std::string& path : OpenFiles().paths) ::unlink(path.c_str());
}

void AtomicFile::Flush() {
  WriteAll(descriptor_, buffer_, target_);
  buffer_.clear();
}

void AtomicFile::Write(std::string_view text) {
  buffer_.append(text);
  if (!temporary_.empty() && buffer_.size() >= kBufferBytes) Flush();
}

void AtomicFile::Close() {
  Flush();
  if (!temporary_.empty()) {
    // mkostemps makes files private; give the mode that an ordinary new file would have.
    const mode_t mask = ::umask(0);
    ::umask(mask);
    ::fchmod(descriptor_, 0666 & ~mask);
  }
  if (::close(std::exchange(descriptor_, -1)) != 0) throw Failed(target_, errno);
}

void AtomicFile::CommitAtOnce() {
  Flush();
  if (::fsync(descriptor_) != 0) throw Failed(target_, errno);
  Close();
  Rename({temporary_, replaced_, target_});
  Leave(temporary_);
  temporary_.clear();
}

void AtomicFile::Commit() {
  if (target_ == "-") {
    WriteAll(STDOUT_FILENO, buffer_, "standard output");
    buffer_.clear();
    return;
  }
  Close();
  if (temporary_.empty()) return;
  const Waiting file{temporary_, replaced_, target_};
  if (!TakenByBatch(file)) {
    Rename(file);
    Leave(temporary_);
  }
  temporary_.clear();
}

OutputBatch::OutputBatch() {
  const std::lock_guard lock(OpenFiles().mutex);
  if (std::exchange(OpenFiles().in_batch, true))
    throw std::logic_error("OutputBatch: there is one already");
}

OutputBatch::~OutputBatch() {
  const std::lock_guard lock(OpenFiles().mutex);
  for (const Waiting& file : OpenFiles().batch) {
    ::unlink(file.temporary.c_str());
    OpenFiles().paths.erase(file.temporary);
  }
  OpenFiles().batch.clear();
  OpenFiles().in_batch = false;
}

void OutputBatch::Commit() {
  const std::lock_guard lock(OpenFiles().mutex);
  std::vector<Waiting>& batch = OpenFiles().batch;
  while (!batch.empty()) {
    Rename(batch.front());
    OpenFiles().paths.erase(batch.front().temporary);
    batch.erase(batch.begin());
  }
}

}  // namespace batten
