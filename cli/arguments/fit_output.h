// SPDX-License-Identifier: MIT
// What fits and comparisons leave besides the geometry: reports and the line on the terminal.
#pragma once

#include <chrono>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/part_options.h"
#include "batten/io/atomic_file.h"
#include "batten/io/geometry_types.h"
#include "batten/io/report_json.h"
#include "batten/io/report_scene.h"
#include "cli/terminal/cli11_forward.h"
#include "cli/terminal/common_flags.h"

namespace batten::internal {

struct OutputArguments {
  std::vector<std::string> reports;
  std::string beside;  // a page
  std::string residuals;
  std::string unit = "mm";
  bool certify = false;     // proved bounds in the report
  std::string certificate;  // and in a file; empty: none
};
// The flags --certify and --certificate.
void AddCertificateArguments(CLI::App& command, OutputArguments& arguments);

void AddOutputArguments(CLI::App& command, OutputArguments& arguments);

// Refuses file names and units nothing can be written as, and a page that can't stand beside the
// report, before any work is done. Throws UsageError, and ReadError for that page, whose unit is
// looked at only where the report's is known.
void CheckOutputArguments(const OutputArguments& arguments, bool unit_known = true);

// Whether one of the reports is a page, which needs a scene.
bool WantsPage(const OutputArguments& arguments);

// Refuses a file that could not be written in the end: a missing folder, no permission, a name too
// long (WriteError), the module of its format missing (std::runtime_error).
void CheckWritable(const std::string& path);

// Refuses a file name given for two outputs, or standard output wanted by two, and an output that
// is one of the files that are read, of which nothing would be left. Throws UsageError.
void CheckDistinct(const std::vector<std::string>& outputs,
                   bool json,
                   const std::vector<std::string>& inputs = {});

// {"files": [entry]}
void PrintFiles(const nlohmann::ordered_json& entry);

// Resident memory at its highest, in bytes.
std::int64_t PeakMemory();

// The scene of the page, where one is wanted. Names, and progress on the terminal unless `quiet`,
// are added to the options.
std::optional<ReportScene> SceneFor(const OutputArguments& arguments,
                                    const std::vector<Geometry>& geometry,
                                    const MeasuredPoints& points,
                                    ReportSceneOptions options,
                                    int threads,
                                    bool quiet);

// The residuals, where they are wanted; the file appears on Commit().
std::unique_ptr<AtomicFile> ResidualsFor(const OutputArguments& arguments,
                                         const MeasuredPoints& points,
                                         std::optional<double> tolerance);

// The proved bounds of the points' distances, where they are wanted; the file appears on Commit()
// of `file`, where one is.
struct Certified {
  std::optional<CertificateSummary> summary;
  std::unique_ptr<AtomicFile> file;
};
Certified CertificateFor(const OutputArguments& arguments,
                         const std::vector<Geometry>& geometry,
                         const PointCloud& cloud,
                         const Eigen::Vector3d& shift,
                         std::optional<double> tolerance,
                         int threads);

struct ReportTarget {
  const OutputArguments& arguments;
  const CommonFlags& flags;
  std::string geometry_file;
  std::string result_line;  // for standard output; empty where that carries the data
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();
  std::optional<ReportScene> scene = std::nullopt;  // where a page is wanted
  ReportChecks checks = {};
  const PartSummary* part = nullptr;  // of a part
  std::size_t told = 0;               // of the warnings, the first, which have been printed
};

// Writes the reports asked for and prints warnings and the result line, or the report as JSON.
void WriteReports(const FitReport& report, const ReportTarget& target);

}  // namespace batten::internal
