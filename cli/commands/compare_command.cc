// SPDX-License-Identifier: MIT
// batten compare: how far points are from a geometry.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/distances.h"
#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cli/arguments/cloud_arguments.h"
#include "cli/arguments/describe_geometry.h"
#include "cli/arguments/fit_output.h"
#include "cli/arguments/geometry_output.h"
#include "cli/commands/commands.h"
#include "cli/commands/file_kind.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"
#include "fitting/core/input_summary.h"
#include "fitting/core/stage_clock.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten::internal {
namespace {

struct CompareArguments {
  std::string geometry;
  std::vector<std::string> clouds;
  CloudArguments cloud;
  OutputArguments output;
  CommonFlags flags;
  WorkFlags work;
  GeometryInput input;
  std::optional<double> tolerance;
  bool unit_given = false;
  std::string align = "none", datum, profile, points = "faces";
};

// T, or LOW,HIGH.
std::optional<ProfileZone> ToZone(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const std::vector<double> numbers = ParseNumbers("--profile", text);
  if (numbers.size() == 1 && numbers[0] > 0) return ProfileZone{-numbers[0] / 2, numbers[0] / 2};
  if (numbers.size() == 2 && numbers[0] < numbers[1]) return ProfileZone{numbers[0], numbers[1]};
  throw UsageError("--profile: '" + text +
                   "' is neither a positive number nor LOW,HIGH with LOW below HIGH");
}

// Refuses a zone that differs on the two sides of a geometry that has none.
void CheckSides(const std::string& profile, const std::vector<Geometry>& geometry) {
  for (const Geometry& one : geometry) {
    if (!std::holds_alternative<NurbsSurface>(one))
      throw UsageError("--profile " + profile +
                       ": distances from a curve have no side: give one number");
  }
}

// The numbers of the datum surfaces, from 0 on, where the alignment is to them.
std::vector<int> ToDatums(const CompareArguments& a) {
  if (a.align != "datum") {
    if (!a.datum.empty()) throw UsageError("--datum: needs --align datum");
    return {};
  }
  if (a.datum.empty())
    throw UsageError(
        "--align datum: needs --datum, the numbers of its surfaces as reports have them");
  std::vector<int> datums;
  for (const double number : ParseNumbers("--datum", a.datum)) {
    if (!(number >= 0 && number < 1e6 && number == std::floor(number)))
      throw UsageError("--datum: '" + a.datum + "' are not whole numbers from 0 on");
    datums.push_back(static_cast<int>(number));
  }
  return datums;
}

// The motion of the points onto the surfaces, where one is asked for.
std::optional<RigidAlignment> AlignmentOf(const CompareArguments& a,
                                          const std::vector<int>& datums,
                                          const std::vector<Geometry>& geometry,
                                          const PointCloud& cloud,
                                          ThreadPool& pool) {
  if (a.align == "none") return std::nullopt;
  std::vector<NurbsSurface> surfaces;
  for (const Geometry& one : geometry) {
    const auto* surface = std::get_if<NurbsSurface>(&one);
    if (surface == nullptr)
      throw UsageError("--align " + a.align + ": " + a.geometry +
                       " holds a curve; points are "
                       "aligned to surfaces");
    surfaces.push_back(*surface);
  }
  try {
    return AlignRigidly(surfaces, cloud, datums, pool);
  } catch (const std::invalid_argument& error) {
    throw UsageError("--align " + a.align + ": " + error.what());
  }
}

std::string ProfileWords(const ProfileVerdict& verdict) {
  const char* const decision = verdict.decision == Conformity::kConforms    ? "conforms to"
                               : verdict.decision == Conformity::kUndecided ? "cannot be told from"
                                                                            : "does not conform to";
  return fmt::format(
      "; {} the profile zone {:.4g} ... {:.4g}: {:.4g} ... {:.4g}, uncertainty {:.2g}",
      decision,
      verdict.zone.low,
      verdict.zone.high,
      verdict.lowest,
      verdict.highest,
      verdict.uncertainty);
}

// The same shape with its control points moved.
template <int Dim>
NurbsCurve<Dim> Moved(const NurbsCurve<Dim>& curve, const Eigen::Vector3d& shift) {
  return Translated(curve, shift.head<Dim>());
}
NurbsSurface Moved(const NurbsSurface& surface, const Eigen::Vector3d& shift) {
  return surface.Translated(shift);
}

template <typename Curve>
void Describe(const Curve& curve, GeometrySummary& summary) {
  summary.kind = "curve";
  summary.degree = {curve.basis().degree()};
  summary.control_points = {curve.basis().size()};
  summary.rational = curve.rational();
  summary.closed = ClosedDirections(curve);
}
void Describe(const NurbsSurface& surface, GeometrySummary& summary) {
  summary.kind = "surface";
  summary.degree = {surface.basis_u().degree(), surface.basis_v().degree()};
  summary.control_points = {surface.size_u(), surface.size_v()};
  summary.rational = surface.rational();
  summary.closed = ClosedDirections(surface);
}

// The points of each geometry, by who owns them.
std::vector<PartError> PartsOf(const GeometryContents& contents,
                               const Eigen::VectorXd& distances,
                               const std::vector<int>& owners,
                               std::optional<double> tolerance) {
  const Eigen::Map<const Eigen::ArrayXi> owner(owners.data(), std::ssize(owners));
  std::vector<PartError> parts;
  for (size_t g = 0; g < contents.geometry.size(); ++g) {
    const bool surface = std::holds_alternative<NurbsSurface>(contents.geometry[g]);
    parts.push_back({g < contents.names.size() ? contents.names[g] : "",
                     surface ? "surface" : "curve",
                     Summarise(distances, tolerance, owner == static_cast<int>(g))});
  }
  return parts;
}

// Of several geometries every point belongs to the nearest.
struct Nearest {
  PointDistances found;
  std::vector<int> owners;
  Eigen::Index uncertified = 0;
};

Nearest NearestOf(const std::vector<Geometry>& geometry,
                  const PointCloud& cloud,
                  ThreadPool& pool,
                  const Progress& progress) {
  Nearest nearest;
  nearest.owners.assign(static_cast<std::size_t>(cloud.size()), 0);
  for (size_t g = 0; g < geometry.size(); ++g) {
    Report(progress, "project", static_cast<double>(g) / static_cast<double>(geometry.size()));
    PointDistances found = std::visit(
        [&](const auto& shape) {
          return DistancesTo(Moved(shape, -cloud.origin()), cloud.points(), pool);
        },
        geometry[g]);
    nearest.uncertified = std::max(nearest.uncertified, found.uncertified);
    PointDistances& best = nearest.found;
    if (g == 0) {
      best = std::move(found);
      continue;
    }
    if (found.parameters.rows() > best.parameters.rows()) {
      best.parameters.conservativeResizeLike(
          Eigen::MatrixXd::Zero(found.parameters.rows(), cloud.size()));
    }
    for (Eigen::Index k = 0; k < cloud.size(); ++k) {
      if (std::abs(found.distances[k]) >= std::abs(best.distances[k])) continue;
      best.distances[k] = found.distances[k];
      nearest.owners[static_cast<std::size_t>(k)] = static_cast<int>(g);
      best.parameters.col(k).setZero();
      best.parameters.col(k).head(found.parameters.rows()) = found.parameters.col(k);
    }
  }
  return nearest;
}

InputSummary InputOf(const CompareArguments& a,
                     const CloudFile& file,
                     const PointCloud& cloud,
                     ThreadPool& pool,
                     const Progress& progress) {
  const MergedCloud merged = MergeDuplicates(cloud);
  CloudStatisticsOptions statistics;
  statistics.find_outliers = false;
  statistics.seed = a.work.seed;
  const CloudStatistics measured = MeasureCloud(
      merged.cloud.points(), NeighbourIndex(merged.cloud.points()), statistics, pool, progress);
  InputSummary input = SummariseInput(cloud, merged.duplicates, measured.spacing, measured.noise);
  input.files = a.clouds;
  input.points = file.points_in_file - file.filtered;
  input.used = cloud.size();
  input.non_finite = file.non_finite;
  input.mesh = MeshIn(file);
  return input;
}

std::string ResultLine(const CompareArguments& a, const ErrorSummary& error) {
  std::string line = fmt::format("{} to {}: rms {:.4g}, mean {:.4g}, max {:.4g} over {} points",
                                 JoinedNames(a.clouds),
                                 a.geometry,
                                 error.rms,
                                 error.mean,
                                 error.max,
                                 error.points);
  if (error.tolerance)
    line += fmt::format("; {} out of tolerance {:.4g}", error.out_of_tolerance, *error.tolerance);
  return line;
}

bool NamedAsGeometry(const std::string& path) {
  const std::optional<FileFormat> format = FormatOfName(path);
  return format && IsGeometryFormat(*format);
}

// Puts the one file that is geometry by its name first, where a cloud was given in its place.
CompareArguments InOrder(CompareArguments a) {
  const auto found = std::find_if(a.clouds.begin(), a.clouds.end(), NamedAsGeometry);
  const bool swapped = FormatOfName(a.geometry) && !NamedAsGeometry(a.geometry) &&
                       std::count_if(a.clouds.begin(), a.clouds.end(), NamedAsGeometry) == 1;
  if (!swapped) return a;
  if (!a.flags.quiet) {
    PrintNote(*found + " is the geometry and " + a.geometry +
              " the cloud: batten compare GEOMETRY CLOUD names them in this order");
  }
  std::swap(a.geometry, *found);
  return a;
}

int RunCompare(const CompareArguments& given) {
  const CompareArguments a = InOrder(given);
  StageClock clock(&StageSeconds::read);
  CheckOutputArguments(a.output, a.unit_given);
  const std::optional<ProfileZone> zone = ToZone(a.profile);
  const std::vector<int> datums = ToDatums(a);
  std::vector<std::string> outputs = a.output.reports;
  outputs.push_back(a.output.residuals);
  outputs.push_back(a.output.certificate);
  std::vector<std::string> inputs = a.clouds;
  inputs.push_back(a.geometry);
  CheckDistinct(outputs, a.flags.json, inputs);
  CheckWritable(a.output.residuals);
  CheckWritable(a.output.certificate);
  for (const std::string& path : a.output.reports) CheckWritable(path);
  const bool word_is_geometry = NamesGeometry(a.cloud.format);
  BeginReading({a.geometry}, a.flags.quiet);
  const GeometryContents contents =
      ReadGeometryContents(a.geometry,
                           {.format = word_is_geometry ? a.cloud.format : "",
                            .unit = a.unit_given ? a.output.unit : "",
                            .strict = a.input.strict});
  TellUnread(a.geometry, contents, a.input, a.flags.quiet);
  const std::vector<Geometry>& geometry = contents.geometry;
  if (zone && zone->low != -zone->high) CheckSides(a.profile, geometry);
  CloudReadOptions read = ToReadOptions(a.cloud, a.flags.quiet);
  if (word_is_geometry) read.format.clear();
  BeginReading(a.clouds, a.flags.quiet);
  read.faces = a.points == "faces" ? CloudFaces::kMeasured : CloudFaces::kIgnored;
  const CloudFile file = ReadCloud(a.clouds, read);
  TellMesh(file, a.clouds, a.flags.quiet);
  RequireFixedMiddle(file, read, a.clouds);

  FitReport report;
  report.warnings = file.remarks;
  for (const std::string& remark : contents.remarks) {
    report.warnings.push_back(a.geometry + ": " + remark);
  }
  for (const std::string& why : contents.unread) {
    report.doubts.push_back({"unread", a.geometry + ": " + why});
  }
  if (!contents.flattened.empty()) {
    report.warnings.push_back(a.geometry + ": " + contents.flattened);
  }
  ThreadPool pool(a.work.threads);
  report.threads = pool.threads();
  clock.Enter(&StageSeconds::project);
  const Progress progress = MakeProgress(a.flags.quiet);
  const std::optional<RigidAlignment> alignment =
      AlignmentOf(a, datums, geometry, file.cloud, pool);
  const PointCloud cloud = alignment ? alignment->Moved(file.cloud) : file.cloud;

  const Nearest near = NearestOf(geometry, cloud, pool, progress);
  const PointDistances& nearest = near.found;
  if (near.uncertified > 0) report.warnings.push_back(UncertifiedText(near.uncertified));
  clock.Enter(&StageSeconds::prepare);
  report.input = InputOf(a, file, cloud, pool, progress);
  std::visit([&](const auto& shape) { Describe(shape, report.geometry); }, geometry.front());
  if (geometry.size() > 1) {
    report.warnings.push_back(
        a.geometry + " holds " + std::to_string(geometry.size()) +
        " geometries: distances are to the nearest, degree and control points those of the first");
    report.geometry.count = static_cast<int>(geometry.size());
    report.parts = PartsOf(contents, nearest.distances, near.owners, a.tolerance);
  }
  report.error = report.error_all = Summarise(nearest.distances, a.tolerance);
  report.optimize.why = "a comparison fits nothing";
  report.termination = a.tolerance && report.error.out_of_tolerance == 0
                           ? Termination::kToleranceReached
                           : Termination::kStalled;
  clock.Enter(&StageSeconds::write);
  const MeasuredPoints points{.cloud = cloud,
                              .distances = nearest.distances,
                              .parameters = nearest.parameters,
                              .outliers = PointMask::Constant(cloud.size(), false),
                              .owners = geometry.size() > 1 ? near.owners : std::vector<int>{},
                              .spacing = report.input.spacing,
                              .noise = report.input.noise};
  OutputArguments output = a.output;
  if (!contents.unit.empty()) output.unit = contents.unit;
  ReportTarget target{output, a.flags, a.geometry, ResultLine(a, report.error)};
  target.checks.alignment = alignment;
  if (zone) {
    if (!(report.input.noise > 0)) {
      report.warnings.push_back(
          "--profile: the noise of the points is not known: the decision allows for none");
    }
    target.checks.profile = CheckProfile(
        nearest.distances, DistanceDeviations(cloud, report.input.noise, alignment), *zone);
    target.result_line += ProfileWords(*target.checks.profile);
  }
  const Certified certified = CertificateFor(
      a.output, geometry, cloud, Eigen::Vector3d::Zero(), a.tolerance, a.work.threads);
  target.checks.certified = certified.summary;
  target.scene = SceneFor(a.output,
                          geometry,
                          points,
                          {.tolerance = a.tolerance, .names = contents.names},
                          a.work.threads,
                          a.flags.quiet);
  const auto residuals = ResidualsFor(a.output, points, a.tolerance);
  if (residuals) residuals->Commit();
  if (certified.file) certified.file->Commit();
  report.seconds = clock.Seconds();
  WriteReports(report, target);
  if (zone && target.checks.profile->decision != Conformity::kConforms) return kToleranceMissed;
  return report.tolerance_reached().value_or(true) ? kDone : kToleranceMissed;
}

}  // namespace

void AddCompareCommand(CLI::App& app, Action& action) {
  auto a = std::make_shared<CompareArguments>();
  CLI::App& command =
      *app.add_subcommand("compare", "Measure how far points are from a curve or surface");
  command.add_option("GEOMETRY", a->geometry, "Curves or surfaces: .json .step .iges .brep")
      ->required();
  command
      .add_option(
          "CLOUD", a->clouds, std::string("Points: ") + kCloudFormats + "; several are one cloud")
      ->required();
  command
      .add_option_function<std::string>(
          "--tolerance",
          [a](const std::string& text) {
            a->tolerance = ParseNumber("--tolerance", text, Sign::kPositive);
          },
          "Exit code 3 when a point is farther than this [none]")
      ->type_name("T");
  Allow(
      *command
           .add_option("--align",
                       a->align,
                       "Move the points first: none, best (a rigid motion of least squares), datum "
                       "(the same to the surfaces of --datum, one after the other)")
           ->capture_default_str()
           ->type_name("HOW"),
      {"none", "best", "datum"});
  command
      .add_option("--datum",
                  a->datum,
                  "Numbers of the datum surfaces, from 0, primary first: each fixes what it "
                  "determines and leaves the rest to the next")
      ->type_name("A[,B,...]");
  command
      .add_option("--profile",
                  a->profile,
                  "Profile tolerance: T is the zone -T/2 ... T/2 along the normals, LOW,HIGH any; "
                  "exit code 3 unless all points conform with their uncertainty")
      ->type_name("T|LOW,HIGH");
  AddCertificateArguments(command, a->output);
  AddPointsFlag(command, a->points);
  AddCloudArguments(command, a->cloud);
  AddOutputArguments(command, a->output);
  AddWorkFlags(command, a->work);
  AddGeometryInput(command, a->input);
  AddCommonFlags(command, a->flags);
  command.footer(
      "Distances are to the nearest point; of a trimmed surface only the part inside its loops "
      "counts.\n"
      "Examples:\n"
      "  batten compare part.step scan.ply\n"
      "  batten compare part.step scan.ply --tolerance 0.05 --report out.json --residuals out.ply\n"
      "  batten compare part.step scan.ply --report part.html\n"
      "  batten compare part.step scan.ply --align best --profile 0.2 --report part.json\n"
      "  batten compare part.json scan.ply --tolerance 0.05 --certify --certificate proof.json\n"
      "  batten compare other.step scan.ply --report both.html --beside part.html");
  command.callback([a, &command, &action] {
    a->unit_given = command.count("--unit") > 0;
    action = [a] { return RunCompare(*a); };
  });
}

}  // namespace batten::internal
