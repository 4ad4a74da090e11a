// SPDX-License-Identifier: MIT
#include "batten/fitting/interpolate_grid.h"

#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "fitting/grid/line_interpolation.h"
#include "fitting/grid/value_span.h"
#include "fitting/interpolation/collocation.h"
#include "fitting/knots/data_knots.h"

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
  bool closed;

  Side(int degree, const Eigen::VectorXd& t, GridKnots knots, bool closes)
      : Side(closes ? KnotsAround(degree, Values(t)) : ClosedKnots{OpenKnots(degree, t, knots), t},
             closes) {}
  Side(ClosedKnots knots, bool closes)
      : basis(std::move(knots.basis)), parameters(std::move(knots.parameters)), closed(closes) {}

  // Control points (in place of `values`, one a column) of a closed direction.
  Eigen::MatrixXd Around(const Eigen::MatrixXd& values) const {
    std::vector<SplineCondition> conditions;
    for (const double t : parameters) conditions.push_back({t, 0});
    auto control = SolveConditions(basis, conditions, values, true);
    if (!control) {
      throw std::invalid_argument(
          "the grid's lines are spaced so that no closed surface of degree " +
          std::to_string(basis.degree()) + " goes through them");
    }
    return *std::move(control);
  }
};

// A net of 3-vectors, v fastest, as the solver sees it.
using Net = Eigen::Matrix3Xd;

Net AlongU(const Side& side, Net net, Eigen::Index columns, ThreadPool& pool) {
  const Eigen::Index width = 3 * columns;
  if (!side.closed) {
    LineInterpolation(side.basis, Values(side.parameters)).SolveLines(net.data(), width, pool);
    return net;
  }
  const Eigen::Map<const Eigen::MatrixXd> lines(net.data(), width, net.size() / width);
  const Eigen::MatrixXd control = side.Around(lines);
  return Eigen::Map<const Net>(control.data(), 3, control.size() / 3);
}

Net AlongV(const Side& side, Net net, Eigen::Index rows, ThreadPool& pool) {
  if (!side.closed) {
    LineInterpolation(side.basis, Values(side.parameters)).SolveWithin(net.data(), rows, 3, pool);
    return net;
  }
  const Eigen::Index columns = net.cols() / rows;
  Eigen::MatrixXd values(3 * rows, columns);
  for (Eigen::Index i = 0; i < rows; ++i) {
    values.middleRows(3 * i, 3) = net.middleCols(i * columns, columns);
  }
  const Eigen::MatrixXd control = side.Around(values);
  Net result(3, rows * control.cols());
  for (Eigen::Index i = 0; i < rows; ++i) {
    result.middleCols(i * control.cols(), control.cols()) = control.middleRows(3 * i, 3);
  }
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
  control = AlongV(v, std::move(control), net.rows, pool);
  control = AlongU(u, std::move(control), v.basis.size(), pool);
  control.colwise() += middle;
  Collapse(PolesOf(net, options.closed), u.basis.size(), v.basis.size(), control);
  return {NurbsSurface(u.basis, v.basis, std::move(control)), {u.parameters, v.parameters}};
}

}  // namespace batten
