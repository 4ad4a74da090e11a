// SPDX-License-Identifier: MIT
// Curves that leave their data between them, or go on beyond them.
#include "fitting/curve/overshoot.h"

#include <gtest/gtest.h>

#include <cmath>
#include <memory>

#include "batten/fitting/fit_curve.h"
#include "dense_samples.h"
#include "fitting/curve/curve_cut.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::overshoot_test {

// Points of a curve at the parameters.
FittingProblem On(const NurbsCurve<2>& curve, const Eigen::VectorXd& u) {
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, u.size());
  data->parameters.row(0) = u;
  data->values.resize(2, u.size());
  for (Eigen::Index k = 0; k < u.size(); ++k) data->values.col(k) = curve.At(u[k]);
  return FittingProblem(curve.basis(), std::move(data), 0);
}

NurbsCurve<2> Bulge(double height) {
  Eigen::Matrix2Xd net(2, 10);
  for (int i = 0; i < 10; ++i) net.col(i) << i, 0;
  net(1, 5) = height;
  return NurbsCurve<2>(SplineBasis::Uniform(3, 10, 0, 1), net);
}

TEST(HasOvershootTest, TellsABulgeThatNoDatumHolds) {
  Eigen::VectorXd beside(20);
  beside << Eigen::VectorXd::LinSpaced(10, 0, 0.38), Eigen::VectorXd::LinSpaced(10, 0.75, 1);
  const auto overshoots = [&](double height, const Eigen::VectorXd& u) {
    const NurbsCurve<2> curve = Bulge(height);
    return HasOvershoot(On(curve, u), curve.control_points(), {}, 0);
  };
  EXPECT_FALSE(overshoots(1, beside));  // not higher than the gap is wide
  EXPECT_TRUE(overshoots(50, beside));
  EXPECT_FALSE(overshoots(50, Eigen::VectorXd::LinSpaced(400, 0, 1)));  // where data follow it
}

// Many data at either end of a span each: the rest of both is extrapolation.
TEST(HasOvershootTest, TellsAKneeBetweenDataAtBothEnds) {
  for (int degree = 1; degree <= 5; ++degree) {
    SCOPED_TRACE(degree);
    const SplineBasis basis = SplineBasis::Uniform(degree, 2 + degree, 0, 1);  // two spans
    Eigen::Matrix2Xd net = Eigen::Matrix2Xd::Zero(2, basis.size());
    for (int i = 0; i < basis.size(); ++i) net.col(i) << basis.Greville(i), 0;
    Eigen::VectorXd u(80);
    u << Eigen::VectorXd::LinSpaced(40, 0, 0.24), Eigen::VectorXd::LinSpaced(40, 0.76, 1);
    const NurbsCurve<2> straight(basis, net);
    EXPECT_FALSE(HasOvershoot(On(straight, u), straight.control_points(), {}, 0));
    net.rightCols(net.cols() - 1).leftCols(net.cols() - 2).row(1).setConstant(30);
    const NurbsCurve<2> knee(basis, net);
    const FittingProblem few = On(straight, u);
    EXPECT_TRUE(HasOvershoot(few, knee.control_points(), {}, 0));
  }
}

TEST(HasOvershootTest, TellsAnEndBeyondTheData) {
  const NurbsCurve<2> curve = Bulge(0);
  EXPECT_FALSE(
      HasOvershoot(On(curve, Eigen::VectorXd::LinSpaced(15, 0, 1)), curve.control_points(), {}, 0));
  EXPECT_TRUE(HasOvershoot(
      On(curve, Eigen::VectorXd::LinSpaced(15, 0.3, 1)), curve.control_points(), {}, 0));
}

// A line whose short last spans run on, or back between the last two data.
TEST(TurnsBackTest, TellsAFoldBetweenData) {
  const SplineBasis basis(3, {0, 0, 0, 0, 0.25, 0.5, 0.75, 0.9, 0.96, 1, 1, 1, 1});
  Eigen::Matrix2Xd net = Eigen::Matrix2Xd::Zero(2, basis.size());
  for (int i = 0; i < basis.size(); ++i) net(0, i) = basis.Greville(i);
  const FittingProblem data = On(NurbsCurve<2>(basis, net), Eigen::VectorXd::LinSpaced(11, 0, 1));
  EXPECT_FALSE(TurnsBack(data, net, 0));
  net(0, basis.size() - 2) -= 0.02;
  EXPECT_FALSE(TurnsBack(data, net, 0));
  net(0, basis.size() - 2) -= 0.08;
  EXPECT_TRUE(TurnsBack(data, net, 0));
  EXPECT_FALSE(HasOvershoot(data, net, {}, 0));  // it is nowhere far from its data
  EXPECT_FALSE(TurnsBack(data, net, 0.1));       // data of such noise do so themselves
}

// Between data on either side of a corner a curve may run against their chord, for as long as it
// likes.
TEST(TurnsBackTest, LeavesCornersAlone) {
  const SplineBasis corner(1, {0, 0, 0.5, 1, 1});
  Eigen::Matrix2Xd net(2, 3);
  net << 0, 1, 0.2, 0, 0, 0.01;
  Eigen::VectorXd u(5);
  u << 0, 0.2, 0.45, 0.8, 1;
  EXPECT_FALSE(TurnsBack(On(NurbsCurve<2>(corner, net), u), net, 0));
  // The same way without one.
  const SplineBasis smooth(2, {0, 0, 0, 0.5, 1, 1, 1});
  Eigen::Matrix2Xd round(2, 4);
  round << 0, 1, 1, 0.2, 0, 0, 0.01, 0.01;
  EXPECT_TRUE(TurnsBack(On(NurbsCurve<2>(smooth, round), u), round, 0));
}

// Nothing holds a curve of few points between them, nor its end between the last two.
TEST(FitCurveTest, RunsOnBetweenFewExactPoints) {
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int count = seed == 0 ? 51 : random.Integer(40, 99);
    const double turns = seed == 0 ? 10 : random.Integer(60, 140) / 10.0,
                 height = seed == 0 ? 0.2 : random.Integer(5, 40) / 100.0,
                 from = seed == 0 ? 0 : random.Integer(0, 60) / 10.0;
    Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, count);
    for (int k = 0; k < count; ++k) {
      const double x = k / (count - 1.0);
      points.col(k) << float(x), float(height * std::sin(turns * x + from)), 0;
    }
    const CurveFit<3> fit = FitCurve<3>(PointCloud::FromWorld(points));
    const SplineBasis& basis = fit.curve.basis();
    double back = 0, last = fit.curve.At(basis.lower())[0];
    for (int k = 1; k <= 4000; ++k) {
      const double x = fit.curve.At(
          basis.Clamp(basis.lower() + (basis.upper() - basis.lower()) * k / 4000.0))[0];
      back += std::max(0.0, last - x);
      last = x;
    }
    EXPECT_LE(back * (count - 1), 0.05);  // spacings
  }
}

TEST(SampledSizeTest, IsThatOfTheBox) {
  EXPECT_NEAR(SampledSize(Bulge(0).basis(), Bulge(0).control_points(), Eigen::VectorXd::Ones(10)),
              9,
              kRounding * 9);
}

TEST(CutToDataTest, LeavesTheShapeAndEndsAtTheData) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsCurve<2> curve = random.Curve<2>(random.Integer(1, 6), true);
    const SplineBasis& basis = curve.basis();
    if (basis.periodic()) continue;
    const double length = basis.upper() - basis.lower();
    const std::vector<int> spans = basis.Spans();
    const double first =
        basis.lower() +
        0.5 * (basis.knots()[static_cast<size_t>(spans.front()) + 1] - basis.lower());
    const Eigen::VectorXd u = Eigen::VectorXd::LinSpaced(30, first, basis.upper());
    if (!(first < basis.upper() - 1e-3 * length)) continue;
    const FittingProblem problem = On(curve, u);
    const auto cut = CutToData(curve, problem.data());
    ASSERT_TRUE(cut);
    EXPECT_EQ(cut->curve.basis().lower(), basis.lower());
    EXPECT_EQ(cut->curve.basis().upper(), basis.upper());
    const double size = curve.control_points().cwiseAbs().maxCoeff();
    for (Eigen::Index k = 0; k < u.size(); ++k) {
      EXPECT_LT((cut->curve.At(cut->parameters(0, k)) - problem.data().values.col(k)).norm(),
                kIterated * size);
    }
    EXPECT_LT((cut->curve.At(basis.lower()) - curve.At(first)).norm(), kIterated * size);
  }
}

TEST(CutToDataTest, GivesUpWhereASpanWouldBeLost) {
  const NurbsCurve<2> curve = Bulge(1);
  EXPECT_FALSE(CutToData(curve, On(curve, Eigen::VectorXd::LinSpaced(9, 0.5, 1)).data()));
  const auto whole = CutToData(curve, On(curve, Eigen::VectorXd::LinSpaced(9, 0, 1)).data());
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->curve, curve);
}

// Points in clumps are many and yet at few places: no curve flies off between them.
TEST(FitCurveTest, StaysNearTheBoxOfClumpedPoints) {
  int fitted = 0;
  for (unsigned seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int places = random.Integer(2, 6), each = random.Integer(3, 8);
    const double noise = std::pow(10.0, random.Integer(-6, -3));
    Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, Eigen::Index{places} * each);
    for (int k = 0; k < places * each; ++k) {
      const double t = double(k / each) / places;
      points.col(k) = Eigen::Vector3d(t, seed % 2 ? t * t : std::sin(9 * t), 0);
      points.col(k) += random.Vector(noise);
    }
    const PointCloud cloud = PointCloud::FromWorld(points);
    CurveFitOptions options;
    options.threads = 1;
    options.degree = random.Integer(1, 9);
    if (random.Coin()) options.optimize = FreeVariables{true, random.Coin(), false};
    if (random.Coin()) options.tolerance = noise;
    try {
      const CurveFit<3> fit = FitCurve<3>(cloud, options);
      ++fitted;
      const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
      double beyond = 0;
      for (int k = 0; k <= 2000; ++k) {
        const SplineBasis& basis = fit.curve.basis();
        const Eigen::Vector3d place =
            fit.curve.At(basis.Clamp(basis.lower() + (basis.upper() - basis.lower()) * k / 2000.0));
        beyond = std::max(beyond, (low - place).cwiseMax(place - high).maxCoeff());
      }
      EXPECT_LE(beyond, 0.5 * (high - low).norm());
    } catch (const std::invalid_argument&) {  // refused
    }
  }
  EXPECT_GT(fitted, 20);
}

}  // namespace batten::internal::overshoot_test
