// SPDX-License-Identifier: MIT
#include "batten/fitting/grid_parameters.h"

#include <array>
#include <cmath>
#include <optional>
#include <stdexcept>
#include <string>

#include "fitting/core/rounding.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/enum_name.h"
#include "geometry/numeric/polygon.h"

namespace batten {
namespace {

constexpr double kRegular = 1e-3;  // of a mean step: how far a grid may be off its plane's lines

// The grid as lines across one direction: step k leads from line k to line k + 1.
class Lines {
 public:
  Lines(const PointNet& net, bool along_u, bool closed)
      : net_(net),
        along_u_(along_u),
        count_(along_u ? net.rows : net.columns),
        across_(along_u ? net.columns : net.rows),
        steps_(closed ? count_ : count_ - 1) {}

  int steps() const { return steps_; }
  int across() const { return across_; }
  int line_after(int k) const { return (k + 1) % count_; }
  bool Has(int k, int l) const { return net_.missing.size() == 0 || !net_.missing[Column(k, l)]; }
  Eigen::Vector3d At(int k, int l) const { return net_.points.col(Column(k, l)); }
  std::string Name(int k) const {
    const std::string kind = along_u_ ? "rows " : "columns ";
    return kind + std::to_string(k + 1) + " and " + std::to_string(line_after(k) + 1);
  }

 private:
  Eigen::Index Column(int k, int l) const {
    return along_u_ ? Eigen::Index{k} * net_.columns + l : Eigen::Index{l} * net_.columns + k;
  }

  const PointNet& net_;
  bool along_u_;
  int count_, across_, steps_;
};

// Mean length of each step over the lines that have both its ends.
Eigen::VectorXd MeanLengthsOf(const Lines& lines) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(lines.steps());
  for (int k = 0; k < lines.steps(); ++k) {
    int count = 0;
    for (int l = 0; l < lines.across(); ++l) {
      const int after = lines.line_after(k);
      if (!lines.Has(k, l) || !lines.Has(after, l)) continue;
      mean[k] += (lines.At(after, l) - lines.At(k, l)).stableNorm();
      ++count;
    }
    if (count > 0) mean[k] /= count;
  }
  return mean;
}

// Each step's share of the whole length, averaged over the lines across; where cells are missing,
// the mean of the steps themselves.
Eigen::VectorXd MeanSteps(const Lines& lines, bool complete, bool centripetal) {
  Eigen::VectorXd mean = Eigen::VectorXd::Zero(lines.steps()), step(lines.steps());
  Eigen::VectorXd count = Eigen::VectorXd::Zero(lines.steps());
  for (int l = 0; l < lines.across(); ++l) {
    Eigen::VectorXd has = Eigen::VectorXd::Zero(lines.steps());
    for (int k = 0; k < lines.steps(); ++k) {
      if (!lines.Has(k, l) || !lines.Has(lines.line_after(k), l)) {
        step[k] = 0;
        continue;
      }
      const double length = (lines.At(lines.line_after(k), l) - lines.At(k, l)).stableNorm();
      step[k] = centripetal ? std::sqrt(length) : length;
      has[k] = 1;
    }
    const double whole = step.sum();
    if (!(whole > 0)) continue;
    mean += complete ? step / whole : step;
    count += has;
  }
  for (int k = 0; k < lines.steps(); ++k) {
    if (count[k] > 0) mean[k] /= count[k];
  }
  return mean;
}

Eigen::VectorXd FromSteps(const Lines& lines, const Eigen::VectorXd& steps) {
  const double whole = steps.sum();
  if (!(whole > 0)) {
    throw std::invalid_argument("the points of the grid lie on a line or in one place: " +
                                lines.Name(0) + " and all after them are the same");
  }
  for (int k = 0; k < lines.steps(); ++k) {
    if (steps[k] > internal::kRelativeRounding * whole) continue;
    throw std::invalid_argument(lines.Name(k) +
                                " of the grid lie in one place, or have no cells side by side: "
                                "leave one of them out");
  }
  return internal::SummedSteps(steps);
}

Eigen::VectorXd AlongLines(const Lines& lines,
                           bool complete,
                           GridParameterization parameterization) {
  if (parameterization == GridParameterization::kUniform) {
    return Eigen::VectorXd::LinSpaced(lines.steps() + 1, 0, 1);
  }
  return FromSteps(
      lines, MeanSteps(lines, complete, parameterization == GridParameterization::kCentripetal));
}

// Sum of the outer products of what cells are off a parallelogram, and their greatest.
struct Twists {
  Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
  double largest = 0, step = 0;  // mean length of a step
};

Twists TwistsOf(const PointNet& net) {
  Twists twists;
  for (int i = 0; i + 1 < net.rows; ++i) {
    for (int j = 0; j + 1 < net.columns; ++j) {
      const Eigen::Vector3d a = net.At(i + 1, j) - net.At(i, j),
                            b = net.At(i, j + 1) - net.At(i, j);
      const Eigen::Vector3d twist = net.At(i + 1, j + 1) - net.At(i, j) - a - b;
      twists.spread += twist * twist.transpose();
      twists.largest = std::max(twists.largest, twist.norm());
      twists.step += (a.norm() + b.norm()) / 2;
    }
  }
  twists.step /= static_cast<double>(net.rows - 1) * (net.columns - 1);
  return twists;
}

// Steps along the lines projected to a plane; none where they do not keep one direction and length.
std::optional<Eigen::VectorXd> StepsInPlane(const Lines& lines, const Eigen::Matrix3d& flat) {
  const auto step_at = [&](int k, int l) -> Eigen::Vector3d {
    return flat * (lines.At(lines.line_after(k), l) - lines.At(k, l));
  };
  Eigen::Matrix3Xd mean = Eigen::Matrix3Xd::Zero(3, lines.steps());
  for (int k = 0; k < lines.steps(); ++k) {
    for (int l = 0; l < lines.across(); ++l) mean.col(k) += step_at(k, l) / lines.across();
  }
  const Eigen::Vector3d whole = mean.rowwise().sum();
  const double length = whole.norm(), near = kRegular * length / lines.steps();
  if (!(length > 0)) return std::nullopt;
  const Eigen::VectorXd steps = mean.transpose() * whole / length;
  for (int k = 0; k < lines.steps(); ++k) {
    if (!(steps[k] > near)) return std::nullopt;
    for (int l = 0; l < lines.across(); ++l) {
      if ((step_at(k, l) - steps[k] * whole / length).norm() > near) return std::nullopt;
    }
  }
  return steps;
}

// The places of the lines in the plane that the grid is regular over.
std::optional<GridParameters> PlacesInPlane(const PointNet& net) {
  const Twists twists = TwistsOf(net);
  // Without twists, rows are alike, and columns, and chord lengths serve as well.
  if (!(twists.largest > kRegular * twists.step)) return std::nullopt;
  const double size = twists.largest * twists.largest;
  const SymmetricEigen3 axes = EigenOf3(twists.spread / size);
  const Eigen::Vector3d up = axes.vectors.col(2);
  const Eigen::Matrix3d flat = Eigen::Matrix3d::Identity() - up * up.transpose();
  const auto u = StepsInPlane(Lines(net, true, false), flat);
  if (!u) return std::nullopt;
  const auto v = StepsInPlane(Lines(net, false, false), flat);
  if (!v) return std::nullopt;
  return GridParameters{internal::SummedSteps(*u), internal::SummedSteps(*v)};
}

void CheckGiven(const Eigen::VectorXd& t, int lines, bool closed, const std::string& name) {
  if (t.size() != lines + (closed ? 1 : 0)) {
    throw std::invalid_argument("a grid of " + std::to_string(lines) + " " + name + " needs " +
                                std::to_string(lines + (closed ? 1 : 0)) +
                                " parameters; there are " + std::to_string(t.size()));
  }
  for (Eigen::Index k = 0; k < t.size(); ++k) {
    if (std::isfinite(t[k]) && (k == 0 || t[k] > t[k - 1])) continue;
    throw std::invalid_argument("the parameters of the grid's " + name + " do not increase at " +
                                std::to_string(k + 1));
  }
}

}  // namespace

const char* Name(GridParameterization parameterization) {
  static constexpr std::array kNames{"auto", "given", "uniform", "chord", "centripetal"};
  return NameIn<GridParameterization::kCentripetal>(kNames, parameterization);
}

CollapsedLines PolesOf(const PointNet& net, const GridClosing& closed) {
  CollapsedLines poles = CollapsedLinesOf(net);
  if (closed.u) poles.first_row = poles.last_row = false;
  if (closed.v) poles.first_column = poles.last_column = false;
  return poles;
}

GridParameters ParametersOf(const PointNet& net,
                            GridParameterization parameterization,
                            const GridClosing& closed) {
  Check(net, "ParametersOf");
  if (parameterization == GridParameterization::kGiven) {
    throw std::invalid_argument("ParametersOf: given parameters are the caller's");
  }
  const bool complete = net.complete();
  if (parameterization == GridParameterization::kAuto && complete && !closed.u && !closed.v) {
    if (std::optional<GridParameters> places = PlacesInPlane(net)) return *std::move(places);
  }
  return {AlongLines(Lines(net, true, closed.u), complete, parameterization),
          AlongLines(Lines(net, false, closed.v), complete, parameterization)};
}

Eigen::Vector2d MeanLengths(const PointNet& net, const GridClosing& closed) {
  return {MeanLengthsOf(Lines(net, true, closed.u)).sum(),
          MeanLengthsOf(Lines(net, false, closed.v)).sum()};
}

GridParameters ParametersFor(const PointNet& net,
                             GridParameterization parameterization,
                             const GridParameters& given,
                             const GridClosing& closed) {
  if (parameterization != GridParameterization::kGiven) {
    return ParametersOf(net, parameterization, closed);
  }
  CheckParameters(net, given, closed);
  return given;
}

void CheckParameters(const PointNet& net,
                     const GridParameters& parameters,
                     const GridClosing& closed) {
  CheckGiven(parameters.u, net.rows, closed.u, "rows");
  CheckGiven(parameters.v, net.columns, closed.v, "columns");
}

}  // namespace batten
