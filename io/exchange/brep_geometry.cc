// SPDX-License-Identifier: MIT
#include "io/exchange/brep_geometry.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <vector>

namespace batten::internal {
namespace {

constexpr int kMostLayers = 8;             // trimmed curves of offset curves of …
constexpr int kHighestDegree = 25;       // OpenCASCADE's limit
constexpr int kMostPoles = 100'000'000;  // far above what a file can hold
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kShortest = 1e-100;  // of a direction
constexpr double kParallel = 1e-9;    // sine of the least angle between axes
constexpr double kSlack = 1e-9;       // of parameters beyond a domain, OpenCASCADE's own

// The parameters of a curve, or of a surface in one direction.
struct Domain {
  double lower, upper;
  bool periodic = false;
};
constexpr Domain kLine = {-kInfinity, kInfinity};
constexpr Domain kRound = {0, kTurn, true};

struct SurfaceDomain {
  Domain u, v;
};

class GeometryChecker {
 public:
  explicit GeometryChecker(BrepScanner& in) : in_(in) {}

  // [OpenCASCADE, BRep format, §3.3 and §3.4]
  Domain Curve(int dimension, int depth) {
    CheckDepth(depth);
    switch (in_.Integer("the kind of a curve", 1, 9)) {
      case 1:
        Point(dimension);
        Direction(dimension);
        return kLine;
      case 2:
        Axes(dimension);
        Size("a radius");
        return kRound;
      case 3:
        Axes(dimension);
        Radii();
        return kRound;
      case 4:
        Axes(dimension);
        Size("a focal length");
        return kLine;
      case 5:
        Axes(dimension);
        Size("a radius");
        Size("a radius");
        return kLine;
      case 6:
        return Bezier(dimension);
      case 7:
        return BSpline(dimension);
      case 8:
        return Trimmed(dimension, depth);
      default:
        in_.Real("an offset");
        if (dimension == 3) Direction(3);
        return Curve(dimension, depth + 1);
    }
  }

  // [OpenCASCADE, BRep format, §3.5]
  SurfaceDomain Surface(int depth) {
    CheckDepth(depth);
    switch (in_.Integer("the kind of a surface", 1, 11)) {
      case 1:
        Axes(3);
        return {kLine, kLine};
      case 2:
        Axes(3);
        Size("a radius");
        return {kRound, kLine};
      case 3:
        return Cone();
      case 4:
        Axes(3);
        Size("a radius");
        return {kRound, {-kTurn / 4, kTurn / 4}};
      case 5:
        Axes(3);
        Size("a radius");
        if (!(Size("a radius") > 0)) in_.Fail("the tube of a torus has no radius");
        return {kRound, kRound};
      case 6: {
        Direction(3);
        const Domain along = Curve(3, depth + 1);
        return {along, kLine};
      }
      case 7: {
        Point(3);
        Direction(3);
        const Domain profile = Curve(3, depth + 1);
        return {kRound, profile};
      }
      case 8:
        return BezierSurface();
      case 9:
        return BSplineSurface();
      case 10:
        return TrimmedSurface(depth);
      default:
        in_.Real("an offset");
        return Surface(depth + 1);
    }
  }

 private:
  void CheckDepth(int depth) {
    if (depth > kMostLayers) in_.Fail("a shape is built on another more than 8 times over");
  }

  void Point(int dimension) {
    for (int k = 0; k < dimension; ++k) in_.Real("a coordinate");
  }

  Eigen::Vector3d Direction(int dimension) {
    Eigen::Vector3d direction = Eigen::Vector3d::Zero();
    for (int k = 0; k < dimension; ++k) direction[k] = in_.Real("a direction");
    if (!(direction.norm() > kShortest)) in_.Fail("a direction has no length");
    return direction.normalized();
  }

  // Where it stands, and its axes: of the plane x and y, of space z, x and y.
  void Axes(int dimension) {
    Point(dimension);
    const Eigen::Vector3d first = Direction(dimension), second = Direction(dimension);
    if (!(first.cross(second).norm() > kParallel)) in_.Fail("two axes are parallel");
    if (dimension == 3) Direction(3);
  }

  double Size(const char* what) {
    const double size = in_.Real(what);
    if (size < 0) in_.Fail(std::string(what) + " must not be negative");
    return size;
  }

  void Radii() {
    const double major = Size("a radius");
    if (Size("a radius") > major) in_.Fail("the minor radius is above the major one");
  }

  SurfaceDomain Cone() {
    Axes(3);
    Size("a radius");
    const double angle = std::abs(in_.Real("the angle of a cone"));
    if (!(angle > kParallel && angle < kTurn / 4 - kParallel)) {
      in_.Fail("the angle of a cone must lie between 0 and a quarter turn");
    }
    return {kRound, kLine};
  }

  void Pole(int dimension, bool rational) {
    Point(dimension);
    if (rational && !(in_.Real("a weight") > kShortest)) in_.Fail("a weight must be positive");
  }

  int Degree() { return static_cast<int>(in_.Integer("a degree", 1, kHighestDegree)); }
  int Count(const char* what) { return static_cast<int>(in_.Integer(what, 2, kMostPoles)); }

  // Distinct knots with their multiplicities, which must be those of so many control points.
  Domain Knots(int degree, bool periodic, int poles, int count) {
    double lower = 0, before = -kInfinity;
    std::int64_t sum = 0, first = 0, last = 0;
    for (int i = 0; i < count; ++i) {
      const double knot = in_.Real("a knot");
      if (!(knot > before)) in_.Fail("knots must increase");
      const bool end = i == 0 || i + 1 == count;
      const std::int64_t most = end && !periodic ? degree + 1 : degree;
      last = in_.Integer("a knot's multiplicity", 1, most);
      if (i == 0) {
        lower = knot;
        first = last;
      }
      sum += last;
      before = knot;
    }
    if (periodic && first != last) in_.Fail("the end knots of a periodic direction must be alike");
    const std::int64_t expected = periodic ? sum - last : sum - degree - 1;
    if (expected != poles) {
      in_.Fail("there are " + std::to_string(poles) + " control points where the knots want " +
               std::to_string(expected));
    }
    return {lower, before, periodic};
  }

  Domain Bezier(int dimension) {
    const bool rational = in_.Flag("the sign of weights");
    const int degree = Degree();
    for (int i = 0; i <= degree; ++i) Pole(dimension, rational);
    return {0, 1};
  }

  Domain BSpline(int dimension) {
    const bool rational = in_.Flag("the sign of weights"),
               periodic = in_.Flag("the sign of a period");
    const int degree = Degree(), poles = Count("a number of control points");
    const int knots = Count("a number of knots");
    for (int i = 0; i < poles; ++i) Pole(dimension, rational);
    return Knots(degree, periodic, poles, knots);
  }

  SurfaceDomain BezierSurface() {
    const bool in_u = in_.Flag("the sign of weights"), in_v = in_.Flag("the sign of weights");
    const int degree_u = Degree(), degree_v = Degree();
    for (int i = 0; i < (degree_u + 1) * (degree_v + 1); ++i) Pole(3, in_u || in_v);
    return {{0, 1}, {0, 1}};
  }

  SurfaceDomain BSplineSurface() {
    const bool in_u = in_.Flag("the sign of weights"), in_v = in_.Flag("the sign of weights");
    const bool period_u = in_.Flag("the sign of a period"),
               period_v = in_.Flag("the sign of a period");
    const int degree_u = Degree(), degree_v = Degree();
    const int poles_u = Count("a number of control points"),
              poles_v = Count("a number of control points");
    const int knots_u = Count("a number of knots"), knots_v = Count("a number of knots");
    for (std::int64_t i = 0; i < std::int64_t{poles_u} * poles_v; ++i) Pole(3, in_u || in_v);
    const Domain u = Knots(degree_u, period_u, poles_u, knots_u);
    return {u, Knots(degree_v, period_v, poles_v, knots_v)};
  }

  // The part from `from` to `to` of what is read next.
  Domain Part(const Domain& whole, double from, double to) {
    if (from == to) in_.Fail("a shape is trimmed to nothing");
    if (whole.periodic) {
      const double period = whole.upper - whole.lower;
      if (std::abs(from) > 1e6 * period || std::abs(to) > 1e6 * period) {
        in_.Fail("a shape is trimmed a million periods away");
      }
      return {from, to};
    }
    const double lower = std::min(from, to), upper = std::max(from, to);
    if (!(lower >= whole.lower - kSlack && upper <= whole.upper + kSlack)) {
      in_.Fail("a shape is trimmed outside its domain");
    }
    return {lower, upper};
  }

  Domain Trimmed(int dimension, int depth) {
    const double from = in_.Real("a parameter"), to = in_.Real("a parameter");
    return Part(Curve(dimension, depth + 1), from, to);
  }

  SurfaceDomain TrimmedSurface(int depth) {
    double ends[4];
    for (double& end : ends) end = in_.Real("a parameter");
    const SurfaceDomain whole = Surface(depth + 1);
    const Domain u = Part(whole.u, ends[0], ends[1]);
    return {u, Part(whole.v, ends[2], ends[3])};
  }

  BrepScanner& in_;
};

}  // namespace

void CheckBrepCurve(BrepScanner& scanner, int dimension) {
  GeometryChecker(scanner).Curve(dimension, 0);
}

void CheckBrepSurface(BrepScanner& scanner) { GeometryChecker(scanner).Surface(0); }

}  // namespace batten::internal
