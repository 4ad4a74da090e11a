// SPDX-License-Identifier: MIT
// What can be known of a fit to a bent sheet whose truth is known: the best that a uniform bicubic
// grid does at the true parameters, the error against the noise-free sheet, and folds.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <numbers>
#include <utility>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "bent_sheets.h"

namespace batten::internal {

struct TruthError {
  double rms, max;
};

inline TruthError ErrorToTruth(const NurbsSurface& surface, const Eigen::Matrix3Xd& truth) {
  ThreadPool pool(2);
  const Eigen::VectorXd d = DistancesTo(surface, truth, pool).distances;
  return {std::sqrt(d.squaredNorm() / static_cast<double>(d.size())), d.cwiseAbs().maxCoeff()};
}

// A sheet with a map of its unit square to parameters near lengths along it, and its largest
// extent.
struct ChartedSheet {
  BentSheet sheet;
  std::function<Eigen::Vector2d(double, double)> chart;
  double size;
};

inline ChartedSheet Charted(BentSheet sheet, double length_u, double length_v) {
  const Eigen::Matrix3Xd points = SheetTruth(sheet, 60);
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).maxCoeff();
  return {std::move(sheet),
          [=](double u, double v) { return Eigen::Vector2d(length_u * u, length_v * v); },
          size};
}

// Lengths along its meridians and angles between them are those of the cap.
inline ChartedSheet ChartedCap(double degrees) {
  ChartedSheet charted = Charted(SphericalCap(degrees), 1, 1);
  const double height = 1 - std::cos(degrees * std::numbers::pi / 180);
  charted.chart = [=](double u, double v) {
    const double from_pole = std::acos(1 - height * u), angle = 2 * std::numbers::pi * v;
    return Eigen::Vector2d(from_pole * std::cos(angle), from_pole * std::sin(angle));
  };
  return charted;
}

// Turns `apart` spacings from each other where there are `count` points.
inline ChartedSheet ChartedRoll(double apart, Eigen::Index count) {
  constexpr double kTurns = 1.5, kInner = 0.4;
  double gap = 0, length = 3 * std::numbers::pi * kInner;
  for (int round = 0; round < 9; ++round) {  // the gap makes the sheet longer
    gap = apart * std::sqrt(length / static_cast<double>(count));
    length = 2 * std::numbers::pi * kTurns * (kInner + gap * kTurns / 2);
  }
  const BentSheet roll = Roll(kTurns, gap, kInner);
  ChartedSheet charted = Charted(roll, 1, 1);
  charted.chart = roll.flat;
  return charted;
}

struct Oracle {
  double rms = std::numeric_limits<double>::infinity();  // against the truth
  int unknowns = 0;
};

// The best of uniform bicubic grids at the true parameters: nearly square cells from coarse to fine
// until the error has risen three times, then each direction alone. Errors are those at side²
// places.
class OracleSearch {
 public:
  OracleSearch(const ChartedSheet& charted, const SheetPoints& cloud, int side)
      : truth_(SheetTruth(charted.sheet, side)), truth_parameters_(2, truth_.cols()) {
    auto data = std::make_shared<FittingData>();
    data->values = cloud.points;
    data->parameters.resize(2, cloud.points.cols());
    for (Eigen::Index k = 0; k < cloud.points.cols(); ++k) {
      data->parameters.col(k) = charted.chart(cloud.parameters(0, k), cloud.parameters(1, k));
    }
    low_ = data->parameters.rowwise().minCoeff();
    high_ = data->parameters.rowwise().maxCoeff();
    data_ = std::move(data);
    Eigen::Index k = 0;
    for (int i = 0; i < side; ++i) {
      for (int j = 0; j < side; ++j) {
        const double u = (i + 0.5) / side, v = (j + 0.5) / side;
        if (!charted.sheet.Holds(u, v)) continue;
        truth_parameters_.col(k++) = charted.chart(u, v).cwiseMax(low_).cwiseMin(high_);
      }
    }
  }

  Oracle Find() {
    const Eigen::Vector2d side = high_ - low_;
    const double stretch = std::sqrt(side[0] / side[1]);
    std::pair<int, int> best{1, 1};
    int rises = 0;
    for (double cells = 3; rises < 3 && cells < 100; cells *= 1.25) {
      const std::pair<int, int> grid{Rounded(cells * stretch), Rounded(cells / stretch)};
      const bool better = Rms(grid) < Rms(best);
      if (better) best = grid;
      rises = better || grid == best ? 0 : rises + 1;
    }
    for (bool moved = true; moved;) {
      moved = false;
      for (const auto& [du, dv] : {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}}) {
        const std::pair<int, int> grid{std::max(1, best.first + du), std::max(1, best.second + dv)};
        if (Rms(grid) >= 0.999 * Rms(best)) continue;
        best = grid;
        moved = true;
      }
    }
    return {Rms(best), (best.first + 3) * (best.second + 3)};
  }

 private:
  static int Rounded(double cells) { return std::max(1, static_cast<int>(std::lround(cells))); }

  double Rms(const std::pair<int, int>& cells) {
    const auto [place, is_new] = rms_.try_emplace(cells, 0);
    if (!is_new) return place->second;
    double least = std::numeric_limits<double>::infinity();
    for (const double smoothing : {1e-4, 1e-9}) {
      const FittingProblem problem(SplineBasis::Uniform(3, cells.first + 3, low_[0], high_[0]),
                                   SplineBasis::Uniform(3, cells.second + 3, low_[1], high_[1]),
                                   data_,
                                   smoothing);
      const NurbsSurface surface(
          problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool_).coefficients);
      const Eigen::VectorXd d = DistancesFrom(surface, truth_, truth_parameters_, pool_).distances;
      least = std::min(least, std::sqrt(d.squaredNorm() / static_cast<double>(d.size())));
    }
    return place->second = least;
  }

  Eigen::Matrix3Xd truth_;
  Eigen::Matrix2Xd truth_parameters_;
  std::shared_ptr<const FittingData> data_;
  Eigen::Vector2d low_, high_;
  std::map<std::pair<int, int>, double> rms_;
  ThreadPool pool_{2};
};

inline Oracle BestUniform(const ChartedSheet& charted, const SheetPoints& cloud, int side) {
  return OracleSearch(charted, cloud, side).Find();
}

// How many places of a sheet a fitted surface shows turned over, against the others: by its
// normals, and by the sense of small triangles of the true parameters in the fitted ones.
struct FoldCount {
  int normals = 0, triangles = 0;
};

// Of side² places all over the sheet.
inline FoldCount FoldsOf(const NurbsSurface& surface, const BentSheet& sheet, int side) {
  ThreadPool pool(2);
  BentSheet whole = sheet;
  whole.inside = nullptr;
  const Eigen::MatrixXd feet = DistancesTo(surface, SheetTruth(whole, side), pool).parameters;
  const auto minority = [](int a, int b) { return std::min(a, b); };
  int same = 0, other = 0, left = 0, right = 0;
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const double u = (i + 0.5) / side, v = (j + 0.5) / side, step = 1.0 / side;
      if (!sheet.Holds(u, v)) continue;
      const Eigen::Vector2d foot = feet.col(i * side + j);
      const auto normal = surface.NormalAt(foot[0], foot[1]);
      ++(normal && normal->dot(sheet.NormalAt(u, v)) > 0 ? same : other);
      if (i + 1 == side || j + 1 == side) continue;
      if (!sheet.Holds(u + step, v) || !sheet.Holds(u, v + step)) continue;
      const Eigen::Vector2d a = feet.col((i + 1) * side + j) - foot;
      const Eigen::Vector2d b = feet.col(i * side + j + 1) - foot;
      ++(a[0] * b[1] > a[1] * b[0] ? left : right);
    }
  }
  return {minority(same, other), minority(left, right)};
}

}  // namespace batten::internal
