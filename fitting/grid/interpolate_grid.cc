// SPDX-License-Identifier: MIT
#include "batten/fitting/interpolate_grid.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "fitting/grid/line_least_squares.h"
#include "fitting/grid/value_span.h"
#include "fitting/knots/data_knots.h"
#include "fitting/linear/collocation.h"

namespace batten {
using namespace internal;
namespace {

void CheckCount(int lines, int degree, bool closed, const std::string& name) {
  if (degree < 1 || degree > kMaxDegree) {
    throw std::invalid_argument("the degree " + std::to_string(degree) + " is not between 1 and " +
                                std::to_string(kMaxDegree));
  }
  const int least = closed ? 3 : degree + 1;
  if (lines >= least) return;
  const std::string have = "; this one has " + std::to_string(lines);
  if (closed) {
    throw std::invalid_argument("a grid that closes needs at least 3 " + name + have);
  }
  throw std::invalid_argument("interpolation with degree " + std::to_string(degree) +
                              " needs a grid of at least " + std::to_string(least) + " " + name +
                              have + ": lower the degree to " + std::to_string(lines - 1));
}

constexpr double kNearEnd = 0.6;  // of the step; the best of a scan on smooth functions

SplineBasis OpenKnots(int degree, const Eigen::VectorXd& t, GridKnots rule) {
  SplineBasis averaged = AveragedKnots(degree, Values(t));
  // The first and the last inner knot of a cubic, where these are two.
  if (rule == GridKnots::kAveraged || degree != 3 || t.size() < 6) return averaged;
  std::vector<double> knots = averaged.knots();
  const Eigen::Index n = t.size();
  knots[4] = t[1] + kNearEnd * (t[2] - t[1]);
  knots[static_cast<size_t>(n) - 1] = t[n - 2] - kNearEnd * (t[n - 2] - t[n - 3]);
  return SplineBasis(degree, std::move(knots));
}

// One direction: the parameters of its lines and its basis.
struct Side {
  SplineBasis basis;
  Eigen::VectorXd parameters;  // one a line, inside the domain

  Side(int degree, const Eigen::VectorXd& t, GridKnots knots, bool closes)
      : Side(closes ? KnotsAround(degree, Values(t))
                    : ClosedKnots{OpenKnots(degree, t, knots), t}) {}
  explicit Side(ClosedKnots knots)
      : basis(std::move(knots.basis)), parameters(std::move(knots.parameters)) {}

  // Control points (in place of `values`, one a column).
  Eigen::MatrixXd Solved(const Eigen::MatrixXd& values) const {
    std::vector<SplineCondition> conditions;
    for (const double t : parameters) conditions.push_back({t, 0});
    auto control = SolveConditions(basis, conditions, values, true);
    if (!control) {
      throw std::invalid_argument("the grid's lines are spaced so that no surface of degree " +
                                  std::to_string(basis.degree()) + " goes through them");
    }
    return *std::move(control);
  }
};

// A net of 3-vectors, v fastest, as the solver sees it.
using Net = Eigen::Matrix3Xd;

Net AlongU(const Side& side, const Net& net, Eigen::Index columns, ThreadPool& pool) {
  const Eigen::Index width = 3 * columns;
  const Eigen::Map<const Eigen::MatrixXd> lines(net.data(), width, net.size() / width);
  Net result(3, columns * side.basis.size());
  Eigen::Map<Eigen::MatrixXd> control(result.data(), width, side.basis.size());
  pool.For(width, kSolvedTogether, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    control.middleRows(begin, end - begin) = side.Solved(lines.middleRows(begin, end - begin));
  });
  return result;
}

Net AlongV(const Side& side, const Net& net, Eigen::Index rows, ThreadPool& pool) {
  const Eigen::Index columns = net.cols() / rows, size = side.basis.size();
  Net result(3, rows * size);
  pool.For(rows, kSolvedTogether / 3, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    Eigen::MatrixXd lines(3 * (end - begin), columns);
    for (std::ptrdiff_t i = begin; i < end; ++i)
      lines.middleRows(3 * (i - begin), 3) = net.middleCols(i * columns, columns);
    const Eigen::MatrixXd control = side.Solved(lines);
    for (std::ptrdiff_t i = begin; i < end; ++i)
      result.middleCols(i * size, size) = control.middleRows(3 * (i - begin), 3);
  });
  return result;
}

}  // namespace

InterpolatedGrid InterpolateGrid(const PointNet& net,
                                 const GridInterpolationOptions& options,
                                 ThreadPool& pool) {
  RequireComplete(net, "InterpolateGrid");
  CheckCount(net.rows, options.degree_u, options.closed.u, "rows");
  CheckCount(net.columns, options.degree_v, options.closed.v, "columns");
  const GridParameters t =
      ParametersFor(net, options.parameterization, options.parameters, options.closed);
  const Side u(options.degree_u, t.u, options.knots, options.closed.u),
      v(options.degree_v, t.v, options.knots, options.closed.v);
  const Eigen::Vector3d middle = MiddleOf(net);
  Net control = net.points.colwise() - middle;
  control = AlongV(v, control, net.rows, pool);
  control = AlongU(u, control, v.basis.size(), pool);
  control.colwise() += middle;
  Collapse(PolesOf(net, options.closed), u.basis.size(), v.basis.size(), control);
  return {NurbsSurface(u.basis, v.basis, std::move(control)), {u.parameters, v.parameters}};
}

}  // namespace batten
