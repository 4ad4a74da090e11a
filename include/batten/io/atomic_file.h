// SPDX-License-Identifier: MIT
// Output files that appear whole or not at all.
#pragma once

#include <string>
#include <string_view>

#include "batten/io/read_error.h"

namespace batten {

// A file written under a temporary name beside its target and renamed on Commit(). Destroyed
// without Commit(), it leaves nothing behind and the old target untouched. The target "-" is
// standard output, written at once on Commit(); so are devices and pipes, which are never replaced.
// A symbolic link stays and its file is replaced. Throws WriteError naming the target.
class AtomicFile {
 public:
  explicit AtomicFile(std::string target);
  ~AtomicFile();
  AtomicFile(const AtomicFile&) = delete;
  AtomicFile& operator=(const AtomicFile&) = delete;

  // Where a library that wants a path may write before Commit(). The file exists and is empty; no
  // name where the target is standard output, a device or a pipe.
  const std::string& temporary_path() const { return temporary_; }

  // Appends to the file; buffered.
  void Write(std::string_view text);

  void Commit();

  // Unlinks the temporary files of every AtomicFile that is open, from any thread: for a process
  // about to end without running destructors.
  static void RemoveTemporaries();

 private:
  void Flush();
  WriteError Failure(int reason) const;
  std::string target_, temporary_, buffer_;
  std::string replaced_;  // what the temporary file is renamed to: the target or what it links to
  int descriptor_ = -1;
};

}  // namespace batten
