// SPDX-License-Identifier: MIT
// The jobs of a batch: lines of a table that are command lines.
#pragma once

#include <functional>
#include <string>
#include <vector>

namespace batten::internal {

struct BatchJob {
  int line = 0;                     // of the table
  std::string command;              // "fit surface"
  std::vector<std::string> inputs;  // patterns resolved
  std::string output;               // empty where the command has none
  std::vector<std::string> reports;
  std::vector<std::string> words;  // of the whole command line, without the program
  bool own_threads = false;        // the line says how many threads it may have
  // Of the words and of size and time of every file that is read: another one is another job.
  std::string fingerprint;
};

// What the table of jobs has to ask of the parser.
struct BatchLanguage {
  // Whether a flag of a command takes no value.
  std::function<bool(const std::string& command, const std::string& flag)> is_switch;
  // Throws UsageError where the words are no command line.
  std::function<void(const std::vector<std::string>& words)> check;
};

// The jobs of a table whose first row names its columns: `input` (files or patterns, several by
// semicolon), `output`, `command` ("fit surface" where there is none), and flags without their
// dashes, in any order; an empty cell leaves its flag out, and a flag without a value takes yes or
// no. Without a column `report`, a page beside the output is the report. Files are relative to the
// current folder. Throws ReadError naming line, column and value where a row is no command line,
// reads what is not there, or writes what another writes or reads.
std::vector<BatchJob> ReadBatchJobs(const std::string& path, const BatchLanguage& language);

}  // namespace batten::internal
