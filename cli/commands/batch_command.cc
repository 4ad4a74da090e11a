// SPDX-License-Identifier: MIT
// batten batch: a table of command lines in, their results, a table and a page of them out.
#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <filesystem>
#include <list>
#include <memory>
#include <nlohmann/json.hpp>
#include <thread>

#include "batten/io/atomic_file.h"
#include "batten/io/read_error.h"
#include "cli/arguments/batch_jobs.h"
#include "cli/arguments/batch_results.h"
#include "cli/arguments/fit_output.h"
#include "cli/commands/commands.h"
#include "cli/commands/program.h"
#include "cli/terminal/child_process.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/interrupt.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/streams.h"
#include "cli/terminal/terminal.h"

namespace batten::internal {
namespace {

struct BatchArguments {
  std::string table, results;
  int at_once = 1, threads = 0;
  bool again = false;
  CommonFlags flags;
};

// part.csv → part.results.csv; part.results.csv → part.results.html.
std::string WithEnding(const std::string& path, const char* ending) {
  return std::filesystem::path(path).replace_extension(ending).string();
}

class Batch {
 public:
  Batch(const BatchArguments& a, std::vector<BatchJob> jobs)
      : a_(a),
        jobs_(std::move(jobs)),
        table_(a.results.empty() ? WithEnding(a.table, ".results.csv") : a.results),
        page_(WithEnding(table_, ".html")) {
    const int cores = std::max(1, static_cast<int>(std::thread::hardware_concurrency()));
    threads_ = std::max(1, (a.threads > 0 ? a.threads : cores) / a.at_once);
    CheckOutputs();
  }

  int Run() {
    TakeEarlierResults();
    const size_t skipped = results_.size();
    const Progress progress = MakeProgress(a_.flags.quiet);
    size_t next = 0;
    while (next < jobs_.size() || !running_.empty()) {
      if (!progress("batch", static_cast<double>(results_.size()) / Count())) return GiveUp();
      while (std::ssize(running_) < a_.at_once && next < jobs_.size()) {
        if (!results_.contains(next)) Start(next);
        ++next;
      }
      if (!CollectEnded()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    }
    WriteResults();
    ClearProgress();
    Tell(skipped);
    return ExitCode();
  }

 private:
  using Clock = std::chrono::steady_clock;
  struct Running {
    Running(size_t job, const std::vector<std::string>& words) : at(job), process(words) {}

    size_t at;
    Clock::time_point start = Clock::now();
    ChildProcess process;
  };

  double Count() const { return static_cast<double>(jobs_.size()); }

  void CheckOutputs() const {
    std::vector<std::string> taken = {a_.table};
    for (const BatchJob& job : jobs_) {
      taken.insert(taken.end(), job.inputs.begin(), job.inputs.end());
      taken.insert(taken.end(), job.reports.begin(), job.reports.end());
      taken.push_back(job.output);
    }
    std::erase(taken, "");
    CheckDistinct({table_, page_}, a_.flags.json, taken);
    CheckWritable(table_);
    CheckWritable(page_);
  }

  // Jobs that are done, with what they wrote still there; those that failed are run again.
  void TakeEarlierResults() {
    const std::map<std::string, BatchResult> earlier = ReadBatchResults(table_);
    if (a_.again) return;
    for (size_t k = 0; k < jobs_.size(); ++k) {
      const auto found = earlier.find(jobs_[k].fingerprint);
      if (found == earlier.end()) continue;
      if (IsWritten(found->second.exit_code) && AllThere(jobs_[k])) results_[k] = found->second;
    }
  }

  static bool AllThere(const BatchJob& job) {
    std::error_code unknown;
    const auto there = [&](const std::string& path) {
      return path.empty() || std::filesystem::exists(path, unknown);
    };
    return there(job.output) && std::all_of(job.reports.begin(), job.reports.end(), there);
  }

  void Start(size_t at) {
    std::vector<std::string> words = jobs_[at].words;
    words.emplace_back("--json");
    if (!jobs_[at].own_threads) words.push_back("--threads=" + std::to_string(threads_));
    running_.emplace_back(at, words);
  }

  // Whether a job ended.
  bool CollectEnded() {
    const size_t before = running_.size();
    for (auto job = running_.begin(); job != running_.end();) {
      const std::optional<int> code = job->process.Ended();
      if (code && !(Interrupted() && *code == kInterrupted)) Note(*job, *code);
      job = code ? running_.erase(job) : std::next(job);
    }
    return running_.size() < before;
  }

  void Note(const Running& job, int code) {
    const double seconds = std::chrono::duration<double>(Clock::now() - job.start).count();
    const BatchResult result =
        ToBatchResult(jobs_[job.at], code, seconds, job.process.Output(), job.process.Errors());
    results_[job.at] = result;
    WriteResults();
    if (a_.flags.quiet || a_.flags.json) return;
    ClearProgress();
    PrintResult(fmt::format("{} of {}: {}", results_.size(), jobs_.size(), Line(job.at)));
    std::fflush(stdout);
  }

  std::string Line(size_t at) const {
    const BatchJob& job = jobs_[at];
    const BatchResult& result = results_.at(at);
    std::string line = job.output.empty() ? job.inputs.front() : job.output;
    line += fmt::format(": exit {}, {} s", result.exit_code, result.seconds);
    if (!result.rms.empty()) line += fmt::format(", rms {}, max {}", result.rms, result.max);
    if (!result.message.empty()) line += "; " + result.message;
    return line;
  }

  // They get their names at once, whatever becomes of the rest.
  void WriteResults() const {
    AtomicFile table(table_), page(page_);
    table.Write(ToCsv(jobs_, results_));
    page.Write(
        ToIndexPage(jobs_, results_, std::filesystem::path(a_.table).filename().string(), page_));
    table.Commit();
    page.Commit();
    OutputBatch::Commit();
  }

  int GiveUp() {
    for (const Running& job : running_) job.process.Interrupt();
    while (!running_.empty())
      if (!CollectEnded()) std::this_thread::sleep_for(std::chrono::milliseconds(5));
    ClearProgress();
    PrintError(
        fmt::format("interrupted; {} of {} jobs have results, the same command does the rest",
                    results_.size(),
                    jobs_.size()));
    return kInterrupted;
  }

  void Tell(size_t skipped) const {
    if (a_.flags.json) {
      const nlohmann::ordered_json all{{"jobs", ToJson(jobs_, results_)},
                                       {"skipped", skipped},
                                       {"results", table_},
                                       {"page", page_}};
      fmt::print("{}\n", all.dump(2));
      return;
    }
    if (a_.flags.quiet) return;
    PrintResult(fmt::format("{}: {} jobs, {} done before and unchanged, {} not done; {}",
                            table_,
                            jobs_.size(),
                            skipped,
                            CountOf(kBadInput),
                            page_));
  }

  // Jobs that wrote nothing, as `code` 1 says of a single fit.
  std::ptrdiff_t CountOf(int code) const {
    return std::count_if(results_.begin(), results_.end(), [&](const auto& entry) {
      const int of_job = entry.second.exit_code;
      return of_job == code || (code == kBadInput && !IsWritten(of_job));
    });
  }

  int ExitCode() const {
    if (CountOf(kBadInput) > 0) return kBadInput;
    if (CountOf(kToleranceMissed) > 0) return kToleranceMissed;
    return CountOf(kDoubtful) > 0 ? kDoubtful : kDone;
  }

  const BatchArguments& a_;
  std::vector<BatchJob> jobs_;
  std::string table_, page_;
  int threads_ = 1;
  BatchResults results_;
  std::list<Running> running_;
};

int RunBatch(const BatchArguments& a) {
  if (a.table == "-") throw UsageError("JOBS '-': a batch is resumed from its file");
  BePatient();
  return Batch(a, ReadBatchJobs(a.table, {FlagTakesNoValue, CheckCommandLine})).Run();
}

}  // namespace

void AddBatchCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<BatchArguments>();
  CLI::App& command = *app.add_subcommand("batch", "Run a table of fits, a line each");
  command
      .add_option("JOBS",
                  a->table,
                  "Table (.csv) whose first row names columns: input (files or patterns, several "
                  "by ;), output, command (fit surface unless said; fit curve, fit primitive, fit "
                  "solid, compare), and flags of that command without dashes. Empty cells leave "
                  "flags out, yes and no set those without a value")
      ->required()
      ->type_name("JOBS.csv");
  constexpr int kMostJobs = 1024;
  command
      .add_option_function<std::string>(
          "--jobs",
          [a](const std::string& text) {
            a->at_once = static_cast<int>(ParseWhole("--jobs", text, 1, kMostJobs));
          },
          "Jobs at a time; the threads are shared out among them")
      ->default_str("1")
      ->type_name("N");
  command
      .add_option("--results",
                  a->results,
                  "Table of results, and under the same name a page (.html) [JOBS.results.csv]")
      ->type_name("FILE.csv");
  command.add_flag("--again", a->again, "Run jobs that are done and unchanged too");
  AddThreadsFlag(command, a->threads);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Examples:\n"
      "  batten batch jobs.csv\n"
      "  batten batch jobs.csv --jobs 4 --results tonight.csv\n"
      "with, in jobs.csv:\n"
      "  input,output,tolerance,degree,snap\n"
      "  scans/a.ply,out/a.step,0.05,,\n"
      "  scans/b-*.las,out/b.step,,\"5,5\",yes\n"
      "After an interruption, or changes of lines and files, the same command does what is left "
      "to do:\njobs whose line and input files are as they were are not run again; those that "
      "failed are.\n"
      "Exit codes: 0 all jobs done; 3 some miss their tolerance; 1 some failed. The table has them "
      "all.");
  command.callback([a, &action] { action = [a] { return RunBatch(*a); }; });
}

}  // namespace batten::internal
