// SPDX-License-Identifier: MIT
#include "fitting/tiles/tile_system.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

#include "fitting/least_squares/fairness.h"
#include "fitting/least_squares/nested_bases.h"
#include "fitting/least_squares/normal_equations.h"
#include "fitting/linear/overlapping_boxes.h"

namespace batten::internal {
namespace {

constexpr int kAttempts = 6;

// A diagonal that rounding of the sums cannot make indefinite, as PenalisedSystem has it.
double Jitter(const NormalEquations& equations) {
  return 4 * std::numeric_limits<double>::epsilon() * equations.trace() /
         static_cast<double>(equations.band().size());
}

// The net on every so many-th knot: as many unknowns as are solved at once. Its functions are sums
// of the fine ones, so that its own matrix is that of the fine one between them.
std::optional<CoarseSystem> CoarseOf(const FoldedPoints& points,
                                     const SplineBasis& basis_u,
                                     const SplineBasis& basis_v,
                                     double lambda,
                                     double jitter,
                                     ThreadPool& pool) {
  const double size = static_cast<double>(basis_u.size()) * basis_v.size();
  if (size <= kOneBox) return std::nullopt;
  const int step = static_cast<int>(std::ceil(std::sqrt(size / kOneBox)));
  const SplineBasis u = EveryKnot(basis_u, step), v = EveryKnot(basis_v, step);
  const CellMoments moments =
      CoarserMoments(points.moments, points.basis_u, points.basis_v, u, v, pool);
  TensorBand band = NormalEquations(u, &v, moments, pool).band();
  FairnessForm(u, &v).AddTo(band, lambda);
  band.AddToDiagonal(jitter);
  return CoarseSystem{
      KnotInsertion(u, basis_u), KnotInsertion(v, basis_v), band.Of({0, u.size(), 0, v.size()})};
}

Eigen::MatrixXd Refined(const TileNet& net,
                        const SplineBasis& basis_u,
                        const SplineBasis& basis_v) {
  const auto to_u = KnotInsertion(net.basis_u, basis_u), to_v = KnotInsertion(net.basis_v, basis_v);
  Eigen::MatrixXd rows(Eigen::Index{basis_u.size()} * basis_v.size(), net.rows.cols());
  for (Eigen::Index d = 0; d < rows.cols(); ++d) {
    const Eigen::Map<const Eigen::MatrixXd> coarse(
        net.rows.col(d).data(), net.basis_v.size(), net.basis_u.size());
    const Eigen::MatrixXd half = to_v * coarse;
    rows.col(d) = (half * to_u.transpose()).reshaped();
  }
  return rows;
}

}  // namespace

TileNet SolveNet(const FoldedPoints& points,
                 const SplineBasis& basis_u,
                 const SplineBasis& basis_v,
                 double smoothing,
                 const TileNet* start,
                 ThreadPool& pool,
                 const std::function<void()>& each) {
  std::optional<CellMoments> own;
  if (basis_u != points.basis_u || basis_v != points.basis_v)
    own = CoarserMoments(points.moments, points.basis_u, points.basis_v, basis_u, basis_v, pool);
  const CellMoments& moments = own ? *own : points.moments;
  const NormalEquations equations(basis_u, &basis_v, moments, pool);
  const FairnessForm fairness(basis_u, &basis_v);
  const double unit = equations.trace() / fairness.Trace(), jitter = Jitter(equations);
  const Eigen::MatrixXd& rhs = equations.rhs();
  const Eigen::MatrixXd from =
      start ? Refined(*start, basis_u, basis_v) : Eigen::MatrixXd::Zero(rhs.rows(), rhs.cols());
  double weight = std::max(smoothing, kFirmSmoothing);
  for (int attempt = 0; attempt < kAttempts; ++attempt, weight *= 10) {
    TensorBand matrix = equations.band();
    fairness.AddTo(matrix, weight * unit);
    matrix.AddToDiagonal(jitter);
    BoxSolution solved =
        SolveByBoxes(matrix,
                     CoarseOf(points, basis_u, basis_v, weight * unit, jitter, pool),
                     rhs,
                     from,
                     pool,
                     each);
    if (solved.singular || !solved.rows.allFinite()) continue;
    CellErrors errors = ErrorsOfCells(moments, basis_u, basis_v, solved.rows, pool);
    return {
        basis_u, basis_v, std::move(solved.rows), std::move(errors), solved.residual, attempt > 0};
  }
  throw std::invalid_argument(
      "the points do not determine the control points: too few carry weight, or the degree is too "
      "high for them");
}

}  // namespace batten::internal
