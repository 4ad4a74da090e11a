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

  // Gives the file its name; while an OutputBatch lives, that waits for the batch.
  void Commit();

  // The same whatever batch lives, and on the disk when it returns: for what outlives the work.
  void CommitAtOnce();

  // Unlinks the temporary files of every AtomicFile that is open, from any thread: for a process
  // about to end without running destructors.
  static void RemoveTemporaries();

 private:
  void Flush();
  void Close();
  std::string target_, temporary_, buffer_;
  std::string replaced_;  // what the temporary file is renamed to: the target or what it links to
  int descriptor_ = -1;
};

// All outputs of a piece of work, or none: while one lives, files that any thread of the process
// commits are written whole and keep their temporary names until the batch is committed. One at a
// time: throws std::logic_error for a second.
class OutputBatch {
 public:
  OutputBatch();
  // Removes what has not been committed.
  ~OutputBatch();
  OutputBatch(const OutputBatch&) = delete;
  OutputBatch& operator=(const OutputBatch&) = delete;

  // Gives the files of the batch that lives their names, in the order in which they were committed.
  // Throws WriteError naming the first that can't be; those before it stay.
  static void Commit();
};

}  // namespace batten
