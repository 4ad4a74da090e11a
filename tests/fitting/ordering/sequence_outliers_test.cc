// SPDX-License-Identifier: MIT
#include "fitting/ordering/sequence_outliers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "ordered_curves.h"

namespace batten::internal::sequence_outliers_test {

double MeanStep(const Eigen::Matrix3Xd& points) {
  const Eigen::Index steps = points.cols() - 1;
  return (points.rightCols(steps) - points.leftCols(steps)).colwise().norm().mean();
}

struct Spoilt {
  Eigen::Matrix3Xd points;
  std::vector<Eigen::Index> moved;
};

// A share of the points, `run` in a row, moved to anywhere in the box around all.
Spoilt Strewn(NoisyPoints& random, const Eigen::Matrix3Xd& points, double share, int run) {
  const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  const double size = (high - low).norm();
  Spoilt result{points, {}};
  for (Eigen::Index k = 0; k + run <= points.cols(); ++k) {
    if (random.Real(0, 1) > share / (run - (run - 1) * share)) continue;
    Eigen::Vector3d place;
    for (int d = 0; d < 3; ++d) place[d] = random.Real(low[d], high[d]);
    for (int j = 0; j < run; ++j, ++k) {
      result.points.col(k) = place + 0.01 * size * Eigen::Vector3d(random.Normal(), 0, 0);
      result.moved.push_back(k);
    }
    --k;
  }
  return result;
}

// A share of the points moved by ± `offset` to the side.
Spoilt Offset(NoisyPoints& random, const Eigen::Matrix3Xd& points, double share, double offset) {
  Spoilt result{points, {}};
  for (Eigen::Index k = 1; k + 1 < points.cols(); ++k) {
    if (random.Real(0, 1) > share) continue;
    const Eigen::Vector3d along = points.col(k + 1) - points.col(k - 1);
    const Eigen::Vector3d aside = Eigen::Vector3d(-along[1], along[0], 0).normalized();
    result.points.col(k) += (random.Integer(0, 1) == 1 ? offset : -offset) * aside;
    result.moved.push_back(k);
  }
  return result;
}

struct Score {
  Eigen::Index far = 0, found = 0, clean = 0, wrong = 0;

  // Strays count that lie farther than `least` from every point of the true curve.
  void Add(const PointMask& sequence_outliers,
           const Spoilt& spoilt,
           const Eigen::Matrix3Xd& truth,
           double least) {
    std::vector<bool> moved(static_cast<size_t>(sequence_outliers.size()), false);
    for (const Eigen::Index k : spoilt.moved) {
      moved[static_cast<size_t>(k)] = true;
      const double squared =
          (truth.colwise() - spoilt.points.col(k)).colwise().squaredNorm().minCoeff();
      if (squared <= least * least) continue;
      ++far;
      if (sequence_outliers[k]) ++found;
    }
    for (Eigen::Index k = 0; k < sequence_outliers.size(); ++k) {
      if (moved[static_cast<size_t>(k)]) continue;
      ++clean;
      if (sequence_outliers[k]) ++wrong;
    }
  }
};

// Dense arcs at three corners of a rectangle, a sharp fourth one, ends only along the sides.
Eigen::Matrix3Xd Plate(double w, double h, double r, int steps) {
  std::vector<Eigen::Vector3d> places;
  for (int corner = 0; corner < 3; ++corner) {
    const Eigen::Vector3d middle(corner == 0 ? w - r : r, corner < 2 ? h - r : r, 0);
    for (int k = 0; k <= steps; ++k) {
      const double angle = 0.5 * std::numbers::pi * (corner + static_cast<double>(k) / steps);
      places.emplace_back(middle + r * OnCircle(angle));
    }
  }
  places.emplace_back(w, 0, 0);
  Eigen::Matrix3Xd points(3, static_cast<Eigen::Index>(places.size()));
  for (size_t k = 0; k < places.size(); ++k) points.col(static_cast<Eigen::Index>(k)) = places[k];
  return points;
}

TEST(FindSequenceOutliersTest, KeepsExactPointsOfCoarseAndSharpCurves) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    NoisyPoints random(seed);
    const int count = random.Integer(20, 80);
    const Eigen::Matrix3Xd ellipse =
        Ellipse(count, random.Real(1, 4), 1, random.Real(0, 2 * std::numbers::pi));
    EXPECT_EQ(FindSequenceOutliers(ellipse, true).count(), 0);
    EXPECT_EQ(FindSequenceOutliers(ellipse, false).count(), 0);
    const Eigen::Matrix3Xd blunt = Airfoil(count / 2, -0.1015), sharp = Airfoil(count, -0.1036);
    EXPECT_EQ(FindSequenceOutliers(blunt, false).count(), 0);
    EXPECT_EQ(FindSequenceOutliers(sharp.leftCols(2 * count), true).count(), 0);
    const Eigen::Matrix3Xd zigzag =
        Zigzag(random.Integer(3, 12), random.Integer(1, 20), random.Real(0.3, 6));
    EXPECT_EQ(FindSequenceOutliers(zigzag, false).count(), 0);
    EXPECT_EQ(FindSequenceOutliers(Spiral(4 * count, random.Real(1, 5)), false).count(), 0);
    const Eigen::Matrix3Xd plate = Plate(
        random.Real(0.5, 20), random.Real(0.5, 20), random.Real(0.05, 0.24), random.Integer(4, 40));
    EXPECT_EQ(FindSequenceOutliers(plate, true).count(), 0);
    EXPECT_EQ(FindSequenceOutliers(plate, false).count(), 0);
    const Eigen::Matrix3Xd square =
        Polyline({{0, 0, 0}, {1, 0, 0}, {1, random.Real(0.2, 3), 0}, {0, 1, 0}, {0, 0, 0}}, count);
    EXPECT_EQ(FindSequenceOutliers(square.leftCols(4 * count), true).count(), 0);
  }
}

// One in a thousand may stand so far out of the noise that it is taken for a stray.
TEST(FindSequenceOutliersTest, KeepsNoisyPoints) {
  for (const double steps : {0.02, 0.3, 2.0, 20.0}) {
    SCOPED_TRACE("noise of " + std::to_string(steps) + " steps");
    Eigen::Index marked = 0, all = 0;
    for (unsigned seed = 0; seed < 20; ++seed) {
      NoisyPoints random(seed);
      const bool space = seed % 2 == 0;
      const Eigen::Matrix3Xd curve = space ? Helix(4000) : Flower(4000);
      const double sigma = steps * MeanStep(curve);
      const PointMask sequence_outliers =
          FindSequenceOutliers(random.Scattered(curve, sigma, space ? 3 : 2), !space);
      marked += sequence_outliers.count();
      all += sequence_outliers.size();
    }
    EXPECT_LT(1000 * marked, all);
  }
}

// A crest between points far apart turns sharply once, where outliers turn the way twice or more.
TEST(FindSequenceOutliersTest, MarksNoCrestsOfWavesAtUnevenSteps) {
  Eigen::Index marked = 0, all = 0;
  for (unsigned seed = 0; seed < 400; ++seed) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> even(0, 1);
    std::vector<double> x(20 + random() % 80);
    for (double& one : x) one = even(random);
    std::sort(x.begin(), x.end());
    const double fast = 3 + 11 * even(random), height = 0.05 + 0.35 * even(random),
                 from = 6 * even(random), other = 0.6 * even(random) - 0.3;
    Eigen::Matrix3Xd points(3, std::ssize(x));
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      const double at = fast * x[std::size_t(k)];
      points.col(k) << x[std::size_t(k)],
          height * (std::sin(at + from) + other * std::cos(1.7 * at)), 0;
    }
    marked += FindSequenceOutliers(points, false).count();
    all += points.cols();
  }
  EXPECT_LT(1000 * marked, all);
}

// Several near each other in a row must lie farther off than one: in wide noise 14 σ, not 8.
TEST(FindSequenceOutliersTest, FindsPointsStrewnOverTheBox) {
  for (const int run : {1, 3}) {
    const double far = run == 1 ? 8 : 14;
    for (const double share : {0.02, 0.1, 0.3}) {
      for (const double steps : {0.0, 0.02, 0.3, 2.0, 10.0}) {
        SCOPED_TRACE(std::to_string(run) + " in a row, share " + std::to_string(share) +
                     ", noise of " + std::to_string(steps) + " steps");
        Score score;
        for (unsigned seed = 0; seed < 6; ++seed) {
          NoisyPoints random(seed);
          const bool space = seed % 2 == 0;
          const Eigen::Matrix3Xd curve = space ? Helix(2000) : Flower(2000);
          const double step = MeanStep(curve), sigma = steps * step;
          const Eigen::Matrix3Xd noisy = random.Scattered(curve, sigma, space ? 3 : 2);
          const Spoilt spoilt = Strewn(random, noisy, share, run);
          score.Add(FindSequenceOutliers(spoilt.points, !space), spoilt, curve, far * sigma + step);
        }
        EXPECT_GE(score.found, 0.98 * score.far);
        EXPECT_LE(score.wrong, 0.03 * score.clean);
      }
    }
  }
}

// Where a third is offset, some rows of them to the same side look like a piece of a curve.
TEST(FindSequenceOutliersTest, FindsPointsOffsetToTheSide) {
  for (const double share : {0.02, 0.1, 0.3}) {
    for (const double steps : {0.0, 0.01, 0.1}) {
      SCOPED_TRACE("share " + std::to_string(share) + ", noise of " + std::to_string(steps));
      Score score;
      for (unsigned seed = 0; seed < 6; ++seed) {
        NoisyPoints random(seed);
        const Eigen::Matrix3Xd curve = Helix(2000);
        const double step = MeanStep(curve);
        const Spoilt spoilt =
            Offset(random, random.Scattered(curve, steps * step, 3), share, 8 * step);
        score.Add(FindSequenceOutliers(spoilt.points, false), spoilt, curve, 4 * step);
      }
      EXPECT_GE(score.found, (share < 0.2 ? 0.98 : 0.97) * score.far);
      EXPECT_LE(score.wrong, 0.01 * score.clean);
    }
  }
}

// What the eye hardly sees spoils a curve through exact points: less than a step off.
TEST(FindSequenceOutliersTest, FindsPointsHardlyOffExactOnes) {
  for (const double offset : {0.6, 1.0, 1.5, 3.0}) {
    SCOPED_TRACE(std::to_string(offset) + " steps off");
    Score score;
    for (unsigned seed = 0; seed < 6; ++seed) {
      NoisyPoints random(seed);
      const bool space = seed % 2 == 0;
      const Eigen::Matrix3Xd curve = space ? Helix(2000) : Flower(2000);
      const Spoilt spoilt = Offset(random, curve, 0.02, offset * MeanStep(curve));
      score.Add(FindSequenceOutliers(spoilt.points, !space), spoilt, curve, 0);
    }
    EXPECT_GE(score.found, (offset < 1 ? 0.8 : 0.98) * score.far);
    EXPECT_LE(score.wrong, 0.001 * score.clean);
  }
}

TEST(FindSequenceOutliersTest, FindsAFewStraysAmongFewPoints) {
  Eigen::Matrix3Xd points = Arc(40, 200);
  points.col(7) << 0, 3, 0;
  points.col(20) << 1, -2, 0;
  points.col(21) << 1.1, -2.2, 0;
  const PointMask sequence_outliers = FindSequenceOutliers(points, false);
  EXPECT_EQ(sequence_outliers.count(), 3);
  EXPECT_TRUE(sequence_outliers[7] && sequence_outliers[20] && sequence_outliers[21]);
}

TEST(FindSequenceOutliersTest, FindsStraysAtTheSeamOfARing) {
  for (const Eigen::Index place : {0, 1, 198, 199}) {
    SCOPED_TRACE("place " + std::to_string(place));
    Eigen::Matrix3Xd points = Ellipse(200, 2, 1);
    points.col(place) << 0.3, 0.2, 0;
    const PointMask sequence_outliers = FindSequenceOutliers(points, true);
    EXPECT_EQ(sequence_outliers.count(), 1);
    EXPECT_TRUE(sequence_outliers[place]);
  }
}

TEST(FindSequenceOutliersTest, FindsStraysAtTheEnds) {
  for (const Eigen::Index place : {0, 1, 198, 199}) {
    SCOPED_TRACE("place " + std::to_string(place));
    Eigen::Matrix3Xd points = Arc(200, 180);
    points.col(place) << 0.1, -0.5, 0;
    const PointMask sequence_outliers = FindSequenceOutliers(points, false);
    EXPECT_EQ(sequence_outliers.count(), 1);
    EXPECT_TRUE(sequence_outliers[place]);
  }
}

TEST(FindSequenceOutliersTest, MarksTheSamePointsInOtherUnitsAndPlaces) {
  for (unsigned seed = 0; seed < 10; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    NoisyPoints random(seed);
    const Eigen::Matrix3Xd curve = random.Scattered(Helix(500), 0.01, 3);
    const Eigen::Matrix3Xd points = Strewn(random, curve, 0.2, 1).points;
    const PointMask sequence_outliers = FindSequenceOutliers(points, false);
    // Powers of two change no digit.
    for (const double scale : {std::ldexp(1, -20), std::ldexp(1, 20)}) {
      EXPECT_TRUE((FindSequenceOutliers(scale * points, false) == sequence_outliers).all());
    }
    const Eigen::Matrix3Xd far = points.colwise() + Eigen::Vector3d(5e6, -4e6, 300);
    EXPECT_LE((FindSequenceOutliers(far, false) != sequence_outliers).count(),
              1);  // at the limit of a threshold
  }
}

TEST(FindSequenceOutliersTest, LivesWithDegeneratePoints) {
  EXPECT_EQ(FindSequenceOutliers(Eigen::Matrix3Xd(3, 0), false).size(), 0);
  for (const int count : {1, 2, 7, 8, 9, 100}) {
    for (const bool closed : {false, true}) {
      EXPECT_EQ(FindSequenceOutliers(Eigen::Matrix3Xd::Ones(3, count), closed).count(), 0);
    }
  }
  Eigen::Matrix3Xd twice(3, 200);
  for (int k = 0; k < 200; ++k) twice.col(k) = OnCircle(0.02 * (k / 2));
  EXPECT_EQ(FindSequenceOutliers(twice, false).count(), 0);
}

}  // namespace batten::internal::sequence_outliers_test
