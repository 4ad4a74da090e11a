// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_surface.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/coefficient_order.h"
#include "batten/fitting/distances.h"
#include "batten/fitting/given_parameters.h"
#include "batten/fitting/outline_in_box.h"
#include "batten/fitting/snap.h"
#include "batten/fitting/stopwatch.h"
#include "batten/fitting/surface_fitter.h"
#include "batten/fitting/surface_outcome.h"
#include "batten/fitting/surface_preparation.h"
#include "batten/fitting/symmetric_net.h"
#include "batten/fitting/trim_to_points.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"

namespace batten {
namespace {

constexpr double kVoidShareToWarn = 0.05;
constexpr double kExplains = 0.1;  // share of the misfit that a feature leaves

// Distances of the used points from the surface at their own parameters.
ErrorSummary AtParameters(const SurfaceFit& fit,
                          const PointCloud& cloud,
                          const SurfaceFitOptions& options) {
  const Eigen::Vector3d move = cloud.origin() - options.shift;
  Eigen::VectorXd offsets(cloud.size());
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    const auto at = cloud.parameters().col(k);
    offsets[k] = (fit.surface.At(at[0], at[1]) - move - cloud.points().col(k)).norm();
  }
  return Summarise(offsets, options.tolerance, !fit.outliers);
}

// One cloud, its base found, to be fitted once or twice and measured.
class SurfaceRoad {
 public:
  SurfaceRoad(const PointCloud& cloud,
              const SurfaceFitOptions& options,
              std::optional<CloudSymmetry> symmetry = std::nullopt)
      : cloud_(cloud), pool_(options.threads) {
    if (options.given_parameters) {
      given_ = PrepareGiven(cloud, options, pool_);
    } else {
      prepared_ = PrepareCloud(cloud, options, pool_, std::move(symmetry));
    }
    prepare_seconds_ = watch_.Lap();
  }

  // Whether the last fit set points aside or bounded them, unasked.
  bool doubted() const { return doubted_; }

  SurfaceFit Fit(const SurfaceFitOptions& asked) {
    const SurfaceFitOptions options = WithDegreesOfSides(asked);
    const PreparedCloud& prepared = given_ ? given_->prepared : prepared_;
    FittedDraft fitted = FitOverBase(prepared, options, StartReport(prepared), pool_);
    const double so_far = prepared_.base_seconds;
    if (!given_ && fitted.doubted && TakeSmallerBase(prepared_, fitted.used, options, pool_)) {
      prepare_seconds_ += prepared_.base_seconds - so_far;
      fitted = FitOverBase(prepared, options, StartReport(prepared), pool_);
    }
    doubted_ = fitted.doubted;
    if (options.snap && !given_) Snap(fitted, options);
    if (prepared_.symmetry) MirrorNet(fitted.draft.surface);
    Trim(fitted, options);
    if (options.domain) TakeParametersOf(*options.domain, fitted.draft);
    if (options.side_of_normals) TakeSideOfNormals(fitted.draft);
    watch_.Lap();
    SurfaceFit fit =
        MeasureFit(given_ ? given_->InUsersUnits(fitted.draft.surface) : fitted.draft.surface,
                   cloud_,
                   prepared.merged,
                   fitted.used,
                   options,
                   prepared.base.shape,
                   pool_,
                   std::move(fitted.report));
    const bool kept =
        !fit.report.optimize.ran || (options.optimize && !options.optimize->parameters);
    if (given_ && kept) fit.report.parameter_error = AtParameters(fit, cloud_, options);
    fit.report.seconds.project += watch_.Lap();
    fit.report.seconds.total = total_.Lap();
    return fit;
  }

  // The same with every point that has a place taken for a good one.
  SurfaceFit FitAll(SurfaceFitOptions options) {
    options.keep_outliers = true;
    prepared_.used = prepared_.reached;
    prepared_.statistics.outliers.setConstant(false);
    prepared_.statistics.outlier_count = 0;
    return Fit(options);
  }

 private:
  // Degrees that hold the curves given for edges.
  SurfaceFitOptions WithDegreesOfSides(SurfaceFitOptions options) const {
    for (const LaidSide& laid : prepared_.conditions.sides) {
      int& degree = laid.edge.direction == Direction::kU ? options.degree_v : options.degree_u;
      degree = std::max(degree, laid.side.curve.basis().degree());
    }
    return options;
  }

  // An exact shape in place of the free form where it explains the points as well.
  void Snap(FittedDraft& fitted, const SurfaceFitOptions& options) {
    constexpr double kRounding = 1e-12;  // of the size
    SurfaceDraft& draft = fitted.draft;
    const Eigen::VectorXd distances =
        DistancesFrom(draft.surface, draft.used.points(), draft.parameters, pool_).distances;
    const bool weighted = draft.weights.size() > 0;
    const double squares = weighted
                               ? distances.cwiseAbs2().dot(draft.weights) / draft.weights.mean()
                               : distances.squaredNorm();
    const auto& bases = std::pair(draft.surface.basis_u(), draft.surface.basis_v());
    const int unknowns = DistinctCount(bases.first) * DistinctCount(bases.second) -
                         PoleConditionCount(bases.first, bases.second, draft.poles);
    const Eigen::VectorXd weights =
        weighted ? (draft.weights / draft.weights.mean()).eval() : Eigen::VectorXd();
    std::optional<Snapped> snapped =
        SnapToPrimitive(draft.used.points(),
                        weights,
                        {squares, static_cast<double>(unknowns), options.tolerance},
                        kRounding,
                        options.seed,
                        pool_);
    GeometrySummary& geometry = fitted.report.geometry;
    if (!snapped) {
      geometry.base_why +=
          "; no plane, sphere, cylinder, cone or torus explains the points as well";
      return;
    }
    draft.surface = std::move(snapped->surface);
    geometry.primitive = std::move(snapped->summary);
    const Eigen::Vector3d move = cloud_.origin() - options.shift;
    for (auto* place :
         {&geometry.primitive->point, &geometry.primitive->center, &geometry.primitive->apex}) {
      if (*place) **place += move;
    }
    geometry.base_why += "; " + geometry.primitive->why;
    geometry.distortion = 0;
    fitted.report.warnings.insert(
        fitted.report.warnings.end(), snapped->warnings.begin(), snapped->warnings.end());
  }

  // The surface next to this one that mirrors itself; knots without a mirror image get theirs.
  void MirrorNet(NurbsSurface& surface) const {
    constexpr double kSame = 1e-9;  // of the domain
    const auto& [plane, twins, direction] = *prepared_.symmetry;
    const SplineBasis basis = direction == Direction::kU ? surface.basis_u() : surface.basis_v();
    const double low = basis.lower(), high = basis.upper(), near = kSame * (high - low);
    std::vector<double> missing;
    for (const KnotMultiplicity& one : DomainKnots(basis)) {
      const double image = low + high - one.knot;
      if (basis.periodic() || image - low <= near || high - image <= near) continue;
      int there = 0;
      for (const double knot : basis.knots()) there += std::abs(knot - image) <= near ? 1 : 0;
      for (; there < one.multiplicity; ++there) missing.push_back(image);
    }
    std::sort(missing.begin(), missing.end());
    if (!missing.empty()) surface = RefineKnots(surface, direction, missing);
    surface = SymmetricNet(surface, direction, plane);
  }

  // The box's own numbers for parameters.
  static void TakeParametersOf(const DomainBox& box, SurfaceDraft& draft) {
    const NurbsSurface& old = draft.surface;
    draft.parameters = Eigen::Vector2d((box.u1 - box.u0) / old.basis_u().upper(),
                                       (box.v1 - box.v0) / old.basis_v().upper())
                           .asDiagonal() *
                       draft.parameters;
    draft.parameters.colwise() += Eigen::Vector2d(box.u0, box.v0);
    draft.surface = Reparameterized(Reparameterized(draft.surface, Direction::kU, box.u0, box.u1),
                                    Direction::kV,
                                    box.v0,
                                    box.v1);
  }

  // Turns the surface round where most of the cloud's normals look to its other side.
  void TakeSideOfNormals(SurfaceDraft& draft) const {
    const Eigen::Matrix3Xd& normals = draft.used.normals();
    if (normals.cols() == 0) throw std::invalid_argument("the points have no normals");
    double along = 0;
    for (Eigen::Index k = 0; k < normals.cols(); ++k) {
      const auto normal = draft.surface.NormalAt(draft.parameters(0, k), draft.parameters(1, k));
      if (normal) along += normal->dot(normals.col(k)) > 0 ? 1 : -1;
    }
    if (along >= 0) return;
    const SplineBasis& basis = draft.surface.basis_u();
    draft.surface = Reversed(draft.surface, Direction::kU);
    draft.parameters.row(0) = (basis.lower() + basis.upper()) - draft.parameters.row(0).array();
  }

  // Whether the points fill the rectangle that they were given places in. Later, feet on a coarse
  // surface may leave part of it that sticks out.
  bool FillBase(const PointMask& used) {
    const PreparedCloud& prepared = given_ ? given_->prepared : prepared_;
    const SurfaceBase& base = prepared.base;
    if (base.poles.any()) return false;
    std::vector<Eigen::Index> kept;
    for (Eigen::Index k = 0; k < used.size(); ++k)
      if (used[k] && prepared.reached[k]) kept.push_back(k);
    OutlineOptions options;
    options.spacing = prepared.statistics.spacing;
    options.noise = prepared.statistics.noise;
    options.periodic_u = base.periodic_u;
    options.periodic_v = base.periodic_v;
    options.length_u = base.length_u;
    options.length_v = base.length_v;
    return FindOutlineInBox(base.parameters(Eigen::all, kept), options, pool_).fills;
  }

  // Cut back to the points, where they leave part of the domain open.
  void Trim(FittedDraft& fitted, const SurfaceFitOptions& options) {
    SurfaceDraft& draft = fitted.draft;
    FitReport& report = fitted.report;
    if (options.trim == Trimming::kAuto && !FillBase(fitted.used)) {
      const CloudStatistics& statistics = (given_ ? given_->prepared : prepared_).statistics;
      const Eigen::Matrix2Xd feet =
          report.geometry.primitive
              ? DistancesTo(draft.surface, draft.used.points(), pool_).parameters
              : DistancesFrom(draft.surface, draft.used.points(), draft.parameters, pool_)
                    .parameters;
      PointTrim trim = TrimToPoints(
          draft.surface, feet, draft.poles, statistics.spacing, statistics.noise, pool_);
      draft.surface = std::move(trim.surface);
      report.warnings.insert(report.warnings.end(), trim.warnings.begin(), trim.warnings.end());
    }
    if (draft.surface.trimmed() || fitted.empty_share <= kVoidShareToWarn) return;
    report.warnings.push_back("there are no points in " +
                              std::to_string(std::lround(100 * fitted.empty_share)) +
                              " % of the surface's rectangle: the surface is a guess there");
  }

  FitReport StartReport(const PreparedCloud& prepared) const {
    FitReport report;
    report.threads = pool_.threads();
    report.input = SummariseInput(cloud_, prepared.merged.duplicates, prepared.statistics);
    report.geometry.base = prepared.base.name;
    report.geometry.base_why = prepared.base.why;
    if (prepared.base.plane) report.geometry.base_axes = prepared.base.plane->axes;
    report.warnings = prepared.warnings;
    report.seconds.parameterize = prepared.base_seconds;
    report.seconds.prepare = prepare_seconds_ - prepared.base_seconds;
    return report;
  }

  const PointCloud& cloud_;
  ThreadPool pool_;
  Stopwatch watch_, total_;
  PreparedCloud prepared_;
  std::optional<GivenParameters> given_;
  double prepare_seconds_ = 0;
  bool doubted_ = false;
};

// Of a fit that set points aside and one of all points: what stands out of equal knots may be a
// narrow feature, which free knots follow; outliers nothing follows.
SurfaceFit Explained(SurfaceFit without, SurfaceFit with_all) {
  if (!(with_all.report.error_all.rms < kExplains * without.report.error_all.rms)) return without;
  with_all.report.warnings.push_back(
      "points that stand out of a shape with equal knots were kept: free knots follow them");
  return with_all;
}

}  // namespace

void Check(const SurfaceFitOptions& options) {
  const auto reject = [](const std::string& rule) {
    throw std::invalid_argument("SurfaceFitOptions: " + rule);
  };
  for (const auto& [name, degree] :
       {std::pair{"degree_u", options.degree_u}, {"degree_v", options.degree_v}}) {
    if (degree < 1 || degree > kMaxDegree) {
      reject(std::string(name) + " is " + std::to_string(degree) + ", not in [1, " +
             std::to_string(kMaxDegree) + "]");
    }
  }
  if (options.tolerance && !(*options.tolerance > 0 && std::isfinite(*options.tolerance))) {
    reject("tolerance must be positive");
  }
  if (options.control_points) {
    if (options.control_points->first <= options.degree_u ||
        options.control_points->second <= options.degree_v) {
      reject("control_points must exceed the degree in both directions");
    }
    if (std::int64_t{options.control_points->first} * options.control_points->second > 1000000) {
      reject("control_points must not exceed a million in all");
    }
  }
  if (options.max_control_points < (options.degree_u + 1) * (options.degree_v + 1)) {
    reject("max_control_points is below (degree_u + 1)(degree_v + 1), the least a surface has");
  }
  if (options.smoothing && !(*options.smoothing >= 0 && std::isfinite(*options.smoothing))) {
    reject("smoothing must not be negative");
  }
  if (options.smooth_by != SmoothBy::kWeight &&
      (options.smoothing || options.tolerance ||
       options.loss.value_or(Loss::kNone) != Loss::kNone)) {
    reject("smooth_by chooses the smoothing: not beside smoothing, tolerance or loss");
  }
  if (options.loss_scale && !(*options.loss_scale > 0 && std::isfinite(*options.loss_scale))) {
    reject("loss_scale must be positive");
  }
  if (options.boundary.size() > 4) {
    reject("boundary holds " + std::to_string(options.boundary.size()) +
           " conditions; a surface has four edges");
  }
  if (!(options.boundary_tolerance >= 0) || !std::isfinite(options.boundary_tolerance))
    reject("boundary_tolerance must not be negative");
  if (options.symmetric &&
      !(options.symmetric->normal.norm() > 0 && options.symmetric->normal.allFinite() &&
        std::isfinite(options.symmetric->offset))) {
    reject("symmetric needs a plane with a normal");
  }
  if (options.domain &&
      !(options.domain->u0 < options.domain->u1 && options.domain->v0 < options.domain->v1)) {
    reject("domain must rise in both directions");
  }
  const bool conditions = !options.boundary.empty() || options.meet;
  if (options.given_parameters && (conditions || options.symmetric || options.domain))
    reject("given_parameters leaves no base that conditions, symmetry or a domain could shape");
  if (options.snap && (conditions || options.symmetric))
    reject("snap: an exact shape meets no conditions");
  if (options.symmetric && (conditions || options.domain))
    reject("symmetric with boundary, meet or domain is not in this version");
  if (options.domain && !options.boundary.empty())
    reject("domain and boundary both say where the surface ends");
  if (!options.shift.allFinite()) reject("shift must be finite");
}

namespace {

// The fit of a cloud and its mirror image, as one of the cloud.
SurfaceFit FitSymmetric(const PointCloud& cloud, const SurfaceFitOptions& options) {
  MirrorPlane plane = *options.symmetric;
  const double length = plane.normal.norm();
  plane = {plane.normal / length, plane.offset / length};
  SymmetricCloud both = WithMirrorImage(cloud, plane);
  SurfaceRoad road(
      both.cloud, options, CloudSymmetry{plane.From(both.cloud.origin()), std::move(both.twins)});
  SurfaceFit fit = road.Fit(options);
  const Eigen::Index own = cloud.size();
  fit.parameters.conservativeResize(2, own);
  fit.residuals.conservativeResize(own);
  fit.outliers.conservativeResize(own);
  FitReport& report = fit.report;
  report.error = Summarise(fit.residuals, options.tolerance, !fit.outliers);
  report.error_all = Summarise(fit.residuals, options.tolerance);
  report.input.points = own;
  report.input.duplicates = MergeDuplicates(cloud).duplicates;
  report.input.used = report.error.points;
  report.input.outliers = fit.outliers.count();
  report.input.box_min = cloud.origin() + cloud.points().rowwise().minCoeff();
  report.input.box_max = cloud.origin() + cloud.points().rowwise().maxCoeff();
  return fit;
}

}  // namespace

SurfaceFit FitSurface(const PointCloud& cloud, const SurfaceFitOptions& options) {
  Check(options);
  if (options.symmetric) return FitSymmetric(cloud, options);
  SurfaceRoad road(cloud, options);
  SurfaceFit fit = road.Fit(options);
  const bool free_knots = options.optimize && options.optimize->knots && !options.given_parameters;
  if (!road.doubted() || !free_knots) return fit;
  return Explained(std::move(fit), road.FitAll(options));
}

}  // namespace batten
