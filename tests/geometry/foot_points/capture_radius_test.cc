// SPDX-License-Identifier: MIT
// Which stationary places are vouched for as the nearest of all, at a glance.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/insert_knots.h"
#include "random_splines.h"

namespace batten::internal::capture_radius_test {

// A V rounded at its bottom, the more sharply the higher the degree: heights c·|x| for control
// points over x, y in [-1, 1], x = 2u − 1, y = 2v − 1, in so many pieces of either direction.
NurbsSurface Trough(double c, int degree, int pieces) {
  Eigen::Matrix3Xd net(3, 2 * (degree + 1));
  for (int i = 0; i <= degree; ++i) {
    const double x = 2.0 * i / degree - 1;
    for (int j = 0; j < 2; ++j) net.col(2 * i + j) << x, 2 * j - 1, c * std::abs(x);
  }
  NurbsSurface surface(
      SplineBasis::Uniform(degree, degree + 1, 0, 1), SplineBasis::Uniform(1, 2, 0, 1), net);
  std::vector<double> knots;
  for (int k = 1; k < pieces; ++k) knots.push_back(static_cast<double>(k) / pieces);
  if (knots.empty()) return surface;
  return RefineKnots(RefineKnots(surface, Direction::kU, knots), Direction::kV, knots);
}

// The trough's profile: height and slope over x.
struct Profile {
  const NurbsSurface& trough;

  double Height(double x) const { return trough.At((x + 1) / 2, 0.5)[2]; }
  // Of half the squared distance to (a, h).
  double Slope(double x, double a, double h) const {
    const SurfaceJet jet = trough.JetAt((x + 1) / 2, 0.5);
    return (x - a) + jet.du[2] / 2 * (jet.point[2] - h);
  }
  double Distance(double x, double a, double h) const { return std::hypot(x - a, Height(x) - h); }
};

// Where that slope is zero in (-1, 1), between changes of its sign.
std::vector<double> Stationary(const Profile& profile, double a, double h) {
  constexpr int kSteps = 300;
  std::vector<double> roots;
  double before = profile.Slope(-1, a, h);
  for (int k = 1; k <= kSteps; ++k) {
    double low = -1 + 2.0 * (k - 1) / kSteps, high = -1 + 2.0 * k / kSteps;
    const double after = profile.Slope(high, a, h);
    const bool rises = before < 0, changes = rises != (after < 0);
    before = after;
    if (!changes) continue;
    for (int halving = 0; halving < 50; ++halving) {
      const double middle = (low + high) / 2;
      ((profile.Slope(middle, a, h) < 0) == rises ? low : high) = middle;
    }
    roots.push_back((low + high) / 2);
  }
  return roots;
}

// Above a trough's line of centres the bottom is no nearest place, and each wall has one of its
// own; below it every stationary place is the nearest.
TEST(CaptureRadiusTest, VouchesForNoStationaryPlaceThatIsNotTheNearest) {
  RandomSplines random(1);
  int stationary = 0, worse = 0, vouched = 0, near = 0;
  for (int round = 0; round < 200; ++round) {
    const double c = std::exp(random.Real(-1.5, 1.5));
    const int degree = 2 * random.Integer(1, 4), pieces = random.Integer(1, 6);
    SCOPED_TRACE(testing::Message() << "c " << c << ", degree " << degree << ", pieces " << pieces
                                    << ", round " << round);
    const NurbsSurface trough = Trough(c, degree, pieces);
    const Profile profile{trough};
    const SurfaceFootPoints feet(trough);
    for (int k = 0; k < 10; ++k) {
      const double a = random.Real(-0.6, 0.6) * std::pow(10.0, random.Real(-4, 0)),
                   y = random.Real(-0.9, 0.9);
      const double above = random.Real(-1, 1) * std::pow(10.0, random.Real(-3, 0.2));
      const double h = profile.Height(a) + (k % 2 == 0 ? std::abs(above) : above);
      const std::vector<double> roots = Stationary(profile, a, h);
      double least = std::min(profile.Distance(-1, a, h), profile.Distance(1, a, h));
      for (const double x : roots) least = std::min(least, profile.Distance(x, a, h));
      for (const double x : roots) {
        ++stationary;
        const double distance = profile.Distance(x, a, h);
        const bool nearest = distance <= least + 1e-9;
        worse += nearest ? 0 : 1;
        const bool sure = feet.SurelyNearest({a, y, h}, (x + 1) / 2, (y + 1) / 2);
        near += nearest && distance < 0.02 ? 1 : 0;
        vouched += sure && distance < 0.02 ? 1 : 0;
        ASSERT_TRUE(nearest || !sure) << "a " << a << ", y " << y << ", h " << h << ", x " << x;
      }
    }
  }
  EXPECT_GT(worse, stationary / 20);
  EXPECT_GT(vouched, near / 5);  // a quarter, at bottoms as sharp as these
  EXPECT_GT(near, 500);
}

}  // namespace batten::internal::capture_radius_test
