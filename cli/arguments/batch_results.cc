// SPDX-License-Identifier: MIT
#include "cli/arguments/batch_results.h"

#include <fmt/format.h>

#include <charconv>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "batten/io/read_error.h"
#include "cli/arguments/csv_table.h"
#include "cli/terminal/exit_codes.h"
#include "io/base/markup_text.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

const std::vector<std::string> kColumns = {"line",
                                           "command",
                                           "input",
                                           "output",
                                           "report",
                                           "exit_code",
                                           "seconds",
                                           "points",
                                           "control_points",
                                           "rms",
                                           "max",
                                           "tolerance_reached",
                                           "message",
                                           "job"};

std::string Joined(const std::vector<std::string>& parts, const char* between) {
  return fmt::format("{}", fmt::join(parts, between));
}

std::vector<std::string> Cells(const BatchJob& job, const BatchResult& result) {
  return {std::to_string(job.line),
          job.command,
          Joined(job.inputs, ";"),
          job.output,
          Joined(job.reports, ";"),
          std::to_string(result.exit_code),
          result.seconds,
          result.points,
          result.control_points,
          result.rms,
          result.max,
          result.tolerance_reached,
          result.message,
          result.fingerprint};
}

std::string Number(const Json& report, const char* pointer) {
  const Json::json_pointer at(pointer);
  return report.contains(at) && report[at].is_number()
             ? fmt::format("{:g}", report[at].get<double>())
             : "";
}

// "12 x 9", or of several geometries their numbers.
std::string ControlPoints(const Json& report) {
  const Json::json_pointer at("/geometry/control_points");
  if (!report.contains(at) || !report[at].is_array()) return "";
  std::vector<std::string> numbers;
  for (const Json& number : report[at]) numbers.push_back(number.dump());
  return Joined(numbers, " x ");
}

// The last line that the program wrote, without its name.
std::string LastLine(std::string errors) {
  while (!errors.empty() && errors.back() == '\n') errors.pop_back();
  std::string line = errors.substr(errors.rfind('\n') + 1);
  constexpr std::string_view kName = "batten: ";
  return line.starts_with(kName) ? line.substr(kName.size()) : line;
}

std::string Message(const Json& report, int exit_code, const std::string& errors) {
  constexpr int kSignal = 128;
  if (exit_code > kSignal) return fmt::format("ended by signal {}", exit_code - kSignal);
  if (IsWritten(exit_code)) {
    std::vector<std::string> sentences;
    for (const Json& doubt : report.value("doubt", Json::array()))
      sentences.push_back("doubtful: " + doubt.value("words", ""));
    const Json::json_pointer words("/end/words");
    if (exit_code == kToleranceMissed && report.contains(words) && report[words].is_string())
      sentences.push_back(report[words].get<std::string>());
    for (const Json& warning : report.value("warnings", Json::array()))
      if (warning.is_string()) sentences.push_back(warning.get<std::string>());
    return Joined(sentences, "; ");
  }
  return LastLine(errors);
}

std::string Link(const std::string& path, const std::string& page) {
  const auto folder = std::filesystem::absolute(page).parent_path();
  const std::string target =
      std::filesystem::absolute(path).lexically_relative(folder).generic_string();
  return fmt::format("<a href=\"{}\">{}</a>",
                     InMarkup(AsReference(target)),
                     InMarkup(std::filesystem::path(path).filename().string()));
}

std::string Links(const std::vector<std::string>& paths, const std::string& page) {
  std::string links;
  for (const std::string& path : paths) links += (links.empty() ? "" : "<br>") + Link(path, page);
  return links;
}

constexpr const char* kPageHead = R"(<!DOCTYPE html>
<html lang="en"><head><meta charset="utf-8"><title>{0}</title>
<style>
body {{ font: 15px/1.4 system-ui, sans-serif; margin: 2em; color: #222; }}
table {{ border-collapse: collapse; }}
th, td {{ padding: .3em .7em; text-align: left; vertical-align: top; border-bottom: 1px solid #ddd; }}
th {{ background: #f4f4f2; }}
td.number {{ text-align: right; font-variant-numeric: tabular-nums; }}
tr.failed td.state {{ color: #a11; font-weight: bold; }}
tr.missed td.state {{ color: #96660a; font-weight: bold; }}
</style></head><body>
<h1>{0}</h1>
<p>{1}</p>
<table>
<tr><th>Line</th><th>Command</th><th>Input</th><th>Output</th><th>Report</th><th>Result</th><th>Seconds</th>
<th>Points</th><th>Control points</th><th>rms</th><th>max</th><th>What was said</th></tr>
)";

std::string PageRow(const BatchJob& job, const BatchResult* result, const std::string& page) {
  const int code = result == nullptr ? kDone : result->exit_code;
  const bool written = result != nullptr && IsWritten(code);
  const std::vector<std::string> outputs = written && !job.output.empty()
                                               ? std::vector<std::string>{job.output}
                                               : std::vector<std::string>{};
  const char* const state = result == nullptr          ? "not run"
                            : code == kDone            ? "done"
                            : code == kToleranceMissed ? "tolerance missed"
                            : code == kDoubtful        ? "doubtful"
                                                       : "failed";
  const char* const row_class = code == kDone ? ""
                                : written     ? " class=\"missed\""
                                              : " class=\"failed\"";
  const BatchResult none;
  const BatchResult& r = result == nullptr ? none : *result;
  std::string row = fmt::format("<tr{}><td class=\"number\">{}</td><td>{}</td><td>{}</td>",
                                row_class,
                                job.line,
                                InMarkup(job.command),
                                Links(job.inputs, page));
  row += fmt::format("<td>{}</td><td>{}</td><td class=\"state\">{}{}</td>",
                     Links(outputs, page),
                     written ? Links(job.reports, page) : "",
                     state,
                     result == nullptr ? "" : fmt::format(" ({})", code));
  for (const std::string& number : {r.seconds, r.points, r.control_points, r.rms, r.max})
    row += fmt::format("<td class=\"number\">{}</td>", InMarkup(number));
  return row + fmt::format("<td>{}</td></tr>\n", InMarkup(r.message));
}

}  // namespace

BatchResult ToBatchResult(const BatchJob& job,
                          int exit_code,
                          double seconds,
                          const std::string& report,
                          const std::string& errors) {
  const Json told = Json::parse(report, nullptr, false);
  BatchResult result;
  result.exit_code = exit_code;
  result.seconds = fmt::format("{:.2f}", seconds);
  result.fingerprint = job.fingerprint;
  if (told.is_object()) {
    result.points = Number(told, "/input/points");
    result.control_points = ControlPoints(told);
    result.rms = Number(told, "/error/rms");
    result.max = Number(told, "/error/max");
    if (told.contains("tolerance_reached") && told["tolerance_reached"].is_boolean())
      result.tolerance_reached = told["tolerance_reached"].get<bool>() ? "yes" : "no";
  }
  result.message = Message(told.is_object() ? told : Json::object(), exit_code, errors);
  return result;
}

std::map<std::string, BatchResult> ReadBatchResults(const std::string& path) {
  std::map<std::string, BatchResult> results;
  std::error_code unknown;
  if (!std::filesystem::exists(path, unknown)) return results;
  const std::vector<CsvRow> rows = ReadCsv(path);
  const std::string advice = "it is no table of results of a batch; --results names another file";
  if (rows.empty() || rows.front().cells != kColumns) throw ReadError(path, advice);
  for (size_t k = 1; k < rows.size(); ++k) {
    const std::vector<std::string>& cells = rows[k].cells;
    int code = 0;
    if (cells.size() != kColumns.size()) throw ReadError::AtLine(path, rows[k].line, advice);
    const std::string& text = cells[5];
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), code);
    if (error != std::errc() || end != text.data() + text.size())
      throw ReadError::AtLine(path, rows[k].line, "exit_code '" + text + "' is no number");
    results[cells.back()] = {
        code, cells[6], cells[7], cells[8], cells[9], cells[10], cells[11], cells[12], cells[13]};
  }
  return results;
}

std::string ToCsv(const std::vector<BatchJob>& jobs, const BatchResults& results) {
  std::string table = CsvLine(kColumns);
  for (const auto& [at, result] : results) table += CsvLine(Cells(jobs[at], result));
  return table;
}

nlohmann::ordered_json ToJson(const std::vector<BatchJob>& jobs, const BatchResults& results) {
  Json rows = Json::array();
  for (const auto& [at, result] : results) {
    const std::vector<std::string> cells = Cells(jobs[at], result);
    Json row;
    for (size_t k = 0; k + 1 < kColumns.size(); ++k) {
      const Json number = Json::parse(cells[k], nullptr, false);
      row[kColumns[k]] = number.is_number() ? number : Json(cells[k]);
    }
    rows.push_back(std::move(row));
  }
  return rows;
}

std::string ToIndexPage(const std::vector<BatchJob>& jobs,
                        const BatchResults& results,
                        const std::string& title,
                        const std::string& page) {
  size_t done = 0, missed = 0, doubtful = 0;
  for (const auto& [at, result] : results) {
    done += result.exit_code == kDone ? 1 : 0;
    missed += result.exit_code == kToleranceMissed ? 1 : 0;
    doubtful += result.exit_code == kDoubtful ? 1 : 0;
  }
  const std::string counts =
      fmt::format("{} jobs: {} done, {} tolerance missed, {} doubtful, {} failed, {} not run",
                  jobs.size(),
                  done,
                  missed,
                  doubtful,
                  results.size() - done - missed - doubtful,
                  jobs.size() - results.size());
  std::string html = fmt::format(fmt::runtime(kPageHead), InMarkup(title), counts);
  for (size_t k = 0; k < jobs.size(); ++k) {
    const auto found = results.find(k);
    html += PageRow(jobs[k], found == results.end() ? nullptr : &found->second, page);
  }
  return html + "</table>\n</body></html>\n";
}

}  // namespace batten::internal
