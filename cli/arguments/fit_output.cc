// SPDX-License-Identifier: MIT
#include "cli/arguments/fit_output.h"

#include <fmt/format.h>
#include <sys/resource.h>

#include <algorithm>
#include <charconv>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <set>

#include "batten/io/atomic_file.h"
#include "batten/io/deviation_limit.h"
#include "batten/io/file_format.h"
#include "batten/io/read_error.h"
#include "batten/io/report_html.h"
#include "batten/io/report_json.h"
#include "batten/io/write_residuals.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/streams.h"
#include "cli/terminal/terminal.h"
#include "cli/terminal/this_run.h"
#include "io/base/whole_file.h"
#include "io/exchange/opencascade_functions.h"

namespace batten::internal {
namespace {

std::string Extension(const std::string& path) {
  std::string extension = std::filesystem::path(path).extension().string();
  std::transform(extension.begin(), extension.end(), extension.begin(), [](unsigned char c) {
    return static_cast<char>(std::tolower(c));
  });
  return extension;
}

// The page named, checked; empty where none is.
std::string BesidePage(const OutputArguments& arguments, const std::string& unit) {
  if (arguments.beside.empty()) return {};
  std::string page = ReadWholeFile(arguments.beside);
  try {
    CheckBeside(page, unit);
  } catch (const std::invalid_argument& refused) {
    throw ReadError(arguments.beside, refused.what());
  }
  return page;
}

// The day and time in UTC: that of SOURCE_DATE_EPOCH where it holds seconds since 1970.
std::string Today() {
  std::time_t now = std::time(nullptr);
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {
    const char* const end = epoch + std::strlen(epoch);
    std::from_chars(epoch, end, now);
  }
  std::tm utc{};
  char text[32] = "";
  if (gmtime_r(&now, &utc)) std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
  return text;
}

}  // namespace

void AddOutputArguments(CLI::App& command, OutputArguments& arguments) {
  command
      .add_option("--report",
                  arguments.reports,
                  "Write the report: R.html, a page to look at, or R.json; may be given again")
      ->allow_extra_args(false)
      ->type_name("FILE");
  command
      .add_option("--beside",
                  arguments.beside,
                  "With --report R.html: show what this page of an earlier report shows beside it, "
                  "on one scale")
      ->type_name("PAGE.html");
  command
      .add_option("--residuals",
                  arguments.residuals,
                  "Write every point with its distance: R.ply, coloured by it, or R.csv")
      ->type_name("FILE");
  AddUnitFlag(command, arguments.unit);
}

bool WantsPage(const OutputArguments& arguments) {
  return std::any_of(arguments.reports.begin(), arguments.reports.end(), [](const auto& path) {
    return Extension(path) == ".html";
  });
}

void AddCertificateArguments(CLI::App& command, OutputArguments& arguments) {
  command.add_flag("--certify",
                   arguments.certify,
                   "Prove bounds of every point's distance, and that the surface has no folds; the "
                   "report says what could not be proved");
  command
      .add_option("--certificate",
                  arguments.certificate,
                  "Write these bounds too, C.json, for batten-verify to prove anew")
      ->type_name("FILE");
}

void CheckOutputArguments(const OutputArguments& arguments, bool unit_known) {
  CheckUnit(arguments.unit);
  for (const std::string& path : arguments.reports) {
    const std::string extension = Extension(path);
    if (extension != ".json" && extension != ".html")
      throw UsageError("--report " + path + ": a report is a .html or .json file");
  }
  if (!arguments.residuals.empty()) CheckResidualsName(arguments.residuals);
  if (!arguments.certificate.empty() && Extension(arguments.certificate) != ".json") {
    throw UsageError("--certificate " + arguments.certificate + ": a certificate is a .json file");
  }
  if (arguments.beside.empty()) return;
  if (!WantsPage(arguments))
    throw UsageError("--beside is of the page of a report: it needs --report R.html");
  CheckDistinct(arguments.reports, false, {arguments.beside});
  BesidePage(arguments, unit_known ? arguments.unit : "");
}

void CheckWritable(const std::string& path) {
  if (path.empty()) return;
  AtomicFile{path};
  const auto format = FormatOfName(path);
  if (format == FileFormat::kStep || format == FileFormat::kIges || format == FileFormat::kBrep)
    OpenCascade();
}

void CheckDistinct(const std::vector<std::string>& outputs,
                   bool json,
                   const std::vector<std::string>& inputs) {
  std::set<std::string> seen;
  for (const std::string& path : outputs) {
    if (path.empty()) continue;
    if (path == "-" && json) throw UsageError("-o - and --json both want standard output");
    std::error_code unknown;  // what can't be looked at can't be written either
    const std::filesystem::path whole =
        std::filesystem::weakly_canonical(std::filesystem::absolute(path), unknown);
    const std::string name = path == "-" || unknown ? path : whole.string();
    if (!seen.insert(name).second) throw UsageError(path + " is named for two outputs");
    for (const std::string& input : inputs) {
      std::error_code other;  // what can't be looked at is another file
      if (input != "-" && path != "-" && std::filesystem::equivalent(path, input, other)) {
        throw UsageError(path + " is read: it would be lost if it were written too");
      }
    }
  }
}

void PrintFiles(const nlohmann::ordered_json& entry) {
  const nlohmann::ordered_json list{{"files", nlohmann::ordered_json::array({entry})}};
  fmt::print("{}\n", list.dump(2, ' ', false, nlohmann::ordered_json::error_handler_t::replace));
}

std::int64_t PeakMemory() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return std::int64_t{usage.ru_maxrss} * 1024;
}

std::optional<ReportScene> SceneFor(const OutputArguments& arguments,
                                    const std::vector<Geometry>& geometry,
                                    const MeasuredPoints& points,
                                    ReportSceneOptions options,
                                    int threads,
                                    bool quiet) {
  if (!WantsPage(arguments)) return std::nullopt;
  options.progress = MakeProgress(quiet);
  ThreadPool pool(threads);
  return MakeReportScene(geometry, points, options, pool);
}

std::unique_ptr<AtomicFile> ResidualsFor(const OutputArguments& arguments,
                                         const MeasuredPoints& points,
                                         std::optional<double> tolerance) {
  if (arguments.residuals.empty()) return nullptr;
  const Eigen::Matrix3Xd& places = points.cloud.points();
  const double size =
      places.cols() == 0 ? 0 : (places.rowwise().maxCoeff() - places.rowwise().minCoeff()).norm();
  const double range =
      DeviationLimit(points.distances, points.outliers, tolerance, points.noise, size);
  return WriteResiduals(arguments.residuals,
                        {points.cloud,
                         points.distances,
                         points.parameters,
                         points.outliers,
                         range,
                         points.owners,
                         points.deviations});
}

Certified CertificateFor(const OutputArguments& arguments,
                         const std::vector<Geometry>& geometry,
                         const PointCloud& cloud,
                         const Eigen::Vector3d& shift,
                         std::optional<double> tolerance,
                         int threads) {
  Certified certified;
  if (!arguments.certify && arguments.certificate.empty()) return certified;
  ThreadPool pool(threads);
  const Certificate certificate = Certify(geometry, cloud, shift, tolerance, pool);
  certified.summary = certificate.summary;
  if (arguments.certificate.empty()) return certified;
  certified.file = std::make_unique<AtomicFile>(arguments.certificate);
  certified.file->Write(ToCertificateJson(certificate, geometry, cloud, shift));
  return certified;
}

void WriteReports(const FitReport& report, const ReportTarget& target) {
  const std::string beside = BesidePage(target.arguments, target.arguments.unit);
  ReportContext context;
  context.command = CommandLine();
  context.file = target.geometry_file;
  context.unit = target.arguments.unit;
  context.shift = target.shift;
  context.peak_memory_bytes = PeakMemory();
  context.part = target.part;
  context.version = Version();
  context.date = Today();
  context.checks = target.checks;
  for (const std::string& path : target.arguments.reports) {
    AtomicFile file(path);
    if (Extension(path) == ".html") {
      file.Write(ToReportHtml(report, context, target.scene.value(), beside));
    } else {
      file.Write(ToReportJson(report, context));
    }
    file.Commit();
  }
  ClearProgress();
  if (!target.flags.quiet) {
    for (std::size_t k = target.told; k < report.warnings.size(); ++k)
      PrintWarning(report.warnings[k]);
  }
  if (target.flags.json) {
    std::fputs(ToReportJson(report, context).c_str(), stdout);
  } else if (!target.flags.quiet && !target.result_line.empty()) {
    const std::optional<bool> reached = report.tolerance_reached();
    if (reached) {
      PrintVerdict(target.result_line, *reached);
    } else {
      PrintResult(target.result_line);
    }
  }
}

}  // namespace batten::internal
