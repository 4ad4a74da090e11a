// SPDX-License-Identifier: MIT
// Over many draws of noise the truth lies within reported deviations as often as a normal law says.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>

#include "batten/fitting/fit_curve.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/uncertainty.h"
#include "batten/geometry/foot_point.h"

namespace batten {
namespace {

constexpr double kPi = std::numbers::pi;

// Places of a known shape, with noise of equal size in every coordinate.
struct KnownShape {
  const char* name;
  std::function<Eigen::Vector3d(double, double)> at;  // of [0, 1]²
  SurfaceFitOptions options;
  int points = 1600;
  double noise = 0.01;
};

SurfaceFitOptions With(std::pair<int, int> control_points, BaseShape base = BaseShape::kAuto) {
  SurfaceFitOptions options;
  options.control_points = control_points;
  options.base = base;
  options.threads = 1;
  options.trim = Trimming::kNone;
  options.optimize = FreeVariables{};
  return options;
}

std::vector<KnownShape> Shapes() {
  const auto ground = [](double s, double t) {
    return Eigen::Vector3d(10 * s, 8 * t, std::sin(4 * s) * std::cos(3 * t) + 2 * s * t);
  };
  const auto arch = [](double s, double t) {
    const double a = kPi * (s - 0.5) * 1.3, r = 4 + 0.3 * std::cos(3 * t + 2 * a);
    return Eigen::Vector3d(r * std::sin(a), 9 * t, r * std::cos(a));
  };
  const auto tube = [](double s, double t) {
    const double a = 2 * kPi * s, r = 3 + 0.2 * std::cos(2 * a) * std::sin(4 * t);
    return Eigen::Vector3d(r * std::cos(a), r * std::sin(a), 8 * t);
  };
  const auto wave = [](double s, double t) {
    return Eigen::Vector3d(6 * s, 6 * t, 0.8 * std::sin(5 * s + 2 * t));
  };
  SurfaceFitOptions quintic = With({9, 8});
  quintic.degree_u = quintic.degree_v = 5;
  KnownShape mirrored{"mirrored",
                      [](double s, double t) {
                        return Eigen::Vector3d(8 * s, 7 * t, std::cos(3 * (s - 0)) + 0.5 * t * t);
                      },
                      With({12, 8})};
  mirrored.options.symmetric = MirrorPlane{Eigen::Vector3d::UnitX(), 0};
  return {{"ground", ground, With({10, 9})},
          {"arch", arch, With({12, 10})},
          {"tube", tube, With({20, 9})},
          {"wave", wave, With({14, 10}, BaseShape::kPlane)},
          {"quintic", ground, quintic},
          mirrored};
}

PointCloud CloudOf(const KnownShape& shape, double noise, double outliers, std::uint64_t seed) {
  std::mt19937_64 places(7), random(seed);
  std::uniform_real_distribution<double> even(0, 1);
  std::normal_distribution<double> normal;
  Eigen::Matrix3Xd points(3, shape.points);
  for (int k = 0; k < shape.points; ++k) {
    const double s = even(places), t = even(places);
    points.col(k) = shape.at(s, t);
    if (even(random) < outliers) {
      for (double& x : points.col(k)) x += 200 * noise * (even(random) - 0.5);
    } else {
      for (double& x : points.col(k)) x += noise * normal(random);
    }
  }
  return PointCloud(points);
}

// The shape's height over a place of the truth, and what is said of it.
struct Found {
  double error, deviation;
};

Found At(const SurfaceFit& fit, const Uncertainty& uncertainty, const Eigen::Vector3d& place) {
  const SurfaceFoot foot = SurfaceFootPoints(fit.surface).Nearest(place);
  const Eigen::Vector3d normal = fit.surface.NormalAt(foot.u, foot.v).value();
  return {normal.dot(foot.point - place), uncertainty.At(foot.u, foot.v).deviation};
}

struct Coverage {
  std::array<double, 3> within{};  // shares within 1, 2, 3 deviations
  double ratio = 0;                // rms of error over deviation
};

// One place of twenty each draw, so that draws are independent; the bias of the shape space, which
// the fit of exact points shows, is taken away.
Coverage CoverageOf(const KnownShape& shape, int draws, double outliers = 0) {
  std::mt19937_64 random(3);
  std::uniform_real_distribution<double> inner(0.03, 0.97);
  std::vector<Eigen::Vector3d> places;
  for (int k = 0; k < 20; ++k) {
    const double s = inner(random);
    places.push_back(shape.at(s, inner(random)));
  }
  const PointCloud exact = CloudOf(shape, 0, 0, 1);
  SurfaceFitOptions plain = shape.options;
  plain.loss = Loss::kNone;
  const SurfaceFit unbiased = FitSurface(exact, plain);
  Coverage coverage;
  double squares = 0;
  for (int draw = 0; draw < draws; ++draw) {
    const Eigen::Vector3d& place = places[static_cast<size_t>(draw % 20)];
    const PointCloud cloud =
        CloudOf(shape, shape.noise, outliers, 100 + static_cast<std::uint64_t>(draw));
    const SurfaceFit fit = FitSurface(cloud, shape.options);
    const Uncertainty uncertainty(fit, cloud, 1);
    const Found found = At(fit, uncertainty, place);
    const SurfaceFoot foot = SurfaceFootPoints(unbiased.surface).Nearest(place);
    const Eigen::Vector3d normal = unbiased.surface.NormalAt(foot.u, foot.v).value();
    double bias = normal.dot(foot.point - place);
    if (const auto own = fit.surface.NormalAt(SurfaceFootPoints(fit.surface).Nearest(place).u,
                                              SurfaceFootPoints(fit.surface).Nearest(place).v);
        own && own->dot(normal) < 0)
      bias = -bias;
    const double z = (found.error - bias) / found.deviation;
    squares += z * z;
    for (int k = 0; k < 3; ++k) coverage.within[static_cast<size_t>(k)] += std::abs(z) <= k + 1;
  }
  for (double& share : coverage.within) share /= draws;
  coverage.ratio = std::sqrt(squares / draws);
  return coverage;
}

constexpr std::array<double, 3> kNormal = {0.6827, 0.9545, 0.9973};

void ExpectNormal(const Coverage& coverage, int draws, const char* name) {
  std::printf("%-10s %5.1f %5.1f %5.1f %%  rms of error over deviation %.3f\n",
              name,
              100 * coverage.within[0],
              100 * coverage.within[1],
              100 * coverage.within[2],
              coverage.ratio);
  for (size_t k = 0; k < 3; ++k) {
    const double deviation = std::sqrt(kNormal[k] * (1 - kNormal[k]) / draws);
    EXPECT_NEAR(coverage.within[k], kNormal[k], 3 * deviation) << name << ", " << k + 1;
  }
}

TEST(CoverageTest, TruthLiesWithinDeviationsAsOftenAsNormalLawSays) {
  KnownShape small = Shapes()[0];
  small.options.control_points = {6, 5};
  small.points = 400;
  ExpectNormal(CoverageOf(small, 150), 150, small.name);
}

TEST(LongCoverageTest, TruthLiesWithinDeviationsAsOftenAsNormalLawSays) {
  for (const KnownShape& shape : Shapes()) ExpectNormal(CoverageOf(shape, 500), 500, shape.name);
}

TEST(LongCoverageTest, RobustFitsCoverWithinFivePoints) {
  for (const KnownShape& shape : Shapes()) {
    const Coverage coverage = CoverageOf(shape, 500, 0.1);
    std::printf("%-10s %5.1f %5.1f %5.1f %%  with outliers\n",
                shape.name,
                100 * coverage.within[0],
                100 * coverage.within[1],
                100 * coverage.within[2]);
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(coverage.within[k], kNormal[k], 0.05) << shape.name;
  }
}

TEST(LongCoverageTest, JointFitsCoverWithinFivePoints) {
  for (KnownShape shape : Shapes()) {
    shape.options.optimize = FreeVariables{.parameters = true};
    const Coverage coverage = CoverageOf(shape, 500);
    std::printf("%-10s %5.1f %5.1f %5.1f %%  joint\n",
                shape.name,
                100 * coverage.within[0],
                100 * coverage.within[1],
                100 * coverage.within[2]);
    for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(coverage.within[k], kNormal[k], 0.05) << shape.name;
  }
}

// Plane curves: of each draw the height at one place.
Coverage CurveCoverage(bool closed, CurveFitOptions options, int draws) {
  const auto at = [&](double s) {
    const double a = closed ? 2 * kPi * s : 2 * s;
    const double r = closed ? 3 + 0.4 * std::cos(3 * a) : 0;
    return closed ? Eigen::Vector3d(r * std::cos(a), r * std::sin(a), 0)
                  : Eigen::Vector3d(5 * s, std::sin(2 * a), 0);
  };
  options.threads = 1;
  options.optimize = FreeVariables{};
  const auto cloud_of = [&](double noise, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    std::normal_distribution<double> normal;
    Eigen::Matrix3Xd points(3, 300);
    for (int k = 0; k < 300; ++k) {
      points.col(k) = at((k + (closed ? 0.0 : 0.5)) / 300.0);
      for (double& x : points.col(k).head<2>()) x += noise * normal(random);
    }
    return PointCloud(points, Eigen::Vector3d::Zero(), 2);
  };
  const CurveFit<2> exact = FitCurve<2>(cloud_of(0, 1), options);
  Coverage coverage;
  double squares = 0;
  for (int draw = 0; draw < draws; ++draw) {
    const Eigen::Vector3d place = at(0.03 + 0.94 * (draw % 20) / 19.0);
    const PointCloud cloud = cloud_of(0.004, 50 + static_cast<std::uint64_t>(draw));
    const CurveFit<2> fit = FitCurve<2>(cloud, options);
    const Uncertainty uncertainty(fit, cloud, 1);
    const auto height = [&](const CurveFit<2>& of, double& u) {
      const CurveFoot foot = CurveFootPoints<2>(of.curve).Nearest(place);
      u = foot.u;
      const Eigen::Vector2d along = of.curve.Derivatives(u, 1).col(1).normalized();
      const Eigen::Vector2d off = (foot.point - place).head<2>();
      return -along[1] * off[0] + along[0] * off[1];
    };
    double u = 0, other = 0;
    const double error = height(fit, u) - height(exact, other);
    const double z = error / uncertainty.At(u).deviation;
    squares += z * z;
    for (int k = 0; k < 3; ++k) coverage.within[static_cast<size_t>(k)] += std::abs(z) <= k + 1;
  }
  for (double& share : coverage.within) share /= draws;
  coverage.ratio = std::sqrt(squares / draws);
  return coverage;
}

TEST(LongCoverageTest, TruthLiesWithinDeviationsOfCurves) {
  CurveFitOptions options;
  options.parameterization = CurveParameterization::kChord;
  options.control_points = 12;
  options.closed = ClosedChoice::kNo;
  ExpectNormal(CurveCoverage(false, options, 500), 500, "open");
  options.control_points = 16;
  options.closed = ClosedChoice::kYes;
  // Knots are chosen among several layouts: within five points, as other searches.
  const Coverage closed = CurveCoverage(true, options, 500);
  for (size_t k = 0; k < 3; ++k) EXPECT_NEAR(closed.within[k], kNormal[k], 0.05);
}

}  // namespace
}  // namespace batten
