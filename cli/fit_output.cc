// SPDX-License-Identifier: MIT
#include "batten/cli/fit_output.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "batten/cli/geometry_flags.h"
#include "batten/cli/parse_values.h"
#include "batten/cli/terminal.h"
#include "batten/io/atomic_file.h"
#include "batten/io/read_error.h"
#include "batten/io/report_json.h"

namespace batten {
namespace {

std::string Extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return extension;
}

void Append(std::string& bytes, const void* value, size_t size) {
  bytes.append(static_cast<const char*>(value), size);
}

}  // namespace

void AddOutputArguments(CLI::App& command, OutputArguments& arguments) {
  command.add_option("--report", arguments.reports, "Write the report: R.json; may be given again")
      ->type_name("FILE")
      ->allow_extra_args(false);
  command
      .add_option(
          "--residuals", arguments.residuals, "Write every point's distance: R.ply or R.csv")
      ->type_name("FILE");
  AddUnitFlag(command, arguments.unit);
}

void CheckOutputArguments(const OutputArguments& arguments) {
  CheckUnit(arguments.unit);
  for (const std::string& path : arguments.reports) {
    const std::string extension = Extension(path);
    if (extension == ".html")
      throw UsageError("--report " + path + ": HTML reports are not in this version; write .json");
    if (extension != ".json") throw UsageError("--report " + path + ": a report is a .json file");
  }
  if (!arguments.residuals.empty()) {
    const std::string extension = Extension(arguments.residuals);
    if (extension != ".ply" && extension != ".csv") {
      throw UsageError("--residuals " + arguments.residuals +
                       ": residuals are a .ply or .csv file");
    }
  }
}

void CheckWritable(const std::string& path) {
  if (!path.empty()) AtomicFile{path};
}

void CheckDistinct(const std::vector<std::string>& outputs, bool json) {
  std::set<std::string> seen;
  for (const std::string& path : outputs) {
    if (path.empty()) continue;
    if (path == "-" && json) throw UsageError("-o - and --json both want standard output");
    const std::string name =
        path == "-" ? path
                    : std::filesystem::weakly_canonical(std::filesystem::absolute(path)).string();
    if (!seen.insert(name).second) throw UsageError(path + " is named for two outputs");
  }
}

const std::vector<std::string>& Units() {
  static const std::vector<std::string> units = {
      "mm", "cm", "m", "km", "um", "in", "inch", "ft", "mi", "mil", "uin"};
  return units;
}

void CheckUnit(const std::string& unit) { CheckChoice("--unit", unit, Units()); }

void PrintFiles(const nlohmann::ordered_json& entry) {
  const nlohmann::ordered_json list{{"files", nlohmann::ordered_json::array({entry})}};
  fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

std::int64_t PeakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

void WriteReports(const FitReport& report, const ReportTarget& target) {
  ReportContext context;
  context.command = CommandLine();
  context.file = target.geometry_file;
  context.unit = target.arguments.unit;
  context.shift = target.shift;
  context.peak_memory_bytes = PeakMemory();
  context.version = Version();
  for (const std::string& path : target.arguments.reports) {
    AtomicFile file(path);
    file.Write(ToReportJson(report, context));
    file.Commit();
  }
  ClearProgress();
  if (!target.flags.quiet) {
    for (const std::string& warning : report.warnings) PrintWarning(warning);
  }
  if (target.flags.json) {
    std::fputs(ToReportJson(report, context).c_str(), stdout);
  } else if (!target.flags.quiet && !target.result_line.empty()) {
    const std::optional<bool> reached = report.tolerance_reached();
    fmt::print("{}\n", reached ? WithVerdict(target.result_line, *reached) : target.result_line);
  }
}

std::unique_ptr<AtomicFile> WriteResiduals(const std::string& path,
                                           const PointCloud& cloud,
                                           const Eigen::VectorXd& distances,
                                           const Eigen::MatrixXd& parameters,
                                           const Eigen::Array<bool, Eigen::Dynamic, 1>& outliers) {
  if (path.empty()) return nullptr;
  auto target = std::make_unique<AtomicFile>(path);
  AtomicFile& file = *target;
  const bool has_v = parameters.rows() > 1;
  std::string row;
  if (Extension(path) == ".csv") {
    file.Write(has_v ? "x,y,z,distance,u,v,outlier\n" : "x,y,z,distance,u,outlier\n");
    for (Eigen::Index k = 0; k < cloud.size(); ++k) {
      const Eigen::Vector3d p = cloud.World(k);
      row.clear();
      fmt::format_to(std::back_inserter(row),
                     "{},{},{},{},{}",
                     p[0],
                     p[1],
                     p[2],
                     distances[k],
                     parameters(0, k));
      if (has_v) fmt::format_to(std::back_inserter(row), ",{}", parameters(1, k));
      fmt::format_to(std::back_inserter(row), ",{}\n", outliers[k] ? 1 : 0);
      file.Write(row);
    }
  } else {
    std::string header = fmt::format(
        "ply\nformat binary_little_endian 1.0\nelement vertex {}\nproperty double x\nproperty "
        "double y\n"
        "property double z\nproperty double distance\nproperty double u\n",
        cloud.size());
    if (has_v) header += "property double v\n";
    file.Write(header + "property uchar outlier\nend_header\n");
    for (Eigen::Index k = 0; k < cloud.size(); ++k) {
      const Eigen::Vector3d p = cloud.World(k);
      const double numbers[6] = {
          p[0], p[1], p[2], distances[k], parameters(0, k), has_v ? parameters(1, k) : 0};
      const unsigned char outlier = outliers[k] ? 1 : 0;
      row.clear();
      Append(row, numbers, (has_v ? 6 : 5) * sizeof(double));
      Append(row, &outlier, 1);
      file.Write(row);
    }
  }
  return target;
}

}  // namespace batten
