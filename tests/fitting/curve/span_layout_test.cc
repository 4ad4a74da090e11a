// SPDX-License-Identifier: MIT
#include "fitting/curve/span_layout.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <stdexcept>
#include <string>
#include <vector>

#include "fitting/linear/coefficient_order.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::span_layout_test {

// Random breaks, some of them corners, a closed one's seam too.
SpanLayout RandomLayout(RandomSplines& random, int degree, bool closed) {
  std::vector<double> breaks{random.Real(-3, 3)}, corners;
  const int spans = random.Integer(1, 12);
  for (int k = 0; k < spans; ++k) breaks.push_back(breaks.back() + random.Logarithmic(1e-3, 1));
  for (int k = closed ? 0 : 1; k < spans; ++k) {
    if (random.Integer(0, 3) == 0) corners.push_back(breaks[static_cast<size_t>(k)]);
  }
  return SpanLayout(degree, breaks, corners, closed);
}

void ForRandomLayouts(const std::function<void(RandomSplines&, const SpanLayout&)>& law) {
  for (unsigned seed = 0; seed < 300; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int degree = random.Integer(1, 7);
    const bool closed = random.Coin();
    law(random, RandomLayout(random, degree, closed));
    if (testing::Test::HasFailure()) return;
  }
}

bool IsCornerAt(const SpanLayout& layout, double at) {
  return std::find(layout.corners().begin(), layout.corners().end(), at) != layout.corners().end();
}

// How often a value stands in the knots, to rounding: a period later knots are sums.
int Times(const SplineBasis& basis, double at) {
  const double near = kRounding * (std::abs(basis.lower()) + std::abs(basis.upper()));
  return static_cast<int>(std::count_if(basis.knots().begin(),
                                        basis.knots().end(),
                                        [&](double knot) { return std::abs(knot - at) <= near; }));
}

TEST(SpanLayoutTest, CountsTheControlPointsOfItsBasisThatDiffer) {
  ForRandomLayouts([](RandomSplines&, const SpanLayout& layout) {
    EXPECT_EQ(layout.control_points(), DistinctCount(layout.Basis()));
    EXPECT_EQ(layout.spans(), static_cast<int>(layout.Basis().Spans().size()));
  });
}

TEST(SpanLayoutTest, HasKnotsAtItsBreaksAndFullOnesAtItsCorners) {
  ForRandomLayouts([](RandomSplines&, const SpanLayout& layout) {
    const SplineBasis basis = layout.Basis();
    EXPECT_EQ(basis.degree(), layout.degree());
    EXPECT_EQ(basis.periodic(), layout.closed());
    EXPECT_EQ(basis.lower(), layout.breaks().front());
    EXPECT_EQ(basis.upper(), layout.breaks().back());
    for (int k = 0; k <= layout.spans(); ++k) {
      const double at = layout.breaks()[static_cast<size_t>(k)];
      const bool end = k == 0 || k == layout.spans();
      const double front = layout.breaks().front();
      const bool corner = IsCornerAt(layout, layout.closed() && end ? front : at);
      EXPECT_EQ(layout.IsCorner(k), corner) << k;
      const int expected = end && !layout.closed() ? layout.degree() + 1
                           : corner                ? layout.degree()
                                                   : 1;
      EXPECT_EQ(Times(basis, at), expected) << k;
    }
  });
}

TEST(SpanLayoutTest, FindsTheSpanThatHoldsAParameter) {
  ForRandomLayouts([](RandomSplines& random, const SpanLayout& layout) {
    const std::vector<double>& breaks = layout.breaks();
    for (int k = 0; k < 20; ++k) {
      const double u = random.Real(breaks.front(), breaks.back());
      const auto span = static_cast<size_t>(layout.SpanOf(u));
      EXPECT_LE(breaks[span], u);
      EXPECT_LE(u, breaks[span + 1]);
    }
    for (int k = 0; k <= layout.spans(); ++k)
      EXPECT_EQ(layout.SpanOf(breaks[static_cast<size_t>(k)]), std::min(k, layout.spans() - 1));
    EXPECT_EQ(layout.SpanOf(breaks.front() - 1), 0);
    EXPECT_EQ(layout.SpanOf(breaks.back() + 1), layout.spans() - 1);
  });
}

TEST(SpanLayoutTest, HalvesTheSpansThatAreSet) {
  ForRandomLayouts([](RandomSplines& random, const SpanLayout& layout) {
    std::vector<bool> where(static_cast<size_t>(layout.spans()));
    for (size_t k = 0; k < where.size(); ++k) where[k] = random.Coin();
    const SpanLayout halved = layout.Halved(where);
    size_t at = 0;
    for (size_t k = 0; k < where.size(); ++k) {
      const double from = layout.breaks()[k], to = layout.breaks()[k + 1];
      EXPECT_EQ(halved.breaks()[at++], from);
      if (!where[k]) continue;
      EXPECT_NEAR(halved.breaks()[at++], (from + to) / 2, kRounding * (1 + to - from));
    }
    EXPECT_EQ(halved.breaks()[at], layout.breaks().back());
    EXPECT_EQ(at + 1, halved.breaks().size());
    EXPECT_EQ(halved.corners(), layout.corners());
    EXPECT_EQ(halved.closed(), layout.closed());
  });
}

TEST(SpanLayoutTest, DoesNotHalveWhatHasNoMiddle) {
  const double next = std::nextafter(1.0, 2.0);
  const SpanLayout layout(3, {0, 1, next, 2}, {}, false);
  const SpanLayout halved = layout.Halved({false, true, false});
  EXPECT_EQ(halved.breaks(), layout.breaks());
}

TEST(SpanLayoutTest, LosesTheBreakThatItIsToLose) {
  ForRandomLayouts([](RandomSplines&, const SpanLayout& layout) {
    for (int k = 1; k < layout.spans(); ++k) {
      if (layout.IsCorner(k)) {
        EXPECT_THROW(layout.Without(k), std::invalid_argument);
        continue;
      }
      const SpanLayout fewer = layout.Without(k);
      std::vector<double> expected = layout.breaks();
      expected.erase(expected.begin() + k);
      EXPECT_EQ(fewer.breaks(), expected);
      EXPECT_EQ(fewer.corners(), layout.corners());
      EXPECT_EQ(fewer.control_points(), layout.control_points() - 1);
    }
  });
}

int Pieces(const SpanLayout& layout) {
  int pieces = 1;
  for (int k = 1; k < layout.spans(); ++k) pieces += layout.IsCorner(k) ? 1 : 0;
  return pieces;
}

TEST(SpanLayoutTest, HasTheSpansAskedForWhenResampled) {
  ForRandomLayouts([](RandomSplines& random, const SpanLayout& layout) {
    const int pieces = Pieces(layout);
    for (const int spans : {1, pieces, pieces + 1, layout.spans(), random.Integer(1, 60), 200}) {
      const SpanLayout other = layout.Resampled(spans);
      EXPECT_EQ(other.spans(), std::max(pieces, spans)) << spans;
      EXPECT_EQ(other.corners(), layout.corners());
      EXPECT_EQ(other.breaks().front(), layout.breaks().front());
      EXPECT_EQ(other.breaks().back(), layout.breaks().back());
      EXPECT_EQ(other.closed(), layout.closed());
    }
  });
}

// Breaks at equal steps of the count: between two corners no span holds more than the count over
// the spans there, and one.
TEST(SpanLayoutTest, StaysWhereItIsWhenResampledToItsOwnNumber) {
  ForRandomLayouts([](RandomSplines&, const SpanLayout& layout) {
    const SpanLayout same = layout.Resampled(layout.spans());
    if (Pieces(layout) == layout.spans()) return;  // then lengths decide
    for (int k = 0; k <= layout.spans(); ++k) {
      const auto i = static_cast<size_t>(k);
      EXPECT_NEAR(same.breaks()[i], layout.breaks()[i], kRounding * 10);
    }
  });
}

TEST(SpanLayoutTest, KeepsItsBreaksAmongTwiceAsMany) {
  ForRandomLayouts([](RandomSplines& random, const SpanLayout& layout) {
    if (Pieces(layout) == layout.spans() && layout.spans() > 1) return;
    const int times = random.Integer(2, 5);
    const SpanLayout finer = layout.Resampled(times * layout.spans());
    for (int k = 0; k <= layout.spans(); ++k) {
      EXPECT_NEAR(finer.breaks()[static_cast<size_t>(times * k)],
                  layout.breaks()[static_cast<size_t>(k)],
                  kRounding * 10);
    }
  });
}

TEST(SpanLayoutTest, IsAsEvenAsItsCornersAllow) {
  for (unsigned seed = 0; seed < 200; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const double lower = random.Real(-5, 5), upper = lower + random.Logarithmic(1e-3, 1e3);
    const bool closed = random.Coin();
    std::vector<double> corners;
    for (int k = random.Integer(0, 4); k > 0; --k) corners.push_back(random.Real(lower, upper));
    if (closed && random.Coin()) corners.push_back(lower);
    std::shuffle(corners.begin(), corners.end(), std::mt19937(seed));
    const int degree = random.Integer(1, 5), asked = random.Integer(1, 80);
    const SpanLayout layout = SpanLayout::Equal(degree, asked, lower, upper, corners, closed);
    std::sort(corners.begin(), corners.end());
    EXPECT_EQ(layout.corners(), corners);
    EXPECT_EQ(layout.spans(), std::max(asked, Pieces(layout)));
    EXPECT_EQ(layout.breaks().front(), lower);
    EXPECT_EQ(layout.breaks().back(), upper);
    // Within a piece all are equal; a piece of many has spans near the mean.
    const double mean = (upper - lower) / layout.spans();
    size_t begin = 0;
    for (size_t k = 1; k < layout.breaks().size(); ++k) {
      if (k + 1 < layout.breaks().size() && !layout.IsCorner(static_cast<int>(k))) continue;
      const double width =
          (layout.breaks()[k] - layout.breaks()[begin]) / static_cast<double>(k - begin);
      for (size_t i = begin; i < k; ++i)
        EXPECT_NEAR(layout.breaks()[i + 1] - layout.breaks()[i],
                    width,
                    kRounding * (upper - lower) * 10 + kRounding * std::abs(lower) * 10);
      if (k - begin >= 4) {
        EXPECT_LE(width, 2 * mean);
        EXPECT_GE(width, mean / 2);
      }
      begin = k;
    }
  }
}

TEST(SpanLayoutTest, TakesCornersInAnyOrderAndOnlyOnce) {
  const SpanLayout layout(3, {0, 1, 2, 3}, {2, 1, 2}, false);
  EXPECT_EQ(layout.corners(), (std::vector<double>{1, 2}));
  EXPECT_EQ(layout.control_points(), 3 + 3 + 2 * 2);
}

TEST(SpanLayoutTest, RefusesWhatIsNoLayout) {
  const std::vector<double> breaks{0, 1, 2};
  EXPECT_THROW(SpanLayout(3, {}, {}, false), std::invalid_argument);
  EXPECT_THROW(SpanLayout(3, {1}, {}, true), std::invalid_argument);
  EXPECT_THROW(SpanLayout(3, {0, 1, 1}, {}, false), std::invalid_argument);
  EXPECT_THROW(SpanLayout(3, {0, 2, 1}, {}, false), std::invalid_argument);
  EXPECT_THROW(SpanLayout(3, {0, std::nan(""), 1}, {}, false), std::invalid_argument);
  EXPECT_THROW(SpanLayout(3, breaks, {0.5}, false), std::invalid_argument);
  EXPECT_THROW(SpanLayout(3, breaks, {std::nan("")}, false), std::invalid_argument);
  // The ends of an open curve are no corners; the seam of a closed one may be, by its first name.
  EXPECT_THROW(SpanLayout(3, breaks, {0}, false), std::invalid_argument);
  EXPECT_THROW(SpanLayout(3, breaks, {2}, false), std::invalid_argument);
  EXPECT_NO_THROW(SpanLayout(3, breaks, {0}, true));
  EXPECT_THROW(SpanLayout::Equal(3, 4, 1, 1, {}, false), std::invalid_argument);
  EXPECT_THROW(SpanLayout::Equal(3, 4, 0, 1, {2}, false), std::invalid_argument);
}

}  // namespace batten::internal::span_layout_test
