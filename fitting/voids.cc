// SPDX-License-Identifier: MIT
#include "batten/fitting/voids.h"

#include <Eigen/QR>
#include <Eigen/SparseCholesky>
#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>
#include <vector>

#include "batten/fitting/statistics.h"

namespace batten {
namespace {

constexpr double kPlaceInSpacings = 1;
constexpr double kVoidInSpacings = 3;   // what is empty at this width is a void, not chance
constexpr int kMostPlaces = 160;        // along a side
constexpr double kRangeMargin = 0.02;   // of the data's range
constexpr double kTiltRounding = 1e-6;  // extrapolation magnifies rounding
constexpr double kUsualSlope = 0.75;    // this share of places is less steep
constexpr double kSlopeFactor = 1.2;
constexpr int kSamplesPerCell = 3;
constexpr int kHoldRounds = 12;
constexpr double kHold = 0.03;  // the first weight of a held place, against the data's density
constexpr double kHeavier = 4;

struct PlaceGrid {
  int nu, nv;
  double u0, v0, du, dv;

  PlaceGrid(const FittingProblem& problem, double side) {
    const SplineBasis &bu = problem.basis_u(), &bv = problem.basis_v();
    const double lu = bu.upper() - bu.lower(), lv = bv.upper() - bv.lower();
    nu = side > 0 ? static_cast<int>(std::clamp(lu / side, 1.0, double{kMostPlaces})) : 1;
    nv = side > 0 ? static_cast<int>(std::clamp(lv / side, 1.0, double{kMostPlaces})) : 1;
    u0 = bu.lower();
    v0 = bv.lower();
    du = lu / nu;
    dv = lv / nv;
  }
  int Place(double u, double v) const {
    return std::clamp(static_cast<int>((u - u0) / du), 0, nu - 1) * nv +
           std::clamp(static_cast<int>((v - v0) / dv), 0, nv - 1);
  }
};

double EmptyShare(const Eigen::Matrix2Xd& parameters, const PlaceGrid& grid) {
  std::vector<bool> occupied(static_cast<size_t>(grid.nu) * grid.nv, false);
  for (Eigen::Index k = 0; k < parameters.cols(); ++k) {
    occupied[grid.Place(parameters(0, k), parameters(1, k))] = true;
  }
  const auto empty = std::count(occupied.begin(), occupied.end(), false);
  return static_cast<double>(empty) / static_cast<double>(occupied.size());
}

// Laplace's equation on the empty places: fixed heights at the others, free at the domain's border.
Eigen::VectorXd Membrane(const PlaceGrid& grid,
                         const std::vector<double>& heights,
                         const std::vector<int>& unknown_of,
                         int unknowns) {
  std::vector<Eigen::Triplet<double>> entries;
  Eigen::VectorXd rhs = Eigen::VectorXd::Zero(unknowns);
  const double wu = grid.dv / grid.du, wv = grid.du / grid.dv;
  for (int i = 0; i < grid.nu; ++i) {
    for (int j = 0; j < grid.nv; ++j) {
      const int unknown = unknown_of[i * grid.nv + j];
      if (unknown < 0) continue;
      const auto couple = [&](int i2, int j2, double w) {
        if (i2 < 0 || j2 < 0 || i2 >= grid.nu || j2 >= grid.nv) return;
        const int other = unknown_of[i2 * grid.nv + j2];
        entries.emplace_back(unknown, unknown, w);
        if (other >= 0) {
          entries.emplace_back(unknown, other, -w);
        } else {
          rhs[unknown] += w * heights[i2 * grid.nv + j2];
        }
      };
      couple(i - 1, j, wu);
      couple(i + 1, j, wu);
      couple(i, j - 1, wv);
      couple(i, j + 1, wv);
    }
  }
  Eigen::SparseMatrix<double> matrix(unknowns, unknowns);
  matrix.setFromTriplets(entries.begin(), entries.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> solver(matrix);
  return solver.solve(rhs);
}

// Heights everywhere on a grid a spacing wide: means of the data where there are any, else the
// membrane.
std::vector<double> HeightMap(const FittingData& data,
                              Eigen::Index measured,
                              const PlaceGrid& grid) {
  const size_t places = static_cast<size_t>(grid.nu) * grid.nv;
  std::vector<double> heights(places, 0.0), counts(places, 0.0);
  for (Eigen::Index k = 0; k < measured; ++k) {
    const int place = grid.Place(data.parameters(0, k), data.parameters(1, k));
    heights[place] += data.values(0, k);
    counts[place] += 1;
  }
  std::vector<int> unknown_of(places, -1);
  int unknowns = 0;
  for (size_t place = 0; place < places; ++place) {
    if (counts[place] > 0) {
      heights[place] /= counts[place];
    } else {
      unknown_of[place] = unknowns++;
    }
  }
  if (unknowns > 0) {
    const Eigen::VectorXd membrane = Membrane(grid, heights, unknown_of, unknowns);
    for (size_t place = 0; place < places; ++place) {
      if (unknown_of[place] >= 0) heights[place] = membrane[unknown_of[place]];
    }
  }
  return heights;
}

// The least-squares plane of the measured heights: height at (0,0) and slopes.
Eigen::Vector3d TiltOf(const FittingData& data, Eigen::Index measured) {
  Eigen::MatrixXd design(measured, 3);
  design << Eigen::VectorXd::Ones(measured), data.parameters.leftCols(measured).transpose();
  return design.colPivHouseholderQr().solve(data.values.row(0).head(measured).transpose());
}

// Whether heights keep, everywhere, to a band about the plane that is hardly wider than the data's
// own. A tilted sheet goes on being tilted where there are no points.
bool KeepsToTilt(const Eigen::MatrixXd& there,
                 const Eigen::Matrix2Xd& places,
                 const FittingData& data,
                 Eigen::Index measured,
                 const Eigen::Vector3d& plane) {
  const auto above = [&](const auto& heights, const auto& parameters) {
    return (heights.array() - plane[0] - plane[1] * parameters.row(0).array() -
            plane[2] * parameters.row(1).array())
        .eval();
  };
  const auto own = above(data.values.row(0).head(measured), data.parameters.leftCols(measured));
  const auto anywhere = above(there.row(0), places);
  const double rounding = kTiltRounding * data.values.row(0).head(measured).cwiseAbs().maxCoeff();
  const double margin = kRangeMargin * (own.maxCoeff() - own.minCoeff()) + rounding;
  return anywhere.minCoeff() >= own.minCoeff() - margin &&
         anywhere.maxCoeff() <= own.maxCoeff() + margin;
}

// How far the surface may leave the data's range at every place of the grid: a share of the range,
// and what the usual slope of the data makes of the way to the nearest place with points. A sloping
// sheet goes on sloping in the strip around its points; that is not an overshoot.
std::vector<double> Allowance(const FittingData& data,
                              Eigen::Index measured,
                              const PlaceGrid& grid,
                              double range,
                              double tilt,
                              const PlaceGrid& coarse) {
  const std::vector<double> means = HeightMap(data, measured, coarse);
  std::vector<double> slopes;
  for (int i = 0; i < coarse.nu; ++i) {
    for (int j = 0; j < coarse.nv; ++j) {
      const double here = means[i * coarse.nv + j];
      const double du = i + 1 < coarse.nu ? (means[(i + 1) * coarse.nv + j] - here) / coarse.du : 0;
      const double dv = j + 1 < coarse.nv ? (means[i * coarse.nv + j + 1] - here) / coarse.dv : 0;
      slopes.push_back(std::hypot(du, dv));
    }
  }
  const double slope = kSlopeFactor * std::max(Quantile(std::move(slopes), kUsualSlope), tilt);
  // Steps to the nearest occupied place, by sweeps of a chamfer in both diagonal directions.
  const int far = grid.nu + grid.nv;
  std::vector<int> steps(static_cast<size_t>(grid.nu) * grid.nv, far);
  for (Eigen::Index k = 0; k < measured; ++k) {
    steps[grid.Place(data.parameters(0, k), data.parameters(1, k))] = 0;
  }
  for (const int way : {1, -1}) {
    for (int a = 0; a < grid.nu; ++a) {
      for (int b = 0; b < grid.nv; ++b) {
        const int i = way > 0 ? a : grid.nu - 1 - a, j = way > 0 ? b : grid.nv - 1 - b;
        int& here = steps[i * grid.nv + j];
        for (const auto& [di, dj] : {std::pair{1, 0}, {0, 1}, {1, 1}, {1, -1}}) {
          const int i2 = i - way * di, j2 = j - way * dj;
          if (i2 < 0 || j2 < 0 || i2 >= grid.nu || j2 >= grid.nv) continue;
          here = std::min(here, steps[i2 * grid.nv + j2] + 1);
        }
      }
    }
  }
  std::vector<double> allowance(steps.size(), kRangeMargin * range);
  for (int i = 0; i < grid.nu; ++i) {
    for (int j = 0; j < grid.nv; ++j) {
      const bool border = i == 0 || j == 0 || i == grid.nu - 1 || j == grid.nv - 1;
      const int count = steps[i * grid.nv + j];
      if (border && count <= 1) {
        allowance[i * grid.nv + j] += slope * std::hypot(grid.du, grid.dv) * (count + 0.5);
      }
    }
  }
  return allowance;
}

// Parameters that cut every knot cell in three.
std::vector<double> Samples(const SplineBasis& basis) {
  std::vector<double> samples;
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int k = 0; k < kSamplesPerCell; ++k) samples.push_back(a + (b - a) * k / kSamplesPerCell);
  }
  samples.push_back(basis.upper());
  return samples;
}

FittingProblem WithHolds(const FittingProblem& problem,
                         const Eigen::Matrix2Xd& places,
                         const std::vector<double>& heights,
                         const std::vector<double>& weights) {
  std::vector<Eigen::Index> held;
  for (size_t k = 0; k < weights.size(); ++k) {
    if (weights[k] > 0) held.push_back(static_cast<Eigen::Index>(k));
  }
  const FittingData& given = problem.data();
  const Eigen::Index m = problem.size(), extra = static_cast<Eigen::Index>(held.size());
  auto data = std::make_shared<FittingData>();
  data->parameters.resize(2, m + extra);
  data->values.resize(1, m + extra);
  data->weights.resize(m + extra);
  data->parameters.leftCols(m) = given.parameters;
  data->values.leftCols(m) = given.values;
  data->weights.head(m) =
      given.weights.size() > 0 ? given.weights : Eigen::VectorXd::Ones(m).eval();
  for (Eigen::Index k = 0; k < extra; ++k) {
    data->parameters.col(m + k) = places.col(held[k]);
    data->values(0, m + k) = heights[held[k]];
    data->weights[m + k] = weights[held[k]];
  }
  return FittingProblem(problem.basis_u(), problem.basis_v(), std::move(data), problem.smoothing());
}

}  // namespace

CalmResult SolveCalmly(const FittingProblem& problem,
                       const CalmOptions& options,
                       ThreadPool& pool) {
  const FittingData& data = problem.data();
  CalmResult result{problem, SolveLinear(problem, pool)};
  result.empty_share = EmptyShare(data.parameters.leftCols(options.measured),
                                  PlaceGrid(problem, kVoidInSpacings * options.spacing));
  const auto measured = data.values.row(0).head(options.measured);
  const double low = measured.minCoeff(), high = measured.maxCoeff();
  const Eigen::Vector3d plane = TiltOf(data, options.measured);
  const PlaceGrid grid(problem, kPlaceInSpacings * options.spacing);
  const std::vector<double> allowance =
      Allowance(data,
                options.measured,
                grid,
                high - low,
                plane.tail<2>().norm(),
                PlaceGrid(problem, kVoidInSpacings * options.spacing));

  const std::vector<double> in_u = Samples(problem.basis_u()), in_v = Samples(problem.basis_v());
  auto samples = std::make_shared<FittingData>();
  samples->parameters.resize(2, static_cast<Eigen::Index>(in_u.size() * in_v.size()));
  Eigen::Index count = 0;
  for (const double u : in_u) {
    for (const double v : in_v) samples->parameters.col(count++) << u, v;
  }
  samples->values = Eigen::MatrixXd::Zero(1, count);
  const Eigen::Matrix2Xd places = samples->parameters;
  const FittingProblem everywhere(problem.basis_u(), problem.basis_v(), std::move(samples), 0);

  const double mean_weight =
      data.weights.size() > 0 ? data.weights.head(options.measured).mean() : 1.0;
  const double density =
      mean_weight * static_cast<double>(options.measured) / static_cast<double>(count);
  std::vector<double> holds(static_cast<size_t>(count), 0.0), heights;
  for (int round = 0; round < kHoldRounds; ++round) {
    const Eigen::MatrixXd there = EvaluateAt(everywhere, result.solution.coefficients, pool);
    if (round == 0 && KeepsToTilt(there, places, data, options.measured, plane)) break;
    bool left = false;
    for (Eigen::Index k = 0; k < count; ++k) {
      const double margin = allowance[grid.Place(places(0, k), places(1, k))];
      if (there(0, k) >= low - margin && there(0, k) <= high + margin) continue;
      left = true;
      holds[k] = holds[k] > 0 ? kHeavier * holds[k] : kHold * density;
    }
    if (!left) break;
    if (heights.empty()) {
      const std::vector<double> map = HeightMap(data, options.measured, grid);
      heights.resize(static_cast<size_t>(count));
      for (Eigen::Index k = 0; k < count; ++k)
        heights[k] = map[grid.Place(places(0, k), places(1, k))];
    }
    result.problem = WithHolds(problem, places, heights, holds);
    result.solution = SolveLinear(result.problem, pool);
  }
  result.places_held = std::count_if(holds.begin(), holds.end(), [](double h) { return h > 0; });
  return result;
}

}  // namespace batten
