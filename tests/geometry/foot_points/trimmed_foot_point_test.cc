// SPDX-License-Identifier: MIT
#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "batten/geometry/trim_region.h"
#include "cases.h"
#include "geometry/numeric/point_kd_tree.h"
#include "nasty_surfaces.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten::internal::trimmed_foot_point_test {

using Loops = std::vector<NurbsCurve<2>>;

// What distances are right to, of the surface's size.
constexpr double kMiss = 1e-10;

NurbsCurve<2> PolygonLoop(std::vector<Eigen::Vector2d> corners) {
  corners.push_back(corners.front());
  const auto count = static_cast<int>(corners.size());
  Eigen::Matrix2Xd points(2, count);
  std::vector<double> knots{0};
  for (int k = 0; k < count; ++k) {
    points.col(k) = corners[k];
    knots.push_back(k);
  }
  knots.push_back(count - 1);
  return NurbsCurve<2>(SplineBasis(1, std::move(knots)), points);
}

NurbsCurve<2> Rectangle(double u0, double u1, double v0, double v1) {
  return PolygonLoop({{u0, v0}, {u1, v0}, {u1, v1}, {u0, v1}});
}

// A square of the plane z = 0, with u and v in [0, 1].
NurbsSurface Square(double side) { return MakePlane({}, {0, side}, {0, side}); }

// A star-shaped loop about a place of the domain: a closed cubic, a polygon or an ellipse.
NurbsCurve<2> RandomLoop(const NurbsSurface& surface,
                         const Eigen::Array2d& centre,
                         double reach,
                         RandomSplines& random) {
  const Eigen::Array2d lower(surface.basis_u().lower(), surface.basis_v().lower());
  const Eigen::Array2d length(surface.basis_u().upper() - lower[0],
                              surface.basis_v().upper() - lower[1]);
  const int kind = random.Integer(0, 2);
  const int count = random.Integer(kind == 0 ? 3 : 5, 9);
  std::vector<Eigen::Vector2d> corners;
  for (int k = 0; k < count; ++k) {
    const double angle = 2 * std::numbers::pi * (k + random.Real(-0.2, 0.2)) / count;
    const double radius = reach * random.Real(0.5, 1);
    const Eigen::Array2d unit(std::cos(angle), std::sin(angle));
    corners.push_back(lower + length * (centre + radius * unit));
  }
  if (kind == 0) return PolygonLoop(corners);
  if (kind == 1) {
    const NurbsCurve<2> circle = MakeArc(Eigen::Vector2d(0, 0), 1);
    Eigen::Matrix2Xd points = circle.control_points();
    for (int k = 0; k < points.cols(); ++k) {
      const Eigen::Array2d place = lower + length * (centre + reach * points.col(k).array());
      points.col(k) = place;
    }
    return NurbsCurve<2>(circle.basis(), points, circle.weights());
  }
  // Control points round the centre, the first repeated as the last.
  corners.push_back(corners.front());
  const SplineBasis basis = SplineBasis::Uniform(3, static_cast<int>(corners.size()), 0, 1);
  Eigen::Matrix2Xd points(2, basis.size());
  for (int k = 0; k < basis.size(); ++k) points.col(k) = corners[k];
  return NurbsCurve<2>(basis, points);
}

// An outer loop of random shape, or the whole domain's edge, and a few holes that do not meet.
NurbsSurface WithRandomTrims(const NurbsSurface& surface, RandomSplines& random) {
  Loops loops;
  double reach = 0.5;
  if (random.Coin()) {
    loops.push_back(Rectangle(surface.basis_u().lower(),
                              surface.basis_u().upper(),
                              surface.basis_v().lower(),
                              surface.basis_v().upper()));
  } else {
    reach = random.Coin() ? random.Real(0.2, 0.5) : random.Logarithmic(1e-3, 0.5);
    const Eigen::Array2d centre(random.Real(reach, 1 - reach), random.Real(reach, 1 - reach));
    loops.push_back(RandomLoop(surface, centre, 0.999 * reach, random));
    return surface.WithTrims(TurnedLoops(std::move(loops)));
  }
  const int across = random.Integer(1, 4);
  for (int i = 0; i < across; ++i) {
    for (int j = 0; j < across; ++j) {
      if (random.Integer(0, 3) == 0) continue;
      const Eigen::Array2d centre((i + 0.5) / across, (j + 0.5) / across);
      loops.push_back(RandomLoop(surface, centre, 0.49 / across, random));
    }
  }
  return surface.WithTrims(TurnedLoops(std::move(loops)));
}

// Places of the part that counts: a grid over its box, and its loops.
class DensePart {
 public:
  DensePart(const NurbsSurface& surface, int count) : surface_(surface), region_(surface) {
    Eigen::AlignedBox2d box;
    for (const NurbsCurve<2>& loop : surface.trims()) {
      constexpr int kOnLoop = 400;
      for (int k = 0; k < kOnLoop; ++k) {
        const double share = double(k) / kOnLoop;
        const SplineBasis& basis = loop.basis();
        Add(loop.At(basis.lower() + share * (basis.upper() - basis.lower())));
        box.extend(places_.back());
      }
    }
    for (int i = 0; i <= count; ++i) {
      for (int j = 0; j <= count; ++j) {
        const Eigen::Vector2d place =
            box.min().array() + box.sizes().array() * Eigen::Array2d(i, j) / count;
        if (region_.Contains(place[0], place[1])) Add(place);
      }
    }
    tree_ = PointKdTree(Eigen::Map<const Eigen::Matrix3Xd>(points_[0].data(), 3, points_.size()));
  }

  // Of the nearest sample, and of the local minimum below it where that counts.
  double Distance(const Eigen::Vector3d& q, bool polish = false) const {
    const int k = tree_.Nearest(q.data());
    const double distance = (points_[k] - q).norm();
    if (!polish) return distance;
    const SurfaceFoot foot = LocalFootPoint(surface_, q, places_[k][0], places_[k][1]);
    return region_.Contains(foot.u, foot.v) ? std::min(distance, foot.distance) : distance;
  }
  const Eigen::Vector3d& RandomPoint(RandomSplines& random) const {
    return points_[random.Integer(0, static_cast<int>(points_.size()) - 1)];
  }

 private:
  void Add(const Eigen::Vector2d& place) {
    places_.push_back(place);
    points_.push_back(surface_.At(place[0], place[1]));
  }

  const NurbsSurface& surface_;
  TrimRegion region_;
  std::vector<Eigen::Vector2d> places_;
  std::vector<Eigen::Vector3d> points_;
  PointKdTree tree_;
};

Eigen::Vector3d Query(const NurbsSurface& surface, const DensePart& part, RandomSplines& random) {
  const double size = SizeOf(surface);
  const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
  switch (random.Integer(0, 6)) {
    case 0:
      return surface.At(u, v) + random.Vector(0.02 * size);
    case 1:
      return surface.At(u, v) + random.Vector(0.3 * size);
    case 2:
      return part.RandomPoint(random) + random.Vector(std::pow(10.0, random.Integer(1, 8)) * size);
    case 3:
      return part.RandomPoint(random) + random.Vector(kRounding * size);
    case 4:
      return part.RandomPoint(random) + random.Vector(0.05 * size);
    case 5:
      return surface.control_points().rowwise().mean() + random.Vector(kHalfDigits * size);
    default:
      return surface.At(u, v);
  }
}

// A surface with its trims, and without.
struct Searches {
  explicit Searches(const NurbsSurface& s)
      : surface(s), region(s), trimmed(s), whole(s.WithTrims({})), size(SizeOf(s)) {}
  NurbsSurface surface;
  TrimRegion region;
  SurfaceFootPoints trimmed, whole;
  double size;
};

// `known` is the distance of a place that counts. Where the whole surface's own search gives up, as
// it may where a surface is all one curve, only the bound is looked at.
void ExpectNearest(const Searches& searches, const Eigen::Vector3d& q, double known) {
  const SurfaceFoot foot = searches.trimmed.Nearest(q), whole = searches.whole.Nearest(q);
  const double slack = kMiss * searches.size + kRounding * known;
  const Eigen::Vector3d point = searches.surface.At(foot.u, foot.v);
  EXPECT_TRUE(searches.region.Contains(foot.u, foot.v)) << foot.u << " " << foot.v;
  EXPECT_NEAR(foot.distance, (point - q).norm(), kRounding * (searches.size + known));
  EXPECT_LE((foot.point - point).norm(), kRounding * (searches.size + point.norm()));
  EXPECT_LE(foot.lower_bound, foot.distance);
  EXPECT_GE(foot.lower_bound, (1 - kRounding) * whole.lower_bound);
  EXPECT_LE(foot.lower_bound, known + kRounding * (searches.size + known));
  if (whole.lower_bound < whole.distance - slack) return;
  EXPECT_LE(foot.distance, known + slack) << "a nearer place was missed";
  EXPECT_GE(foot.lower_bound, foot.distance - slack) << "the bound says less than it could";
}

void TrySurfaces(unsigned first, unsigned last, int queries, int dense) {
  for (unsigned seed = first; seed < last; ++seed) {
    RandomSplines random(seed);
    const int kind = static_cast<int>(seed) % kNastyKinds;
    const NurbsSurface surface = WithRandomTrims(NastySurface(kind, random), random);
    const Searches searches(surface);
    const DensePart part(surface, dense);
    for (int trial = 0; trial < queries; ++trial) {
      SCOPED_TRACE("seed " + std::to_string(seed) + ", query " + std::to_string(trial));
      const Eigen::Vector3d q = Query(surface, part, random);
      ExpectNearest(searches, q, part.Distance(q, true));
      if (testing::Test::HasFailure()) return;
    }
  }
}

TEST(TrimmedFootPointTest, IsNoFartherThanAnyPlaceThatCounts) {
  TrySurfaces(0, Cases(45), 200, 60);
}

TEST(LongTrimmedFootPointTest, IsNoFartherThanAnyPlaceThatCounts) {
  TrySurfaces(1000, 2080, 2000, 100);
}

// A disc of radius 0.8 with a round hole of radius 0.2 in the plane z = 0.
TEST(TrimmedFootPointTest, OfAPiercedDiscHasTheFormula) {
  const Eigen::Vector2d centre(0.5, 0.5);
  const Searches disc(
      Square(2).WithTrims(TurnedLoops({MakeArc(centre, 0.4), MakeArc(centre, 0.1)})));
  RandomSplines random(1);
  for (int trial = 0; trial < 2000; ++trial) {
    const Eigen::Vector3d q = Eigen::Vector3d(1, 1, 0) + random.Vector(2);
    const double out = (q.head<2>() - Eigen::Vector2d(1, 1)).norm();
    const double beside = std::max({0.0, out - 0.8, 0.2 - out});
    const SurfaceFoot foot = disc.trimmed.Nearest(q);
    EXPECT_NEAR(foot.distance, std::hypot(beside, q[2]), kRounding);
    ExpectNearest(disc, q, std::hypot(beside, q[2]));
  }
}

// All of the loop is equally near to the places on the axis.
TEST(TrimmedFootPointTest, OfPlacesOnTheAxisOfAHoleIsAPlaceOfItsLoop) {
  const Searches ring(
      Square(1).WithTrims(TurnedLoops({Rectangle(0, 1, 0, 1), MakeArc({0.5, 0.5}, 0.25)})));
  for (const double height : {0.0, 1e-14, 1e-9, 1e-3, 1.0, 1e3, 1e9}) {
    SCOPED_TRACE(height);
    const Eigen::Vector3d q(0.5, 0.5, height);
    ExpectNearest(ring, q, std::hypot(0.25, height));
    EXPECT_NEAR(ring.trimmed.Nearest(q).distance,
                std::hypot(0.25, height),
                kRounding * std::max(1.0, height));
  }
}

// A polygon in the plane: the nearest of its sides, or the height above it.
double DistanceToPolygon(const std::vector<Eigen::Vector2d>& corners, const Eigen::Vector3d& q) {
  const Eigen::Vector2d p = q.head<2>();
  double least = std::numeric_limits<double>::infinity();
  bool inside = false;
  for (size_t k = 0; k < corners.size(); ++k) {
    const Eigen::Vector2d a = corners[k], b = corners[(k + 1) % corners.size()];
    const double t = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    least = std::min(least, (p - a - t * (b - a)).norm());
    if ((a[1] > p[1]) != (b[1] > p[1]) &&
        p[0] < a[0] + (p[1] - a[1]) / (b[1] - a[1]) * (b[0] - a[0])) {
      inside = !inside;
    }
  }
  return std::hypot(inside ? 0 : least, q[2]);
}

TEST(TrimmedFootPointTest, OfPolygonsHasTheFormulaAtSidesAndCornersToo) {
  for (unsigned seed = 0; seed < 40; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    std::vector<Eigen::Vector2d> corners;
    const int count = random.Integer(3, 40);
    for (int k = 0; k < count; ++k) {
      const double angle = 2 * std::numbers::pi * k / count;
      corners.push_back(Eigen::Vector2d(0.5, 0.5) +
                        random.Real(0.05, 0.5) * Eigen::Vector2d(std::cos(angle), std::sin(angle)));
    }
    const Searches polygon(Square(1).WithTrims({PolygonLoop(corners)}));
    for (int trial = 0; trial < 200; ++trial) {
      const int k = random.Integer(0, count - 1);
      const Eigen::Vector2d a = corners[k], b = corners[(k + 1) % count];
      Eigen::Vector3d q = Eigen::Vector3d(0.5, 0.5, 0) + random.Vector(1);
      if (trial % 4 == 1) q << a, 0;
      if (trial % 4 == 2) q << a + random.Real(0, 1) * (b - a), 0;
      if (trial % 4 == 3) q << a, random.Real(-1, 1);
      const double exact = DistanceToPolygon(corners, q);
      EXPECT_NEAR(polygon.trimmed.Nearest(q).distance, exact, kRounding);
      ExpectNearest(polygon, q, exact);
    }
  }
}

// Two thirds of the way round from the seam, and half the height: the distance from a point is
// found along the nearest of angle and height that counts.
TEST(TrimmedFootPointTest, OfAPieceOfACylinderHasTheFormula) {
  // Where the parameter runs is a matter of the arc: angles of its corners are asked of it.
  const NurbsSurface cylinder = MakeCylinder({}, 1, {0, 4});
  const double u0 = 0.125, u1 = 0.625;
  const Searches piece(cylinder.WithTrims({Rectangle(u0, u1, 0.25, 0.75)}));
  const auto angle = [&](double u) {
    const Eigen::Vector3d p = cylinder.At(u, 0);
    const double a = std::atan2(p[1], p[0]);
    return a < 0 ? a + 2 * std::numbers::pi : a;
  };
  const double low = angle(u0), high = angle(u1);
  RandomSplines random(3);
  for (int trial = 0; trial < 2000; ++trial) {
    const double radius = random.Real(0.01, 3), height = random.Real(-2, 6);
    const double turn = random.Real(0, 2 * std::numbers::pi);
    const double off = turn >= low && turn <= high
                           ? 0
                           : std::min(std::abs(std::remainder(turn - low, 2 * std::numbers::pi)),
                                      std::abs(std::remainder(turn - high, 2 * std::numbers::pi)));
    const double across = std::hypot(radius - std::cos(off), std::sin(off));
    const double along = std::max({0.0, 1 - height, height - 3});
    const Eigen::Vector3d q(radius * std::cos(turn), radius * std::sin(turn), height);
    EXPECT_NEAR(piece.trimmed.Nearest(q).distance, std::hypot(across, along), kRounding * 10);
    ExpectNearest(piece, q, std::hypot(across, along));
  }
}

// A cap about the pole, a collapsed edge, down to the latitude of v = 0.75; its outer loop runs
// along the seam and over the pole. The centre is equally far from all of it.
TEST(TrimmedFootPointTest, OfASphericalCapHasTheFormula) {
  const NurbsSurface sphere = MakeSphere({}, 1);
  const Searches cap(sphere.WithTrims({Rectangle(0, 1, 0.75, 1)}));
  const double latitude = std::asin(sphere.At(0, 0.75)[2]);
  RandomSplines random(4);
  for (int trial = 0; trial < 2000; ++trial) {
    const double reach = trial % 4 == 0 ? 1e-9 : trial % 4 == 1 ? 1e-3 : 2;
    const Eigen::Vector3d q = trial == 0 ? Eigen::Vector3d::Zero() : random.Vector(reach);
    const double beside = q.head<2>().norm(), up = std::max(latitude, std::atan2(q[2], beside));
    const double exact = std::hypot(beside - std::cos(up), q[2] - std::sin(up));
    EXPECT_NEAR(cap.trimmed.Nearest(q).distance, exact, kMiss);
    ExpectNearest(cap, q, exact);
  }
}

// A ring about the sphere without its pole: what is nearest to places on the axis beyond the pole
// is the whole upper loop.
TEST(TrimmedFootPointTest, OfASphereWithoutItsPoleIsOnTheLoop) {
  const NurbsSurface sphere = MakeSphere({}, 1);
  const Searches ring(sphere.WithTrims({Rectangle(0, 1, 0.25, 0.75)}));
  const Eigen::Vector3d rim = sphere.At(0, 0.75);
  for (const double height : {0.5, 1.0, 1.5, 10.0, 1e6}) {
    const double exact = std::hypot(rim.head<2>().norm(), height - rim[2]);
    ExpectNearest(ring, {0, 0, height}, exact);
    EXPECT_NEAR(ring.trimmed.Nearest({0, 0, height}).distance, exact, kMiss * height);
  }
}

// A periodic surface, its part all round but for a notch at the seam, whose loop lies in one
// period.
TEST(TrimmedFootPointTest, LooksAcrossTheSeam) {
  for (unsigned seed = 0; seed < 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface =
        random.Surface(3, 2, random.Coin(), {.most_spans = 6, .periodic = true}, {.most_spans = 3});
    const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
    const auto at = [&](double x, double y) -> Eigen::Vector2d {
      return {u.lower() + x * (u.upper() - u.lower()), v.lower() + y * (v.upper() - v.lower())};
    };
    const NurbsSurface notched = surface.WithTrims({PolygonLoop({at(0, 0.2),
                                                                 at(1, 0.2),
                                                                 at(1, 0.4),
                                                                 at(0.9, 0.5),
                                                                 at(1, 0.6),
                                                                 at(1, 0.8),
                                                                 at(0, 0.8),
                                                                 at(0, 0.6),
                                                                 at(0.1, 0.5),
                                                                 at(0, 0.4)})});
    const Searches searches(notched);
    const DensePart part(notched, 60);
    for (int trial = 0; trial < 200; ++trial) {
      const Eigen::Vector3d q = Query(notched, part, random);
      ExpectNearest(searches, q, part.Distance(q, true));
    }
  }
}

TEST(TrimmedFootPointTest, OfManyHolesAndTinyPartsIsFound) {
  RandomSplines random(8);
  const NurbsSurface sheet = random.Sheet(3, 3, 0.5, {.most_spans = 8});
  const SplineBasis &u = sheet.basis_u(), &v = sheet.basis_v();
  const auto at = [&](double x, double y) -> Eigen::Vector2d {
    return {u.lower() + x * (u.upper() - u.lower()), v.lower() + y * (v.upper() - v.lower())};
  };
  Loops loops{Rectangle(u.lower(), u.upper(), v.lower(), v.upper())};
  for (int i = 0; i < 20; ++i) {
    for (int j = 0; j < 20; ++j) {
      const double x = (i + 0.5) / 20, y = (j + 0.5) / 20, half = 0.024;
      loops.push_back(
          PolygonLoop({at(x - half, y), at(x, y - half), at(x + half, y), at(x, y + half)}));
    }
  }
  Loops tiny{PolygonLoop({at(0.3, 0.3), at(0.3 + 1e-7, 0.3), at(0.3, 0.3 + 1e-7)})};
  for (const Loops& some : {loops, tiny}) {
    const NurbsSurface surface = sheet.WithTrims(TurnedLoops(some));
    const Searches searches(surface);
    const DensePart part(surface, 100);
    for (int trial = 0; trial < 1000; ++trial) {
      const Eigen::Vector3d q = Query(surface, part, random);
      ExpectNearest(searches, q, part.Distance(q, true));
    }
  }
}

// What is found does not depend on where a part lies or in which units it is given.
TEST(TrimmedFootPointTest, HoldsFarFromTheOriginAndInAllUnits) {
  RandomSplines random(9);
  const NurbsSurface sheet = WithRandomTrims(random.Sheet(3, 3, 1), random);
  const Searches near(sheet);
  for (const double unit : {1e-6, 1.0, 1e6}) {
    for (const double shift : {0.0, 5e6}) {
      const Eigen::Vector3d away = Eigen::Vector3d(1, -1, 0.5) * shift * unit;
      const NurbsSurface moved =
          NurbsSurface(
              sheet.basis_u(), sheet.basis_v(), (unit * sheet.control_points()).colwise() + away)
              .WithTrims(sheet.trims());
      const SurfaceFootPoints feet(moved);
      const double rounding = std::numeric_limits<double>::epsilon() * shift;
      for (int trial = 0; trial < 300; ++trial) {
        const Eigen::Vector3d q =
            sheet.At(random.Parameter(sheet.basis_u()), random.Parameter(sheet.basis_v())) +
            random.Vector(near.size);
        const SurfaceFoot foot = feet.Nearest(unit * q + away);
        const double expected = near.trimmed.Nearest(q).distance;
        EXPECT_NEAR(foot.distance / unit, expected, kMiss * near.size + 8 * rounding);
        EXPECT_LE(foot.lower_bound, foot.distance);
      }
    }
  }
}

TEST(TrimmedFootPointTest, IsBitByBitThatOfTheWholeSurfaceWhereThatCounts) {
  int inside = 0;
  for (unsigned seed = 0; seed < 36; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface =
        WithRandomTrims(NastySurface(static_cast<int>(seed) % kNastyKinds, random), random);
    const Searches searches(surface);
    for (int trial = 0; trial < 50; ++trial) {
      const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
      const Eigen::Vector3d q = surface.At(u, v) + random.Vector(0.1 * searches.size);
      const SurfaceFoot whole = searches.whole.Nearest(q);
      if (!searches.region.Contains(whole.u, whole.v)) continue;
      ++inside;
      const SurfaceFoot foot = searches.trimmed.Nearest(q);
      EXPECT_EQ(foot.u, whole.u);
      EXPECT_EQ(foot.v, whole.v);
      EXPECT_EQ(foot.distance, whole.distance);
      EXPECT_EQ(foot.lower_bound, whole.lower_bound);
    }
  }
  EXPECT_GT(inside, 200);
}

// A start's own local minimum where that counts, the nearest of all elsewhere.
TEST(TrimmedFootPointTest, NearStaysInThePartThatCounts) {
  for (unsigned seed = 0; seed < 36; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    RandomSplines random(seed);
    const NurbsSurface surface = WithRandomTrims(random.Sheet(3, 3, 1), random);
    const Searches searches(surface);
    for (int trial = 0; trial < 50; ++trial) {
      const double u = random.Parameter(surface.basis_u()), v = random.Parameter(surface.basis_v());
      const Eigen::Vector3d q = surface.At(u, v) + random.Vector(0.1 * searches.size);
      const SurfaceFoot whole = searches.whole.Near(q, u, v), foot = searches.trimmed.Near(q, u, v);
      EXPECT_TRUE(searches.region.Contains(foot.u, foot.v));
      const bool counts = searches.region.Contains(whole.u, whole.v);
      EXPECT_EQ(foot.distance, (counts ? whole : searches.trimmed.Nearest(q)).distance);
    }
  }
}

TEST(TrimmedFootPointTest, DoesNotDependOnTheNumberOfThreads) {
  RandomSplines random(11);
  const NurbsSurface surface = WithRandomTrims(random.Sheet(3, 3, 1), random);
  const SurfaceFootPoints feet(surface);
  Eigen::Matrix3Xd points(3, 3000);
  for (auto p : points.colwise()) p = random.Vector(3);
  ThreadPool one(1), three(3);
  const auto alone = feet.Nearest(points, one), together = feet.Nearest(points, three);
  for (size_t k = 0; k < alone.size(); ++k) {
    ASSERT_EQ(alone[k].u, together[k].u);
    ASSERT_EQ(alone[k].distance, together[k].distance);
    ASSERT_EQ(alone[k].lower_bound, together[k].lower_bound);
  }
}

}  // namespace batten::internal::trimmed_foot_point_test
