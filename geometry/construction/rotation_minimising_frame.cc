// SPDX-License-Identifier: MIT
#include "geometry/construction/rotation_minimising_frame.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>

#include "batten/geometry/closure.h"
#include "batten/geometry/frame.h"
#include "batten/geometry/knot_vectors.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

std::string PlaceText(double at, const Eigen::Vector3d& point) {
  return RoundedText(at) + ", at (" + RoundedText(point.x()) + ", " + RoundedText(point.y()) +
         ", " + RoundedText(point.z()) + ")";
}

Eigen::Vector3d AnyNormal(const Eigen::Vector3d& tangent) { return Frame({0, 0, 0}, tangent).x(); }

Eigen::Matrix3d CrossMatrix(const Eigen::Vector3d& w) {
  Eigen::Matrix3d matrix;
  matrix << 0, -w.z(), w.y(), w.z(), 0, -w.x(), -w.y(), w.x(), 0;
  return matrix;
}

Eigen::Matrix3d Axes(const Eigen::Vector3d& normal, const Eigen::Vector3d& tangent) {
  Eigen::Matrix3d axes;
  axes << normal, tangent.cross(normal), tangent;
  return axes;
}

}  // namespace

RotationMinimisingFrame::RotationMinimisingFrame(const NurbsCurve<3>& curve,
                                                 double accuracy,
                                                 const char* function)
    : pieces_(curve), length_(curve), function_(function) {
  constexpr int kMostSteps = 1024;
  for (const KnotMultiplicity& knot : DomainKnots(curve.basis())) breaks_.push_back(knot.knot);
  nodes_ = Walk(4);
  for (int steps = 8; steps <= kMostSteps; steps *= 2) {
    std::vector<Node> finer = Walk(steps);
    double worst = 0;
    for (std::size_t k = 0; k < nodes_.size(); ++k) {
      worst = std::max(worst, AngleBetween(nodes_[k].normal, finer[2 * k].normal));
    }
    nodes_ = std::move(finer);
    if (worst <= accuracy) return;  // the finer one is sixteen times better
  }
}

std::vector<RotationMinimisingFrame::Node> RotationMinimisingFrame::Walk(int steps) const {
  const CurveJet<3> start = MovingJet(breaks_.front(), Side::kAbove);
  const Eigen::Vector3d tangent = start.first.normalized();
  std::vector<Node> nodes = {{breaks_.front(), start.point, tangent, AnyNormal(tangent)}};
  for (std::size_t k = 0; k + 1 < breaks_.size(); ++k) {
    for (int step = 1; step <= steps; ++step) {
      const double at = step == steps ? breaks_[k + 1]
                                      : breaks_[k] + (breaks_[k + 1] - breaks_[k]) * step / steps;
      nodes.push_back(Stepped(nodes.back(), at, Side::kBelow));
    }
  }
  return nodes;
}

CurveJet<3> RotationMinimisingFrame::MovingJet(double at, Side side) const {
  constexpr double kStill = 1e-12;  // of the mean speed
  const CurveJet<3> jet = pieces_.JetAt(at, side);
  const double mean_speed = length_.length() / (breaks_.back() - breaks_.front());
  RequireThat(jet.first.norm() > kStill * mean_speed,
              function_,
              "the trajectory has no tangent at its parameter " + PlaceText(at, jet.point) +
                  ", where its first derivative vanishes");
  return jet;
}

// Mirrored in the plane midway between the points, then in the one midway between the tangents.
RotationMinimisingFrame::Node RotationMinimisingFrame::Stepped(const Node& from,
                                                               double to,
                                                               Side side) const {
  const CurveJet<3> jet = MovingJet(to, side);
  Node node{to, jet.point, jet.first.normalized(), from.normal};
  Eigen::Vector3d tangent = from.tangent;
  const Eigen::Vector3d chord = node.point - from.point;
  if (!chord.isZero(0)) {
    const Eigen::Vector3d across = chord.normalized();
    node.normal -= 2 * across.dot(node.normal) * across;
    tangent -= 2 * across.dot(tangent) * across;
    const Eigen::Vector3d between = (node.tangent - tangent).normalized();
    node.normal -= 2 * between.dot(node.normal) * between;
  }
  node.normal = (node.normal - node.normal.dot(node.tangent) * node.tangent).normalized();
  return node;
}

double RotationMinimisingFrame::Holonomy() const {
  const Node& first = nodes_.front();
  const Node& last = nodes_.back();
  return std::atan2(first.tangent.dot(first.normal.cross(last.normal)),
                    first.normal.dot(last.normal));
}

RotationMinimisingFrame::Place RotationMinimisingFrame::At(double v, Side side) const {
  const auto above = std::ranges::upper_bound(nodes_, v, {}, &Node::at);
  const Node& before = above == nodes_.begin() ? nodes_.front() : *(above - 1);
  const Node here = v == before.at ? before : Stepped(before, v, side);
  Place place{pieces_.JetAt(v, side), {}, {}, {}};
  const double speed = place.jet.first.norm(), share = length_.LengthAt(v) / length_.length();
  const Eigen::Vector3d tangent = place.jet.first / speed;
  const Eigen::Vector3d tangent_slope =
      (place.jet.second - tangent * tangent.dot(place.jet.second)) / speed;
  const Eigen::Matrix3d twist = Eigen::AngleAxisd(twist_ * share, here.tangent).matrix();
  place.turn = twist * Axes(here.normal, here.tangent) *
               Axes(nodes_.front().normal, nodes_.front().tangent).transpose();
  const Eigen::Vector3d spin =
      tangent.cross(tangent_slope) + tangent * (twist_ * speed / length_.length());
  place.turn_slope = CrossMatrix(spin) * place.turn;
  place.bend = tangent_slope / speed;
  return place;
}

std::vector<double> RotationMinimisingFrame::Places() const {
  std::vector<double> places;
  for (const Node& node : nodes_) places.push_back(node.at);
  return places;
}

void RefuseKinks(const NurbsCurve<3>& curve, double angle, const char* function) {
  const OneSidedCurve pieces(curve);
  const SplineBasis& basis = curve.basis();
  double shortest = basis.upper() - basis.lower();
  for (const int span : basis.Spans())
    shortest = std::min(shortest, basis.knots()[span + 1] - basis.knots()[span]);
  // What rounding of the coordinates makes of the slope beside a knot.
  const double rounding =
      8 * kEpsilon * basis.degree() * curve.control_points().cwiseAbs().maxCoeff() / shortest;
  const auto refuse = [&](double below, double above) {
    const CurveJet<3> end = pieces.JetAt(below, Side::kBelow);
    const double turn = AngleBetween(end.first, pieces.JetAt(above, Side::kAbove).first);
    constexpr double kDegrees = 180 / std::numbers::pi;
    RequireThat(turn <= angle + rounding / end.first.norm(),
                function,
                "the trajectory has a kink of " + RoundedText(turn * kDegrees) +
                    " degrees at its parameter " + PlaceText(below, end.point) +
                    ": sweep the pieces between its kinks, or round them");
  };
  for (const KnotMultiplicity& knot : DomainKnots(basis)) {
    const bool may_kink = knot.multiplicity >= basis.degree();
    if (may_kink && knot.knot > basis.lower() && knot.knot < basis.upper()) {
      refuse(knot.knot, knot.knot);
    }
  }
  if (Closed(curve)) refuse(basis.upper(), basis.lower());
}

}  // namespace batten::internal
