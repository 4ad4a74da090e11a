// SPDX-License-Identifier: MIT
#include "batten/fitting/approximate_grid.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

#include "fitting/grid/line_least_squares.h"
#include "batten/geometry/knot_vectors.h"
#include "fitting/grid/value_span.h"

namespace batten {
using namespace internal;
namespace {

SplineBasis BasisFor(
    int degree, int control, const Eigen::VectorXd& t, bool closed, const std::string& name) {
  if (degree < 1 || degree > kMaxDegree) {
    throw std::invalid_argument("the degree " + std::to_string(degree) + " is not between 1 and " +
                                std::to_string(kMaxDegree));
  }
  const int lines = static_cast<int>(t.size()) - (closed ? 1 : 0), least = closed ? 3 : degree + 1;
  if (control < least || control > lines) {
    throw std::invalid_argument("least squares of degree " + std::to_string(degree) + " over " +
                                std::to_string(lines) + " " + name + " takes " +
                                std::to_string(least) + " to " + std::to_string(lines) +
                                " control points across them, not " + std::to_string(control));
  }
  if (!closed) {
    return control == lines ? AveragedKnots(degree, Values(t))
                            : LeastSquaresKnots(degree, control, Values(t));
  }
  // Breaks at equal shares of the lines.
  std::vector<double> breaks;
  for (int k = 0; k <= control; ++k) {
    const double place = static_cast<double>(k) * lines / control;
    const auto before = std::min<Eigen::Index>(static_cast<Eigen::Index>(place), lines - 1);
    breaks.push_back(t[before] +
                     (place - static_cast<double>(before)) * (t[before + 1] - t[before]));
  }
  return PeriodicKnots(degree, breaks);
}

}  // namespace

NurbsSurface LeastSquaresOver(const SplineBasis& basis_u,
                              const SplineBasis& basis_v,
                              const PointNet& net,
                              const GridParameters& parameters,
                              const MetEnds& met,
                              ThreadPool& pool) {
  const GridClosing closed{basis_u.periodic(), basis_v.periodic()};
  const CollapsedLines poles = PolesOf(net, closed);
  const LineLeastSquares u(basis_u, Values(parameters.u), !closed.u && (met.u || poles.any_row())),
      v(basis_v, Values(parameters.v), !closed.v && (met.v || poles.any_column()));
  const Eigen::Vector3d middle = MiddleOf(net);
  const Eigen::Matrix3Xd points = net.points.colwise() - middle;
  Eigen::Matrix3Xd half(3, net.rows * v.size()), control(3, u.size() * v.size());
  v.SolveWithin(points.data(), net.rows, 3, half.data(), pool);
  u.SolveLines(half.data(), 3 * v.size(), control.data(), pool);
  control.colwise() += middle;
  Collapse(poles, basis_u.size(), basis_v.size(), control);
  return NurbsSurface(basis_u, basis_v, std::move(control));
}

InterpolatedGrid LeastSquaresGrid(const PointNet& net,
                                  const GridLeastSquaresOptions& options,
                                  ThreadPool& pool) {
  RequireComplete(net, "LeastSquaresGrid");
  const GridParameters t =
      ParametersFor(net, options.parameterization, options.parameters, options.closed);
  const SplineBasis u = BasisFor(
                        options.degree_u, options.control_u, t.u, options.closed.u, "rows"),
                    v = BasisFor(
                        options.degree_v, options.control_v, t.v, options.closed.v, "columns");
  const GridParameters lines{t.u.head(net.rows), t.v.head(net.columns)};
  return {LeastSquaresOver(u, v, net, lines, {options.meet_corners, options.meet_corners}, pool),
          lines};
}

}  // namespace batten
