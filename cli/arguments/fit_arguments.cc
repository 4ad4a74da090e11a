// SPDX-License-Identifier: MIT
#include "cli/arguments/fit_arguments.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <numeric>

#include "batten/fitting/progress.h"
#include "batten/io/file_format.h"
#include "batten/io/geometry_file.h"
#include "batten/io/mesh_writer.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "batten/io/solid_writer.h"
#include "batten/io/write_uncertainty.h"
#include "cli/arguments/geometry_flags.h"
#include "cli/arguments/geometry_output.h"
#include "cli/arguments/mesh_output.h"
#include "cli/arguments/point_sharing.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/common_flags.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/help_format.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"
#include "cli/terminal/written_format.h"

namespace batten::internal {
namespace {

// 500 m in the data's unit: CAD kernels lose digits beyond.
double FarAway(const std::string& unit) {
  static const std::map<std::string, double> kPerMetre = {{"mm", 1000},
                                                          {"cm", 100},
                                                          {"m", 1},
                                                          {"km", 0.001},
                                                          {"um", 1e6},
                                                          {"inch", 39.3701},
                                                          {"in", 39.3701},
                                                          {"ft", 3.28084},
                                                          {"foot", 3.28084}};
  const auto found = kPerMetre.find(unit);
  return 500 * (found == kPerMetre.end() ? 1000 : found->second);
}

CLI::Option& AddText(CLI::App& command,
                     const std::string& flag,
                     std::string& value,
                     const std::string& help,
                     const std::string& type) {
  return *command.add_option(flag, value, help)->capture_default_str()->type_name(type);
}

}  // namespace

void NotYet(const std::string& what) { throw UsageError(what + " is not in this version"); }

std::optional<Loss> ToLoss(const std::string& word) {
  if (word == "auto") return std::nullopt;
  if (word == "none") return Loss::kNone;
  if (word == "huber") return Loss::kHuber;
  if (word == "cauchy") return Loss::kCauchy;
  if (word == "truncated") return Loss::kTruncated;
  return Loss::kTukey;
}

std::optional<double> ToSmoothing(const std::string& text) {
  if (text == "auto") return std::nullopt;
  constexpr double kMost = 1e12;  // beyond, the points drown in rounding
  const double smoothing = ParseNumber("--smoothing", text, Sign::kNotNegative);
  if (smoothing > kMost) throw UsageError("--smoothing: '" + text + "' is more than 1e12");
  return smoothing;
}

std::optional<double> ToLossScale(const std::string& text) {
  if (text == "auto") return std::nullopt;
  return ParseNumber("--loss-scale", text, Sign::kPositive);
}

std::optional<FreeVariables> ToFreeVariables(const std::string& words) {
  if (words == "auto") return std::nullopt;
  FreeVariables freedom;
  if (words == "none") return freedom;
  std::string rest = words + ",";
  for (size_t comma; (comma = rest.find(',')) != std::string::npos; rest.erase(0, comma + 1)) {
    const std::string word = rest.substr(0, comma);
    bool* const named = word == "params"    ? &freedom.parameters
                        : word == "weights" ? &freedom.weights
                        : word == "knots"   ? &freedom.knots
                                            : nullptr;
    if (named == nullptr) {
      throw UsageError("--optimize: '" + words +
                       "' is not auto, none or a list of params, weights and knots");
    }
    if (*named) throw UsageError("--optimize: '" + words + "' names " + word + " twice");
    *named = true;
  }
  return freedom;
}

std::optional<Eigen::Vector3d> ToShift(const std::string& origin) {
  if (origin == "keep") return Eigen::Vector3d::Zero();
  if (origin == "local") return std::nullopt;
  if (origin.find_first_of("0123456789") == std::string::npos) {
    CheckChoice("--origin", origin, {"keep", "local", "x,y,z"});
  }
  const std::vector<double> numbers = ParseNumbers("--origin", origin);
  if (numbers.size() != 3)
    throw UsageError("--origin: '" + origin + "' is not keep, local or x,y,z");
  return Eigen::Vector3d(numbers[0], numbers[1], numbers[2]);
}

void AddEveryFitsArguments(CLI::App& command,
                           FitArguments& a,
                           const char* points,
                           const char* loss) {
  command
      .add_option(
          points, a.clouds, std::string("Points: ") + kCloudFormats + "; several are one cloud")
      ->required();
  command
      .add_option("-o,--output",
                  a.out,
                  a.curves
                      ? "Where to write: .step .iges .brep .json"
                      : "Where to write: .step .iges .brep .json, or triangles, within 1e-3 of the "
                        "size and half the tolerance: .stl .obj .ply .glb")
      ->required()
      ->type_name("OUT");
  command
      .add_option_function<std::string>(
          "--tolerance",
          [&a](const std::string& text) {
            a.tolerance = ParseNumber("--tolerance", text, Sign::kPositive);
          },
          "Distance every point must keep, in the data's unit; free shapes refine where it is "
          "missed [none]")
      ->type_name("T");
  command
      .add_option_function<std::string>(
          "--time-limit",
          [&a](const std::string& text) {
            a.time_limit = ParseNumber("--time-limit", text, Sign::kPositive);
          },
          "Seconds for the fit; then the best so far is written, and the exit code is 3 [none]")
      ->type_name("S");
  command.add_flag(
      "--accept-doubt",
      a.accept_doubt,
      "A result that may be wrong, which the first line says, ends with code 0 and not 4");
  if (loss != nullptr) {
    Allow(AddText(command, "--loss", a.loss, loss, "LOSS"),
          {"auto", "none", "huber", "cauchy", "tukey", "truncated"});
    Suggest(AddText(command,
                    "--loss-scale",
                    a.loss_scale,
                    "Standard deviation of good points, in the data's unit: auto (estimated) or a "
                    "number",
                    "S"),
            {"auto"});
  }
  Suggest(AddText(command,
                  "--clean",
                  a.clean,
                  !a.may_keep_all
                      ? "Stray points: auto (found by the fit), or statistical[:K,S] "
                        "(removed before: farther from their K nearest, 16, than S, 3, standard "
                        "deviations)"
                      : "Stray points: auto (found by the fit), none (there are none: every point "
                        "is fitted), or statistical[:K,S] (removed before: farther from their K "
                        "nearest, 16, than S, 3, standard deviations)",
                  "HOW"),
          !a.may_keep_all ? std::vector<std::string>{"auto", "statistical"}
                          : std::vector<std::string>{"auto", "none", "statistical"});
  Suggest(AddText(command,
                  "--origin",
                  a.origin,
                  "Subtracted from what is written: keep (nothing), local, or x,y,z",
                  "ORIGIN"),
          {"keep", "local"});
  AddOutputFormatFlag(command, a.out_format);
  AddStepSchemaFlag(command, a.step_schema);
  if (!a.curves && !a.vertices_alone) AddPointsFlag(command, a.points);
  AddCloudArguments(command, a.cloud);
  AddOutputArguments(command, a.output);
  AddWorkFlags(command, a.work);
  AddCommonFlags(command, a.flags);
}

void AddFitArguments(CLI::App& command, FitArguments& a, const FitWords& words) {
  AddEveryFitsArguments(command, a, words.points, words.loss);
  Suggest(AddText(command,
                  "--control-points",
                  a.control_points,
                  std::string(words.control_points) + " control points, or chosen by the data",
                  words.control_points),
          {"chosen"});
  AddText(command,
          "--max-control-points",
          a.max_control_points,
          "Never more control points than this",
          "K");
  Suggest(AddText(command,
                  "--smoothing",
                  a.smoothing,
                  std::string("Fairness relative to the data: auto (") + words.smoothing +
                      ") or a number",
                  "L"),
          {"auto"});
  Allow(AddText(command, "--parameterization", a.parameterization, words.parameterization, "FROM"),
        words.parameterizations);
  Suggest(
      AddText(
          command,
          "--optimize",
          a.optimize,
          "Joint stage by Ceres: auto (where residuals exceed the noise and the points carry it), "
          "none, or what is free besides the control points, any of params,weights,knots",
          "MODE"),
      {"auto", "none", "params", "weights", "knots", "params,weights", "params,weights,knots"});
}

void AddUncertaintyArguments(CLI::App& command, FitArguments& a) {
  command.add_flag(
      "--uncertainty",
      a.uncertainty,
      "Standard deviations of the shape along its normal, by the noise of the points, in "
      "the report, and with --residuals at every point");
  command
      .add_option("--uncertainty-map",
                  a.uncertainty_map,
                  "Write them over the whole shape: M.csv, or of a surface M.ply or M.glb, a mesh "
                  "coloured by them")
      ->type_name("FILE");
  AddCertificateArguments(command, a.output);
}

void GroupFitFlags(CLI::App& command) {
  GroupFlags(command,
             "What is written",
             {"--output",
              "--report",
              "--beside",
              "--residuals",
              "--uncertainty",
              "--uncertainty-map",
              "--certify",
              "--certificate",
              "--unit",
              "--origin",
              "--output-format",
              "--step-schema",
              "--sew",
              "--tile-faces"});
  GroupFlags(command,
             "How near, how smooth, how long",
             {"--tolerance",
              "--degree",
              "--control-points",
              "--max-control-points",
              "--smoothing",
              "--optimize",
              "--distance",
              "--interpolate",
              "--spline",
              "--method",
              "--time-limit",
              "--accept-doubt",
              "--memory",
              "--checkpoint",
              "--tiles"});
  GroupFlags(command,
             "Which shape",
             {"--kind",
              "--base",
              "--closed",
              "--trim",
              "--snap",
              "--normals",
              "--corners",
              "--order",
              "--component",
              "--part",
              "--parameterization",
              "--grid",
              "--grid-method",
              "--start-tangent",
              "--end-tangent",
              "--start-curvature",
              "--end-curvature"});
  GroupFlags(command,
             "What it has to meet",
             {"--boundary",
              "--boundary-tolerance",
              "--meet",
              "--through",
              "--tangents",
              "--symmetric",
              "--domain"});
  GroupFlags(command,
             "Which points count",
             {"--points",
              "--loss",
              "--loss-scale",
              "--clean",
              "--keep-outliers",
              "--thin",
              "--columns",
              "--where",
              "--las-class",
              "--box",
              "--projection",
              "--format"});
  GroupFlags(command, "The run", {"--threads", "--seed", "--quiet", "--json"});
}

FitFiles::FitFiles(const FitArguments& arguments,
                   const std::vector<std::string>& beside,
                   const std::vector<std::string>& also)
    : a_(arguments), word_is_geometry_(NamesGeometry(arguments.cloud.format)) {
  CheckOutputArguments(a_.output);
  cleaning_ = ToCleaning(a_.clean);
  if (cleaning_.keep_outliers && !a_.may_keep_all)
    throw UsageError(
        "--clean none: fit surface and fit solid alone can be told to fit every point");
  shift_ = ToShift(a_.origin);
  // A format word belongs to the file whose kind it names.
  out_format_ = a_.out_format.empty() && word_is_geometry_ ? a_.cloud.format : a_.out_format;
  const std::string written = std::string("geometry is written as .json, .step, .iges or .brep") +
                              (a_.curves ? "" : ", triangles as .stl, .obj, .ply or .glb");
  if (NamesMesh(a_.out, out_format_)) {
    if (a_.curves) RefuseMesh();
  } else if (!IsGeometryFormat(WrittenFormat(a_.out, out_format_, written))) {
    throw UsageError("-o " + a_.out + ": " + written);
  }
  std::vector<std::string> outputs = a_.output.reports;
  outputs.insert(outputs.end(),
                 {a_.out, a_.output.residuals, a_.output.certificate, a_.uncertainty_map});
  outputs.insert(outputs.end(), also.begin(), also.end());
  if (!a_.uncertainty_map.empty()) CheckUncertaintyName(a_.uncertainty_map, a_.curves);
  std::vector<std::string> inputs = a_.clouds;
  inputs.insert(inputs.end(), beside.begin(), beside.end());
  CheckDistinct(outputs, a_.flags.json, inputs);
  for (const std::string& path : outputs) CheckWritable(path);
}

const PointCloud& FitFiles::Read(bool parameters, CloudFaces faces) {
  CloudReadOptions read = ToReadOptions(a_.cloud, a_.flags.quiet);
  if (word_is_geometry_) read.format.clear();
  read.parameters = parameters;
  if (!a_.curves && a_.points == "faces")
    read.faces = cleaning_.statistical || a_.vertices_alone ? CloudFaces::kKept : faces;
  BeginReading(a_.clouds, a_.flags.quiet);
  file_ = ReadCloud(a_.clouds, read);
  TellRemarks(file_, a_.flags.quiet);
  TellMesh(file_, a_.clouds, a_.flags.quiet);
  read_seconds_ = Seconds();
  if (cleaning_.statistical) Clean(*cleaning_.statistical);
  RefuseFarOrigin();
  return file_.cloud;
}

void FitFiles::RefuseFarOrigin() const {
  if (!shift_ || shift_->isZero(0)) return;
  constexpr double kShare = 1e-6;  // of the cloud's size: what rounding must not move points by
  const auto& points = file_.cloud.points();
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  const double far = (file_.cloud.World(0) - *shift_).cwiseAbs().maxCoeff();
  const double apart = std::numeric_limits<double>::epsilon() * far;
  if (!(size > 0) || apart <= kShare * size) return;
  Refuse(fmt::format(
      "--origin {} is so far from the points that their coordinates there are {:.1g} apart at "
      "least, of a cloud {:.3g} in size: choose one nearer to them, or --origin local",
      a_.origin,
      apart,
      size));
}

CloudFileSource FitFiles::Source() {
  CloudReadOptions read = ToReadOptions(a_.cloud, a_.flags.quiet);
  if (word_is_geometry_) read.format.clear();
  BeginReading(a_.clouds, a_.flags.quiet);
  return CloudFileSource(OwnFiles(a_.clouds), std::move(read));
}

void FitFiles::TakeSample(const CloudFileSource& source,
                          Eigen::Index points,
                          const PointCloud& sample) {
  file_.cloud = sample;
  file_.non_finite = source.non_finite();
  file_.filtered = source.filtered();
  file_.points_in_file = points + file_.non_finite + file_.filtered;
  RefuseFarOrigin();
}

int FitFiles::ExitCode(const FitReport& report) {
  if (report.end.code == EndCode::kTimeLimit) return kToleranceMissed;
  return report.tolerance_reached().value_or(true) ? kDone : kToleranceMissed;
}

void FitFiles::Clean(const StatisticalRemoval& how) {
  const std::vector<Eigen::Index> kept = WithoutStatisticalOutliers(file_.cloud, how);
  cleaned_ = file_.cloud.size() - std::ssize(kept);
  if (cleaned_ == 0) return;
  Keep(kept);
  file_.filtered += cleaned_;
}

std::string FlagsThatHelp(Remedy remedy) {
  switch (remedy) {
    case Remedy::kNone:
      return "";
    case Remedy::kFitPart:
      return " (--part, --box, --where)";
    case Remedy::kFlatten:
      return " (--base sheet lays a bent sheet out flat, --part or --box takes a part of the "
             "cloud)";
    case Remedy::kClosingByData:
      return " (--closed auto)";
    case Remedy::kLeaveOpen:
      return " (--open leaves the borders of a scan)";
  }
  return "";
}

void FitFiles::Refuse(const std::string& reason) const {
  const std::string first = a_.clouds.front() == "-" ? "standard input" : a_.clouds.front();
  throw ReadError(first + (a_.clouds.size() > 1 ? " and others" : ""), reason);
}

Eigen::Vector3d FitFiles::shift() const {
  Eigen::Vector3d shift = shift_.value_or(file_.cloud.origin());
  if (file_.cloud.dimension() == 2) shift[2] = 0;  // plane points stay in z = 0
  return shift;
}

template <class Fit>
void FitFiles::NoteUncertainty(Fit& fit) {
  if (!a_.uncertainty && a_.uncertainty_map.empty()) return;
  UncertaintySummary& summary = fit.report.uncertainty.emplace();
  try {
    const Uncertainty& found = uncertainty_.emplace(fit, file_.cloud, a_.work.threads);
    Eigen::Matrix2Xd feet = Eigen::Matrix2Xd::Zero(2, fit.residuals.size());
    if constexpr (std::is_same_v<Fit, SurfaceFit>) {
      feet = fit.parameters;
      map_ = MapUncertainty(found, fit.surface);
    } else {
      feet.row(0) = fit.parameters.transpose();
      map_ = MapUncertainty(found, fit.curve);
    }
    summary = map_->Summary(found);
    const std::vector<PlaceUncertainty> places = found.At(feet);
    deviations_.resize(std::ssize(places));
    for (size_t k = 0; k < places.size(); ++k)
      deviations_[static_cast<Eigen::Index>(k)] = places[k].deviation;
  } catch (const std::invalid_argument& error) {
    // The library names itself and the field before the sentence.
    const std::string text = error.what();
    const size_t begin = text.rfind(": ");
    summary.note = "not known: " + (begin == std::string::npos ? text : text.substr(begin + 2));
    fit.report.warnings.push_back("the uncertainty is " + summary.note);
  }
}

template void FitFiles::NoteUncertainty(SurfaceFit&);
template void FitFiles::NoteUncertainty(CurveFit<2>&);
template void FitFiles::NoteUncertainty(CurveFit<3>&);

double FitFiles::Seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

bool FitFiles::TimeIsUp() const {
  if (Interrupted() || !PastTimeLimit()) return false;
  EndTimeLimit();
  return true;
}

void FitFiles::NoteTimeLimit(FitReport& report) const {
  report.end.code = EndCode::kTimeLimit;
  report.end.words = fmt::format("the {:g} s allowed were used up: this is the best that was found",
                                 *a_.time_limit);
  report.termination = Termination::kMaxIterations;
  report.warnings.push_back(report.end.words);
}

void FitFiles::TakePoints(const PointCloud& points, Eigen::Index sampled) {
  if (file_.mesh) file_.mesh->sampled = sampled;
  file_.points_in_file += points.size() - file_.cloud.size();
  file_.cloud = points;
}

void FitFiles::Keep(const std::vector<Eigen::Index>& points) {
  file_.cloud = file_.cloud.Picked(points);
}

void FitFiles::RefuseMesh() const {
  throw UsageError("-o " + a_.out +
                   ": a curve has no triangles; it is written as .json, .step, .iges or .brep");
}

std::string FitFiles::WriteShapes(const std::vector<Geometry>& geometry,
                                  std::optional<CertificateSummary>& certified) const {
  const bool mesh = NamesMesh(a_.out, out_format_);
  if (trimmed_ != nullptr) {
    *census_ = WriteSolid(*trimmed_, a_.out, {out_format_, a_.output.unit, a_.step_schema});
    return "";
  }
  if (solid_ != nullptr && !mesh) {
    WriteSolid(*solid_, a_.out, {out_format_, a_.output.unit, a_.step_schema});
    return "";
  }
  if (!mesh) {
    const GeometryWriteOptions options{out_format_, a_.output.unit, a_.step_schema, a_.sew};
    const auto sewing = WriteGeometry(GeometryFile{a_.out, geometry}, options);
    if (sewing && !a_.flags.quiet) TellSewing(a_.out, *sewing, {});
    return "";
  }
  NamedSurfaces named;
  for (const Geometry& one : geometry) {
    const auto* surface = std::get_if<NurbsSurface>(&one);
    if (surface == nullptr) RefuseMesh();
    named.surfaces.push_back(*surface);
  }
  named.names.resize(named.surfaces.size());
  if (solid_ != nullptr) {
    GeometryBody& body = named.bodies.emplace_back();
    body.surfaces.resize(named.surfaces.size());
    std::iota(body.surfaces.begin(), body.surfaces.end(), size_t{0});
    body.borders = BordersOf(*solid_);
  }
  double chord_tolerance = DefaultChordTolerance(named.surfaces);
  if (a_.tolerance) chord_tolerance = std::min(chord_tolerance, *a_.tolerance / 2);
  std::vector<SurfaceMesh> meshes;
  const MeshSummary summary =
      TessellateAll(named, chord_tolerance, MakeProgress(a_.flags.quiet), meshes);
  if (certified) CertifyMeshes(named.surfaces, meshes, chord_tolerance, *certified);
  WriteMeshes(meshes, a_.out, {.format = out_format_, .metres = MetresIn(a_.output.unit)});
  return MeshWords(summary);
}

int FitFiles::Write(const std::vector<Geometry>& geometry,
                    const Eigen::VectorXd& residuals,
                    const Eigen::MatrixXd& parameters,
                    const Eigen::Array<bool, Eigen::Dynamic, 1>& outliers,
                    FitReport& report,
                    std::vector<int> owners) const {
  if (report.termination == Termination::kCancelled) {
    if (Interrupted() || !a_.time_limit) throw Cancelled();
    NoteTimeLimit(report);
  }
  EndTimeLimit();
  report.input.files = a_.clouds;
  report.input.mesh = MeshIn(file_);
  report.input.points = file_.points_in_file - file_.filtered;
  report.input.non_finite = file_.non_finite;
  report.warnings.insert(report.warnings.begin(), file_.remarks.begin(), file_.remarks.end());
  if (cleaned_ > 0) {
    report.warnings.push_back(
        fmt::format("--clean {} removed {} stray points before the fit", a_.clean, cleaned_));
  }
  const double far = file_.cloud.World(0).cwiseAbs().maxCoeff();
  if (a_.origin == "keep" && far > FarAway(a_.output.unit)) {
    report.warnings.push_back(
        "coordinates are more than 500 m from zero, where CAD systems lose digits: "
        "--origin local writes them near zero and reports the shift");
  }
  const MeasuredPoints measured{.cloud = file_.cloud,
                                .distances = residuals,
                                .parameters = parameters,
                                .outliers = outliers,
                                .owners = std::move(owners),
                                .spacing = report.input.spacing,
                                .noise = report.input.noise,
                                .deviations = deviations_};
  ReportTarget target{a_.output, a_.flags, a_.out, "", shift()};
  target.checks = checks_;
  target.told = file_.remarks.size();
  const Certified certified =
      CertificateFor(a_.output, geometry, file_.cloud, shift(), a_.tolerance, a_.work.threads);
  target.checks.certified = certified.summary;
  target.scene = SceneFor(
      a_.output, geometry, measured, {a_.tolerance, shift()}, a_.work.threads, a_.flags.quiet);
  if (target.scene && uncertainty_ && !target.scene->surfaces.empty()) {
    ReportSurface& drawn = target.scene->surfaces.front();
    drawn.sigma = SigmaAt(*uncertainty_, drawn.mesh.parameters);
  }
  target.part = part_;
  const auto written = ResidualsFor(a_.output, measured, a_.tolerance);
  const std::string mesh = WriteShapes(geometry, target.checks.certified);
  if (written) written->Commit();
  if (certified.file) certified.file->Commit();
  if (map_ && !a_.uncertainty_map.empty())
    WriteUncertainty(a_.uncertainty_map, *map_, geometry.front(), MetresIn(a_.output.unit))
        ->Commit();
  report.seconds.read = read_seconds_;
  report.seconds.prepare += prepared_seconds_;
  const double before = read_seconds_ + prepared_seconds_ + report.seconds.total;
  report.seconds.total = std::max(before, Seconds());
  report.seconds.write = report.seconds.total - before;
  std::string doubt;
  for (const Doubt& one : report.Doubts())
    doubt += (doubt.empty() ? "doubtful: " : "; ") + one.words;
  if (a_.out != "-") {
    target.result_line = a_.out + ": " + doubt + (doubt.empty() ? "" : "; ") + report.OneLine();
  }
  WriteReports(report, target);
  if (!mesh.empty() && !a_.flags.quiet) PrintNote(a_.out + ": " + mesh);
  const int code = ExitCode(report);
  return code == kDone && !doubt.empty() && !a_.accept_doubt ? kDoubtful : code;
}

}  // namespace batten::internal
