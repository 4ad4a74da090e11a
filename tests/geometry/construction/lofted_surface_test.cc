// SPDX-License-Identifier: MIT
#include "batten/geometry/lofted_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "batten/geometry/closure.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "construction_cases.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::lofted_surface_test {

using ::testing::HasSubstr;
using Curves = std::vector<NurbsCurve<3>>;

// Sections of differing degree and knots, one above the other.
Curves RandomSections(RandomSplines& random, int count, bool rational) {
  Curves sections;
  for (int k = 0; k < count; ++k) {
    const double z = k + random.Real(-0.3, 0.3);
    sections.push_back(
        NearSegment(random, {0, 0, z}, {4, 0, z}, 0.4, random.Integer(1, 4), rational));
  }
  return sections;
}

Curves Circles(int count, double wobble = 0) {
  Curves circles;
  for (int k = 0; k < count; ++k) {
    circles.push_back(
        MakeArc(Frame({wobble * k * k, 0, double(k)}, {0, wobble * k, 1}), 1 + 0.2 * (k % 3)));
  }
  return circles;
}

double WorstOf(const LoftedSurface& loft, const Curves& sections) {
  double worst = 0;
  for (std::size_t k = 0; k < sections.size(); ++k) {
    worst = std::max(worst,
                     DistanceAlong(
                         loft.surface,
                         [&](double t) { return Eigen::Vector2d(t, loft.parameters[k]); },
                         [&](double t) { return AtShare(sections[k], t); }));
  }
  return worst;
}

// Whatever the pace of the sections.
double FarthestOf(const LoftedSurface& loft, const Curves& sections) {
  double worst = 0;
  for (std::size_t k = 0; k < sections.size(); ++k) {
    const NurbsCurve<3> line = IsoCurve(loft.surface, Direction::kV, loft.parameters[k]);
    worst = std::max({worst, FarthestFrom(sections[k], line), FarthestFrom(line, sections[k])});
  }
  return worst;
}

TEST(LoftTest, ContainsEverySection) {
  for (int seed = 0; seed < 60; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const int count = random.Integer(2, 9);
    LoftOptions options;
    options.degree = random.Integer(1, 5);
    const Curves sections = RandomSections(random, count, false);
    const LoftedSurface loft = Loft(sections, options);
    EXPECT_EQ(loft.surface.basis_v().degree(), std::min(options.degree, count - 1));
    EXPECT_LE(WorstOf(loft, sections), 100 * kRounding);
  }
}

TEST(LoftTest, FarFromTheOriginNoDigitsAreLostButThoseOfTheCoordinates) {
  RandomSplines random(3);
  Curves sections = RandomSections(random, 6, false);
  const Eigen::Matrix4d far = Translation({5e6, 4e5, 300});
  for (NurbsCurve<3>& section : sections) section = Transformed(section, far);
  EXPECT_LE(WorstOf(Loft(sections), sections), 16 * 5e6 * std::numeric_limits<double>::epsilon());
}

TEST(LoftTest, IsAffinelyInvariantAtGivenParameters) {
  // Maps that scale all chords of a row alike leave parameters; then the whole surface is mapped.
  RandomSplines random(5);
  Curves sections = RandomSections(random, 5, false);
  const Eigen::Matrix4d map = Translation({3, -2, 7}) * Rotation({1, 2, 3}, 0.7) * Scaling(3);
  const NurbsSurface plain = Loft(sections).surface;
  for (NurbsCurve<3>& section : sections) section = Transformed(section, map);
  EXPECT_LE(LargestDifference(Loft(sections).surface, Transformed(plain, map)), 1e3 * kRounding);
}

TEST(LoftTest, SectionsOfACylinderGiveTheCylinder) {
  Curves circles;
  for (const double z : {0.0, 1.0, 2.5, 3.0}) {
    circles.push_back(MakeArc(Frame({0, 0, z}, {0, 0, 1}), 2));
  }
  const LoftedSurface loft = Loft(circles);
  for (int k = 0; k <= 40; ++k) {
    for (int l = 0; l <= 10; ++l) {
      const Eigen::Vector3d p = loft.surface.At(k / 40.0, l / 10.0);
      EXPECT_NEAR(p.head<2>().norm(), 2, kRounding * 10);
    }
  }
  EXPECT_TRUE(Closed(loft.surface, Direction::kU, 0));
}

TEST(LoftTest, ClosedLoftsContainTheirSectionsAndAreSmoothAtTheSeam) {
  Curves sections;
  for (int k = 0; k < 7; ++k) {
    const double a = 2 * kPi * k / 7;
    const Eigen::Vector3d out(std::cos(a), std::sin(a), 0);
    sections.push_back(MakeArc(Frame(5 * out, {-out.y(), out.x(), 0}, out), 1 + 0.1 * (k % 2)));
  }
  LoftOptions options;
  options.closed = true;
  const LoftedSurface loft = Loft(sections, options);
  EXPECT_TRUE(loft.surface.basis_v().periodic());
  EXPECT_GE(SeamContinuity(loft.surface, Direction::kV).value_or(-1), 2);
  EXPECT_LE(WorstOf(loft, sections), 100 * kRounding);
}

TEST(LoftTest, LeavesAndArrivesInTheGivenDirections) {
  RandomSplines random(8);
  for (const int count : {2, 3, 6}) {
    const Curves sections = RandomSections(random, count, count == 6);
    LoftOptions options;
    options.start = LoftEnd{{0, 2, 2}, 1.5};
    options.end = LoftEnd{{1, 0, 3}, 0.5};
    const LoftedSurface loft = Loft(sections, options);
    EXPECT_LE(FarthestOf(loft, sections), 100 * kRounding);
    double lengths[2] = {0, 0};
    for (int k = 0; k <= 20; ++k) {
      const Eigen::Vector3d first = loft.surface.JetAt(k / 20.0, 0).dv;
      const Eigen::Vector3d last = loft.surface.JetAt(k / 20.0, 1).dv;
      EXPECT_LE(first.normalized().cross(Eigen::Vector3d(0, 1, 1).normalized()).norm(), kIterated);
      EXPECT_LE(last.normalized().cross(Eigen::Vector3d(1, 0, 3).normalized()).norm(), kIterated);
      EXPECT_GT(first.z(), 0);
      if (k > 0) {
        EXPECT_NEAR(first.norm(), lengths[0], kIterated * lengths[0]);
      }
      lengths[0] = first.norm();
      lengths[1] = last.norm();
    }
    EXPECT_NEAR(lengths[0], 3 * lengths[1], kIterated * lengths[0]);
  }
}

TEST(LoftTest, CrossesSectionsAlongTheSpine) {
  const NurbsCurve<3> spine = MakeArc(Frame(), 10, {0, kPi / 2});
  Curves sections;
  for (const double a : {0.0, 0.3, 0.9, kPi / 2}) {
    const Eigen::Vector3d out(std::cos(a), std::sin(a), 0);
    sections.push_back(MakeArc(Frame(10 * out, {-out.y(), out.x(), 0}, {0, 0, 1}), 1));
  }
  LoftOptions options;
  options.spine = spine;
  const LoftedSurface loft = Loft(sections, options);
  EXPECT_LE(WorstOf(loft, sections), 100 * kRounding);
  for (std::size_t k = 0; k < sections.size(); ++k) {
    const Eigen::Vector3d middle = (sections[k].At(0) + sections[k].At(0.5)) / 2;
    const Eigen::Vector3d along(-middle.y() / 10, middle.x() / 10, 0);
    for (const double u : {0.0, 0.2, 0.7}) {
      const Eigen::Vector3d dv = loft.surface.JetAt(u, loft.parameters[k]).dv;
      EXPECT_LE(dv.normalized().cross(along).norm(), kIterated);
      EXPECT_GT(dv.dot(along), 0);
    }
  }
  std::swap(sections[1], sections[2]);
  EXPECT_THAT(RefusalOf([&] { Loft(sections, options); }), HasSubstr("the spine passes section 3"));
}

TEST(LoftTest, MildWeightsAreLoftedInHomogeneousSpace) {
  for (int seed = 0; seed < 30; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    Curves sections;
    for (int k = 0; k < 5; ++k) {
      // Arcs of differing opening: one basis, weights that differ from section to section.
      sections.push_back(
          MakeArc(Frame({0, 0, double(k)}, {0, 0, 1}), 2, {0, random.Real(0.4, 1.2)}));
    }
    const LoftedSurface loft = Loft(sections);
    EXPECT_EQ(loft.error, 0);
    EXPECT_LE(WorstOf(loft, sections), 100 * kRounding);
  }
}

TEST(LoftTest, SectionsWithWeightsAndOtherEndWeightsAreContained) {
  for (int seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const Curves sections = RandomSections(random, 4, true);
    const LoftedSurface loft = Loft(sections, {.tolerance = 1e-6});
    EXPECT_LE(FarthestOf(loft, sections), std::max(loft.error, 100 * kRounding));
    EXPECT_LE(loft.error, 1e-6);
  }
}

TEST(LoftTest, WildWeightsAreRefusedOrReplacedWithinTheTolerance) {
  Curves sections;
  for (int k = 0; k < 6; ++k) {
    Eigen::Matrix3Xd points(3, 4);
    points << 0, 1, 2, 3, 0, 1, 1, 0, k, k, k, k;
    const double wild = k % 2 == 0 ? 100 : 0.01;
    sections.emplace_back(
        SplineBasis::Uniform(3, 4, 0, 1), points, Eigen::Vector4d(1, wild, 1 / wild, 1));
  }
  EXPECT_THAT(RefusalOf([&] { Loft(sections); }), HasSubstr("beyond half and twice that"));
  LoftOptions options;
  options.tolerance = 1e-5;
  const LoftedSurface loft = Loft(sections, options);
  EXPECT_FALSE(loft.surface.rational());
  EXPECT_GT(loft.error, 0);
  EXPECT_LE(WorstOf(loft, sections), options.tolerance);
}

TEST(LoftTest, AlignedSectionsBeginBesideOneAnother) {
  const Curves straight = Circles(4);
  Curves turned = straight;
  turned[1] = Reversed(turned[1]);
  turned[3] = MakeArc(Frame({0, 0, 3}, {0, 0, 1}, {-1, 1, 0}), 1);
  LoftOptions options;
  options.align = true;
  const LoftedSurface loft = Loft(turned, options);
  EXPECT_FALSE(loft.changes[0].reversed);
  EXPECT_TRUE(loft.changes[1].reversed);
  EXPECT_EQ(loft.changes[2].start, 0);
  EXPECT_NEAR(loft.changes[3].start, 1 - 3.0 / 8, 0.01);
  // Nothing is twisted: rows stay near planes through the axis.
  for (const double u : {0.0, 0.25, 0.6}) {
    const double at = std::atan2(loft.surface.At(u, 0).y(), loft.surface.At(u, 0).x());
    for (int k = 1; k <= 20; ++k) {
      const Eigen::Vector3d p = loft.surface.At(u, k / 20.0);
      EXPECT_NEAR(std::remainder(std::atan2(p.y(), p.x()) - at, 2 * kPi), 0, 0.02) << u;
    }
  }
}

TEST(LoftTest, MayBeginAndEndInAPoint) {
  const auto point = [](double z) {
    return NurbsCurve<3>(SplineBasis(1, {0, 0, 1, 1}), Eigen::Vector3d(0, 0, z).replicate<1, 2>());
  };
  RandomSplines random(2);
  for (const bool align : {false, true}) {
    Curves open = RandomSections(random, 3, false);
    open.insert(open.begin(), point(-2));
    EXPECT_LE(WorstOf(Loft(open, {.align = align}), open), 100 * kRounding);
    Curves closed = Circles(3);
    closed.insert(closed.begin(), point(-1));
    closed.push_back(point(4));
    const LoftedSurface loft = Loft(closed, {.align = align});
    EXPECT_EQ(CollapsedEdges(loft.surface), (CollapsedEdgeSet{.v_lower = true, .v_upper = true}));
  }
}

TEST(LoftTest, Refusals) {
  Curves sections = Circles(3);
  EXPECT_THAT(RefusalOf([&] { Loft({sections[0]}); }), HasSubstr("at least 2"));
  sections.push_back(MakeLine<3>({0, 0, 9}, {3, 4, 9}));
  EXPECT_THAT(RefusalOf([&] { Loft(sections); }),
              HasSubstr("section 1 is closed and section 4 is open, its ends 5 apart"));
  sections = Circles(3);
  sections.push_back(sections.back());
  EXPECT_THAT(RefusalOf([&] { Loft(sections); }), HasSubstr("sections 3 and 4 are the same"));
  sections = Circles(3);
  LoftOptions closed;
  closed.closed = true;
  sections.push_back(sections.front());
  EXPECT_THAT(RefusalOf([&] { Loft(sections, closed); }),
              HasSubstr("sections 4 and 1 are the same"));
  closed.degree = 2;
  EXPECT_THAT(RefusalOf([&] { Loft(sections, closed); }), HasSubstr("odd"));
  LoftOptions linear;
  linear.degree = 1;
  linear.start = LoftEnd{{0, 0, 1}};
  EXPECT_THAT(RefusalOf([&] { Loft(Circles(3), linear); }), HasSubstr("no room"));
  linear.degree = 3;
  linear.start->direction.setZero();
  EXPECT_THAT(RefusalOf([&] { Loft(Circles(3), linear); }), HasSubstr("direction"));
}

}  // namespace batten::internal::lofted_surface_test
