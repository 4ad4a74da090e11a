// SPDX-License-Identifier: MIT
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "batten/geometry/bounding_box.h"
#include "batten/geometry/classify_shape.h"
#include "batten/geometry/intersect_curves.h"
#include "batten/geometry/offset_curve.h"
#include "batten/geometry/split.h"
#include "geometry/bezier/cubic_chain.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/intersection/net_cone.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten {
using namespace internal;
namespace {

constexpr const char* kOffsetCurve = "OffsetCurve";
constexpr double kAim = 0.5;  // of the tolerance: between the places looked at it may be more

// A place of the offset: by the curve's parameter, one-sided at knots.
struct OffsetPlace {
  Eigen::Vector3d point, velocity;
  Eigen::Vector3d base, aside;  // of the curve; the unit direction to the left
  double stretch;  // speed of the offset along the curve's direction, over that of the curve
};

class OffsetOfPiece {
 public:
  OffsetOfPiece(const CurvePiece& piece, const Eigen::Vector3d& normal, double distance)
      : piece_(piece), normal_(normal), distance_(distance) {}

  double lower() const { return piece_.u0; }
  double upper() const { return piece_.u1; }

  OffsetPlace At(double u) const {
    const double wide = piece_.u1 - piece_.u0;
    const CurvePieceJet jet = JetOf(piece_, (u - piece_.u0) / wide);
    const Eigen::Vector3d first = jet.first / wide, second = jet.second / (wide * wide);
    const Eigen::Vector3d across = normal_.cross(first);
    const double length = across.norm();
    constexpr double kAlong = 1e-9;
    RequireThat(length > kAlong * first.norm() && length > 0,
                kOffsetCurve,
                "the curve stands still or runs along the normal at t = " + NumberText(u) +
                    ": there is no side to go to");
    OffsetPlace place;
    place.aside = across / length;
    const Eigen::Vector3d turned = normal_.cross(second);
    const Eigen::Vector3d change = (turned - place.aside * place.aside.dot(turned)) / length;
    place.base = piece_.origin + jet.point;
    place.point = place.base + distance_ * place.aside;
    place.velocity = first + distance_ * change;
    place.stretch = place.velocity.dot(first) / first.squaredNorm();
    return place;
  }

 private:
  const CurvePiece& piece_;
  Eigen::Vector3d normal_;
  double distance_;
};

// Refuses a curve that bends tighter than the distance. [Kiefer 1953, the search]
void RequireWideBends(const std::vector<CurvePiece>& pieces,
                      const Eigen::Vector3d& normal,
                      double distance) {
  double least = 1, at = 0;
  for (const CurvePiece& piece : pieces) {
    const OffsetOfPiece offset(piece, normal, distance);
    const int places = 4 * piece.degree() + 9;
    const double step = (piece.u1 - piece.u0) / places;
    for (int k = 0; k <= places; ++k) {
      double u = piece.u0 + k * step, reach = step;
      double value = offset.At(std::min(u, piece.u1)).stretch;
      if (value > least + 0.1) continue;
      constexpr int kSteps = 40;
      for (int i = 0; i < kSteps; ++i) {
        bool moved = false;
        for (const double next : {u - reach, u + reach}) {
          const double kept = std::clamp(next, piece.u0, piece.u1);
          const double there = offset.At(kept).stretch;
          if (there < value) {
            value = there;
            u = kept;
            moved = true;
            break;
          }
        }
        if (!moved) reach /= 2;
      }
      if (value < least) {
        least = value;
        at = u;
      }
    }
  }
  constexpr double kLeast = 1e-9;
  RequireThat(least > kLeast,
              kOffsetCurve,
              "distance = " + NumberText(distance) +
                  " is beyond the smallest radius of curvature " +
                  RoundedText(std::abs(distance) / (1 - least)) +
                  " on that side, at t = " + RoundedText(at));
}

// Cubics over [from, to] of one piece, halved until they are near.
class OffsetFitter {
 public:
  OffsetFitter(double tolerance, CubicChain<3>& chain) : tolerance_(tolerance), chain_(chain) {}

  void AddPiece(const OffsetOfPiece& offset, double shift) {
    shift_ = shift;
    Add(offset,
        offset.lower(),
        offset.At(offset.lower()),
        offset.upper(),
        offset.At(offset.upper()),
        0);
  }

  // An arc about a corner from one side's direction to the other's, over [from, from + width].
  void AddArc(const OffsetPlace& before,
              const OffsetPlace& after,
              const Eigen::Vector3d& normal,
              double distance,
              double from,
              double width) {
    const double angle =
        std::atan2(normal.dot(before.aside.cross(after.aside)), before.aside.dot(after.aside));
    // A cubic over an angle φ is off by φ⁶/46656 of the radius at most. [Goldapp 1991]
    const double finest = std::pow(kAim * tolerance_ / std::abs(distance) * 4e4, 1.0 / 6);
    const int parts =
        std::max(1, static_cast<int>(std::ceil(std::abs(angle) / std::min(finest, 1.5))));
    const double part = angle / parts;
    const double third = 4.0 / 3 * std::tan(part / 4);
    for (int k = 0; k < parts; ++k) {
      const auto spoke = [&](double turn) -> Eigen::Vector3d {
        return Eigen::AngleAxisd(turn, normal) * before.aside;
      };
      const Eigen::Vector3d a = spoke(k * part), b = spoke((k + 1) * part);
      Eigen::Matrix<double, 3, 4> cubic;
      cubic << a, a + third * normal.cross(a), b - third * normal.cross(b), b;
      cubic = (distance * cubic).colwise() + before.base;
      const double start = from + k * width / parts, end = from + (k + 1) * width / parts;
      chain_.Add(cubic, start, end, 3);
      last_.setZero();
    }
    corner_ = true;
  }

  double greatest() const { return greatest_; }

 private:
  void Add(const OffsetOfPiece& offset,
           double from,
           const OffsetPlace& a,
           double to,
           const OffsetPlace& b,
           int depth) {
    const double third = (to - from) / 3;
    Eigen::Matrix<double, 3, 4> cubic;
    cubic << a.point, a.point + third * a.velocity, b.point - third * b.velocity, b.point;
    constexpr int kPlaces = 7, kMostHalvings = 30;
    double most = 0;
    for (int k = 1; k <= kPlaces && most <= kAim * tolerance_; ++k) {
      const double t = static_cast<double>(k) / (kPlaces + 1);
      double B[4];
      BernsteinBasis(3, t, B);
      const Eigen::Vector3d here =
          B[0] * cubic.col(0) + B[1] * cubic.col(1) + B[2] * cubic.col(2) + B[3] * cubic.col(3);
      most = std::max(most, (here - offset.At(from + t * (to - from)).point).norm());
    }
    if (most > kAim * tolerance_ && depth < kMostHalvings) {
      const double middle = from / 2 + to / 2;
      const OffsetPlace m = offset.At(middle);
      Add(offset, from, a, middle, m, depth + 1);
      Add(offset, middle, m, to, b, depth + 1);
      return;
    }
    greatest_ = std::max(greatest_, most);
    constexpr double kSame = 1e-9;
    const bool smooth = !corner_ && (last_ - a.velocity).norm() <= kSame * a.velocity.norm();
    chain_.Add(cubic, from + shift_, to + shift_, smooth ? 2 : 3);
    last_ = b.velocity;
    corner_ = false;
  }

  double tolerance_, shift_ = 0, greatest_ = 0;
  CubicChain<3>& chain_;
  Eigen::Vector3d last_ = Eigen::Vector3d::Zero();
  bool corner_ = true;
};

template <int Dim>
NurbsCurve<Dim> BackFrom(const NurbsCurve<3>& curve) {
  return NurbsCurve<Dim>(
      curve.basis(), curve.control_points().template topRows<Dim>(), curve.weights());
}

// A line moved, or a circle about the normal scaled.
std::optional<NurbsCurve<3>> ExactOffset(const NurbsCurve<3>& curve,
                                         const std::vector<CurvePiece>& pieces,
                                         const Eigen::Vector3d& normal,
                                         double distance) {
  constexpr double kExact = 1e-13, kAlong = 1e-12;
  const CurveShape shape = ClassifyShape(curve, {.tolerance = kExact});
  const CurvePiece& middle = pieces[pieces.size() / 2];
  const OffsetPlace place =
      OffsetOfPiece(middle, normal, distance).At(middle.u0 / 2 + middle.u1 / 2);
  Eigen::Matrix3Xd points = curve.control_points();
  if (std::holds_alternative<LineShape>(shape)) {
    points.colwise() += distance * place.aside;
  } else if (const CircleShape* circle = std::get_if<CircleShape>(&shape)) {
    if (LineAngle(circle->normal, normal) > kAlong) return std::nullopt;
    const Eigen::Vector3d spoke = place.base - circle->center;
    const double ratio = (place.point - circle->center).dot(spoke) / spoke.squaredNorm();
    points = (ratio * (points.colwise() - circle->center)).colwise() + circle->center;
  } else {
    return std::nullopt;
  }
  return NurbsCurve<3>(curve.basis(), std::move(points), curve.weights());
}

// Where Bézier pieces of a curve that are not neighbours meet, and neighbours besides at their
// joint.
template <int Dim>
std::vector<CurveSelfMeeting<Dim>> SelfMeetings(const NurbsCurve<Dim>& curve, double tolerance) {
  const std::vector<NurbsCurve<Dim>> pieces = Decompose(curve);
  std::vector<Eigen::AlignedBox<double, Dim>> boxes;
  for (const NurbsCurve<Dim>& piece : pieces) {
    Eigen::AlignedBox<double, Dim> box;
    for (const auto& x : piece.control_points().colwise()) {
      box.extend(Eigen::Matrix<double, Dim, 1>(x));
    }
    boxes.push_back(box);
  }
  const double lower = curve.basis().lower(), upper = curve.basis().upper();
  const bool closed = (curve.At(lower) - curve.At(upper)).norm() <= 4 * tolerance;
  std::vector<CurveSelfMeeting<Dim>> found;
  for (std::size_t i = 0; i < pieces.size(); ++i) {
    for (std::size_t j = i + 1; j < pieces.size(); ++j) {
      if (boxes[i].exteriorDistance(boxes[j]) > tolerance) continue;
      const bool next = j == i + 1, round = closed && i == 0 && j + 1 == pieces.size();
      for (const auto& one : IntersectCurves(pieces[i], pieces[j], tolerance).points) {
        const double reach = 16 * tolerance;
        const auto at_end = [&](double u) { return (curve.At(u) - one.point).norm() <= reach; };
        if (next && at_end(pieces[i].basis().upper())) continue;
        if (round && at_end(lower)) continue;
        const bool known = std::any_of(found.begin(), found.end(), [&](const auto& other) {
          return (other.point - one.point).norm() <= reach;
        });
        if (!known) found.push_back({one.first, one.second, one.point});
      }
    }
  }
  return found;
}

template <int Dim>
double ToleranceOf(const NurbsCurve<Dim>& curve, const OffsetOptions& options) {
  const auto& points = curve.control_points();
  constexpr double kOfTheSize = 1e-6;
  return options.tolerance.value_or(
      kOfTheSize * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm());
}

template <int Dim>
CurveOffset<Dim> Offset(const NurbsCurve<Dim>& curve,
                        const Eigen::Vector3d& normal,
                        double distance,
                        const OffsetOptions& options) {
  RequireThat(std::isfinite(distance) && distance != 0,
              kOffsetCurve,
              "distance = " + NumberText(distance) + " is not finite and different from zero");
  if (options.tolerance) RequirePositive(kOffsetCurve, "tolerance", *options.tolerance);
  const double length = normal.norm();
  RequireThat(
      std::isfinite(length) && length > 0, kOffsetCurve, "the normal is zero or not finite");
  const Eigen::Vector3d unit = normal / length;
  const NurbsCurve<3> spatial = InSpace(curve);
  const std::vector<CurvePiece> pieces = PiecesOf(spatial);
  RequireWideBends(pieces, unit, distance);
  if (const auto exact = ExactOffset(spatial, pieces, unit, distance)) {
    return {BackFrom<Dim>(*exact), true, 0, {}};
  }
  const double tolerance = ToleranceOf(curve, options);
  constexpr double kArcWidth = 0.01;  // of the domain
  const double width = kArcWidth * (curve.basis().upper() - curve.basis().lower());
  CubicChain<3> chain;
  OffsetFitter fitter(tolerance, chain);
  double shift = 0;
  const auto corner = [&](const CurvePiece& from, const CurvePiece& to) {
    const OffsetPlace a = OffsetOfPiece(from, unit, distance).At(from.u1);
    const OffsetPlace b = OffsetOfPiece(to, unit, distance).At(to.u0);
    if ((a.point - b.point).norm() <= kAim * tolerance) return;
    fitter.AddArc(a, b, unit, distance, from.u1 + shift, width);
    shift += width;
  };
  for (std::size_t k = 0; k < pieces.size(); ++k) {
    if (k > 0) corner(pieces[k - 1], pieces[k]);
    fitter.AddPiece(OffsetOfPiece(pieces[k], unit, distance), shift);
  }
  const Eigen::Vector3d start = pieces.front().Euclidean(0);
  const Eigen::Vector3d end = pieces.back().Euclidean(pieces.back().degree());
  if ((start - end).norm() <= kAim * tolerance) corner(pieces.back(), pieces.front());
  NurbsCurve<Dim> offset = BackFrom<Dim>(chain.Take());
  std::vector<CurveSelfMeeting<Dim>> meetings = SelfMeetings(offset, tolerance);
  return {std::move(offset), false, fitter.greatest(), std::move(meetings)};
}

}  // namespace

CurveOffset<2> OffsetCurve(const NurbsCurve<2>& curve,
                           double distance,
                           const OffsetOptions& options) {
  return Offset(curve, Eigen::Vector3d::UnitZ(), distance, options);
}

CurveOffset<3> OffsetCurve(const NurbsCurve<3>& curve,
                           const Eigen::Vector3d& normal,
                           double distance,
                           const OffsetOptions& options) {
  return Offset(curve, normal, distance, options);
}

}  // namespace batten
