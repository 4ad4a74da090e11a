// SPDX-License-Identifier: MIT
#include "fitting/surface/fit_context.h"

#include <vector>

#include "batten/fitting/distances.h"
#include "fitting/core/mask_indices.h"
#include "fitting/core/shared_constants.h"
#include "fitting/least_squares/fitting_bases.h"

namespace batten::internal {
namespace {

// Uniform knots over given parameters.
SplineBasis Cells(const Parameterization& base, const SplineBasis& like, int degree, int cells) {
  return base.exact ? SplineBasis::Uniform(degree, degree + cells, like.lower(), like.upper())
                    : FittingBasisLike(like, degree, cells);
}

}  // namespace

FitContext::FitContext(const PreparedCloud& prepared,
                       const SurfaceFitOptions& options,
                       ThreadPool& pool)
    : prepared_(prepared), options_(options), pool_(pool) {
  if (!prepared.reached.all()) own_base_ = prepared.base;
}

FittingProblem FitContext::ProblemOf(const PointMask& mask) const {
  return base().ProblemOf(points(),
                          mask,
                          options_.degree_u,
                          options_.degree_v,
                          options_.smoothing.value_or(kSurfaceSmoothing));
}

FittingProblem FitContext::WithCells(const FittingProblem& problem,
                                     int cells_u,
                                     int cells_v) const {
  return problem.WithBases(Cells(base(), problem.basis_u(), options_.degree_u, cells_u),
                           Cells(base(), problem.basis_v(), options_.degree_v, cells_v));
}

void FitContext::PlaceTheRest(const NurbsSurface& surface) {
  if (!own_base_) return;
  const std::vector<Eigen::Index> rest = IndicesOf(!prepared_.reached);
  const Eigen::Matrix3Xd places = points().points()(Eigen::all, rest);
  own_base_->parameters(Eigen::all, rest) = DistancesTo(surface, places, pool_).parameters;
}

bool FitContext::IsInside(Eigen::Index k) const {
  const auto place = base().parameters.col(k);
  return (base().periodic_u || (place[0] > 0 && place[0] < base().length_u)) &&
         (base().periodic_v ||
          ((place[1] > 0 || base().poles.start != PoleKind::kNone) &&
           (place[1] < base().length_v || base().poles.end != PoleKind::kNone)));
}

}  // namespace batten::internal
