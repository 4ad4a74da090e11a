// SPDX-License-Identifier: MIT
#include "fitting/grid/grid_input.h"

#include <stdexcept>

#include "fitting/core/rounding.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

std::string Plural(Eigen::Index count, const std::string& word) {
  return std::to_string(count) + " " + word + (count == 1 ? "" : "s");
}

// The sizes of grids that so many points could fill.
std::string WhatFits(Eigen::Index points, int rows, int columns) {
  std::string fits;
  const auto add = [&](Eigen::Index n, Eigen::Index m) {
    if (n < 2 || m < 2) return;
    fits += (fits.empty() ? "; so many points would be " : " or ") + std::to_string(n) + " x " +
            std::to_string(m);
  };
  if (points % columns == 0) add(points / columns, columns);
  if (points % rows == 0) add(rows, points / rows);
  return fits.empty() ? "; so many points fill neither rows of " + std::to_string(columns) +
                            " nor columns of " + std::to_string(rows)
                      : fits;
}

PointNet NetOf(const PointCloud& cloud, const GridFitOptions& options) {
  const Eigen::Index cells = Eigen::Index{options.rows} * options.columns;
  PointNet net{options.rows, options.columns, Eigen::Matrix3Xd::Zero(3, cells), options.missing};
  const Eigen::Index missing = options.missing.size() > 0 ? options.missing.count() : 0;
  if (cloud.size() != cells - missing) {
    throw std::invalid_argument(
        "a grid of " + std::to_string(options.rows) + " x " + std::to_string(options.columns) +
        " takes " + Plural(cells, "point") +
        (missing > 0 ? " less " + std::to_string(missing) + " that are missing" : "") +
        "; there are " + std::to_string(cloud.size()) +
        (missing > 0 ? "" : WhatFits(cloud.size(), options.rows, options.columns)));
  }
  Eigen::Index next = 0;
  for (Eigen::Index k = 0; k < cells; ++k) {
    if (missing > 0 && options.missing[k]) continue;
    net.points.col(k) = cloud.points().col(next++);
  }
  // Contents of missing cells must not widen the box.
  for (Eigen::Index k = 0; missing > 0 && next > 0 && k < cells; ++k) {
    if (options.missing[k]) net.points.col(k) = cloud.points().col(0);
  }
  if (missing == 0) net.missing.resize(0);
  return net;
}

// Lines of a grid in one direction, by index.
struct LineView {
  const PointNet& net;
  bool rows;

  int count() const { return rows ? net.rows : net.columns; }
  int across() const { return rows ? net.columns : net.rows; }
  Eigen::Index Cell(int k, int l) const {
    return rows ? Eigen::Index{k} * net.columns + l : Eigen::Index{l} * net.columns + k;
  }
  bool Missing(int k, int l) const { return net.missing.size() > 0 && net.missing[Cell(k, l)]; }

  // Whether all points agree, to `near`; missing cells agree with missing ones only.
  bool Same(int a, int b, double near) const {
    for (int l = 0; l < across(); ++l) {
      if (Missing(a, l) != Missing(b, l)) return false;
      if (Missing(a, l)) continue;
      const Eigen::Vector3d apart = net.points.col(Cell(a, l)) - net.points.col(Cell(b, l));
      if (!(apart.cwiseAbs().maxCoeff() <= near)) return false;
    }
    return true;
  }
  bool Empty(int k) const {
    for (int l = 0; l < across(); ++l) {
      if (!Missing(k, l)) return false;
    }
    return true;
  }
};

}  // namespace

PointNet WithLines(const PointNet& net, bool rows, const std::vector<int>& kept) {
  const auto count = static_cast<int>(kept.size());
  PointNet fewer{rows ? count : net.rows, rows ? net.columns : count, {}, {}};
  fewer.points.resize(3, Eigen::Index{fewer.rows} * fewer.columns);
  if (net.missing.size() > 0) fewer.missing.resize(fewer.points.cols());
  const LineView from{net, rows}, to{fewer, rows};
  for (int k = 0; k < count; ++k) {
    for (int l = 0; l < from.across(); ++l) {
      const Eigen::Index cell = from.Cell(kept[static_cast<size_t>(k)], l);
      fewer.points.col(to.Cell(k, l)) = net.points.col(cell);
      if (net.missing.size() > 0) fewer.missing[to.Cell(k, l)] = net.missing[cell];
    }
  }
  return fewer;
}

namespace {

// Drops lines that repeat the one before, and lines without a point.
void DropKnotLines(bool rows, Eigen::VectorXd* given, GridInput& input) {
  const LineView lines{input.net, rows};
  const std::string name = rows ? "row" : "column";
  std::vector<int> kept, &stands = rows ? input.row_of : input.column_of;
  for (int k = 0; k < lines.count(); ++k) {
    if (lines.Empty(k)) {
      stands.push_back(-1);
      input.warnings.push_back(name + " " + std::to_string(k + 1) +
                               " of the grid has no points and was left out");
      continue;
    }
    const bool repeats = !kept.empty() && lines.Same(k, kept.back(), 0);
    if (repeats) {
      input.warnings.push_back(name + " " + std::to_string(k + 1) + " of the grid repeats " + name +
                               " " + std::to_string(kept.back() + 1) + " and was left out");
    } else {
      kept.push_back(k);
    }
    stands.push_back(static_cast<int>(kept.size()) - 1);
  }
  if (static_cast<int>(kept.size()) == lines.count()) return;
  if (kept.size() < 2) {
    throw std::invalid_argument("all " + name + "s of the grid are the same: a surface needs two");
  }
  if (given && given->size() == lines.count()) *given = (*given)(kept).eval();
  input.net = WithLines(input.net, rows, kept);
}

// Whether a direction closes; a last line that repeats the first is then dropped.
bool CloseDirection(bool rows, bool wanted, bool allowed, GridInput& input) {
  if (!allowed) return false;
  const LineView lines{input.net, rows};
  const double size =
      (input.net.points.rowwise().maxCoeff() - input.net.points.rowwise().minCoeff()).maxCoeff();
  // Around a closed direction there are three different lines at least.
  const bool meets =
      lines.count() > 3 && lines.Same(0, lines.count() - 1, kRelativeRounding * size);
  if (meets) {
    std::vector<int> kept;
    for (int k = 0; k + 1 < lines.count(); ++k) kept.push_back(k);
    for (int& line : rows ? input.row_of : input.column_of) {
      if (line == static_cast<int>(kept.size())) line = 0;
    }
    input.net = WithLines(input.net, rows, kept);
  }
  return meets || wanted;
}

void RequireSheet(const PointNet& net) {
  constexpr double kLineSquared = 1e-13;  // of the largest eigenvalue: below, all is on a line
  const Eigen::Vector3d middle = MiddleOf(net);
  const double size = (net.points.colwise() - middle).cwiseAbs().maxCoeff();
  const Eigen::Matrix3Xd unit = (net.points.colwise() - middle) / size;
  const Eigen::Vector3d mean = unit.rowwise().mean();
  const Eigen::Vector3d spread =
      EigenOf3((unit.colwise() - mean) * (unit.colwise() - mean).transpose()).values;
  if (!(spread[1] > kLineSquared * spread[2])) {
    throw std::invalid_argument("the points of the grid lie on a line: they don't carry a surface");
  }
}

}  // namespace

GridInput ReadGrid(const PointCloud& cloud, const GridFitOptions& options) {
  GridInput input{NetOf(cloud, options), options.parameters, {}, {}, {}, {}, {}};
  const bool given = options.parameterization == GridParameterization::kGiven;
  for (const bool rows : {true, false}) {
    DropKnotLines(rows, given ? &(rows ? input.parameters.u : input.parameters.v) : nullptr, input);
  }
  RequireSheet(input.net);
  const Closing closed = options.closed;
  const bool both = closed == Closing::kBoth,
             detect = closed == Closing::kAuto && options.method != GridMethod::kInterpolateLocally;
  const bool u = both || closed == Closing::kU, v = both || closed == Closing::kV;
  input.closed.u = CloseDirection(true, u, u || detect, input);
  input.closed.v = CloseDirection(false, v, v || detect, input);
  if (const Eigen::Index missing = input.net.missing.count(); missing > 0) {
    input.warnings.push_back(Plural(missing, "cell") + " of the grid " +
                             (missing == 1 ? "is" : "are") +
                             " missing: fairness carries the surface over them");
  }
  if (given) {
    CheckParameters(input.net, input.parameters, input.closed);
    input.parameters_from = "given parameters";
    return input;
  }
  input.parameters = ParametersOf(input.net, options.parameterization, input.closed);
  const Eigen::Vector2d lengths = MeanLengths(input.net, input.closed);
  input.parameters.u *= lengths[0];
  input.parameters.v *= lengths[1];
  input.parameters_from = options.parameterization == GridParameterization::kAuto
                              ? "parameters from where the points lie"
                              : std::string(Name(options.parameterization)) + " parameters";
  return input;
}

}  // namespace batten::internal
