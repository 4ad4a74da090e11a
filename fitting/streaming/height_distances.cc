// SPDX-License-Identifier: MIT
#include "fitting/streaming/height_distances.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "batten/geometry/local_foot_points.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "fitting/foot_points/surface_distances.h"

namespace batten::internal {
namespace {

constexpr int kMostCells = 8;  // across a disc; a wider one is not looked at

// Coefficients of the derivative in u of a net v × u, and in v of its transpose.
Eigen::MatrixXd Derivative(const Eigen::MatrixXd& net, const SplineBasis& basis, int order) {
  const int p = basis.degree() - order;
  Eigen::MatrixXd result(net.rows(), net.cols() - 1);
  for (Eigen::Index i = 0; i < result.cols(); ++i) {
    const auto at = static_cast<std::size_t>(i + order);
    const double width = basis.knots()[at + p + 1] - basis.knots()[at + 1];
    result.col(i) = (p / width) * (net.col(i + 1) - net.col(i));
  }
  return result;
}

Eigen::MatrixXd AcrossDerivative(const Eigen::MatrixXd& net, const SplineBasis& basis, int order) {
  return Derivative(net.transpose(), basis, order).transpose();
}

// For every cell the greatest size among the coefficients that act there: `rows` × `columns` of
// them from its first function on. [Convex hull of a spline]
Eigen::MatrixXd GreatestOfCells(const Eigen::MatrixXd& net,
                                const SplineBasis& u,
                                const SplineBasis& v,
                                int orders_u,
                                int orders_v) {
  const std::vector<int> spans_u = u.Spans(), spans_v = v.Spans();
  Eigen::MatrixXd greatest(std::ssize(spans_v), std::ssize(spans_u));
  for (Eigen::Index i = 0; i < greatest.cols(); ++i) {
    for (Eigen::Index j = 0; j < greatest.rows(); ++j)
      greatest(j, i) = net.block(spans_v[static_cast<std::size_t>(j)] - v.degree(),
                                 spans_u[static_cast<std::size_t>(i)] - u.degree(),
                                 v.degree() + 1 - orders_v,
                                 u.degree() + 1 - orders_u)
                           .cwiseAbs()
                           .maxCoeff();
  }
  return greatest;
}

std::vector<int> CellsOfSpans(const SplineBasis& basis) {
  std::vector<int> cells(basis.knots().size(), 0);
  const std::vector<int> spans = basis.Spans();
  for (std::size_t k = 0; k < spans.size(); ++k)
    cells[static_cast<std::size_t>(spans[k])] = static_cast<int>(k);
  return cells;
}

}  // namespace

std::unique_ptr<HeightDistances> HeightDistances::Of(const NurbsSurface& surface,
                                                     const PlaneBase& plane,
                                                     ThreadPool& pool) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  if (surface.trimmed() || surface.rational() || u.periodic() || v.periodic()) return nullptr;
  const Eigen::Matrix3Xd framed = plane.ToFrame(surface.control_points());
  const double allowed = kRelativelyEqual * (framed.cwiseAbs().maxCoeff() + u.upper() + v.upper());
  for (int i = 0; i < surface.size_u(); ++i) {
    for (int j = 0; j < surface.size_v(); ++j) {
      const auto at = framed.col(Eigen::Index{i} * surface.size_v() + j);
      if (std::abs(at[0] - u.Greville(i)) > allowed || std::abs(at[1] - v.Greville(j)) > allowed)
        return nullptr;
    }
  }
  return std::unique_ptr<HeightDistances>(new HeightDistances(surface, plane, pool));
}

HeightDistances::HeightDistances(const NurbsSurface& surface,
                                 const PlaneBase& plane,
                                 ThreadPool& pool)
    : evaluator_(surface),
      plane_(plane),
      cells_u_(CellsOfSpans(surface.basis_u())),
      cells_v_(CellsOfSpans(surface.basis_v())) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  const Eigen::RowVectorXd heights = plane.ToFrame(surface.control_points()).row(2);
  const Eigen::MatrixXd net = heights.reshaped(surface.size_v(), surface.size_u());
  const Eigen::MatrixXd in_u = Derivative(net, u, 0), in_v = AcrossDerivative(net, v, 0);
  // Of degree one there is no second derivative inside a cell, but kinks between: never convex.
  const bool smooth = u.degree() > 1 && v.degree() > 1;
  Eigen::MatrixXd slope_u, slope_v, uu, uv, vv;
  const auto work = [&](int part) {
    if (part == 0) slope_u = GreatestOfCells(in_u, u, v, 1, 0);
    if (part == 1) slope_v = GreatestOfCells(in_v, u, v, 0, 1);
    if (part == 2) uv = GreatestOfCells(AcrossDerivative(in_u, v, 0), u, v, 1, 1);
    if (part == 3 && smooth) uu = GreatestOfCells(Derivative(in_u, u, 1), u, v, 2, 0);
    if (part == 4 && smooth) vv = GreatestOfCells(AcrossDerivative(in_v, v, 1), u, v, 0, 2);
  };
  pool.For(5, 1, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto part = static_cast<int>(begin); part < end; ++part) work(part);
  });
  slopes_ = (slope_u.array().square() + slope_v.array().square()).sqrt();
  if (smooth) {
    curvatures_ = uu.cwiseMax(vv) + uv;
  } else {
    curvatures_ = Eigen::MatrixXd::Constant(
        slopes_.rows(), slopes_.cols(), std::numeric_limits<double>::infinity());
  }
}

bool HeightDistances::SurelyNearest(const Eigen::Vector2d& place, double distance) const {
  if (!(distance > 0)) return true;
  const NurbsSurface& surface = evaluator_.surface();
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  const int first_u = cells_u_[static_cast<std::size_t>(u.Span(place[0] - distance))],
            last_u = cells_u_[static_cast<std::size_t>(u.Span(place[0] + distance))],
            first_v = cells_v_[static_cast<std::size_t>(v.Span(place[1] - distance))],
            last_v = cells_v_[static_cast<std::size_t>(v.Span(place[1] + distance))];
  const int across_u = last_u - first_u + 1, across_v = last_v - first_v + 1;
  if (across_u > kMostCells || across_v > kMostCells) return false;
  const double slope = slopes_.block(first_v, first_u, across_v, across_u).maxCoeff(),
               curvature = curvatures_.block(first_v, first_u, across_v, across_u).maxCoeff();
  return curvature * distance * (1 + 2 * slope) < 1;
}

const SurfaceFootPoints& HeightDistances::Finder() const {
  std::call_once(once_,
                 [&] { finder_ = std::make_unique<SurfaceFootPoints>(evaluator_.surface()); });
  return *finder_;
}

PointDistances HeightDistances::To(const Eigen::Matrix3Xd& points, ThreadPool& pool) const {
  const Eigen::Matrix2Xd places = plane_.ToFrame(points).topRows<2>();
  auto feet = LocalFootPoints(evaluator_, points, places, pool);
  std::atomic<Eigen::Index> uncertified = 0;
  pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      if (SurelyNearest(places.col(k), std::abs(feet.distances[k]))) continue;
      const SurfaceFoot foot =
          Finder().NearestFrom(points.col(k), feet.parameters(0, k), feet.parameters(1, k));
      feet.distances[k] = SignedDistance(evaluator_, points.col(k), foot);
      feet.parameters.col(k) << foot.u, foot.v;
      if (!foot.certified) ++uncertified;
    }
  });
  return {std::move(feet.distances), std::move(feet.parameters), uncertified};
}

}  // namespace batten::internal
