// SPDX-License-Identifier: MIT
#include "batten/geometry/bend.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/insert_knots.h"
#include "geometry/editing/control_forms.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kMostControlPoints = 2000;  // a direction
constexpr int kRounds = 12;               // of insertion: each halves the spans
constexpr int kSteps = 30;                // of the progressive iteration, at most
constexpr int kSamples = 9;               // a span, of surfaces 3 × 3 a cell

// Maps points as CircleBend says.
class BendMap {
 public:
  explicit BendMap(const CircleBend& bend) : center_(bend.center), length_(bend.length) {
    if (!bend.from.allFinite() || !bend.center.allFinite() || !bend.axis.allFinite())
      Reject("Bent", "the circle is not finite");
    if (!(length_ > 0) || !std::isfinite(length_))
      Reject("Bent", "the length " + NumberText(length_) + " is not positive and finite");
    const double axis = bend.axis.stableNorm();
    if (!(axis > 0)) Reject("Bent", "the axis has no length");
    axis_ = bend.axis / axis;
    const Eigen::Vector3d arm = bend.from - center_;
    out_ = arm - axis_ * axis_.dot(arm);
    radius_ = out_.stableNorm();
    constexpr double kOnAxis = 1e-12;
    if (!(radius_ > kOnAxis * arm.stableNorm()))
      Reject("Bent", "the point from which it bends lies on the axis");
    out_ /= radius_;
    along_ = axis_.cross(out_);
    if (length_ > 2 * std::numbers::pi * radius_) {
      Reject("Bent",
             "the length " + NumberText(length_) + " is more than once round the circle, " +
                 RoundedText(2 * std::numbers::pi * radius_));
    }
  }

  Eigen::Vector3d operator()(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d arm = point - center_;
    const double x = along_.dot(arm), out = out_.dot(arm);
    if (x <= 0) return point;
    if (x < length_ && !(out > 0)) {
      Reject("Bent",
             "the shape reaches the axis: a point of it or of its control net lies " +
                 RoundedText(std::abs(out)) + " beyond it; bend about a wider circle");
    }
    const double angle = std::min(x, length_) / radius_, behind = std::max(0.0, x - length_);
    const Eigen::Vector3d radial = std::cos(angle) * out_ + std::sin(angle) * along_;
    const Eigen::Vector3d onward = std::cos(angle) * along_ - std::sin(angle) * out_;
    return center_ + out * radial + behind * onward + axis_.dot(arm) * axis_;
  }

  // How far along the line a point lies, and whether the map breaks its direction at both ends of
  // the bend: it stretches what is not at the radius.
  double Along(const Eigen::Vector3d& point) const { return along_.dot(point - center_); }
  bool Stretches(const Eigen::Vector3d& point) const {
    constexpr double kAtRadius = 1e-9;
    return std::abs(out_.dot(point - center_) - radius_) > kAtRadius * radius_;
  }
  double length() const { return length_; }

  // The angle by which a point is turned.
  double Turn(const Eigen::Vector3d& point) const {
    return std::clamp(Along(point), 0.0, length_) / radius_;
  }

  Eigen::Vector2d operator()(const Eigen::Vector2d& point) const {
    return (*this)(Eigen::Vector3d(point.x(), point.y(), 0)).template head<2>();
  }
  bool keeps_plane() const { return axis_.head<2>().isZero(0); }

 private:
  Eigen::Vector3d center_, axis_, out_, along_;
  double length_, radius_;
};

// Places inside every span of the domain, with the ends of the span each is in.
struct Places {
  struct Span {
    double from, to;
    double middle() const { return from + (to - from) / 2; }
  };
  std::vector<double> at;
  std::vector<Span> span;
};

Places Inside(const SplineBasis& basis, int count) {
  Places places;
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[static_cast<size_t>(span)],
                 b = basis.knots()[static_cast<size_t>(span) + 1];
    for (int k = 0; k < count; ++k) {
      places.at.push_back(a + (b - a) * (k + 0.5) / count);
      places.span.push_back({a, b});
    }
  }
  return places;
}

// The Greville abscissae of distinct control points, in the domain.
std::vector<double> Abscissae(const SplineBasis& basis) {
  std::vector<double> abscissae;
  for (int i = 0; i < DistinctPoints(basis); ++i)
    abscissae.push_back(basis.Clamp(basis.Greville(i)));
  return abscissae;
}

// The old shape over finer knots, the new one and what is between them.
template <int Dim>
Eigen::MatrixXd Misses(const NurbsCurve<Dim>& old,
                       const NurbsCurve<Dim>& bent,
                       const BendMap& map) {
  const std::vector<double> at = Abscissae(old.basis());
  Eigen::MatrixXd misses(Dim, std::ssize(at));
  for (Eigen::Index k = 0; k < misses.cols(); ++k) {
    const double u = at[static_cast<size_t>(k)];
    misses.col(k) = map(old.At(u)) - bent.At(u);
  }
  return misses;
}
Eigen::MatrixXd Misses(const NurbsSurface& old, const NurbsSurface& bent, const BendMap& map) {
  const std::vector<double> at_u = Abscissae(old.basis_u()), at_v = Abscissae(old.basis_v());
  Eigen::MatrixXd misses(3, DistinctPoints(old));
  Eigen::Index k = 0;
  for (const double u : at_u) {
    for (const double v : at_v) misses.col(k++) = map(old.At(u, v)) - bent.At(u, v);
  }
  return misses;
}

template <int Dim>
Eigen::MatrixXd ImageMoves(const NurbsCurve<Dim>& old, const BendMap& map) {
  Eigen::MatrixXd moves(Dim, DistinctPoints(old));
  for (Eigen::Index k = 0; k < moves.cols(); ++k) {
    const typename NurbsCurve<Dim>::Point point = old.control_points().col(k);
    moves.col(k) = map(point) - point;
  }
  return moves;
}
Eigen::MatrixXd ImageMoves(const NurbsSurface& old, const BendMap& map) {
  const int round_u = DistinctPoints(old.basis_u()), round_v = DistinctPoints(old.basis_v());
  Eigen::MatrixXd moves(3, DistinctPoints(old));
  for (int i = 0; i < round_u; ++i) {
    for (int j = 0; j < round_v; ++j) {
      moves.col(i * round_v + j) = map(old.control_point(i, j)) - old.control_point(i, j);
    }
  }
  return moves;
}

// The control points' images, then steps by what is missed at the abscissae while that shrinks.
template <typename Shape>
Shape BentOver(const Shape& old, const BendMap& map, double tolerance) {
  constexpr double kEnough = 1e-3;  // of the tolerance
  Shape bent = WithMoves(old, ImageMoves(old, map));
  double last = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kSteps; ++step) {
    const Eigen::MatrixXd misses = Misses(old, bent, map);
    const double miss = misses.colwise().norm().maxCoeff();
    if (miss <= kEnough * tolerance || !(miss < last)) break;
    last = miss;
    bent = WithMoves(bent, misses);
  }
  return bent;
}

// Where knots lack in each direction, and the greatest error of the samples.
struct Shortage {
  std::vector<double> u, v;
  double error = 0;
};

template <int Dim>
Shortage ShortageOf(const NurbsCurve<Dim>& old,
                    const NurbsCurve<Dim>& bent,
                    const BendMap& map,
                    double tolerance) {
  Shortage shortage;
  const Places places = Inside(old.basis(), kSamples);
  for (size_t k = 0; k < places.at.size(); ++k) {
    const double error = (map(old.At(places.at[k])) - bent.At(places.at[k])).norm();
    shortage.error = std::max(shortage.error, error);
    if (error > tolerance) shortage.u.push_back(places.span[k].middle());
  }
  return shortage;
}
// Along a line on which all points turn alike the map is rigid: knots lack across it.
Shortage ShortageOf(const NurbsSurface& old,
                    const NurbsSurface& bent,
                    const BendMap& map,
                    double tolerance) {
  constexpr double kSmall = 0.2;
  Shortage shortage;
  const Places us = Inside(old.basis_u(), 3), vs = Inside(old.basis_v(), 3);
  for (size_t k = 0; k < us.at.size(); ++k) {
    for (size_t l = 0; l < vs.at.size(); ++l) {
      const double error = (map(old.At(us.at[k], vs.at[l])) - bent.At(us.at[k], vs.at[l])).norm();
      shortage.error = std::max(shortage.error, error);
      if (error <= tolerance) continue;
      const auto& [u, v] = std::pair(us.span[k], vs.span[l]);
      const auto turn = [&](double s, double t) { return map.Turn(old.At(s, t)); };
      const double mean_u = u.middle(), mean_v = v.middle();
      const double turn_u = std::abs(turn(u.to, mean_v) - turn(u.from, mean_v)),
                   turn_v = std::abs(turn(mean_u, v.to) - turn(mean_u, v.from));
      if (turn_u >= kSmall * turn_v) shortage.u.push_back(mean_u);
      if (turn_v >= kSmall * turn_u) shortage.v.push_back(mean_v);
    }
  }
  return shortage;
}

// Halves the spans of these middles; whether there is room for it.
bool Insert(std::vector<double>& middles, const SplineBasis& basis) {
  std::sort(middles.begin(), middles.end());
  middles.erase(std::unique(middles.begin(), middles.end()), middles.end());
  return !middles.empty() && basis.size() + std::ssize(middles) <= kMostControlPoints;
}

Eigen::Vector3d InSpace(const Eigen::Vector3d& point) { return point; }
Eigen::Vector3d InSpace(const Eigen::Vector2d& point) { return {point.x(), point.y(), 0}; }

// Where a curve crosses the plane at x along the line of a bend; what it crosses twice between
// samples is missed.
template <int Dim>
std::vector<double> Crossings(const NurbsCurve<Dim>& curve, const BendMap& map, double x) {
  constexpr int kEven = 32, kHalvings = 60;
  const auto height = [&](double u) { return map.Along(InSpace(curve.At(u))) - x; };
  std::vector<double> crossings;
  for (const int span : curve.basis().Spans()) {
    const double a = curve.basis().knots()[static_cast<size_t>(span)],
                 b = curve.basis().knots()[static_cast<size_t>(span) + 1];
    for (int k = 0; k < kEven; ++k) {
      double low = a + (b - a) * k / kEven, high = a + (b - a) * (k + 1) / kEven;
      const bool below = height(low) < 0;
      if ((height(high) < 0) == below) continue;
      for (int half = 0; half < kHalvings; ++half) {
        const double middle = low + (high - low) / 2;
        ((height(middle) < 0) == below ? low : high) = middle;
      }
      crossings.push_back(high);
    }
  }
  return crossings;
}

// With knots where the bend begins and ends, so that the curve may break there as its image does.
template <int Dim>
NurbsCurve<Dim> Breakable(NurbsCurve<Dim> curve, const BendMap& map) {
  constexpr double kSame = 1e-10;  // of the domain
  for (const double x : {0.0, map.length()}) {
    for (double u : Crossings(curve, map, x)) {
      const SplineBasis& basis = curve.basis();
      const double near = kSame * (basis.upper() - basis.lower());
      if (u <= basis.lower() + near || u >= basis.upper() - near) continue;
      for (const double knot : basis.knots())
        if (std::abs(knot - u) <= near) u = knot;
      const int wanted = basis.degree() - (map.Stretches(InSpace(curve.At(u))) ? 0 : 1);
      const int times = wanted - basis.Multiplicity(u);
      if (times > 0) curve = InsertKnot(curve, u, times);
    }
  }
  return curve;
}
NurbsSurface Breakable(NurbsSurface surface, const BendMap&) { return surface; }

template <int Dim>
bool Refine(NurbsCurve<Dim>& old, Shortage& shortage) {
  if (!Insert(shortage.u, old.basis())) return false;
  old = RefineKnots(old, shortage.u);
  return true;
}

bool Refine(NurbsSurface& old, Shortage& shortage) {
  const bool u = Insert(shortage.u, old.basis_u()), v = Insert(shortage.v, old.basis_v());
  if (u) old = RefineKnots(old, Direction::kU, shortage.u);
  if (v) old = RefineKnots(old, Direction::kV, shortage.v);
  return u || v;
}

template <typename Shape>
BentShape<Shape> BentWithin(Shape old, double tolerance, const BendMap& map) {
  if (!(tolerance > 0) || !std::isfinite(tolerance))
    Reject("Bent", "the tolerance " + NumberText(tolerance) + " is not positive and finite");
  old = Breakable(std::move(old), map);
  for (int round = 0;; ++round) {
    Shape bent = BentOver(old, map, tolerance);
    Shortage shortage = ShortageOf(old, bent, map, tolerance);
    if (shortage.error <= tolerance || round == kRounds || !Refine(old, shortage))
      return {std::move(bent), shortage.error};
  }
}

}  // namespace

template <int Dim>
BentShape<NurbsCurve<Dim>> Bent(const NurbsCurve<Dim>& curve,
                                const CircleBend& bend,
                                double tolerance) {
  const BendMap map(bend);
  if (Dim == 2 && !map.keeps_plane())
    Reject("Bent", "the axis of a plane curve's bend is not along z");
  return BentWithin(curve, tolerance, map);
}

BentShape<NurbsSurface> Bent(const NurbsSurface& surface,
                             const CircleBend& bend,
                             double tolerance) {
  return BentWithin(surface, tolerance, BendMap(bend));
}

template BentShape<NurbsCurve<2>> Bent(const NurbsCurve<2>&, const CircleBend&, double);
template BentShape<NurbsCurve<3>> Bent(const NurbsCurve<3>&, const CircleBend&, double);

}  // namespace batten
