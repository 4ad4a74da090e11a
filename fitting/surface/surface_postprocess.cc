// SPDX-License-Identifier: MIT
#include "fitting/surface/surface_postprocess.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/trim_to_points.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/surface_evaluator.h"
#include "fitting/constraints/symmetric_net.h"
#include "fitting/core/rounding.h"
#include "fitting/linear/coefficient_order.h"
#include "fitting/primitives/snap.h"
#include "fitting/surface/base_borders.h"
#include "fitting/surface/surface_overshoot.h"

namespace batten::internal {
namespace {

constexpr double kEmptyToTrim = 0.02;  // share of the area

}  // namespace

void SnapToShape(FittedState& fitted,
                 const PointCloud& cloud,
                 const SurfaceFitOptions& options,
                 ThreadPool& pool) {
  SurfaceState& draft = fitted.draft;
  const Eigen::VectorXd distances =
      DistancesFrom(draft.surface, draft.used.points(), draft.parameters, pool).distances;
  const bool weighted = draft.weights.size() > 0;
  const double squares = weighted ? distances.cwiseAbs2().dot(draft.weights) / draft.weights.mean()
                                  : distances.squaredNorm();
  const auto& bases = std::pair(draft.surface.basis_u(), draft.surface.basis_v());
  const int unknowns = DistinctCount(bases.first) * DistinctCount(bases.second) -
                       PoleConditionCount(bases.first, bases.second, draft.poles);
  const Eigen::VectorXd weights =
      weighted ? (draft.weights / draft.weights.mean()).eval() : Eigen::VectorXd();
  std::optional<DescribedSurface> snapped =
      SnapToPrimitive(draft.used.points(),
                      weights,
                      {squares, static_cast<double>(unknowns), options.tolerance},
                      kRelativeRounding,
                      options.seed,
                      pool);
  GeometrySummary& geometry = fitted.report.geometry;
  if (!snapped) {
    geometry.base_why += "; no plane, sphere, cylinder, cone or torus explains the points as well";
    return;
  }
  draft.surface = std::move(snapped->surface);
  geometry.primitive = std::move(snapped->summary);
  const Eigen::Vector3d move = cloud.origin() - options.shift;
  for (auto* place :
       {&geometry.primitive->point, &geometry.primitive->center, &geometry.primitive->apex}) {
    if (*place) **place += move;
  }
  geometry.base_why += "; " + geometry.primitive->why;
  geometry.distortion = 0;
  fitted.report.warnings.insert(
      fitted.report.warnings.end(), snapped->warnings.begin(), snapped->warnings.end());
}

void MakeNetSymmetric(NurbsSurface& surface, const CloudSymmetry& symmetry) {
  const auto& [plane, twins, direction] = symmetry;
  const SplineBasis basis = direction == Direction::kU ? surface.basis_u() : surface.basis_v();
  const double low = basis.lower(), high = basis.upper(), near = kRelativelyEqual * (high - low);
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

void TakeParametersOf(const DomainBox& box, SurfaceState& draft) {
  const NurbsSurface& old = draft.surface;
  draft.parameters = Eigen::Vector2d((box.u1 - box.u0) / old.basis_u().upper(),
                                     (box.v1 - box.v0) / old.basis_v().upper())
                         .asDiagonal() *
                     draft.parameters;
  draft.parameters.colwise() += Eigen::Vector2d(box.u0, box.v0);
  draft.surface = Reparameterized(
      Reparameterized(draft.surface, Direction::kU, box.u0, box.u1), Direction::kV, box.v0, box.v1);
}

void TakeSideOfNormals(SurfaceState& draft) {
  const Eigen::Matrix3Xd& normals = draft.used.normals();
  if (normals.cols() == 0) throw std::invalid_argument("the points have no normals");
  const SurfaceEvaluator surface(draft.surface);
  Eigen::Index along = 0, judged = 0;
  for (Eigen::Index k = 0; k < normals.cols(); ++k) {
    if (normals.col(k).isZero(0)) continue;  // none
    ++judged;
    const auto normal = surface.NormalAt(draft.parameters(0, k), draft.parameters(1, k));
    if (normal) along += normal->dot(normals.col(k)) > 0 ? 1 : -1;
  }
  if (judged == 0) throw std::invalid_argument("none of the points has a normal");
  if (along >= 0) return;
  const SplineBasis& basis = draft.surface.basis_u();
  draft.surface = Reversed(draft.surface, Direction::kU);
  draft.parameters.row(0) = (basis.lower() + basis.upper()) - draft.parameters.row(0).array();
}

void TrimToUsed(FittedState& fitted,
                const PreparedCloud& prepared,
                const SurfaceFitOptions& options,
                ThreadPool& pool) {
  SurfaceState& draft = fitted.draft;
  FitReport& report = fitted.report;
  if (options.trim == Trimming::kNone) return;
  const CloudStatistics& statistics = prepared.statistics;
  const Eigen::Matrix2Xd feet =
      report.geometry.primitive
          ? DistancesTo(draft.surface, draft.used.points(), pool).parameters
          : DistancesFrom(draft.surface, draft.used.points(), draft.parameters, pool).parameters;
  // Where the points fill the base, the surface ends near them, unless free parameters moved it.
  const auto ends_near_points = [&] {
    return MeasureOvershoot({draft.surface, draft.used.points(), feet, statistics.spacing}, pool)
               .share_without_points <= kEmptyToTrim;
  };
  if (!FillBase(prepared, fitted.used, pool) || !ends_near_points()) {
    PointTrim trim =
        TrimToPoints(draft.surface, feet, draft.poles, statistics.spacing, statistics.noise, pool);
    draft.surface = std::move(trim.surface);
    report.warnings.insert(report.warnings.end(), trim.warnings.begin(), trim.warnings.end());
  }
}

}  // namespace batten::internal
