// SPDX-License-Identifier: MIT
// The user's own terms in whole fits of curves.
#include <gtest/gtest.h>

#include <cmath>
#include <memory>
#include <random>
#include <utility>

#include "batten/fitting/fit_curve.h"
#include "placed_term.h"

namespace batten::internal::fit_curve_terms_test {

constexpr double kHeavy = 1e3;    // squared beside some hundred points of weight 1
constexpr double kMissed = 1e-4;  // 1e6 pulls against hundreds of points times their residuals

// A noisy arc far from the origin.
PointCloud Arc(int dimension) {
  std::mt19937_64 engine(3);
  std::normal_distribution<double> noise(0, 1e-3);
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, 400);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const double t = 3 * static_cast<double>(k) / 399;
    points.col(k) << 1e4 + std::cos(t) + noise(engine), 2e4 + std::sin(t) + noise(engine),
        dimension == 3 ? 0.2 * t + noise(engine) : 0;
  }
  return PointCloud::FromWorld(std::move(points), dimension);
}

template <int Dim>
void ExpectMovedControlPoint(CurveFitOptions options) {
  using Point = Eigen::Matrix<double, Dim, 1>;
  Point place = Point::Zero();
  options.corners = false;
  options.threads = 2;
  options.terms = [&](const SplineBasis& basis,
                      const Eigen::MatrixXd& control_points) -> ResidualTerms {
    EXPECT_EQ(basis.size(), control_points.cols());
    place = control_points.col(2) + 0.02 * Point::Ones();
    return {std::make_shared<PlacedTerm>(2, place, kHeavy)};
  };
  const CurveFit<Dim> fit = FitCurve<Dim>(Arc(Dim), options);
  EXPECT_TRUE(fit.report.optimize.ran) << fit.report.optimize.why;
  EXPECT_LT((fit.curve.control_points().col(2) - place).norm(), kMissed);
  EXPECT_LT((place - Point(Arc(Dim).World(200).template head<Dim>())).norm(), 3);
}

TEST(FitCurveTermsTest, ATermIsMetInWorldCoordinates) {
  ExpectMovedControlPoint<2>({});
  ExpectMovedControlPoint<3>({});
}

TEST(FitCurveTermsTest, ATermIsMetWhereParametersStay) {
  CurveFitOptions options;
  options.distance = CurveDistance::kParameter;
  ExpectMovedControlPoint<3>(options);
}

TEST(FitCurveTermsTest, CoordinatesAreThoseOfTheResult) {
  CurveFitOptions options;
  options.control_points = 8;
  Eigen::Vector2d place = Eigen::Vector2d::Zero();
  options.shift = Eigen::Vector3d(1e4, 2e4, 0);
  options.terms = [&](const SplineBasis&, const Eigen::MatrixXd& points) -> ResidualTerms {
    place = points.col(2);
    place[1] += 0.02;
    return {std::make_shared<PlacedTerm>(2, place, kHeavy)};
  };
  const CurveFit<2> fit = FitCurve<2>(Arc(2), options);
  EXPECT_LT(place.norm(), 3);
  EXPECT_LT((fit.curve.control_points().col(2) - place).norm(), kMissed);
}

}  // namespace batten::internal::fit_curve_terms_test
