// SPDX-License-Identifier: MIT
#include "fitting/curve/curve_ends.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "random_splines.h"
#include "tolerances.h"

#include "batten/fitting/solve_linear.h"

namespace batten::internal::curve_ends_test {

// A straight curve of that length from the origin along a direction, over [0, 1] in `spans` spans;
// data at signed places along it, the first ones before its beginning, the last beyond its end.
struct Straight {
  SpanLayout layout;
  CorrectedFit fit;
};

Straight OnLine(int degree,
                int spans,
                double length,
                const std::vector<double>& places,
                const Eigen::VectorXd& weights = {}) {
  SpanLayout layout = SpanLayout::Equal(degree, spans, 0, 1, {}, false);
  const SplineBasis basis = layout.Basis();
  const Eigen::Vector2d direction(0.6, 0.8);
  auto data = std::make_shared<FittingData>();
  const auto count = static_cast<Eigen::Index>(places.size());
  data->parameters = Eigen::Matrix2Xd::Zero(2, count);
  data->values.resize(2, count);
  data->weights = weights;
  for (Eigen::Index k = 0; k < count; ++k) {
    const double place = places[static_cast<size_t>(k)];
    data->parameters(0, k) = std::clamp(place / length, 0.0, 1.0);
    data->values.col(k) = place * direction;
  }
  LinearSolution solution;
  solution.coefficients.resize(2, basis.size());
  for (int i = 0; i < basis.size(); ++i)
    solution.coefficients.col(i) = length * basis.Greville(i) * direction;
  FittingProblem problem(basis, std::move(data), 0);
  return {std::move(layout), {std::move(problem), std::move(solution), 1}};
}

// How far, in lengths, the ends moved outwards.
Eigen::Vector2d Moved(const Straight& given, double length, double noise, double spacing) {
  const SpanLayout loose = WithLooseEnds(given.layout, given.fit, noise, spacing);
  EXPECT_EQ(loose.spans(), given.layout.spans());
  EXPECT_EQ(loose.degree(), given.layout.degree());
  for (int k = 1; k < loose.spans(); ++k) {
    EXPECT_EQ(loose.breaks()[static_cast<size_t>(k)],
              given.layout.breaks()[static_cast<size_t>(k)]);
  }
  return length * Eigen::Vector2d(-loose.breaks().front(), loose.breaks().back() - 1);
}

void ExpectMoves(const Eigen::Vector2d& found, double lower, double upper, double length) {
  EXPECT_NEAR(found[0], lower, kRounding * length);
  EXPECT_NEAR(found[1], upper, kRounding * length);
}

TEST(WithLooseEndsTest, MovesEachEndByTheFarthestPointBeyondIt) {
  for (int degree = 1; degree <= 5; ++degree) {
    for (const double length : {1e-6, 1.0, 1e6}) {
      SCOPED_TRACE("degree " + std::to_string(degree) + ", length " + std::to_string(length));
      const Straight given = OnLine(degree,
                                    2,
                                    length,
                                    {-0.03 * length,
                                     -0.01 * length,
                                     0.2 * length,
                                     0.7 * length,
                                     1.04 * length,
                                     1.02 * length});
      ExpectMoves(Moved(given, length, 0, 0), 0.03 * length, 0.04 * length, length);
      ExpectMoves(Moved(given, length, 0, 0.005 * length), 0.035 * length, 0.045 * length, length);
      // Of two points.
      const double less = 0.7 * 0.01 * std::sqrt(2 * std::log(2.0));
      ExpectMoves(Moved(given, length, 0.01 * length, 0),
                  (0.03 - less) * length,
                  (0.04 - less) * length,
                  length);
    }
  }
}

TEST(WithLooseEndsTest, LeavesEndsThatNoPointLiesAt) {
  const Straight given = OnLine(3, 4, 1, {0.1, 0.5, 0.9});
  ExpectMoves(Moved(given, 1, 0, 0.01), 0, 0, 1);
}

TEST(WithLooseEndsTest, MovesNoEndInwards) {
  const Straight given = OnLine(3, 4, 1, {-0.01, 0.5, 1.01});
  ExpectMoves(Moved(given, 1, 10, 0), 0, 0, 1);
}

TEST(WithLooseEndsTest, MovesByAQuarterOfTheEndSpanAtMost) {
  const Straight given = OnLine(3, 4, 1, {-5, 0.5, 7});
  ExpectMoves(Moved(given, 1, 0, 0), 0.25 / 4, 0.25 / 4, 1);
}

TEST(WithLooseEndsTest, DoesNotLookAtPointsWithoutWeight) {
  const Straight given = OnLine(
      3, 2, 1, {-0.06, -0.02, 0.5, 1.01, 1.07}, (Eigen::VectorXd(5) << 0, 1, 1, 1, 0).finished());
  ExpectMoves(Moved(given, 1, 0, 0), 0.02, 0.01, 1);
}

TEST(WithLooseEndsTest, TakesNoPartFromPointsBesideTheCurve) {
  Straight given = OnLine(3, 2, 1, {-0.02, 0.5, 1.03});
  auto data = std::make_shared<FittingData>(given.fit.problem.data());
  // Across the direction.
  data->values.col(0) += 0.5 * Eigen::Vector2d(-0.8, 0.6);
  data->values.col(2) -= 0.5 * Eigen::Vector2d(-0.8, 0.6);
  given.fit.problem = given.fit.problem.WithData(data);
  ExpectMoves(Moved(given, 1, 0, 0), 0.02, 0.03, 1);
}

TEST(WithLooseEndsTest, LeavesACurveThatStandsStillAtItsEnds) {
  Straight given = OnLine(3, 2, 1, {-0.02, 0.5, 1.03});
  given.fit.solution.coefficients.setZero();
  ExpectMoves(Moved(given, 1, 0, 0.1), 0, 0, 1);
}

}  // namespace batten::internal::curve_ends_test
