// SPDX-License-Identifier: MIT
#include "fitting/foot_points/curve_distances.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "batten/geometry/knot_vectors.h"
#include "fitting/foot_points/curve_pieces.h"
#include "tolerances.h"

namespace batten::internal::curve_distances_test {

constexpr double kCertified = 2e-11;  // of the size: two answers, each within half of it

class Random {
 public:
  explicit Random(unsigned seed) : engine_(seed) {}
  double Between(double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(engine_);
  }
  double Normal() { return std::normal_distribution<double>()(engine_); }
  bool OneIn(int count) { return std::uniform_int_distribution<int>(1, count)(engine_) == 1; }
  int Int(int low, int high) { return std::uniform_int_distribution<int>(low, high)(engine_); }

 private:
  std::mt19937 engine_;
};

SplineBasis RandomBasis(int degree, Random& random) {
  std::vector<double> breaks{random.Between(-1, 1)};
  const int spans = random.Int(degree + 2, 30);
  for (int k = 0; k < spans; ++k) breaks.push_back(breaks.back() + random.Between(0.05, 1));
  if (random.OneIn(3)) return PeriodicKnots(degree, breaks);
  const SplineBasis smooth = SplineBasis::Clamped(degree, breaks);
  std::vector<double> knots;
  for (const double knot : smooth.knots()) {
    const bool corner = knot > smooth.lower() && knot < smooth.upper() && random.OneIn(6);
    knots.insert(knots.end(), corner ? static_cast<size_t>(degree) : 1, knot);
  }
  return SplineBasis(degree, knots);
}

// From calm to tangled.
template <int Dim>
NurbsCurve<Dim> RandomCurve(double scale, double origin, Random& random) {
  const SplineBasis basis = RandomBasis(random.Int(1, 9), random);
  const double wild = random.Between(0, 1.2);
  typename NurbsCurve<Dim>::Points net(Dim, basis.size());
  typename NurbsCurve<Dim>::Point place = NurbsCurve<Dim>::Point::Zero(),
                                  way = NurbsCurve<Dim>::Point::UnitX();
  for (Eigen::Index k = 0; k < net.cols(); ++k) {
    net.col(k) = (scale * place).array() + origin;
    for (int d = 0; d < Dim; ++d) way[d] += wild * random.Normal();
    way.normalize();
    place += random.Between(0.2, 1) * way;
  }
  if (basis.periodic()) net.rightCols(basis.degree()) = net.leftCols(basis.degree());
  return NurbsCurve<Dim>(basis, net);
}

template <int Dim>
struct Case {
  NurbsCurve<Dim> curve;
  Eigen::Matrix3Xd points;
  Eigen::VectorXd starts;
  double size;
};

template <int Dim>
Case<Dim> RandomCase(Random& random) {
  const double scale = std::pow(10, random.Between(-6, 6));
  const double origin = random.OneIn(4) ? 5e6 * scale : 0;
  const NurbsCurve<Dim> curve = RandomCurve<Dim>(scale, origin, random);
  const double noise = std::pow(10, random.Between(-5, 0.5)) * scale,
               slip = std::pow(10, random.Between(-6, 0));
  const Eigen::Index count = random.Int(1, 60);
  Case<Dim> made{curve, Eigen::Matrix3Xd::Zero(3, count), Eigen::VectorXd(count), 0};
  const double low = curve.basis().lower(), high = curve.basis().upper();
  for (Eigen::Index k = 0; k < count; ++k) {
    const double u = random.OneIn(10) ? low : random.Between(low, high);
    made.points.col(k).template head<Dim>() = curve.At(u);
    for (int d = 0; d < Dim; ++d) made.points(d, k) += noise * random.Normal();
    made.starts[k] = std::clamp(u + slip * random.Normal(), low, high);
  }
  const auto& net = curve.control_points();
  // Coordinates far from the origin are known to their rounding only.
  made.size = (net.rowwise().maxCoeff() - net.rowwise().minCoeff()).norm() + 1e-4 * origin;
  return made;
}

template <int Dim>
void ExpectNearestOfAll(unsigned seed) {
  Random random(seed);
  Case<Dim> made = RandomCase<Dim>(random);
  for (double& start : made.starts) {
    if (random.OneIn(20)) start = std::numeric_limits<double>::quiet_NaN();
  }
  ThreadPool pool(1);
  const PointDistances found = DistancesNear<Dim>(made.curve, made.points, made.starts, pool),
                       sought = DistancesTo<Dim>(made.curve, made.points, pool);
  for (Eigen::Index k = 0; k < made.points.cols(); ++k) {
    EXPECT_NEAR(found.distances[k], sought.distances[k], kCertified * made.size);
    const double there =
        (made.curve.At(found.parameters(0, k)) - made.points.col(k).template head<Dim>()).norm();
    EXPECT_NEAR(there, found.distances[k], kCertified * made.size);
  }
}

TEST(CurveDistancesTest, AreThoseOfTheNearestPointsOfAll) {
  for (unsigned seed = 1; seed <= 150; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ExpectNearestOfAll<2>(seed);
    ExpectNearestOfAll<3>(seed);
  }
}

template <int Dim>
void ExpectLocalMinima(unsigned seed) {
  Random random(seed);
  const Case<Dim> made = RandomCase<Dim>(random);
  if (!CurvePieces<Dim>::Covers(made.curve)) return;
  const CurvePieces<Dim> pieces(made.curve);
  const Eigen::Matrix<double, Dim, Eigen::Dynamic> points = made.points.template topRows<Dim>();
  Eigen::VectorXd feet(points.cols()), squares(points.cols());
  Eigen::VectorXi found(points.cols());
  LocalCurveFootPoints(pieces.table(),
                       points.data(),
                       made.starts.data(),
                       points.cols(),
                       {feet.data(), squares.data(), found.data()});
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (found[k] < 0) continue;
    const double u = feet[k];
    const CurveJet<Dim> jet = made.curve.JetAt(u);
    const Eigen::Matrix<double, Dim, 1> off = jet.point - points.col(k);
    EXPECT_NEAR(std::sqrt(squares[k]), off.norm(), kCertified * made.size);
    EXPECT_LE(off.norm(),
              (made.curve.At(made.starts[k]) - points.col(k)).norm() + kCertified * made.size);
    const SplineBasis& basis = made.curve.basis();
    if (u > basis.lower() && u < basis.upper() && basis.Multiplicity(u) > 0) continue;  // a corner
    // Perpendicular, but for the square of the last step; or an end that is nearer than the inside.
    const double slope = off.dot(jet.first), slack = kHalfDigits * made.size * jet.first.norm();
    if (u > made.curve.basis().lower()) {
      EXPECT_LE(slope, slack);
    }
    if (u < made.curve.basis().upper()) {
      EXPECT_GE(slope, -slack);
    }
  }
}

TEST(LocalCurveFootPointsTest, AreLocalMinimaBelowTheirStarts) {
  for (unsigned seed = 1; seed <= 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    ExpectLocalMinima<2>(seed);
    ExpectLocalMinima<3>(seed);
  }
}

TEST(LocalFootPointsKernelTest, DependNeitherOnThreadsNorOnOneAnother) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Case<3> made = RandomCase<3>(random);
    ThreadPool one(1), two(2);
    const Eigen::VectorXd feet =
        LocalFootPointsKernel<3>(made.curve, made.points, made.starts, one);
    EXPECT_EQ(feet, LocalFootPointsKernel<3>(made.curve, made.points, made.starts, two));
    for (Eigen::Index k = 0; k < feet.size(); ++k) {
      EXPECT_EQ(feet[k],
                LocalFootPointsKernel<3>(
                    made.curve, made.points.col(k), made.starts.segment(k, 1), one)[0]);
    }
  }
}

// A point nearer to the far side of a closed curve than to the side its start is on.
TEST(CurveDistancesTest, DoNotStayOnTheWrongSide) {
  const std::vector<double> breaks{0, 1, 2, 3, 4, 5, 6, 7, 8};
  const SplineBasis basis = PeriodicKnots(3, breaks);
  Eigen::Matrix2Xd net(2, basis.size());
  for (Eigen::Index k = 0; k < net.cols(); ++k) {
    const double angle = 2 * std::acos(-1.0) * static_cast<double>(k % 8) / 8;
    net.col(k) << 10 * std::cos(angle), std::sin(angle);
  }
  const NurbsCurve<2> flat(basis, net);
  ThreadPool pool(1);
  const Eigen::Matrix3Xd points = (Eigen::Matrix3Xd(3, 2) << 0, 0.3, 0.2, -0.2, 0, 0).finished();
  for (double start = 0; start < 8; start += 0.25) {
    const PointDistances found =
        DistancesNear<2>(flat, points, Eigen::Vector2d(start, start), pool);
    const PointDistances sought = DistancesTo<2>(flat, points, pool);
    EXPECT_LT((found.distances - sought.distances).cwiseAbs().maxCoeff(), kCertified * 20);
  }
}

}  // namespace batten::internal::curve_distances_test
