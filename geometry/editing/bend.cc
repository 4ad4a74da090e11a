// SPDX-License-Identifier: MIT
#include "batten/geometry/bend.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/insert_knots.h"
#include "batten/geometry/iso_curve.h"
#include "geometry/editing/control_forms.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kMostControlPoints = 2000;  // a direction
constexpr Eigen::Index kLargestNet = 200'000;
constexpr int kRounds = 20;      // of insertion: each halves the spans
constexpr int kSteps = 30;       // of the progressive iteration, at most
constexpr int kSamples = 9;      // a span of a curve
constexpr int kCellSamples = 3;  // each way, of a cell of a surface

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
      Reject(
          "Bent",
          "the point from which it bends lies on the axis: move one of them, their distance is the "
          "radius");
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

double Binomial(int n, int k) {
  double value = 1;
  for (int i = 1; i <= k; ++i) value = value * (n - k + i) / i;
  return value;
}

// How far the images of a line of the surface stay at least from every curve over one span of it:
// from polynomials of degree p times the denominator, at p + 2 even places, where that is the
// (p + 1)-th difference over 2^(p+1).
template <typename At>
double LeastMiss(int degree, const Places::Span& span, const At& weighted_image) {
  Eigen::Vector4d difference = Eigen::Vector4d::Zero();
  double least_weight = std::numeric_limits<double>::infinity();
  for (int k = 0; k <= degree + 1; ++k) {
    const double at = span.from + (span.to - span.from) * k / (degree + 1);
    const Eigen::Vector4d image = weighted_image(at);
    least_weight = std::min(least_weight, image.w());
    difference += (k % 2 == 0 ? 1 : -1) * Binomial(degree + 1, k) * image;
  }
  return difference.head<3>().norm() / (least_weight * std::exp2(degree + 1));
}

// Images of points of a surface times the denominator, and the denominator.
class WeightedImages {
 public:
  WeightedImages(const NurbsSurface& surface, const BendMap& map)
      : surface_(surface), map_(map), denominator_(DenominatorOf(surface)) {}

  Eigen::Vector4d operator()(double u, double v) const {
    const double weight = surface_.rational() ? denominator_.At(u, v).x() : 1;
    Eigen::Vector4d image;
    image << weight * map_(surface_.At(u, v)), weight;
    return image;
  }

 private:
  static NurbsSurface DenominatorOf(const NurbsSurface& surface) {
    Eigen::Matrix3Xd weights = Eigen::Matrix3Xd::Zero(3, surface.weights().size());
    weights.row(0) = surface.weights().transpose();
    return NurbsSurface(surface.basis_u(), surface.basis_v(), std::move(weights));
  }

  const NurbsSurface& surface_;
  const BendMap& map_;
  NurbsSurface denominator_;
};

// The place of a cell's samples with the greatest error.
struct WorstOfCell {
  double u = 0, v = 0, error = 0;
};

WorstOfCell WorstOf(const NurbsSurface& old,
                    const NurbsSurface& bent,
                    const BendMap& map,
                    const Places& us,
                    const Places& vs,
                    size_t first_u,
                    size_t first_v) {
  WorstOfCell worst;
  for (size_t k = first_u; k < first_u + kCellSamples; ++k) {
    for (size_t l = first_v; l < first_v + kCellSamples; ++l) {
      const double u = us.at[k], v = vs.at[l];
      const double error = (map(old.At(u, v)) - bent.At(u, v)).norm();
      if (!(error <= worst.error)) worst = {u, v, error};
    }
  }
  return worst;
}

// A direction lacks knots where no curve over the span comes near enough: along lines on which all
// points turn alike the map is rigid, and none are needed. Where both would do by themselves, the
// worse one gets them.
Shortage ShortageOf(const NurbsSurface& old,
                    const NurbsSurface& bent,
                    const BendMap& map,
                    double tolerance) {
  constexpr double kShare = 0.25;  // of the tolerance, for each direction and what binds the spans
  const WeightedImages images(old, map);
  Shortage shortage;
  const Places us = Inside(old.basis_u(), kCellSamples), vs = Inside(old.basis_v(), kCellSamples);
  for (size_t k = 0; k < us.at.size(); k += kCellSamples) {
    for (size_t l = 0; l < vs.at.size(); l += kCellSamples) {
      const WorstOfCell worst = WorstOf(old, bent, map, us, vs, k, l);
      shortage.error = std::max(shortage.error, worst.error);
      if (worst.error <= tolerance) continue;
      const double along_u = LeastMiss(
          old.basis_u().degree(), us.span[k], [&](double u) { return images(u, worst.v); });
      const double along_v = LeastMiss(
          old.basis_v().degree(), vs.span[l], [&](double v) { return images(worst.u, v); });
      const double enough = std::min(kShare * tolerance, std::max(along_u, along_v));
      if (along_u >= enough) shortage.u.push_back(us.span[k].middle());
      if (along_v >= enough) shortage.v.push_back(vs.span[l].middle());
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

// The knot that lets a shape break at u, of the first derivative where it is stretched, else of the
// second; none where it can already.
struct KnotToAdd {
  double at;
  int times;
};
std::optional<KnotToAdd> KnotToRaise(const SplineBasis& basis, double u, bool stretched) {
  constexpr double kSame = 1e-10;  // of the domain
  const double near = kSame * (basis.upper() - basis.lower());
  if (u <= basis.lower() + near || u >= basis.upper() - near) return {};
  for (const double knot : basis.knots()) {
    if (std::abs(knot - u) <= near) u = knot;
  }
  const int times = basis.degree() - (stretched ? 0 : 1) - basis.Multiplicity(u);
  if (times <= 0) return {};
  return KnotToAdd{u, times};
}

// With knots where the bend begins and ends, so that the curve may break there as its image does.
template <int Dim>
NurbsCurve<Dim> Breakable(NurbsCurve<Dim> curve, const BendMap& map, double) {
  for (const double x : {0.0, map.length()}) {
    for (const double u : Crossings(curve, map, x)) {
      const bool stretched = map.Stretches(InSpace(curve.At(u)));
      if (const auto knot = KnotToRaise(curve.basis(), u, stretched)) {
        curve = InsertKnot(curve, knot->at, knot->times);
      }
    }
  }
  return curve;
}

// The knot lines of a direction where all of a line of the surface lies at x along the line of the
// bend, to a tolerance, and whether the map stretches some of it.
struct BreakLine {
  double at;
  bool stretches = false;
};
std::vector<BreakLine> BreakLines(const NurbsSurface& surface,
                                  Direction direction,
                                  const BendMap& map,
                                  double x,
                                  double tolerance) {
  const bool in_u = direction == Direction::kU;
  const Places across = Inside(in_u ? surface.basis_v() : surface.basis_u(), kSamples);
  const Direction other = in_u ? Direction::kV : Direction::kU;
  std::vector<BreakLine> lines;
  for (const double at : Crossings(IsoCurve(surface, other, across.at.front()), map, x)) {
    BreakLine line{at};
    bool straight = true;
    for (const double along : across.at) {
      const Eigen::Vector3d point = in_u ? surface.At(at, along) : surface.At(along, at);
      straight = straight && std::abs(map.Along(point) - x) <= tolerance;
      line.stretches = line.stretches || map.Stretches(point);
    }
    if (straight) lines.push_back(line);
  }
  return lines;
}

// The same for lines of a surface that are bent all at once; across others it can't break.
NurbsSurface Breakable(NurbsSurface surface, const BendMap& map, double tolerance) {
  for (const double x : {0.0, map.length()}) {
    for (const Direction direction : {Direction::kU, Direction::kV}) {
      for (const BreakLine& line : BreakLines(surface, direction, map, x, tolerance)) {
        const SplineBasis& basis =
            direction == Direction::kU ? surface.basis_u() : surface.basis_v();
        if (const auto knot = KnotToRaise(basis, line.at, line.stretches)) {
          surface = InsertKnot(surface, direction, knot->at, knot->times);
        }
      }
    }
  }
  return surface;
}

template <int Dim>
bool Refine(NurbsCurve<Dim>& old, Shortage& shortage) {
  if (!Insert(shortage.u, old.basis())) return false;
  old = RefineKnots(old, shortage.u);
  return true;
}

bool Refine(NurbsSurface& old, Shortage& shortage) {
  const bool u = Insert(shortage.u, old.basis_u()), v = Insert(shortage.v, old.basis_v());
  const Eigen::Index rows = old.size_u() + (u ? std::ssize(shortage.u) : 0),
                     columns = old.size_v() + (v ? std::ssize(shortage.v) : 0);
  if (rows * columns > kLargestNet) return false;
  if (u) old = RefineKnots(old, Direction::kU, shortage.u);
  if (v) old = RefineKnots(old, Direction::kV, shortage.v);
  return u || v;
}

template <typename Shape>
BentShape<Shape> BentWithin(Shape old, double tolerance, const BendMap& map) {
  constexpr double kOfTolerance = 0.1;  // how far a line may be from where it breaks
  if (!(tolerance > 0) || !std::isfinite(tolerance))
    Reject("Bent", "the tolerance " + NumberText(tolerance) + " is not positive and finite");
  old = Breakable(std::move(old), map, kOfTolerance * tolerance);
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
