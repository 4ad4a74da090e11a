// SPDX-License-Identifier: MIT
// Bent sheets given by formulas, clouds on them, and the best that uniform splines can do there.
#pragma once

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <numbers>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/distances.h"
#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/geometry/nurbs_surface.h"
#include "jittered_shell.h"

namespace batten::internal {

struct KnownSheet {
  std::string name;
  std::function<Eigen::Vector3d(double, double)> at;  // (u, v) in the unit square
  Eigen::Vector2d sides;                              // lengths of the square's sides on the sheet
  // Where points lie: from two numbers spread evenly over 0 … 1 to (u, v). None: evenly there too.
  std::function<Eigen::Vector2d(double, double)> place;
};

inline Eigen::Vector2d PlaceOn(const KnownSheet& sheet, double a, double b) {
  return sheet.place ? sheet.place(a, b) : Eigen::Vector2d(a, b);
}

inline double Radians(double degrees) { return degrees * std::numbers::pi / 180; }

// Bent by 200 degrees, wavy both ways.
inline KnownSheet WavyShell() { return {"shell of 200°", Shell, {Radians(200), 2}, {}}; }

// 0 below `from`, 1 above `to`, between them by a polynomial with two continuous derivatives.
inline double SmoothStep(double s, double from, double to) {
  const double t = std::clamp((s - from) / (to - from), 0.0, 1.0);
  return t * t * t * (10 + t * (6 * t - 15));
}

// A curve in the plane by its heading at arc length 0 … 1.
class HeadingCurve {
 public:
  explicit HeadingCurve(std::function<double(double)> heading) : heading_(std::move(heading)) {
    for (int k = 0; k < kChords; ++k) {
      const double s = static_cast<double>(k) / kChords, step = 1.0 / kChords;
      places_.push_back(places_.back() + step / 6 *
                                             (Direction(s) + 4 * Direction(s + step / 2) +
                                              Direction(s + step)));  // Simpson's rule
    }
  }

  Eigen::Vector2d At(double s) const {
    const int k = std::clamp(static_cast<int>(s * kChords), 0, kChords - 1);
    const double rest = s - static_cast<double>(k) / kChords;
    return places_[k] + rest * Direction(s - rest / 2);
  }

  Eigen::Vector2d Normal(double s) const {
    const Eigen::Vector2d along = Direction(s);
    return {-along[1], along[0]};
  }

 private:
  static constexpr int kChords = 2000;

  Eigen::Vector2d Direction(double s) const {
    return {std::cos(heading_(s)), std::sin(heading_(s))};
  }

  std::function<double(double)> heading_;
  std::vector<Eigen::Vector2d> places_{Eigen::Vector2d::Zero()};
};

// Two bends of 150 degrees one after the other, the second back, a little wavy.
inline KnownSheet DoubleBend() {
  const auto profile = std::make_shared<const HeadingCurve>([](double s) {
    return Radians(150) * (SmoothStep(s, 0.12, 0.45) - SmoothStep(s, 0.55, 0.88));
  });
  const auto at = [profile](double u, double v) {
    using std::numbers::pi;
    const double wave = 0.015 * std::sin(2 * pi * v) * std::cos(2 * pi * u);
    const Eigen::Vector2d place = 2.4 * profile->At(u) + wave * profile->Normal(u);
    return Eigen::Vector3d(place[0], place[1], 0.8 * v);
  };
  return {"S of two bends of 150°", at, {2.4, 0.8}, {}};
}

// One and a half turns, `gap` apart; u is arc length but for terms of the gap's square.
inline KnownSheet Roll(double gap) {
  constexpr double kInner = 0.4;
  const double outer = kInner + 1.5 * gap;
  const double low = kInner * kInner, high = outer * outer;
  const auto at = [=](double u, double v) {
    const double radius = std::sqrt(low + u * (high - low));
    const double angle = 2 * std::numbers::pi * (radius - kInner) / gap;
    return Eigen::Vector3d(radius * std::cos(angle), radius * std::sin(angle), v);
  };
  return {"roll of 1.5 turns", at, {std::numbers::pi * (high - low) / gap, 1}, {}};
}

// Bent by 120 degrees; an area at one end has `ratio` times the points of one at the other.
inline KnownSheet GradedSheet(double ratio) {
  constexpr double kRadius = 0.55;
  const auto at = [](double u, double v) {
    using std::numbers::pi;
    const double angle = Radians(-60 + 120 * u);
    const double radius = kRadius * (1 + 0.06 * std::sin(3 * pi * u) * std::cos(2 * pi * v));
    return Eigen::Vector3d(
        radius * std::sin(angle), 0.9 * v + 0.03 * std::sin(2 * pi * u), radius * std::cos(angle));
  };
  const auto place = [ratio](double a, double b) {
    return Eigen::Vector2d(std::log1p(a * (ratio - 1)) / std::log(ratio), b);
  };
  return {"density changes tenfold", at, {kRadius * Radians(120), 0.9}, place};
}

// All of a sphere of radius 0.5 within an angle of its pole; (u, v) keep direction and distance
// from the pole.
inline KnownSheet SphericalCap(double degrees) {
  constexpr double kRadius = 0.5;
  const double most = Radians(degrees);
  const auto at = [=](double u, double v) {
    const double x = (2 * u - 1) * most, y = (2 * v - 1) * most, angle = std::hypot(x, y);
    const double shrink = angle > 0 ? std::sin(angle) / angle : 1;
    return Eigen::Vector3d(kRadius * Eigen::Vector3d(shrink * x, shrink * y, std::cos(angle)));
  };
  const auto place = [most](double a, double b) {
    const double share = std::acos(1 - a * (1 - std::cos(most))) / most;
    const double around = 2 * std::numbers::pi * b;
    return Eigen::Vector2d(0.5 + 0.5 * share * std::cos(around),
                           0.5 + 0.5 * share * std::sin(around));
  };
  const double side = 2 * kRadius * most;
  return {"spherical cap, " + std::to_string(static_cast<int>(degrees)) + "° from its pole",
          at,
          {side, side},
          place};
}

// 220 degrees around, radius 0.28 … 0.48.
inline KnownSheet WideningPipe() {
  const auto at = [](double u, double v) {
    const double angle = Radians(-110 + 220 * u), radius = 0.28 + 0.2 * std::pow(v, 1.5);
    return Eigen::Vector3d(radius * std::sin(angle), 0.95 * v, radius * std::cos(angle));
  };
  return {"half-pipe of 220° that widens", at, {0.36 * Radians(220), 0.97}, {}};
}

struct SheetCloudKind {
  Eigen::Index count;
  double sigma;         // of every coordinate
  double outliers = 0;  // so many more, as a share, anywhere in the box
};

struct SheetCloud {
  Eigen::Matrix3Xd points;
  Eigen::Matrix2Xd parameters;  // of the good points, which come first; in lengths
};

inline SheetCloud CloudOn(const KnownSheet& sheet, const SheetCloudKind& kind, std::uint64_t seed) {
  std::mt19937_64 engine(seed);
  std::uniform_real_distribution<double> uniform(0, 1);
  std::normal_distribution<double> normal(0, kind.sigma);
  const auto astray =
      static_cast<Eigen::Index>(std::llround(kind.outliers * static_cast<double>(kind.count)));
  SheetCloud cloud{Eigen::Matrix3Xd(3, kind.count + astray), Eigen::Matrix2Xd(2, kind.count)};
  for (Eigen::Index k = 0; k < kind.count; ++k) {
    const double a = uniform(engine), b = uniform(engine);
    const Eigen::Vector2d uv = PlaceOn(sheet, a, b);
    cloud.points.col(k) = sheet.at(uv[0], uv[1]);
    for (double& x : cloud.points.col(k)) x += normal(engine);
    cloud.parameters.col(k) = uv.cwiseProduct(sheet.sides);
  }
  const auto good = cloud.points.leftCols(kind.count);
  const Eigen::Vector3d low = good.rowwise().minCoeff(), high = good.rowwise().maxCoeff();
  for (auto point : cloud.points.rightCols(astray).colwise()) {
    for (int d = 0; d < 3; ++d) point[d] = low[d] + uniform(engine) * (high[d] - low[d]);
  }
  return cloud;
}

// side² places of the sheet, all inside the range of a cloud of many more points than side.
inline Eigen::Matrix3Xd PlacesOf(const KnownSheet& sheet, int side) {
  Eigen::Matrix3Xd places(3, Eigen::Index{side} * side);
  for (int i = 0; i < side; ++i) {
    for (int j = 0; j < side; ++j) {
      const Eigen::Vector2d uv = PlaceOn(sheet, (i + 0.5) / side, (j + 0.5) / side);
      places.col(Eigen::Index{i} * side + j) = sheet.at(uv[0], uv[1]);
    }
  }
  return places;
}

struct SheetError {
  double rms = 0, max = 0;  // distances of the sheet's places from the fitted surface
};

inline SheetError ErrorAt(const Eigen::Matrix3Xd& places,
                          const NurbsSurface& surface,
                          ThreadPool& pool) {
  const Eigen::VectorXd d = DistancesTo(surface, places, pool).distances;
  return {std::sqrt(d.squaredNorm() / static_cast<double>(d.size())), d.cwiseAbs().maxCoeff()};
}

struct BestUniform {
  int size_u = 0, size_v = 0;
  SheetError error{std::numeric_limits<double>::infinity(), 0};
};

// Least squares at the true parameters over uniform bicubics of every size: what a fit that knows
// the parameters and the truth, and only chooses its grid, would choose.
class UniformOracle {
 public:
  UniformOracle(const SheetCloud& cloud, Eigen::Matrix3Xd places, ThreadPool& pool)
      : places_(std::move(places)),
        pool_(pool),
        low_(cloud.parameters.rowwise().minCoeff()),
        high_(cloud.parameters.rowwise().maxCoeff()) {
    auto data = std::make_shared<FittingData>();
    data->parameters = cloud.parameters;
    data->values = cloud.points.leftCols(cloud.parameters.cols());
    data_ = std::move(data);
  }

  // Nearly square cells from coarse to fine, then each direction alone.
  BestUniform Best() const {
    const Eigen::Vector2d side = high_ - low_;
    const double aspect = std::sqrt(side[0] / side[1]);
    BestUniform best;
    int worse = 0;
    for (double cells = 3; worse < 3; cells *= 1.15) {
      worse = Take(CellCount(cells * aspect), CellCount(cells / aspect), best) ? 0 : worse + 1;
    }
    for (bool better = true; better;) {
      better = false;
      for (const auto& [du, dv] :
           {std::pair{1, 0}, {-1, 0}, {0, 1}, {0, -1}, {1, -1}, {-1, 1}, {-1, -1}}) {
        better |= Take(best.size_u - kDegree + du, best.size_v - kDegree + dv, best);
      }
    }
    return best;
  }

 private:
  static constexpr int kDegree = 3;

  static int CellCount(double cells) { return std::max(1, static_cast<int>(std::lround(cells))); }

  // Whether it is better than the best so far.
  bool Take(int cells_u, int cells_v, BestUniform& best) const {
    if (cells_u < 1 || cells_v < 1) return false;
    const auto basis = [&](int cells, int d) {
      return SplineBasis::Uniform(kDegree, cells + kDegree, low_[d], high_[d]);
    };
    bool better = false;
    for (const double smoothing : {1e-4, 1e-9}) {
      const FittingProblem problem(basis(cells_u, 0), basis(cells_v, 1), data_, smoothing);
      const NurbsSurface surface(
          problem.basis_u(), problem.basis_v(), SolveLinear(problem, pool_).coefficients);
      const SheetError error = ErrorAt(places_, surface, pool_);
      if (error.rms >= best.error.rms) continue;
      best = {surface.size_u(), surface.size_v(), error};
      better = true;
    }
    return better;
  }

  Eigen::Matrix3Xd places_;
  ThreadPool& pool_;
  Eigen::Vector2d low_, high_;
  std::shared_ptr<const FittingData> data_;
};

}  // namespace batten::internal
