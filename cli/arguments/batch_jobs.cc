// SPDX-License-Identifier: MIT
#include "cli/arguments/batch_jobs.h"

#include <fmt/format.h>
#include <glob.h>
#include <sys/stat.h>

#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <utility>

#include "batten/io/read_error.h"
#include "cli/arguments/csv_table.h"
#include "cli/terminal/nearest_name.h"

namespace batten::internal {
namespace {

const std::vector<std::string> kCommands = {
    "fit surface", "fit curve", "fit primitive", "fit solid", "compare"};

// Standard output is the batch's own, and help does no work.
const std::set<std::string> kNotForJobs = {"help", "json", "quiet", "version"};

// Columns of several values.
const std::set<std::string> kLists = {"report", "boundary"};

std::vector<std::string> Parts(const std::string& list) {
  std::vector<std::string> parts;
  for (size_t begin = 0; begin <= list.size();) {
    const size_t end = std::min(list.find(';', begin), list.size());
    std::string part = Trimmed(std::string_view(list).substr(begin, end - begin));
    if (!part.empty()) parts.push_back(std::move(part));
    begin = end + 1;
  }
  return parts;
}

// A path that no parser takes for a flag.
std::string AsPath(const std::string& path) { return path.starts_with('-') ? "./" + path : path; }

bool IsFile(const std::string& path) {
  struct stat about {};
  return ::stat(path.c_str(), &about) == 0;
}

// The files a pattern stands for, in the order of their names; a name of a file stands for itself.
std::vector<std::string> FilesOf(const std::string& pattern) {
  if (IsFile(pattern)) return {AsPath(pattern)};
  std::vector<std::string> files;
  glob_t found{};
  if (pattern.find_first_of("*?[") != std::string::npos &&
      ::glob(pattern.c_str(), 0, nullptr, &found) == 0) {
    for (size_t k = 0; k < found.gl_pathc; ++k) files.push_back(AsPath(found.gl_pathv[k]));
  }
  ::globfree(&found);
  return files;
}

// FNV-1a of 64 bits, word by word. [Fowler, Noll & Vo 1991]
class Fingerprint {
 public:
  void Add(const std::string& word) {
    for (const char c : word) Mix(static_cast<unsigned char>(c));
    Mix(0);
  }
  void AddFile(const std::string& path) {
    struct stat about {};
    if (::stat(path.c_str(), &about) != 0) return Add(path);
    Add(fmt::format(
        "{} {} {}.{:09}", path, about.st_size, about.st_mtim.tv_sec, about.st_mtim.tv_nsec));
  }
  std::string Text() const { return fmt::format("{:016x}", hash_); }

 private:
  void Mix(unsigned byte) { hash_ = (hash_ ^ byte) * 0x100000001b3; }
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

class JobReader {
 public:
  JobReader(const std::string& path, const std::vector<CsvRow>& rows, const BatchLanguage& language)
      : path_(path), rows_(rows), language_(language) {
    for (const std::string& cell : rows.front().cells) {
      std::string name = cell.substr(std::min(cell.find_first_not_of('-'), cell.size()));
      if (name == "o") name = "output";
      const int line = rows.front().line;
      if (name.empty()) Refuse(line, "a column has no name");
      if (name.find_first_not_of("abcdefghijklmnopqrstuvwxyz-0123456789") != std::string::npos)
        Refuse(line, "'" + cell + "' names no flag; the first row names columns: input, output, …");
      if (kNotForJobs.contains(name))
        Refuse(line, "column " + name + ": a batch says itself how its jobs are run");
      if (std::count(names_.begin(), names_.end(), name) > 0)
        Refuse(line, "column " + name + " is there twice");
      names_.push_back(std::move(name));
    }
    if (std::count(names_.begin(), names_.end(), "input") == 0)
      Refuse(rows.front().line, "there is no column named input");
  }

  std::vector<BatchJob> Jobs() && {
    std::vector<BatchJob> jobs;
    for (size_t k = 1; k < rows_.size(); ++k) jobs.push_back(Job(rows_[k]));
    if (jobs.empty()) throw ReadError(path_, "holds no job: there is no row below the names");
    for (const BatchJob& job : jobs) {
      for (const std::string& input : job.inputs) CheckNotWritten(job, input);
    }
    return jobs;
  }

 private:
  [[noreturn]] void Refuse(int line, const std::string& reason) const {
    throw ReadError::AtLine(path_, line, reason);
  }

  BatchJob Job(const CsvRow& row) {
    if (row.cells.size() != names_.size()) {
      Refuse(row.line,
             fmt::format("has {} cells, but {} columns are named; '{}' is the last cell",
                         row.cells.size(),
                         names_.size(),
                         row.cells.back()));
    }
    std::map<std::string, std::string> cells;
    for (size_t k = 0; k < names_.size(); ++k)
      if (!row.cells[k].empty()) cells[names_[k]] = row.cells[k];
    BatchJob job;
    job.line = row.line;
    job.command = CommandOf(row.line, cells);
    TakeInputs(cells, job);
    job.own_threads = cells.contains("threads");
    job.words = Parts(Spaced(job.command));
    job.words.insert(job.words.end(), job.inputs.begin(), job.inputs.end());
    TakeOutputs(cells, job);
    for (const auto& [name, value] : cells) AddFlag(name, value, job);
    try {
      language_.check(job.words);
    } catch (const UsageError& error) {
      Refuse(row.line, error.what());
    }
    Fingerprint fingerprint;
    for (const std::string& word : job.words) fingerprint.Add(word);
    for (const std::string& input : job.inputs) fingerprint.AddFile(input);
    for (const std::string& beside : Parts(Value(cells, "boundary"))) fingerprint.AddFile(beside);
    fingerprint.AddFile(Value(cells, "meet"));
    fingerprint.AddFile(Value(cells, "beside"));
    job.fingerprint = fingerprint.Text();
    return job;
  }

  static std::string Value(const std::map<std::string, std::string>& cells,
                           const std::string& name) {
    const auto found = cells.find(name);
    return found == cells.end() ? "" : found->second;
  }

  static std::string Spaced(std::string command) {
    std::replace(command.begin(), command.end(), ' ', ';');
    return command;
  }

  std::string CommandOf(int line, std::map<std::string, std::string>& cells) const {
    const std::string command = cells.contains("command") ? cells["command"] : kCommands.front();
    cells.erase("command");
    if (std::count(kCommands.begin(), kCommands.end(), command) > 0) return command;
    Refuse(line,
           "command: '" + command + "' is not for a batch; " +
               DidYouMean(command,
                          kCommands,
                          "fit surface, fit curve, fit primitive, fit solid and compare are"));
  }

  void TakeInputs(std::map<std::string, std::string>& cells, BatchJob& job) const {
    for (const std::string& pattern : Parts(Value(cells, "input"))) {
      const std::vector<std::string> files = FilesOf(pattern);
      if (files.empty()) Refuse(job.line, "input: there is no file '" + pattern + "'");
      job.inputs.insert(job.inputs.end(), files.begin(), files.end());
    }
    if (job.inputs.empty()) Refuse(job.line, "input: there is no file named");
    cells.erase("input");
  }

  void TakeOutputs(std::map<std::string, std::string>& cells, BatchJob& job) {
    job.output = Value(cells, "output");
    job.reports = Parts(Value(cells, "report"));
    const bool has_column = std::count(names_.begin(), names_.end(), "report") > 0;
    if (!has_column && !job.output.empty()) {
      const std::filesystem::path page(job.output);
      job.reports = {(page.parent_path() / page.stem()).string() + ".report.html"};
      cells["report"] = job.reports.front();
    }
    std::vector<std::string> outputs = {job.output, Value(cells, "residuals")};
    outputs.insert(outputs.end(), job.reports.begin(), job.reports.end());
    for (const std::string& output : outputs) {
      if (output.empty()) continue;
      if (output == "-") Refuse(job.line, "'-': jobs write files");
      const auto [other, fresh] = writers_.try_emplace(Place(output), job.line);
      if (!fresh)
        Refuse(job.line, fmt::format("'{}' is written by line {}", output, other->second));
    }
  }

  static std::string Place(const std::string& path) {
    std::error_code unknown;
    return std::filesystem::weakly_canonical(path, unknown).string();
  }

  // Jobs may run in any order, so that none reads what another writes.
  void CheckNotWritten(const BatchJob& job, const std::string& input) const {
    const auto writer = writers_.find(Place(input));
    if (writer == writers_.end()) return;
    Refuse(job.line,
           fmt::format("input: '{}' is written by line {}; run that in a batch before",
                       input,
                       writer->second));
  }

  void AddFlag(const std::string& name, const std::string& value, BatchJob& job) {
    const std::string flag = "--" + name;
    const auto [known, fresh] = switches_.try_emplace({job.command, flag}, false);
    if (fresh) known->second = language_.is_switch(job.command, flag);
    if (known->second) {
      if (value == "yes") return job.words.push_back(flag);
      if (value == "no") return;
      Refuse(job.line, name + ": '" + value + "' is neither yes nor no");
    }
    const std::vector<std::string> values =
        kLists.contains(name) ? Parts(value) : std::vector<std::string>{value};
    for (const std::string& one : values) job.words.push_back(flag + "=" + one);
  }

  const std::string& path_;
  const std::vector<CsvRow>& rows_;
  const BatchLanguage& language_;
  std::vector<std::string> names_;
  std::map<std::string, int> writers_;                            // the line that writes a file
  std::map<std::pair<std::string, std::string>, bool> switches_;  // of commands and flags
};

}  // namespace

std::vector<BatchJob> ReadBatchJobs(const std::string& path, const BatchLanguage& language) {
  const std::vector<CsvRow> rows = ReadCsv(path);
  if (rows.empty()) throw ReadError(path, "holds no row; the first names columns: input, output");
  return JobReader(path, rows, language).Jobs();
}

}  // namespace batten::internal
