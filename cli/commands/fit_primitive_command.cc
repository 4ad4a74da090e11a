// SPDX-License-Identifier: MIT
// batten fit primitive: points in, an exact line, circle, plane, sphere, cylinder, cone or torus
// and its report out.
#include <algorithm>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <variant>

#include "batten/fitting/distances.h"
#include "batten/fitting/fit_primitive.h"
#include "batten/geometry/thread_pool.h"
#include "batten/geometry/triangle_samples.h"
#include "batten/io/read_error.h"
#include "cli/arguments/fit_arguments.h"
#include "cli/commands/commands.h"
#include "cli/commands/file_kind.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/offered_words.h"
#include "cli/terminal/parse_values.h"
#include "cli/terminal/terminal.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

struct FitPrimitiveArguments : FitArguments {
  // Those of a round face lie on it; the middles of its chords do not.
  FitPrimitiveArguments() { vertices_alone = true; }
  std::string kind = "auto";
};

PrimitiveKind ToKind(const std::string& word) {
  constexpr PrimitiveKind kKinds[] = {PrimitiveKind::kAuto,
                                      PrimitiveKind::kLine,
                                      PrimitiveKind::kCircle,
                                      PrimitiveKind::kPlane,
                                      PrimitiveKind::kSphere,
                                      PrimitiveKind::kCylinder,
                                      PrimitiveKind::kCone,
                                      PrimitiveKind::kTorus};
  for (const PrimitiveKind kind : kKinds) {
    if (word == Name(kind)) return kind;
  }
  return PrimitiveKind::kAuto;
}

PrimitiveFitOptions ToFitPrimitiveOptions(const FitPrimitiveArguments& a) {
  PrimitiveFitOptions options;
  options.kind = ToKind(a.kind);
  options.tolerance = a.tolerance;
  options.loss = ToLoss(a.loss);
  options.loss_scale = ToLossScale(a.loss_scale);
  return WithWork(std::move(options), a);
}

// How far what lies between the vertices of a mesh is from the shape, most of it; 0 where its
// chords explain that.
double LeftBetweenVertices(const Geometry& geometry,
                           const FaceSurface& faces,
                           const Eigen::Vector3d& shift,
                           int threads) {
  const auto* surface = std::get_if<NurbsSurface>(&geometry);
  if (surface == nullptr) return 0;
  TriangleSurface local = faces.surface;
  local.vertices.colwise() -= shift;
  const TriangleSamples samples = SamplesBesideVertices(local);
  if (samples.points.cols() == 0) return 0;
  ThreadPool pool(threads);
  Eigen::VectorXd far = DistancesTo(*surface, samples.points, pool).distances.cwiseAbs();
  std::nth_element(far.begin(), far.begin() + far.size() / 2, far.end());
  const double off = far[far.size() / 2];
  const double size =
      (local.vertices.rowwise().maxCoeff() - local.vertices.rowwise().minCoeff()).norm();
  constexpr double kFar = 0.01;  // of the size, as points_missed
  return off > std::max(kFar * size, ChordHeight(local)) ? off : 0;
}

int RunFitPrimitive(const FitPrimitiveArguments& a) {
  PrimitiveFitOptions options = ToFitPrimitiveOptions(a);
  FitFiles files(a);
  const PointCloud& cloud = files.Read(false);
  options.shift = files.shift();
  PrimitiveFit fit = files.Explained([&] {
    try {
      return FitPrimitive(cloud, options);
    } catch (const std::invalid_argument& refusal) {
      const std::string other = OtherCommand(cloud, FileUse::kPrimitive, a.clouds.front());
      const bool may_be_another = a.kind != "auto" && !other.empty();
      throw std::invalid_argument(
          refusal.what() +
          std::string(may_be_another ? "; --kind auto takes the nearest shape" : "") + other);
    }
  });
  const Geometry geometry =
      std::visit([](const auto& shape) { return Geometry(shape); }, fit.geometry);
  if (HasForm(fit)) files.NoteForm(FormDeviationOf(fit, cloud, options.shift));
  if (a.kind == "auto" && files.faces() != nullptr) {
    const double off = LeftBetweenVertices(geometry, *files.faces(), options.shift, a.work.threads);
    if (off > 0) {
      fit.report.doubts.push_back({"points_missed",
                                   "between its vertices half of the mesh is farther than " +
                                       RoundedText(off) + " from the shape"});
    }
  }
  return files.Write({geometry}, fit.residuals, fit.parameters, fit.outliers, fit.report);
}

}  // namespace

void AddFitPrimitiveCommand(CLI::App& fit, Action& action) {
  auto a = std::make_shared<FitPrimitiveArguments>();
  CLI::App& command = *fit.add_subcommand(
      "primitive", "Fit an exact line, circle, plane, sphere, cylinder, cone or torus to points");
  AddEveryFitsArguments(
      command,
      *a,
      "CLOUD",
      "auto none huber cauchy tukey truncated; none takes all points; auto does so for lines and "
      "circles, and for surfaces leaves out what stands farther off than noise explains");
  CLI::Option& kind =
      *command
           .add_option(
               "--kind",
               a->kind,
               "auto line circle plane sphere cylinder cone torus; auto is the simplest that the "
               "points do not reject")
           ->capture_default_str()
           ->type_name("KIND");
  Allow(kind, {"auto", "line", "circle", "plane", "sphere", "cylinder", "cone", "torus"});
  AddCertificateArguments(command, a->output);
  GroupFitFlags(command);
  command.footer(
      "Examples:\n"
      "  batten fit primitive part.xyz -o part.step --kind cylinder\n"
      "  batten fit primitive scan.ply -o shape.step --report shape-report.json\n"
      "  batten fit primitive hole.xyz -o hole.step --kind circle\n"
      "  batten fit primitive pipe-section.xyz -o section.step --kind circle --loss tukey "
      "--tolerance 0.05\n"
      "Two columns are points of the plane: lines and circles only. Distances are orthogonal; a\n"
      "circle in space is found with its plane.\n"
      "The part that the points cover is written, all round where they go all round; STEP gets "
      "the\n"
      "exact shape.\n"
      "Radii, axis, centre or apex with standard deviations and covariance are in the report,\n"
      "under geometry, primitive.\n"
      "Flatness, roundness, sphericity or cylindricity, by least squares and by the minimum zone, "
      "are\n"
      "under form.\n"
      "A warning says where the points do not determine them.\n"
      "Exit code 3 says the best shape is written but the tolerance is not reached.");
  command.callback([a, &action] { action = [a] { return RunFitPrimitive(*a); }; });
}

}  // namespace batten::internal
