// SPDX-License-Identifier: MIT
#include "io/exchange/iges_shapes.h"

#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "batten/geometry/clamp.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/frame.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/make_curve.h"
#include "batten/geometry/remove_knots.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/split.h"

namespace batten::internal {
namespace {

Eigen::Matrix3Xd Points(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::Matrix3Xd>(
      numbers.data(), 3, static_cast<Eigen::Index>(numbers.size() / 3));
}

Eigen::VectorXd Weights(const std::vector<double>& numbers) {
  return Eigen::Map<const Eigen::VectorXd>(numbers.data(),
                                           static_cast<Eigen::Index>(numbers.size()));
}

// The range of parameters that counts, within the domain; all of it where none is given.
std::array<double, 2> Range(const SplineBasis& basis, double from, double to) {
  constexpr double kSame = 1e-12;
  const double slack = kSame * (basis.upper() - basis.lower());
  std::array<double, 2> range = {basis.lower(), basis.upper()};
  if (!(from < to)) return range;
  if (from > range[0] + slack && from < range[1]) range[0] = from;
  if (to < range[1] - slack && to > range[0]) range[1] = to;
  return range;
}

NurbsCurve<3> ReadBSpline(IgesNumbers in) {
  const int size = in.Integer() + 1, degree = in.Integer();
  for (int i = 0; i < 4; ++i) in.Real();
  const auto count = static_cast<size_t>(size);
  std::vector<double> knots = in.Reals(count + static_cast<size_t>(degree) + 1, "knot");
  Eigen::VectorXd weights = Weights(in.Reals(count, "weight"));
  Eigen::Matrix3Xd points = Points(in.Reals(3 * count));
  NurbsCurve<3> curve(SplineBasis(degree, std::move(knots)), std::move(points), std::move(weights));
  const double from = in.Real(), to = in.Real();
  const auto range = Range(curve.basis(), from, to);
  if (range[0] == curve.basis().lower() && range[1] == curve.basis().upper()) return curve;
  return Segment(curve, range[0], range[1]);
}

NurbsCurve<3> ReadLine(IgesNumbers in) {
  return NurbsCurve<3>(SplineBasis(1, {0, 0, 1, 1}), Points(in.Reals(6)));
}

// The degree-1 curve through the columns, on [0, their number − 1].
NurbsCurve<3> Through(const Eigen::Matrix3Xd& points) {
  if (points.cols() < 2) throw std::invalid_argument("is a polyline of less than two points");
  const auto size = static_cast<int>(points.cols());
  return NurbsCurve<3>(SplineBasis::Uniform(1, size, 0, size - 1), points);
}

// Pairs at one height, triples, or triples with a vector each; closed plane curves (63) are pairs.
NurbsCurve<3> ReadPolyline(IgesNumbers in) {
  const int kind = in.Integer(), count = in.Integer();
  if (kind < 1 || kind > 3) throw std::invalid_argument("is copious data of an unknown kind");
  const int columns = kind == 1 ? 2 : kind == 2 ? 3 : 6;
  const double height = kind == 1 ? in.Real() : 0;
  const std::vector<double> numbers =
      in.Reals(static_cast<size_t>(columns) * static_cast<size_t>(count));
  std::vector<double> places;
  for (size_t i = 0; i < numbers.size(); i += static_cast<size_t>(columns)) {
    places.insert(places.end(), {numbers[i], numbers[i + 1], kind == 1 ? height : numbers[i + 2]});
  }
  return Through(Points(places));
}

// From a direction to another, counter-clockwise; the same: all round.
AngleRange Turn(const Eigen::Vector2d& from, const Eigen::Vector2d& to) {
  constexpr double kWhole = 2 * std::numbers::pi, kSame = 1e-12;
  const double start = std::atan2(from.y(), from.x());
  double sweep = std::atan2(to.y(), to.x()) - start;
  if (sweep < 0) sweep += kWhole;
  return {start, sweep > kSame ? sweep : kWhole};
}

NurbsCurve<3> ReadArc(IgesNumbers in) {
  const double height = in.Real();
  const std::vector<double> numbers = in.Reals(6);
  const Eigen::Matrix<double, 2, 3> p =
      Eigen::Map<const Eigen::Matrix<double, 2, 3>>(numbers.data());
  const Eigen::Vector2d from = p.col(1) - p.col(0), to = p.col(2) - p.col(0);
  const Eigen::Vector3d center(p(0, 0), p(1, 0), height);
  return MakeArc(Frame(center, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX()),
                 from.norm(),
                 Turn(from, to));
}

// A x² + C y² + F = 0 in its own frame, from one point of it to another.
NurbsCurve<3> ReadConic(IgesNumbers in) {
  const std::vector<double> c = in.Reals(6);
  const double height = in.Real();
  const std::vector<double> ends = in.Reals(4);
  const double a = c[0], b = c[1], e = c[2], d = c[3], f = c[4], constant = c[5];
  const double x = std::sqrt(-constant / a), y = std::sqrt(-constant / e);
  if (b != 0 || d != 0 || f != 0 || !(x > 0 && y > 0 && std::isfinite(x) && std::isfinite(y))) {
    throw std::invalid_argument(
        "is a conic other than an ellipse on its axes, not in this version");
  }
  const Eigen::Array2d radii(x, y);
  const Frame frame({0, 0, height}, Eigen::Vector3d::UnitZ(), Eigen::Vector3d::UnitX());
  return MakeEllipseArc(
      frame,
      x,
      y,
      Turn(Eigen::Array2d(ends[0], ends[1]) / radii, Eigen::Array2d(ends[2], ends[3]) / radii));
}

// Cubics in the powers of the distance from the last break, as Bézier pieces over the breaks.
NurbsCurve<3> ReadParametric(IgesNumbers in) {
  in.Real();
  in.Real();
  in.Real();
  const int pieces = in.Integer();
  if (pieces < 1) throw std::invalid_argument("is a spline without a piece");
  const auto count = static_cast<size_t>(pieces);
  const std::vector<double> breaks = in.Reals(count + 1, "knot");
  const std::vector<double> powers = in.Reals(12 * count);
  std::vector<double> knots(1, breaks[0]);
  Eigen::Matrix3Xd points(3, 3 * pieces + 1);
  for (int i = 0; i < pieces; ++i) {
    const auto k = static_cast<size_t>(i);
    const double h = breaks[k + 1] - breaks[k];
    // Columns: the coefficients of 1, s, s², s³ with s from 0 to h.
    const Eigen::Matrix<double, 3, 4> p =
        Eigen::Map<const Eigen::Matrix<double, 3, 4, Eigen::RowMajor>>(powers.data() + 12 * k);
    const Eigen::Vector3d linear = p.col(1) * h, square = p.col(2) * (h * h);
    points.col(3 * i) = p.col(0);
    points.col(3 * i + 1) = p.col(0) + linear / 3;
    points.col(3 * i + 2) = p.col(0) + linear * (2.0 / 3) + square / 3;
    points.col(3 * i + 3) = p.col(0) + linear + square + p.col(3) * (h * h * h);
    knots.insert(knots.end(), 3, breaks[k]);
  }
  knots.insert(knots.end(), 4, breaks[count]);
  RequireWithinLimits(points.reshaped(), "coordinate");
  NurbsCurve<3> curve(SplineBasis(3, std::move(knots)), points);
  // Every removal copies the curve: very long ones keep their knots.
  constexpr int kMostPieces = 2000;
  if (pieces > kMostPieces) return curve;
  constexpr double kRounding = 1e-12;
  const double size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  for (int i = 1; i < pieces; ++i) {
    curve = RemoveKnot(curve, breaks[static_cast<size_t>(i)], 2, kRounding * size).shape;
  }
  return curve;
}

// The knots of `other` that a basis over the same domain lacks.
std::vector<double> Missing(const SplineBasis& basis, const SplineBasis& other) {
  std::vector<double> missing;
  const std::vector<double>& knots = other.knots();
  for (size_t i = 0; i < knots.size();) {
    size_t end = i;
    while (end < knots.size() && knots[end] == knots[i]) ++end;
    if (knots[i] > basis.lower() && knots[i] < basis.upper()) {
      const int more = static_cast<int>(end - i) - basis.Multiplicity(knots[i]);
      if (more > 0) missing.insert(missing.end(), static_cast<size_t>(more), knots[i]);
    }
    i = end;
  }
  return missing;
}

}  // namespace

bool IsIgesCurve(const IgesEntity& entity) {
  constexpr int kClosedPolyline = 63;
  switch (entity.type) {
    case kIgesPolyline:
      return (entity.form >= 11 && entity.form <= 13) || entity.form == kClosedPolyline;
    case kIgesArc:
    case kIgesConic:
    case kIgesLine:
    case kIgesParametric:
    case kIgesCurve:
      return true;
    default:
      return false;
  }
}

NurbsCurve<3> ReadIgesCurve(const IgesEntity& entity) {
  const IgesNumbers in(entity.parameters);
  switch (entity.type) {
    case kIgesArc:
      return ReadArc(in);
    case kIgesConic:
      return ReadConic(in);
    case kIgesPolyline:
      return ReadPolyline(in);
    case kIgesLine:
      return ReadLine(in);
    case kIgesParametric:
      return ReadParametric(in);
    default:
      return ReadBSpline(in);
  }
}

AngleRange IgesArcAngles(const IgesEntity& entity) {
  IgesNumbers in(entity.parameters);
  in.Real();
  const std::vector<double> p = in.Reals(6);
  return Turn({p[2] - p[0], p[3] - p[1]}, {p[4] - p[0], p[5] - p[1]});
}

// The file's points run through u first.
NurbsSurface ReadIgesSurface(const IgesEntity& entity) {
  IgesNumbers in(entity.parameters);
  const int size_u = in.Integer() + 1, size_v = in.Integer() + 1;
  const int degree_u = in.Integer(), degree_v = in.Integer();
  for (int i = 0; i < 5; ++i) in.Real();
  const auto nu = static_cast<size_t>(size_u), nv = static_cast<size_t>(size_v);
  std::vector<double> knots_u = in.Reals(nu + static_cast<size_t>(degree_u) + 1, "knot");
  std::vector<double> knots_v = in.Reals(nv + static_cast<size_t>(degree_v) + 1, "knot");
  const std::vector<double> weights = in.Reals(nu * nv, "weight");
  const Eigen::Matrix3Xd points = Points(in.Reals(3 * nu * nv));
  Eigen::Matrix3Xd net(3, points.cols());
  Eigen::VectorXd net_weights(points.cols());
  for (int i = 0; i < size_u; ++i) {
    for (int j = 0; j < size_v; ++j) {
      const Eigen::Index to = Eigen::Index{i} * size_v + j, from = Eigen::Index{j} * size_u + i;
      net.col(to) = points.col(from);
      net_weights[to] = weights[static_cast<size_t>(from)];
    }
  }
  NurbsSurface surface(SplineBasis(degree_u, std::move(knots_u)),
                       SplineBasis(degree_v, std::move(knots_v)),
                       std::move(net),
                       std::move(net_weights));
  const double u0 = in.Real(), u1 = in.Real(), v0 = in.Real(), v1 = in.Real();
  const auto u = Range(surface.basis_u(), u0, u1), v = Range(surface.basis_v(), v0, v1);
  if (u[0] == surface.basis_u().lower() && u[1] == surface.basis_u().upper() &&
      v[0] == surface.basis_v().lower() && v[1] == surface.basis_v().upper()) {
    return surface;
  }
  return Segment(surface, u[0], u[1], v[0], v[1]);
}

NurbsSurface Ruled(const NurbsCurve<3>& first, const NurbsCurve<3>& second) {
  NurbsCurve<3> a = Reparameterized(Clamped(first), 0, 1);
  NurbsCurve<3> b = Reparameterized(Clamped(second), 0, 1);
  const int degree = std::max(a.basis().degree(), b.basis().degree());
  a = Elevated(a, degree - a.basis().degree());
  b = Elevated(b, degree - b.basis().degree());
  a = RefineKnots(a, Missing(a.basis(), b.basis()));
  b = RefineKnots(b, Missing(b.basis(), a.basis()));
  const Eigen::Index count = a.control_points().cols();
  Eigen::Matrix3Xd net(3, 2 * count);
  Eigen::VectorXd weights(2 * count);
  for (Eigen::Index i = 0; i < count; ++i) {
    net.col(2 * i) = a.control_points().col(i);
    net.col(2 * i + 1) = b.control_points().col(i);
    weights[2 * i] = a.weights()[i];
    weights[2 * i + 1] = b.weights()[i];
  }
  return NurbsSurface(a.basis(), SplineBasis(1, {0, 0, 1, 1}), std::move(net), std::move(weights));
}

}  // namespace batten::internal
