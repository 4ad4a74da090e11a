// SPDX-License-Identifier: MIT
#include "batten/geometry/classify_shape.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <cmath>
#include <numbers>
#include <sstream>

#include "batten/geometry/homogeneous.h"
#include "dense_samples.h"
#include "exact_shapes.h"
#include "fixtures.h"
#include "random_splines.h"
#include "tolerances.h"

namespace batten {
namespace {

// A turn, a scale between 1e-9 and 1e9 and a shift of at most ten times the scaled size.
struct Placement {
  double scale;
  Eigen::Matrix3d turn;
  Eigen::Vector3d shift;

  explicit Placement(RandomSplines& random)
      : scale(random.Logarithmic(1e-9, 1e9)), turn(random.Orthogonal()) {
    shift = scale * random.Logarithmic(1e-2, 10) * random.Vector(1);
  }
  Eigen::Vector3d Point(const Eigen::Vector3d& p) const { return scale * (turn * p) + shift; }

  NurbsCurve<3> Placed(const NurbsCurve<3>& curve) const {
    return NurbsCurve<3>(curve.basis(),
                         (scale * (turn * curve.control_points())).colwise() + shift,
                         curve.weights());
  }
  NurbsSurface Placed(const NurbsSurface& surface) const {
    return NurbsSurface(surface.basis_u(),
                        surface.basis_v(),
                        (scale * (turn * surface.control_points())).colwise() + shift,
                        surface.weights());
  }
};

// The same columns over another basis that contains the first: by interpolation at the Greville
// abscissae, each taken a little into the inside of the domain of neither end.
Eigen::MatrixXd Converted(const SplineBasis& from,
                          const Eigen::MatrixXd& columns,
                          const SplineBasis& to) {
  const int n = to.size(), p = to.degree(), q = from.degree();
  Eigen::MatrixXd matrix = Eigen::MatrixXd::Zero(n, n), values(n, columns.rows());
  std::vector<double> N(kMaxDegree + 1);
  for (int i = 0; i < n; ++i) {
    const double u = to.Clamp(to.Greville(i));
    const int span = to.Span(u);
    to.Values(span, u, N.data());
    for (int r = 0; r <= p; ++r) matrix(i, span - p + r) = N[r];
    const int old_span = from.Span(u);
    from.Values(old_span, u, N.data());
    values.row(i).setZero();
    for (int r = 0; r <= q; ++r) values.row(i) += N[r] * columns.col(old_span - q + r).transpose();
  }
  return matrix.partialPivLu().solve(values).transpose();
}

// The basis of `by` degrees more, and with some more knots.
SplineBasis Richer(const SplineBasis& basis, int by, RandomSplines& random) {
  const std::vector<double>& old = basis.knots();
  std::vector<double> knots;
  for (size_t k = 0; k < old.size();) {
    size_t next = k;
    while (next < old.size() && old[next] == old[k]) ++next;
    knots.insert(knots.end(), next - k + by, old[k]);
    if (next < old.size() && random.Coin()) {
      knots.push_back(old[k] + random.Real(0.2, 0.8) * (old[next] - old[k]));
    }
    k = next;
  }
  return SplineBasis(basis.degree() + by, std::move(knots));
}

template <int Dim>
NurbsCurve<Dim> Richer(const NurbsCurve<Dim>& curve, int by, RandomSplines& random) {
  const SplineBasis basis = Richer(curve.basis(), by, random);
  return CurveFromHomogeneous<Dim>(
      basis, Converted(curve.basis(), Homogeneous(curve), basis), curve.rational());
}

NurbsCurve<3> InSpace(const NurbsCurve<2>& curve) {
  Eigen::Matrix3Xd points = Eigen::Matrix3Xd::Zero(3, curve.control_points().cols());
  points.topRows<2>() = curve.control_points();
  return NurbsCurve<3>(curve.basis(), points, curve.weights());
}

// Other weights by a linear rational change of the parameter of a one-span curve: w_i · c^i.
template <int Dim>
NurbsCurve<Dim> Moebius(const NurbsCurve<Dim>& curve, double c) {
  Eigen::VectorXd weights = curve.weights();
  for (Eigen::Index i = 0; i < weights.size(); ++i) weights[i] *= std::pow(c, i);
  return NurbsCurve<Dim>(curve.basis(), curve.control_points(), weights);
}

NurbsCurve<2> ConicArc(const Eigen::Matrix<double, 2, 3>& points, double w1) {
  return NurbsCurve<2>(SplineBasis(2, {0, 0, 0, 1, 1, 1}), points, Eigen::Vector3d(1, w1, 1));
}

// An arc of the circle of radius one about the origin, less than half.
NurbsCurve<2> CircleArc(double start, double sweep) {
  const double half = sweep / 2, reach = 1 / std::cos(half);
  Eigen::Matrix<double, 2, 3> points;
  points << std::cos(start), reach * std::cos(start + half), std::cos(start + sweep),
      std::sin(start), reach * std::sin(start + half), std::sin(start + sweep);
  return ConicArc(points, std::cos(half));
}

NurbsCurve<2> Shifted(const NurbsCurve<2>& curve, double scale, double x, double y) {
  return NurbsCurve<2>(curve.basis(),
                       (scale * curve.control_points()).colwise() + Eigen::Vector2d(x, y),
                       curve.weights());
}

TEST(ClassifyShapeTest, AnyFormOfALineIsALine) {
  RandomSplines random(1);
  for (int k = 0; k < 300; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 1, case " << k);
    const int degree = random.Integer(1, 11);
    const bool periodic = random.Integer(0, 3) == 0;
    const NurbsCurve<3> any =
        random.Curve<3>(degree, random.Coin(), {.clamped = random.Coin(), .periodic = periodic});
    if (periodic && any.basis().size() == degree + 1) continue;  // a point
    const Eigen::Vector3d start = random.Vector(3), direction = random.Vector(1).normalized();
    Eigen::Matrix3Xd points = direction * any.control_points().row(0);
    points.colwise() += start;
    const Placement place(random);
    const CurveShape shape =
        ClassifyShape(place.Placed(NurbsCurve<3>(any.basis(), points, any.weights())));
    ASSERT_EQ(NameOf(shape), "line");
    const auto& line = std::get<LineShape>(shape);
    EXPECT_LT(line.direction.cross(place.turn * direction).norm(), 100 * kRounding);
    EXPECT_LT((line.point - place.Point(start)).cross(line.direction).norm(),
              100 * kRounding * place.scale);
  }
}

TEST(ClassifyShapeTest, ArcsAreCirclesInEveryForm) {
  RandomSplines random(2);
  for (int k = 0; k < 500; ++k) {
    const double sweep = random.Logarithmic(1e-3, 3);
    NurbsCurve<3> curve = InSpace(CircleArc(random.Real(0, 6), sweep));
    curve = Moebius(curve, random.Logarithmic(0.1, 10));
    const int by = random.Integer(0, 6);
    if (by > 0) curve = Richer(curve, by, random);
    const Placement place(random);
    SCOPED_TRACE(::testing::Message()
                 << "seed 2, case " << k << ": sweep " << sweep << ", elevated by " << by);
    const CurveShape shape = ClassifyShape(place.Placed(curve));
    ASSERT_EQ(NameOf(shape), "circle");
    const auto& circle = std::get<CircleShape>(shape);
    // Radius and centre follow from the sagitta, sweep² / 8 of the radius.
    const double relative = 100 * kRounding / (sweep * sweep);
    EXPECT_NEAR(circle.radius, place.scale, relative * place.scale);
    EXPECT_LT((circle.center - place.Point(Eigen::Vector3d::Zero())).norm(),
              relative * place.scale);
    EXPECT_LT(circle.normal.cross(place.turn.col(2)).norm(), relative);
  }
}

TEST(ClassifyShapeTest, CirclesOfThePlaneHaveTheirCentreRadiusAndSense) {
  const CurveShape shape = ClassifyShape(Shifted(Circle(2), 1, 3, -5));
  ASSERT_EQ(NameOf(shape), "circle");
  const auto& circle = std::get<CircleShape>(shape);
  EXPECT_NEAR(circle.radius, 2, kRounding);
  EXPECT_LT((circle.center - Eigen::Vector3d(3, -5, 0)).norm(), kRounding);
  EXPECT_LT((circle.normal - Eigen::Vector3d(0, 0, 1)).norm(), kRounding);  // runs to the left
}

// The 9-point circle over a periodic basis that begins inside an arc.
TEST(ClassifyShapeTest, ThePeriodicCircleIsACircle) {
  const SplineBasis basis =
      SplineBasis::Periodic(2, {-0.25, 0, 0, 0.25, 0.25, 0.5, 0.5, 0.75, 0.75, 1, 1, 1.25, 1.25});
  const NurbsCurve<2> circle = Circle(3);
  Eigen::Matrix2Xd points(2, basis.size());
  Eigen::VectorXd weights(basis.size());
  for (int i = 0; i < basis.size(); ++i) {
    const int j = i % 8;
    points.col(i) = circle.control_points().col(j);
    weights[i] = circle.weights()[j];
  }
  EXPECT_EQ(NameOf(ClassifyShape(NurbsCurve<2>(basis, points, weights))), "circle");
}

TEST(ClassifyShapeTest, QuadraticBezierCurvesAreWhatTheirShapeFactorSays) {
  RandomSplines random(3);
  int seen[3] = {0, 0, 0};
  for (int k = 0; k < 1000; ++k) {
    NurbsCurve<2> plane = random.Curve<2>(2, true, {.most_spans = 1});
    Eigen::VectorXd w = plane.weights();
    if (random.Integer(0, 2) == 0) w[1] = std::sqrt(w[0] * w[2]);
    plane = NurbsCurve<2>(plane.basis(), plane.control_points(), w);
    const Placement place(random);
    NurbsCurve<3> curve = InSpace(plane);
    if (random.Coin()) curve = Richer(curve, random.Integer(1, 4), random);
    static const char* const kNames[] = {"ellipse", "parabola", "hyperbola"};
    const auto expected = static_cast<int>(ClassifyConic(w[0], w[1], w[2]));
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(curve))), kNames[expected])
        << "seed 3, case " << k << ": k = " << ConicShapeFactor(w[0], w[1], w[2]);
    ++seen[expected];
  }
  for (const int count : seen) EXPECT_GT(count, 100);
}

// Every point of a conic keeps the law of its foci.
TEST(ClassifyShapeTest, PointsKeepTheLawOfTheFoci) {
  RandomSplines random(4);
  for (int k = 0; k < 600; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 4, case " << k);
    NurbsCurve<2> plane = random.Curve<2>(2, false, {.most_spans = 1});
    plane = NurbsCurve<2>(plane.basis(),
                          plane.control_points(),
                          Eigen::Vector3d(1, k % 3 == 0 ? 1 : random.Logarithmic(0.2, 5), 1));
    const Placement place(random);
    const NurbsCurve<3> curve = place.Placed(InSpace(plane));
    const CurveShape shape = ClassifyShape(curve);
    for (const double u : {0.0, 0.3, 0.7, 1.0}) {
      const Eigen::Vector3d p = curve.At(u);
      if (const auto* parabola = std::get_if<ParabolaShape>(&shape)) {
        const double f = parabola->focal_length, along = (p - parabola->vertex).dot(parabola->axis);
        const double to_focus = (p - parabola->vertex - f * parabola->axis).norm();
        EXPECT_NEAR(to_focus, along + f, kIterated * (to_focus + place.scale));
      } else if (const auto* ellipse = std::get_if<EllipseShape>(&shape)) {
        const double a = ellipse->major_radius, b = ellipse->minor_radius;
        ASSERT_GE(a, b);
        EXPECT_LT(std::abs(ellipse->major_axis.dot(ellipse->minor_axis)), kRounding);
        const Eigen::Vector3d focus = std::sqrt((a - b) * (a + b)) * ellipse->major_axis;
        const Eigen::Vector3d from = p - ellipse->center;
        EXPECT_NEAR((from - focus).norm() + (from + focus).norm(), 2 * a, kIterated * a);
      } else if (const auto* hyperbola = std::get_if<HyperbolaShape>(&shape)) {
        const double a = hyperbola->transverse_radius, b = hyperbola->conjugate_radius;
        EXPECT_LT(std::abs(hyperbola->transverse_axis.dot(hyperbola->conjugate_axis)), kRounding);
        const Eigen::Vector3d focus = std::hypot(a, b) * hyperbola->transverse_axis;
        const Eigen::Vector3d from = p - hyperbola->center;
        EXPECT_NEAR((from + focus).norm() - (from - focus).norm(),
                    2 * a,
                    kIterated * (from.norm() + a + b));
      } else {
        ADD_FAILURE() << NameOf(shape);
      }
    }
  }
}

TEST(ClassifyShapeTest, OtherCurvesAreFree) {
  RandomSplines random(5);
  for (int k = 0; k < 1000; ++k) {
    const int degree = random.Integer(2, 11);
    const bool periodic = random.Integer(0, 3) == 0;
    const BasisKind kind{.clamped = random.Coin(), .periodic = periodic};
    const bool rational = random.Coin();
    SCOPED_TRACE(::testing::Message() << "seed 5, case " << k << ": degree " << degree);
    const NurbsCurve<2> plane = random.Curve<2>(degree, rational, kind);
    const int distinct = plane.basis().size() - (periodic ? degree : 0);
    if (distinct > 3) {
      EXPECT_EQ(NameOf(ClassifyShape(plane)), "free");
    }
    const NurbsCurve<3> space = random.Curve<3>(degree, rational, kind);
    if (space.basis().size() - (periodic ? degree : 0) > 3) {
      EXPECT_EQ(NameOf(ClassifyShape(space)), "free");
    }
  }
}

TEST(ClassifyShapeTest, BrokenLinesAndPointsAreFree) {
  const SplineBasis two(1, {0, 0, 1, 2, 2});
  for (const double bend : {1.0, 1e-3, 1e-6, 1e-7}) {
    Eigen::Matrix<double, 2, 3> points{{-1, 0, 1}, {0, bend, 0}};
    EXPECT_EQ(NameOf(ClassifyShape(NurbsCurve<2>(two, points))), "free") << bend;
  }
  const Eigen::Matrix<double, 2, 3> there_and_back{{0, 1, 0}, {0, 2, 0}};
  EXPECT_EQ(NameOf(ClassifyShape(NurbsCurve<2>(two, there_and_back))), "line");
  const Eigen::Matrix<double, 3, 3> point = Eigen::Vector3d(1, 2, 3).replicate<1, 3>();
  EXPECT_EQ(NameOf(ClassifyShape(NurbsCurve<3>(two, point))), "free");
  EXPECT_EQ(NameOf(ClassifyShape(NurbsCurve<3>(two, Eigen::Matrix3d::Zero()))), "free");
}

// A control point of weight one in a million moves the curve only where weights are small: the
// checking samples find the place.
TEST(ClassifyShapeTest, ALightControlPointOffTheLineIsSeen) {
  Eigen::Matrix<double, 2, 4> points{{0, 1, 2, 3}, {0, 0, 1, 0}};
  const NurbsCurve<2> curve(
      SplineBasis(3, {0, 0, 0, 0, 1, 1, 1, 1}), points, Eigen::Vector4d(1e6, 1e6, 1, 1e6));
  const double off = curve.At(0.5)[1];
  ASSERT_GT(off, 1e-7);
  EXPECT_EQ(NameOf(ClassifyShape(curve)), "free");
  EXPECT_EQ(NameOf(ClassifyShape(curve, {.tolerance = 1e-6})), "line");
}

// A circle with one control point moved by a little is none; with one moved by less than the
// tolerance it still is.
TEST(ClassifyShapeTest, WhatIsNearlyACircleIsOneWithinTheToleranceOnly) {
  RandomSplines random(6);
  for (int k = 0; k < 200; ++k) {
    const NurbsCurve<2> circle = Circle(random.Logarithmic(1e-9, 1e9));
    const double size = ExtentOf(circle), moved = size * random.Logarithmic(1e-7, 1e-2);
    Eigen::Matrix2Xd points = circle.control_points();
    points.col(random.Integer(1, 7)) += moved * Eigen::Vector2d(random.Real(-1, 1), 1);
    const NurbsCurve<2> off(circle.basis(), points, circle.weights());
    EXPECT_EQ(NameOf(ClassifyShape(off)), "free") << "seed 6, case " << k;
    EXPECT_EQ(NameOf(ClassifyShape(off, {.tolerance = moved / size})), "circle") << k;
  }
}

TEST(ClassifyShapeTest, TheConicOfBezierWeights) {
  EXPECT_EQ(ClassifyConic(1, 1, 1), ConicKind::kParabola);
  EXPECT_EQ(ClassifyConic(1, 0.5, 1), ConicKind::kEllipse);
  EXPECT_EQ(ClassifyConic(1, -0.5, 1), ConicKind::kEllipse);
  EXPECT_EQ(ClassifyConic(1, 2, 1), ConicKind::kHyperbola);
  EXPECT_EQ(ClassifyConic(0.1, 0.3, 0.9), ConicKind::kParabola);
  EXPECT_EQ(ClassifyConic(1, 1.01, 1, 0.1), ConicKind::kParabola);
  EXPECT_DOUBLE_EQ(ConicShapeFactor(2, 3, 4), 8.0 / 9);
  EXPECT_THROW(ClassifyConic(1, 0, 1), std::invalid_argument);
  EXPECT_THROW(ClassifyConic(1, 1, -1), std::invalid_argument);
  EXPECT_THROW(ClassifyConic(1, 1, 1, -1), std::invalid_argument);
  EXPECT_THROW(ClassifyShape(Circle(1), {.tolerance = 0}), std::invalid_argument);
  EXPECT_THROW(ClassifyShape(Sphere(1), {.tolerance = NAN}), std::invalid_argument);
}

// A surface over richer bases in both directions.
NurbsSurface Richer(const NurbsSurface& surface, int by_u, int by_v, RandomSplines& random) {
  const SplineBasis u = Richer(surface.basis_u(), by_u, random);
  const NurbsSurface first = SurfaceFromHomogeneous(
      surface,
      Direction::kU,
      u,
      Converted(surface.basis_u(), HomogeneousRows(surface, Direction::kU), u));
  const SplineBasis v = Richer(surface.basis_v(), by_v, random);
  return SurfaceFromHomogeneous(
      first,
      Direction::kV,
      v,
      Converted(first.basis_v(), HomogeneousRows(first, Direction::kV), v));
}

// The profile (distance from the axis, height) turned by `sweep` < π from `start`.
NurbsSurface RevolvedPatch(const NurbsCurve<2>& profile, double start, double sweep) {
  const NurbsCurve<2> arc = CircleArc(start, sweep);
  const Eigen::Index m = profile.control_points().cols();
  Eigen::Matrix3Xd points(3, 3 * m);
  Eigen::VectorXd weights(3 * m);
  for (Eigen::Index i = 0; i < 3; ++i) {
    for (Eigen::Index j = 0; j < m; ++j) {
      points.col(i * m + j) << profile.control_points()(0, j) * arc.control_points().col(i),
          profile.control_points()(1, j);
      weights[i * m + j] = arc.weights()[i] * profile.weights()[j];
    }
  }
  return NurbsSurface(arc.basis(), profile.basis(), points, weights);
}

NurbsCurve<2> Segment(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  Eigen::Matrix2d points;
  points << a, b;
  return NurbsCurve<2>(SplineBasis(1, {0, 0, 1, 1}), points);
}

// A patch of a known shape about the z axis, or with its centre at the origin.
struct KnownPatch {
  enum Kind { kCylinder, kCone, kSphere, kTorus } kind;
  NurbsSurface surface;
  double first, second = 0;  // radius; half angle; radius; major and minor radius
  double smallest_turn;      // the smaller of the angles the normal turns through: the condition
  std::string description;
};

KnownPatch RandomPatch(KnownPatch::Kind kind, double least, RandomSplines& random) {
  const double sweep = random.Logarithmic(least, 3), length = random.Logarithmic(least, 3);
  const double radius = random.Real(0.5, 2), start = random.Real(0, 6);
  std::ostringstream text;
  text << "kind " << kind << ", turned by " << sweep << ", profile " << length;
  switch (kind) {
    case KnownPatch::kCylinder:
      return {kind,
              RevolvedPatch(Segment({radius, 0.3}, {radius, 0.3 + length}), start, sweep),
              radius,
              0,
              sweep,
              text.str()};
    case KnownPatch::kCone: {
      const double angle = random.Real(0.05, 1.5), from = random.Coin() ? 0 : 0.3;
      text << ", half angle " << angle;
      const Eigen::Vector2d direction(std::sin(angle), std::cos(angle));
      return {kind,
              RevolvedPatch(Segment(from * direction, (from + length) * direction), start, sweep),
              angle,
              0,
              sweep * std::cos(angle),
              text.str()};
    }
    case KnownPatch::kSphere: {
      const double low = random.Real(-1.5, 1.4), turn = std::min(length, 1.5 - low);
      return {kind,
              RevolvedPatch(Shifted(CircleArc(low, turn), radius, 0, 0), start, sweep),
              radius,
              0,
              std::min(sweep * std::cos(std::max(std::abs(low), std::abs(low + turn))), turn),
              text.str()};
    }
    default: {
      const double minor = random.Real(0.1, 0.9) * radius, low = random.Real(0, 6);
      text << ", minor " << minor / radius;
      return {kind,
              RevolvedPatch(Shifted(CircleArc(low, length), minor, radius, 0), start, sweep),
              radius,
              minor,
              std::min(sweep, length),
              text.str()};
    }
  }
}

void ExpectKnown(const KnownPatch& known,
                 const Placement& place,
                 const SurfaceShape& shape,
                 double relative) {
  static const char* const kNames[] = {"cylinder", "cone", "sphere", "torus"};
  ASSERT_EQ(NameOf(shape), kNames[known.kind]);
  const Eigen::Vector3d axis = place.turn.col(2), origin = place.shift;
  const double length = relative * place.scale;
  if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) {
    EXPECT_LT(cylinder->axis.cross(axis).norm(), relative);
    EXPECT_LT((cylinder->point - origin).cross(axis).norm(), length);
    EXPECT_NEAR(cylinder->radius, known.first * place.scale, length);
  } else if (const auto* cone = std::get_if<ConeShape>(&shape)) {
    EXPECT_LT((cone->axis - axis).norm(), relative);
    EXPECT_LT((cone->apex - origin).norm(), length);
    EXPECT_NEAR(cone->half_angle, known.first, relative);
  } else if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
    EXPECT_LT((sphere->center - origin).norm(), length);
    EXPECT_NEAR(sphere->radius, known.first * place.scale, length);
  } else if (const auto* torus = std::get_if<TorusShape>(&shape)) {
    EXPECT_LT(torus->axis.cross(axis).norm(), relative);
    EXPECT_LT((torus->center - origin).norm(), length);
    EXPECT_NEAR(torus->major_radius, known.first * place.scale, length);
    EXPECT_NEAR(torus->minor_radius, known.second * place.scale, length);
  }
}

void CheckPatches(unsigned seed, int count, double least) {
  RandomSplines random(seed);
  for (int k = 0; k < count; ++k) {
    const KnownPatch known = RandomPatch(static_cast<KnownPatch::Kind>(k % 4), least, random);
    const int by_u = random.Integer(0, 4), by_v = random.Integer(0, 4);
    const Placement place(random);
    NurbsSurface surface = known.surface;
    if (random.Coin()) surface = Richer(surface, by_u, by_v, random);
    SCOPED_TRACE(::testing::Message() << "seed " << seed << ", case " << k << ": "
                                      << known.description << ", by " << by_u << " " << by_v);
    const double relative = 1e-13 * std::pow(known.smallest_turn, -4) * 1e4;
    ExpectKnown(known, place, ClassifyShape(place.Placed(surface)), relative);
  }
}

TEST(ClassifyShapeTest, PatchesOfPrimitivesAreRecognizedInEveryForm) { CheckPatches(7, 400, 1e-2); }

TEST(ClassifyShapeTest, WholePrimitivesAreRecognized) {
  RandomSplines random(8);
  for (int k = 0; k < 20; ++k) {
    const Placement place(random);
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(Sphere(random.Real(0.1, 10))))), "sphere");
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(Cylinder(random.Real(0.1, 10), 1)))), "cylinder");
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(Cone(random.Real(0.1, 10), 1)))), "cone");
    const double minor = random.Real(0.1, 8);  // rings, and spindles whole
    const SurfaceShape torus = ClassifyShape(place.Placed(Torus(3, minor)));
    ASSERT_EQ(NameOf(torus), "torus") << minor;
    EXPECT_NEAR(
        std::get<TorusShape>(torus).minor_radius, minor * place.scale, kIterated * place.scale);
    EXPECT_NEAR(std::get<TorusShape>(torus).major_radius, 3 * place.scale, kIterated * place.scale);
    const NurbsSurface nappes = RevolvedPatch(Segment({-1, -2}, {0.5, 1}), 0, 2);
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(nappes))), "cone");
  }
}

// Any net in a plane, weights and all.
TEST(ClassifyShapeTest, AnyFormOfAPlaneIsAPlane) {
  RandomSplines random(9);
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 9, case " << k);
    const NurbsSurface any = random.Surface(random.Integer(1, 6),
                                            random.Integer(1, 6),
                                            random.Coin(),
                                            {.clamped = random.Coin(), .most_spans = 3});
    Eigen::Matrix3Xd points = any.control_points();
    points.row(2).setZero();
    const NurbsSurface flat(any.basis_u(), any.basis_v(), points, any.weights());
    const Placement place(random);
    const SurfaceShape shape = ClassifyShape(place.Placed(flat));
    ASSERT_EQ(NameOf(shape), "plane");
    const auto& plane = std::get<PlaneShape>(shape);
    EXPECT_LT(plane.normal.cross(place.turn.col(2)).norm(), kIterated);
    // One control point off the plane by about a millionth: the surface is as far off one plane as
    // its heights differ from the best linear ones, a quarter of its height at least for a corner
    // of a bilinear patch.
    const int i = random.Integer(0, any.size_u() - 1), j = random.Integer(0, any.size_v() - 1);
    points(2, i * any.size_v() + j) = 1e-6;
    const NurbsSurface bent(any.basis_u(), any.basis_v(), points, any.weights());
    double height = 0;
    for (const double u : DenseParameters(any.basis_u(), 12)) {
      for (const double v : DenseParameters(any.basis_v(), 12)) {
        height = std::max(height, bent.At(u, v)[2]);
      }
    }
    constexpr double kFourTolerances = 4 * 2 * 1.7 * 1e-9;
    if (height < 2 * kFourTolerances) continue;
    EXPECT_NE(NameOf(ClassifyShape(bent)), "plane") << "height " << height;
  }
}

TEST(ClassifyShapeTest, OtherSurfacesAreFree) {
  RandomSplines random(10);
  for (int k = 0; k < 100; ++k) {
    const int p = random.Integer(1, 7), q = random.Integer(1, 7);
    SCOPED_TRACE(::testing::Message() << "seed 10, case " << k << ": degrees " << p << ", " << q);
    const NurbsSurface surface =
        random.Surface(p, q, random.Coin(), {.clamped = random.Coin(), .most_spans = 4});
    EXPECT_EQ(NameOf(ClassifyShape(surface)), "free");
    EXPECT_EQ(NameOf(ClassifyShape(random.Sheet(p, q, 1e-3))), "free");
  }
}

// One control point of a primitive moved by a small part of the size, or none by rounding.
TEST(ClassifyShapeTest, WhatIsNearlyAPrimitiveIsFree) {
  RandomSplines random(11);
  const NurbsSurface whole[] = {Sphere(1), Cylinder(1, 2), Cone(1, 2), Torus(2, 1)};
  const char* const names[] = {"sphere", "cylinder", "cone", "torus"};
  for (int k = 0; k < 200; ++k) {
    const NurbsSurface& surface = whole[k % 4];
    const Placement place(random);
    Eigen::Matrix3Xd points = surface.control_points();
    const Eigen::Vector3d way = random.Vector(1);
    const auto column = random.Integer(1, static_cast<int>(points.cols()) - 1);
    points.col(column) += random.Logarithmic(1e-6, 1e-2) * way;
    const NurbsSurface off(surface.basis_u(), surface.basis_v(), points, surface.weights());
    EXPECT_EQ(NameOf(ClassifyShape(place.Placed(off))), "free") << "seed 11, case " << k;
    EXPECT_EQ(NameOf(ClassifyShape(off, {.tolerance = 0.1})) == "free", false) << names[k % 4];
  }
}

TEST(ClassifyShapeTest, TurnedAndExtrudedFreeFormsAreSeen) {
  RandomSplines random(12);
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 12, case " << k);
    const NurbsCurve<2> profile =
        Shifted(random.Curve<2>(random.Integer(3, 6), random.Coin(), {.most_spans = 3}), 0.5, 2, 0);
    const Placement place(random);
    const SurfaceShape turned =
        ClassifyShape(place.Placed(RevolvedPatch(profile, 0, random.Real(0.5, 2.5))));
    ASSERT_EQ(NameOf(turned), "revolution");
    const auto& revolution = std::get<RevolutionShape>(turned);
    EXPECT_LT(revolution.axis.cross(place.turn.col(2)).norm(), kIterated);
    EXPECT_LT((revolution.point - place.shift).cross(revolution.axis).norm(),
              kIterated * place.scale);

    Eigen::Matrix3Xd points(3, 2 * profile.control_points().cols());
    Eigen::VectorXd weights(points.cols());
    const Eigen::Vector3d height(random.Real(-1, 1), random.Real(-1, 1), 1);
    for (Eigen::Index i = 0; i < profile.control_points().cols(); ++i) {
      points.col(2 * i) << profile.control_points().col(i), 0;
      points.col(2 * i + 1) = points.col(2 * i) + height;
      weights[2 * i] = weights[2 * i + 1] = profile.weights()[i];
    }
    const SurfaceShape pulled = ClassifyShape(
        place.Placed(NurbsSurface(profile.basis(), SplineBasis(1, {0, 0, 1, 1}), points, weights)));
    ASSERT_EQ(NameOf(pulled), "extrusion");
    EXPECT_LT(
        std::get<ExtrusionShape>(pulled).direction.cross(place.turn * height.normalized()).norm(),
        kIterated);
  }
}

// A surface that has shrunk to a curve or a point has no class.
TEST(ClassifyShapeTest, CollapsedSurfacesAreFree) {
  RandomSplines random(13);
  for (int k = 0; k < 100; ++k) {
    SCOPED_TRACE(::testing::Message() << "seed 13, case " << k);
    const NurbsSurface any = random.Surface(random.Integer(1, 5), random.Integer(1, 5), k % 2 == 0);
    Eigen::Matrix3Xd points = any.control_points();
    for (int i = 0; i < any.size_u(); ++i) {
      for (int j = 0; j < any.size_v(); ++j) {
        points.col(i * any.size_v() + j) = points.col(k % 4 < 2 ? i * any.size_v() : 0);
      }
    }
    // Products of one weight for a row and one for a column.
    Eigen::VectorXd weights = Eigen::VectorXd::Ones(points.cols());
    for (Eigen::Index c = 0; c < weights.size() && k % 3 == 0; ++c) {
      weights[c] = any.weights()[c / any.size_v()] * any.weights()[c % any.size_v()];
    }
    const NurbsSurface collapsed(any.basis_u(), any.basis_v(), points, weights);
    EXPECT_EQ(NameOf(ClassifyShape(Placement(random).Placed(collapsed))), "free");
    points.row(2).setZero();
    const NurbsSurface flat(any.basis_u(), any.basis_v(), points, weights);
    EXPECT_EQ(NameOf(ClassifyShape(flat)), "free");
  }
}

// exact_primitives.json: about the origin and the z axis.
TEST(ClassifyShapeTest, OraclePrimitives) {
  fixtures::CheckAll("exact_primitives.json", [](const auto& in, const auto& expected, double tol) {
    const std::string kind = in.at("kind");
    const auto& form = expected.at("one_valid_nurbs");
    if (in.contains("radii")) {
      const CurveShape shape = ClassifyShape(fixtures::Curve<3>(form));
      ASSERT_EQ(NameOf(shape), kind);
      const double a = in.at("radii")[0], b = in.at("radii")[1];
      if (const auto* circle = std::get_if<CircleShape>(&shape)) {
        fixtures::ExpectClose(circle->radius, a, tol);
        EXPECT_LT(circle->center.norm(), tol * a);
      } else {
        const auto& ellipse = std::get<EllipseShape>(shape);
        fixtures::ExpectClose(ellipse.major_radius, a, tol);
        fixtures::ExpectClose(ellipse.minor_radius, b, tol);
        EXPECT_LT(ellipse.center.norm(), tol * a);
      }
      return;
    }
    const SurfaceShape shape = ClassifyShape(fixtures::Surface(form));
    ASSERT_EQ(NameOf(shape), kind);
    const double first = in.at("parameters")[0];
    if (const auto* sphere = std::get_if<SphereShape>(&shape)) {
      fixtures::ExpectClose(sphere->radius, first, tol);
    } else if (const auto* cylinder = std::get_if<CylinderShape>(&shape)) {
      fixtures::ExpectClose(cylinder->radius, first, tol);
    } else if (const auto* torus = std::get_if<TorusShape>(&shape)) {
      fixtures::ExpectClose(torus->major_radius, first, tol);
      fixtures::ExpectClose(torus->minor_radius, in.at("parameters")[1], tol);
    } else {
      // Radius at z = 0, and the angle of the rulings to the axis.
      const auto& cone = std::get<ConeShape>(shape);
      const double angle = in.at("parameters")[1];
      fixtures::ExpectClose(cone.half_angle, angle, tol);
      fixtures::ExpectClose(cone.apex.norm(), first / std::tan(angle), tol);
    }
  });
}

TEST(LongClassifyShapeTest, PatchesOfPrimitivesAreRecognizedInEveryForm) {
  CheckPatches(14, 8000, 2e-3);
}

TEST(LongClassifyShapeTest, OtherSurfacesAreFree) {
  RandomSplines random(15);
  for (int k = 0; k < 1000; ++k) {
    const NurbsSurface surface =
        random.Surface(random.Integer(1, 11), random.Integer(1, 11), random.Coin());
    ASSERT_EQ(NameOf(ClassifyShape(surface)), "free") << "seed 15, case " << k;
  }
}

}  // namespace
}  // namespace batten
