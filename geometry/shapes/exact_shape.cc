// SPDX-License-Identifier: MIT
#include "batten/geometry/exact_shape.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <utility>
#include <vector>

#include "batten/geometry/make_curve.h"
#include "batten/geometry/make_surface.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/constants.h"
#include "geometry/shapes/unit_arc.h"

namespace batten {
using namespace internal;
namespace {

// To rounding, which turning a direction round or moving its domain back and forth costs.
bool Same(const SplineBasis& a, const SplineBasis& b) {
  constexpr double kRounding = 4 * std::numeric_limits<double>::epsilon();
  const auto near = [](double x, double y) { return std::abs(x - y) <= kRounding; };
  return a.degree() == b.degree() && a.periodic() == b.periodic() && a.size() == b.size() &&
         std::equal(a.knots().begin(), a.knots().end(), b.knots().begin(), near);
}

bool IsLineBasis(const SplineBasis& basis) { return Same(basis, SplineBasis(1, {0, 0, 1, 1})); }

struct KnownArc {
  UnitArc arc;  // from angle 0
  double sweep;
};

// The arc that has this basis and these weights: w1/w0 is the cosine of half a piece. None where
// there is none.
std::optional<KnownArc> ArcLike(const SplineBasis& basis, double w0, double w1) {
  const int pieces = (basis.size() - 1) / 2;
  const double cosine = w1 / w0, sine = std::sqrt(1 - cosine * cosine);
  if (basis.degree() != 2 || pieces < 1 || pieces > 4 || !(sine > 0)) return std::nullopt;
  const double sweep = std::min(kTurn, pieces * 2 * std::atan2(sine, cosine));
  KnownArc known{UnitArc({0, sweep}), sweep};
  return Same(basis, known.arc.basis) ? std::optional(std::move(known)) : std::nullopt;
}

// Points of the plane as an image of an arc's under turns, shifts and scaling, by least squares:
// image = center + radius · e^(i start) · point in complex numbers.
struct ArcImage {
  ArcImage(const UnitArc& arc, const Eigen::Matrix2Xd& image) {
    const Eigen::Vector2d from = arc.points.rowwise().mean(), to = image.rowwise().mean();
    double real = 0, imaginary = 0, square = 0;
    for (Eigen::Index k = 0; k < image.cols(); ++k) {
      const Eigen::Vector2d p = arc.points.col(k) - from, q = image.col(k) - to;
      real += p.dot(q);
      imaginary += p.x() * q.y() - p.y() * q.x();
      square += p.squaredNorm();
    }
    const Eigen::Vector2d z = Eigen::Vector2d(real, imaginary) / square;
    radius = z.norm();
    start = std::atan2(z.y(), z.x());
    center = to - Eigen::Vector2d(z.x() * from.x() - z.y() * from.y(),
                                  z.x() * from.y() + z.y() * from.x());
  }

  Eigen::Vector2d center;
  double radius, start;
};

// Points in the coordinates x, y of a plane through `origin`.
Eigen::Matrix2Xd InPlane(const Eigen::Matrix3Xd& points,
                         const Eigen::Vector3d& origin,
                         const Eigen::Vector3d& x,
                         const Eigen::Vector3d& y) {
  Eigen::Matrix2Xd result(2, points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    result.col(k) << (points.col(k) - origin).dot(x), (points.col(k) - origin).dot(y);
  }
  return result;
}

// The area that a polygon from its first point turns through, as a vector.
Eigen::Vector3d AreaOf(const Eigen::Matrix3Xd& points) {
  Eigen::Vector3d sum = Eigen::Vector3d::Zero();
  for (Eigen::Index k = 1; k + 1 < points.cols(); ++k) {
    const Eigen::Vector3d from = points.col(k) - points.col(0);
    sum += from.cross(points.col(k + 1) - points.col(0));
  }
  return sum;
}

// The circle of an arc's image about an axis, its frame turned to the arc's beginning.
struct CircleAbout {
  Frame frame;
  double radius;
};
std::optional<CircleAbout> ImageAbout(const Eigen::Vector3d& axis,
                                      const UnitArc& arc,
                                      const Eigen::Matrix3Xd& points) {
  const Eigen::Vector3d first = points.col(0);
  if (!axis.allFinite() || !(axis.norm() > 0)) return std::nullopt;
  const Frame plane(first, axis);
  const ArcImage image(arc, InPlane(points, first, plane.x(), plane.y()));
  double height = 0;
  for (const auto& p : points.colwise()) height += (p - first).dot(plane.axis());
  height /= static_cast<double>(points.cols());
  if (!std::isfinite(image.radius) || !(image.radius > 0)) return std::nullopt;
  const Eigen::Vector3d x = std::cos(image.start) * plane.x() + std::sin(image.start) * plane.y();
  return CircleAbout{Frame(plane.At(image.center.x(), image.center.y(), height), plane.axis(), x),
                     image.radius};
}

// How far a shape made is from the one given, in units of what is allowed; infinite where they are
// not built alike.
template <typename Shape>
double Mismatch(const Shape& given, const Shape& made) {
  constexpr double kRelative = 1e-13, kWeights = 1e-13, kPlaces = 8;
  const auto &p = given.control_points(), &q = made.control_points();
  if (p.cols() != q.cols()) return kInfinity;
  const double allowed = kRelative * BoxDiagonal(p) +
                         kPlaces * std::numeric_limits<double>::epsilon() * p.cwiseAbs().maxCoeff();
  return std::max((p - q).cwiseAbs().maxCoeff() / allowed,
                  (given.weights() - made.weights()).cwiseAbs().maxCoeff() / kWeights);
}

bool SameBases(const NurbsCurve<3>& a, const NurbsCurve<3>& b) {
  return Same(a.basis(), b.basis());
}
bool SameBases(const NurbsSurface& a, const NurbsSurface& b) {
  return Same(a.basis_u(), b.basis_u()) && Same(a.basis_v(), b.basis_v());
}

// Of the candidates that are good enough the best of the simplest kind: a cylinder is a cone too.
// Numbers that make no shape are refused by what makes them.
template <typename Exact, typename Shape>
std::optional<Exact> Best(const Shape& given, const std::vector<Exact>& candidates) {
  std::optional<Exact> best;
  double least = 1;
  for (const Exact& candidate : candidates) {
    if (best && best->index() < candidate.index()) continue;
    try {
      const Shape made = ToNurbs(candidate);
      const double mismatch = SameBases(given, made) ? Mismatch(given, made) : kInfinity;
      if (!(mismatch <= (best && best->index() == candidate.index() ? least : 1))) continue;
      least = mismatch;
      best = candidate;
    } catch (const std::invalid_argument&) {
      continue;
    }
  }
  return best;
}

// A net whose columns in u are arcs about one axis.
class RoundNet {
 public:
  RoundNet(const NurbsSurface& surface, KnownArc around)
      : surface_(surface), around_(std::move(around)), widest_(WidestRow()) {}

  std::vector<ExactSurface> Candidates() const {
    std::vector<ExactSurface> result;
    const Eigen::Vector3d area = AreaOf(Row(widest_));
    for (const Eigen::Vector3d& axis : {area, Along(area)}) {
      const auto circle = ImageAbout(axis, around_.arc, Row(widest_));
      if (!circle) continue;
      if (IsLineBasis(surface_.basis_v())) {
        AddStraight(circle->frame, result);
      } else {
        AddRound(circle->frame, result);
      }
    }
    return result;
  }

 private:
  Eigen::Matrix3Xd Row(int j) const {
    Eigen::Matrix3Xd row(3, surface_.size_u());
    for (int i = 0; i < surface_.size_u(); ++i) row.col(i) = surface_.control_point(i, j);
    return row;
  }

  bool Collapsed(int j) const {
    const Eigen::Matrix3Xd row = Row(j);
    return (row.colwise() - row.col(0)).isZero(0);
  }

  int WidestRow() const {
    int widest = 0;
    for (int j = 1; j < surface_.size_v(); ++j) {
      if (BoxDiagonal(Row(j)) > BoxDiagonal(Row(widest))) widest = j;
    }
    return widest;
  }

  AngleRange Around() const { return {0, around_.sweep}; }

  // From the first row to the last by and large, on the side of `area`.
  Eigen::Vector3d Along(const Eigen::Vector3d& area) const {
    const int last = surface_.size_v() - 1;
    const Eigen::Vector3d along = Row(last).rowwise().mean() - Row(0).rowwise().mean();
    return along.dot(area) < 0 ? Eigen::Vector3d(-along) : along;
  }

  struct Ring {
    Eigen::Vector3d center;
    double radius;
  };
  std::optional<Ring> TorusSectionOf(int j, const Frame& frame) const {
    if (Collapsed(j)) return Ring{Row(j).col(0), 0};
    const auto circle = ImageAbout(frame.axis(), around_.arc, Row(j));
    if (!circle) return std::nullopt;
    return Ring{circle->frame.origin(), circle->radius};
  }

  void AddStraight(const Frame& frame, std::vector<ExactSurface>& result) const {
    const auto lower = TorusSectionOf(0, frame), upper = TorusSectionOf(1, frame);
    if (!lower || !upper) return;
    const Interval height{0, (upper->center - lower->center).dot(frame.axis())};
    const Frame at_start(lower->center, frame.axis(), frame.x());
    result.push_back(
        ExactCylinder{at_start, (lower->radius + upper->radius) / 2, height, Around()});
    result.push_back(ExactCone{at_start, lower->radius, upper->radius, height, Around()});
  }

  // The profile is the first meridian.
  void AddRound(const Frame& frame, std::vector<ExactSurface>& result) const {
    const int last = surface_.size_v() - 1;
    const auto known = ArcLike(surface_.basis_v(), surface_.weights()[0], surface_.weights()[1]);
    if (!known) return;
    const ArcImage tube(
        known->arc,
        InPlane(
            surface_.control_points().leftCols(last + 1), frame.origin(), frame.x(), frame.axis()));
    if (!tube.center.allFinite()) return;
    const Frame centered(frame.At(0, 0, tube.center.y()), frame.axis(), frame.x());
    const Interval latitude{Collapsed(0) ? -kTurn / 4 : tube.start,
                            Collapsed(last) ? kTurn / 4 : tube.start + known->sweep};
    result.push_back(ExactSphere{centered, tube.radius, Around(), latitude});
    constexpr double kSphere = 1e-6;  // a torus so thin is a sphere that rounding spoils
    if (!(tube.center.x() > kSphere * tube.radius)) return;
    result.push_back(
        ExactTorus{centered, tube.center.x(), tube.radius, Around(), {tube.start, known->sweep}});
  }

  const NurbsSurface& surface_;
  KnownArc around_;
  int widest_;
};

}  // namespace

NurbsCurve<3> ToNurbs(const ExactCurve& shape) {
  if (const auto* line = std::get_if<ExactLine>(&shape)) return MakeLine<3>(line->start, line->end);
  const ExactArc& arc = std::get<ExactArc>(shape);
  return MakeArc(arc.frame, arc.radius, arc.angles);
}

NurbsSurface ToNurbs(const ExactSurface& shape) {
  struct Make {
    NurbsSurface operator()(const ExactPlane& s) const { return MakePlane(s.frame, s.x, s.y); }
    NurbsSurface operator()(const ExactCylinder& s) const {
      return MakeCylinder(s.frame, s.radius, s.height, s.angles);
    }
    NurbsSurface operator()(const ExactCone& s) const {
      return MakeCone(s.frame, s.radius_lower, s.radius_upper, s.height, s.angles);
    }
    NurbsSurface operator()(const ExactSphere& s) const {
      return MakeSphere(s.frame, s.radius, s.longitude, s.latitude);
    }
    NurbsSurface operator()(const ExactTorus& s) const {
      return MakeTorus(s.frame, s.major, s.minor, s.round, s.tube);
    }
  };
  return std::visit(Make(), shape);
}

std::optional<ExactCurve> ExactShapeOf(const NurbsCurve<3>& curve) {
  const Eigen::Matrix3Xd& p = curve.control_points();
  if (IsLineBasis(curve.basis())) {
    return Best<ExactCurve>(curve, {ExactLine{p.col(0), p.col(1)}});
  }
  const Eigen::VectorXd& w = curve.weights();
  const auto known = ArcLike(curve.basis(), w[0], w[1]);
  if (!known) return std::nullopt;
  const auto circle = ImageAbout(AreaOf(p), known->arc, p);
  if (!circle) return std::nullopt;
  return Best<ExactCurve>(curve, {ExactArc{circle->frame, circle->radius, {0, known->sweep}}});
}

std::optional<ExactSurface> ExactShapeOf(const NurbsSurface& surface) {
  if (IsLineBasis(surface.basis_u()) && IsLineBasis(surface.basis_v())) {
    const Eigen::Vector3d corner = surface.control_point(0, 0);
    const Eigen::Vector3d x = surface.control_point(1, 0) - corner;
    const Eigen::Vector3d y = surface.control_point(0, 1) - corner, normal = x.cross(y);
    if (!normal.allFinite() || !(normal.norm() > 0)) return std::nullopt;
    const Frame frame(corner, normal, x);
    return Best<ExactSurface>(surface, {ExactPlane{frame, {0, x.norm()}, {0, y.norm()}}});
  }
  auto around =
      ArcLike(surface.basis_u(), surface.weights()[0], surface.weights()[surface.size_v()]);
  if (!around) return std::nullopt;
  return Best<ExactSurface>(surface, RoundNet(surface, *std::move(around)).Candidates());
}

}  // namespace batten
