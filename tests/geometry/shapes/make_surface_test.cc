// SPDX-License-Identifier: MIT
#include "batten/geometry/make_surface.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <functional>
#include <numbers>
#include <stdexcept>

#include "angles.h"
#include "batten/geometry/classify_shape.h"
#include "batten/geometry/closure.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/surface_area.h"
#include "batten/geometry/surface_evaluator.h"
#include "distance_in_ulps.h"
#include "fixtures.h"
#include "geometry/bezier/normal_limits.h"
#include "random_splines.h"
#include "refusal.h"
#include "tolerances.h"

namespace batten::internal::make_surface_test {

using ::testing::HasSubstr;

constexpr unsigned kSeed = 72;
constexpr int kPlaces = 10000;

AngleRange RandomAngles(RandomSplines& random) {
  return {random.Coin() ? 0 : random.Real(-7, 7),
          random.Coin() ? 2 * kPi : random.Real(0.01, 2 * kPi)};
}

Interval RandomLatitudes(RandomSplines& random) {
  return {random.Coin() ? -kPi / 2 : random.Real(-1.5, -0.1),
          random.Coin() ? kPi / 2 : random.Real(0.1, 1.5)};
}

// A place of the world for a shape: the origin with the world's axes, or anywhere.
Frame RandomFrame(RandomSplines& random, double far = 0) {
  return Frame(
      far > 0 ? random.Vector(far) : Eigen::Vector3d(0, 0, 0), random.Vector(1), random.Vector(1));
}

double RandomRadius(RandomSplines& random) {
  return random.Coin() ? std::nextafter(std::exp2(random.Integer(-9, 10)), 0)
                       : random.Logarithmic(1e-3, 1e3);
}

using Distance = std::function<long double(const Eigen::Vector3d&)>;  // from the shape

struct Errors {
  double surface = 0, evaluator = 0;
};

Errors Worst(const NurbsSurface& surface, const Distance& distance, RandomSplines& random) {
  const SurfaceEvaluator fast(surface);
  Errors worst;
  for (int k = 0; k < kPlaces; ++k) {
    const double u = random.Real(0, 1), v = random.Real(0, 1);
    const auto error = [&](const Eigen::Vector3d& p) {
      return static_cast<double>(std::abs(distance(p)));
    };
    worst.surface = std::max(worst.surface, error(surface.At(u, v)));
    worst.evaluator = std::max(worst.evaluator, error(fast.At(u, v)));
  }
  return worst;
}

// The bound of the header, of the scale given.
void ExpectWithinBound(const NurbsSurface& surface,
                       double scale,
                       bool at_home,
                       const Distance& distance,
                       RandomSplines& random) {
  const Errors worst = Worst(surface, distance, random);
  const double largest = surface.control_points().cwiseAbs().maxCoeff();
  const double bound = 4 * Ulp(scale) + (at_home ? 0 : 2 * Ulp(largest));
  EXPECT_LE(worst.surface, bound);
  EXPECT_LE(worst.evaluator, 2 * bound);
}

struct RoundCase {
  Frame frame;
  bool at_home;
};

template <typename Check>
void ForFrames(unsigned seed, int cases, const Check& check) {
  RandomSplines random(seed);
  for (int k = 0; k < cases; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", case " << k);
    check(RoundCase{Frame(), true}, random);
    check(RoundCase{RandomFrame(random), false}, random);
    check(RoundCase{RandomFrame(random, 5e6), false}, random);
  }
}

void ExpectSpheresAreExact(unsigned seed, int cases) {
  ForFrames(seed, cases, [](const RoundCase& at, RandomSplines& random) {
    const double radius = RandomRadius(random);
    const NurbsSurface sphere =
        MakeSphere(at.frame, radius, RandomAngles(random), RandomLatitudes(random));
    const Distance distance = [&](const Eigen::Vector3d& p) {
      return ExtendedNorm(Extended(p) - Extended(at.frame.origin())) - radius;
    };
    ExpectWithinBound(sphere, radius, at.at_home, distance, random);
  });
}

void ExpectCylindersAndConesAreExact(unsigned seed, int cases) {
  ForFrames(seed, cases, [](const RoundCase& at, RandomSplines& random) {
    const double lower = random.Coin() ? 0 : RandomRadius(random), upper = RandomRadius(random);
    const double radius = std::max(lower, upper);
    const Interval height{random.Real(-2, 0) * radius, random.Real(0.1, 2) * radius};
    const auto across = [&](const Eigen::Vector3d& p) {
      return AcrossAxis(p, at.frame.origin(), at.frame.axis());
    };
    ExpectWithinBound(
        MakeCylinder(at.frame, radius, height, RandomAngles(random)),
        radius,
        at.at_home,
        [&](const Eigen::Vector3d& p) { return ExtendedNorm(across(p)) - radius; },
        random);
    const long double slope = (static_cast<long double>(upper) - lower) /
                              (static_cast<long double>(height.upper) - height.lower);
    const auto off_cone = [&](const Eigen::Vector3d& p) {
      const Extended3 axial = Extended(p) - Extended(at.frame.origin()) - across(p);
      const Extended3 axis = Extended(at.frame.axis());
      const long double z = axial[0] * axis[0] + axial[1] * axis[1] + axial[2] * axis[2];
      const long double expected = lower + (z - height.lower) * slope;
      return (ExtendedNorm(across(p)) - expected) / std::sqrt(1 + slope * slope);
    };
    const double farthest =
        std::max(radius, std::max(std::abs(height.lower), std::abs(height.upper)));
    ExpectWithinBound(MakeCone(at.frame, lower, upper, height, RandomAngles(random)),
                      farthest,
                      at.at_home,
                      off_cone,
                      random);
  });
}

void ExpectToriAreExact(unsigned seed, int cases) {
  ForFrames(seed, cases, [](const RoundCase& at, RandomSplines& random) {
    const double major = RandomRadius(random), minor = major * random.Real(0.05, 0.95);
    const NurbsSurface torus =
        MakeTorus(at.frame, major, minor, RandomAngles(random), RandomAngles(random));
    const auto distance = [&](const Eigen::Vector3d& p) {
      const Extended3 across = AcrossAxis(p, at.frame.origin(), at.frame.axis());
      const Extended3 axial = Extended(p) - Extended(at.frame.origin()) - across;
      const long double over = ExtendedNorm(across) - major, height = ExtendedNorm(axial);
      return std::sqrt(over * over + height * height) - minor;
    };
    ExpectWithinBound(torus, major + minor, at.at_home, distance, random);
  });
}

TEST(MakeSurfaceTest, RoundShapesAreExactToFourUnitsInTheLastPlace) {
  ExpectSpheresAreExact(kSeed, 4);
  ExpectCylindersAndConesAreExact(kSeed, 4);
  ExpectToriAreExact(kSeed, 4);
}

TEST(LongMakeSurfaceTest, ManyRoundShapesAreExactToFourUnitsInTheLastPlace) {
  ExpectSpheresAreExact(kSeed + 1, 150);
  ExpectCylindersAndConesAreExact(kSeed + 1, 150);
  ExpectToriAreExact(kSeed + 1, 150);
}

// u = 0 and u = 1 the same bit by bit; so are whole tubes, and poles are one point.
TEST(MakeSurfaceTest, ClosedEdgesAndPolesCoincideBitByBit) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 20; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    const Frame frame = RandomFrame(random, 1e3);
    const AngleRange round{random.Real(-3, 3), 2 * kPi};
    const NurbsSurface sphere = MakeSphere(frame, 2, round);
    const NurbsSurface torus = MakeTorus(frame, 2, 1, round, {random.Real(-3, 3), 2 * kPi});
    const NurbsSurface cone = MakeCone(frame, 0, 1, {-1, 2}, round);
    for (const NurbsSurface* s : {&sphere, &torus, &cone}) {
      for (int j = 0; j < s->size_v(); ++j) {
        EXPECT_TRUE(s->control_point(0, j) == s->control_point(s->size_u() - 1, j));
      }
    }
    for (int i = 0; i < 9; ++i) {
      EXPECT_TRUE(torus.control_point(i, 0) == torus.control_point(i, 8));
      EXPECT_TRUE(sphere.control_point(i, 0) == sphere.control_point(0, 0));
      EXPECT_TRUE(sphere.control_point(i, 4) == sphere.control_point(0, 4));
      EXPECT_TRUE(cone.control_point(i, 0) == cone.control_point(0, 0));
    }
    EXPECT_EQ(CollapsedEdges(sphere), (CollapsedEdgeSet{.v_lower = true, .v_upper = true}));
    EXPECT_EQ(CollapsedEdges(torus), CollapsedEdgeSet{});
  }
}

// S_u × S_v looks outward everywhere, poles and tips included.
TEST(MakeSurfaceTest, NormalsLookOutwardAlsoAtPolesAndTips) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 10; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    const Frame frame = RandomFrame(random, 10);
    const double half_angle = random.Real(0.1, 1.4);
    const NurbsSurface sphere = MakeSphere(frame, 2, RandomAngles(random));
    const NurbsSurface torus = MakeTorus(frame, 2, 0.5, RandomAngles(random), RandomAngles(random));
    const NurbsSurface cone = MakeCone(frame, 0, 3 * std::tan(half_angle), {0, 3});
    const NurbsSurface down = MakeCone(frame, 3 * std::tan(half_angle), 0, {-3, 0});
    for (int i = 0; i < 40; ++i) {
      const double u = random.Real(0, 1);
      const double v = i < 10 ? 0 : i < 20 ? 1 : random.Real(0, 1);
      const auto normal = [&](const NurbsSurface& s) {
        const auto n = s.NormalAt(u, v);
        EXPECT_TRUE(n.has_value()) << u << ", " << v;
        return n.value_or(Eigen::Vector3d::Zero());
      };
      EXPECT_LE((normal(sphere) - (sphere.At(u, v) - frame.origin()) / 2).norm(), kIterated);
      const Eigen::Vector3d from = torus.At(u, v) - frame.origin();
      const Eigen::Vector3d across = from - from.dot(frame.axis()) * frame.axis();
      EXPECT_LE((normal(torus) - (from - 2 * across.normalized()) / 0.5).norm(), kIterated);
      const auto cone_normal = [&](const NurbsSurface& s, double towards) {
        const Eigen::Vector3d on = s.At(u, 0.5) - frame.origin();
        const Eigen::Vector3d out = (on - on.dot(frame.axis()) * frame.axis()).normalized();
        return Eigen::Vector3d(std::cos(half_angle) * out +
                               towards * std::sin(half_angle) * frame.axis());
      };
      EXPECT_LE((normal(cone) - cone_normal(cone, -1)).norm(), kIterated);
      EXPECT_LE((normal(down) - cone_normal(down, 1)).norm(), kIterated);
    }
  }
}

TEST(MakeSurfaceTest, AreWhatTheyAreClassifiedAs) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 20; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    const Frame frame = RandomFrame(random, 10);
    const double r = random.Logarithmic(0.1, 10);
    const AngleRange round{random.Real(-3, 3), random.Real(0.5, 2 * kPi)};
    const auto plane = std::get<PlaneShape>(ClassifyShape(MakePlane(frame, {-1, r}, {2, 3})));
    EXPECT_LE(plane.normal.cross(frame.axis()).norm(), kIterated);
    const auto cylinder =
        std::get<CylinderShape>(ClassifyShape(MakeCylinder(frame, r, {-1, 2}, round)));
    EXPECT_NEAR(cylinder.radius, r, kIterated * r);
    const auto sphere = std::get<SphereShape>(ClassifyShape(MakeSphere(frame, r, round)));
    EXPECT_LE((sphere.center - frame.origin()).norm(), kIterated * (10 + r));
    const auto cone = std::get<ConeShape>(ClassifyShape(MakeCone(frame, r, 2 * r, {0, 3}, round)));
    EXPECT_NEAR(cone.half_angle, std::atan(r / 3), kIterated);
    const auto torus = std::get<TorusShape>(ClassifyShape(MakeTorus(frame, 2 * r, r, round)));
    EXPECT_NEAR(torus.major_radius, 2 * r, kIterated * r);
    EXPECT_NEAR(torus.minor_radius, r, kIterated * r);
  }
}

// S(u,v) is C(v) turned by the angle that the point of the unit arc at u has.
TEST(MakeSurfaceTest, RevolvingTurnsTheCurve) {
  RandomSplines random(kSeed);
  for (int k = 0; k < 40; ++k) {
    SCOPED_TRACE(testing::Message() << "seed " << kSeed << ", case " << k);
    const bool periodic = random.Coin();
    const NurbsCurve<3> curve =
        random.Curve<3>(random.Integer(1, 5), random.Coin(), {.periodic = periodic});
    const Eigen::Matrix3Xd& points = curve.control_points();
    if ((points.colwise() - points.col(0)).isZero(0)) continue;  // a periodic one of one span
    const Frame frame = RandomFrame(random, 2);
    const AngleRange angles = RandomAngles(random);
    if ((curve.control_points().colwise() - curve.control_points().col(0)).isZero(0)) {
      EXPECT_THAT(RefusalOf([&] { Revolve(curve, frame, angles); }), HasSubstr("is a point"));
      continue;
    }
    const NurbsSurface surface = Revolve(curve, frame, angles);
    EXPECT_EQ(surface.basis_v(), curve.basis());
    const NurbsCurve<2> arc = MakeArc(Eigen::Vector2d(0, 0), 1, angles);
    for (int i = 0; i < 30; ++i) {
      const double u = i == 0 ? 0 : i == 1 ? 1 : random.Real(0, 1);
      const double v = random.Parameter(curve.basis());
      const Eigen::Vector2d at = arc.At(u);
      const Eigen::AngleAxisd turn(std::atan2(at.y(), at.x()), frame.axis());
      const Eigen::Vector3d expected = frame.origin() + turn * (curve.At(v) - frame.origin());
      const double size = curve.control_points().cwiseAbs().maxCoeff() + frame.origin().norm();
      EXPECT_LE((surface.At(u, v) - expected).norm(), kRounding * size);
    }
  }
}

TEST(MakeSurfaceTest, RevolvingAProfileFromTheAxisMakesAPole) {
  const Frame frame({1, 2, 3}, {1, 1, 1});
  Eigen::Matrix3Xd points(3, 3);
  points << frame.At(0, 0, 0), frame.At(2, 0, 0), frame.At(2, 0, 2);
  const NurbsSurface surface =
      Revolve(NurbsCurve<3>(SplineBasis(2, {0, 0, 0, 1, 1, 1}), points), frame);
  EXPECT_EQ(CollapsedEdges(surface), (CollapsedEdgeSet{.v_lower = true}));
  for (int i = 0; i < 9; ++i) {
    EXPECT_TRUE(surface.control_point(i, 0) == surface.control_point(0, 0));
  }
  const auto normal = surface.NormalAt(0.3, 0);
  ASSERT_TRUE(normal.has_value());
  EXPECT_LE((*normal + frame.axis()).norm(), kIterated);  // the profile leads outward: down
  const NurbsCurve<3> on_axis = MakeLine<3>(frame.At(0, 0, 1), frame.At(0, 0, 2));
  EXPECT_THROW(Revolve(on_axis, frame), std::invalid_argument);
}

// A profile in a plane with the axis may cross it once; twice, and turned by more than half a turn,
// the surface would go through itself.
TEST(MakeSurfaceTest, ProfilesThatCrossTheirAxisTwiceAreRefusedWithThePlaces) {
  const Frame frame({5e6, 2, 3}, {1, 1, 1});
  const auto profile = [&](const std::vector<double>& out) {
    Eigen::Matrix3Xd points(3, out.size());
    std::vector<double> knots = {0};
    for (size_t k = 0; k < out.size(); ++k) {
      points.col(static_cast<Eigen::Index>(k)) = frame.At(out[k], 0, static_cast<double>(k));
      knots.push_back(static_cast<double>(k));
    }
    knots.push_back(knots.back());
    return NurbsCurve<3>(SplineBasis(1, knots), points);
  };
  const auto refused = [&](const NurbsCurve<3>& curve, double sweep) {
    try {
      Revolve(curve, frame, {0, sweep});
    } catch (const std::invalid_argument& error) {
      return std::string(error.what());
    }
    return std::string();
  };
  constexpr double kHalf = std::numbers::pi;
  const std::string twice = refused(profile({1, -1, 3}), 2 * kHalf);
  EXPECT_NE(twice.find("crosses its axis 2 times, first at its parameters 0.5 ("),
            std::string::npos)
      << twice;
  EXPECT_NE(twice.find("and 1.25 ("), std::string::npos) << twice;
  EXPECT_EQ(refused(profile({1, -1, 3}), kHalf), "");
  EXPECT_EQ(refused(profile({1, -1}), 2 * kHalf), "");          // a double cone
  EXPECT_EQ(refused(profile({0, 1, 0}), 2 * kHalf), "");        // two poles
  EXPECT_EQ(refused(profile({1, 0, 1, 0, 2}), 2 * kHalf), "");  // touches
  EXPECT_NE(refused(MakeArc(Frame(frame.At(0.5, 0, 0), frame.y()), 1), 2 * kHalf), "");
  EXPECT_NE(refused(MakeArc(Frame(frame.At(0, 0, 0), frame.y(), frame.axis()), 1), 2 * kHalf), "");
  EXPECT_EQ(refused(MakeArc(Frame(frame.At(1, 0, 0), frame.y(), frame.axis()), 1), 2 * kHalf), "");
}

// A circle about the axis covers itself again; a short arc across it far away does not.
TEST(MakeSurfaceTest, CurvesThatOnlyGoRoundTheAxisAreRefused) {
  const Frame frame({5e6, 2, 3}, {1, 1, 1});
  const Frame above(frame.At(0, 0, 7), frame.axis());
  for (const double sweep : {0.1, 3.0, 2 * std::numbers::pi}) {
    EXPECT_THAT(RefusalOf([&] {
                  Revolve(MakeArc(above, 2, {1, sweep}), frame);
                }),
                HasSubstr("lies on a circle about the axis"));
  }
  Revolve(MakeArc(Frame(frame.At(1, 0, 7), frame.axis()), 2, {1, 2}), frame);
  Revolve(MakeLine<3>({5e6, 0, 0}, {5e6 + 1e-3, 0, 0}), Frame());
  Revolve(MakeLine<3>({5e6, 0, 0}, {5e6, 0, 1e-3}), Frame());
}

NurbsSurface Fixture(const std::string& kind, const std::vector<double>& a) {
  if (kind == "sphere") return MakeSphere(Frame(), a[0]);
  if (kind == "torus") return MakeTorus(Frame(), a[0], a[1]);
  if (kind == "cylinder") return MakeCylinder(Frame(), a[0], {0, a[1]});
  const double height = a[2] * std::cos(a[1]);
  return MakeCone(Frame(), a[0], a[0] + a[2] * std::sin(a[1]), {0, height});
}

double Residual(const std::string& kind, const std::vector<double>& a, const Eigen::Vector3d& p) {
  const double across = std::hypot(p.x(), p.y());
  if (kind == "sphere") return p.squaredNorm() / (a[0] * a[0]) - 1;
  if (kind == "torus") {
    return (std::pow(across - a[0], 2) + p.z() * p.z()) / (a[1] * a[1]) - 1;
  }
  if (kind == "cylinder") return std::pow(across / a[0], 2) - 1;
  return across / (a[0] + p.z() * std::tan(a[1])) - 1;
}

TEST(MakeSurfaceTest, TheFixturesAreReproduced) {
  using namespace fixtures;
  int seen = 0;
  CheckAll("exact_primitives.json", [&](const Json& input, const Json& expected, double tolerance) {
    if (!expected.contains("area")) return;
    ++seen;
    const std::string kind = input.at("kind");
    const auto parameters = input.at("parameters").get<std::vector<double>>();
    const NurbsSurface surface = Fixture(kind, parameters);
    ExpectClose(Area(surface), expected.at("area"), tolerance);
    for (int i = 0; i <= 40; ++i) {
      for (int j = 0; j <= 40; ++j) {
        EXPECT_NEAR(Residual(kind, parameters, surface.At(i / 40.0, j / 40.0)),
                    0,
                    expected.at("max_implicit_residual").get<double>());
      }
    }
  });
  EXPECT_EQ(seen, 8);
}

TEST(MakeSurfaceTest, RefusalsNameValueAndRule) {
  const Frame f;
  EXPECT_THAT(RefusalOf([&] { MakeCylinder(f, -1, {0, 1}); }), HasSubstr("radius = -1"));
  EXPECT_THAT(RefusalOf([&] { MakeCylinder(f, 1, {1, 1}); }), HasSubstr("height = [1, 1]"));
  EXPECT_THAT(RefusalOf([&] { MakeCone(f, -1, 1, {0, 1}); }), HasSubstr("radius_lower = -1"));
  EXPECT_THAT(RefusalOf([&] { MakeCone(f, 0, 0, {0, 1}); }), HasSubstr("both radii are zero"));
  EXPECT_THAT(RefusalOf([&] { MakeSphere(f, 1, {}, {-2, 1}); }), HasSubstr("latitude = [-2, 1]"));
  EXPECT_THAT(RefusalOf([&] { MakeTorus(f, 0, 1); }), HasSubstr("major = 0"));
  EXPECT_THAT(RefusalOf([&] { MakeTorus(f, 1, 1, {}, {0, 9}); }), HasSubstr("tube.sweep = 9"));
  EXPECT_THAT(RefusalOf([&] { MakePlane(f, {0, HUGE_VAL}, {0, 1}); }), HasSubstr("x = [0, inf]"));
}

}  // namespace batten::internal::make_surface_test
