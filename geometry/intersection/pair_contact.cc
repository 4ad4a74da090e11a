// SPDX-License-Identifier: MIT
#include "geometry/intersection/pair_contact.h"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>

#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr int kContactSteps = 20;
constexpr double kSettled = 1e-3;  // of the tolerance
constexpr double kBeyond = 0.02;   // of a box: how far outside it steps may go
constexpr double kParallelTangents = 1e-12;
constexpr double kLeastContactSine = 1e-7;  // below, the direction of a branch is rounding

}  // namespace

PairContact::PairContact(const PatchTree& a,
                         const ParameterBox& box_a,
                         const PatchTree& b,
                         const ParameterBox& box_b,
                         MeetKind kind,
                         double tolerance)
    : a_(a),
      b_(b),
      box_a_(box_a),
      box_b_(box_b),
      kind_(kind),
      tolerance_(tolerance),
      size_(std::min(a.size(), b.size())),
      lower_(box_a.u0, box_a.v0, box_b.u0, box_b.v0),
      upper_(box_a.u1, box_a.v1, box_b.u1, box_b.v1),
      widths_(upper_ - lower_) {}

// N_a·B_s and N_a·B_t over the lengths of both, times the size: heights that vanish where the
// normals are parallel.
PairContact::Rows PairContact::TouchRows(const SurfaceJet& a,
                                         const SurfaceJet& b,
                                         Eigen::Vector2d& values) const {
  const Eigen::Vector3d normal = a.du.cross(a.dv);
  const Eigen::Vector3d by_u = a.duu.cross(a.dv) + a.du.cross(a.duv);
  const Eigen::Vector3d by_v = a.duv.cross(a.dv) + a.du.cross(a.dvv);
  Rows rows(2, 4);
  const auto row = [&](int k, const Eigen::Vector3d& t, const Eigen::Vector3d& ts, const auto& tt) {
    const double scale = size_ / std::max(normal.norm() * t.norm(), 1e-300);
    values[k] = scale * normal.dot(t);
    rows.row(k) << scale * by_u.dot(t), scale * by_v.dot(t), scale * normal.dot(ts),
        scale * normal.dot(tt);
  };
  row(0, b.du, b.duu, b.duv);
  row(1, b.dv, b.duv, b.dvv);
  return rows;
}

PairContact::System PairContact::SystemAt(const Eigen::Vector4d& at, const Hold* hold) const {
  const SurfaceJet a = a_.JetAt(box_a_, at[0], at[1]), b = b_.JetAt(box_b_, at[2], at[3]);
  const int touch = kind_ == MeetKind::kTouching ? 2 : 0, held = hold ? 1 : 0;
  System system;
  system.matrix.resize(3 + touch + held, 4);
  system.values.resize(3 + touch + held);
  system.values.head<3>() = a.point - b.point;
  system.matrix.topRows<3>() << a.du, a.dv, -b.du, -b.dv;
  if (touch > 0) {
    Eigen::Vector2d values;
    system.matrix.middleRows<2>(3) = TouchRows(a, b, values);
    system.values.segment<2>(3) = values;
  }
  if (hold && hold->parameter >= 0) {
    system.matrix.bottomRows<1>().setZero();
    system.matrix(3 + touch, hold->parameter) = size_ / widths_[hold->parameter];
    system.values[3 + touch] = 0;
  } else if (hold) {
    system.matrix.bottomRows<1>() << hold->normal.dot(a.du), hold->normal.dot(a.dv), 0, 0;
    system.values[3 + touch] = hold->normal.dot(a.point - hold->through);
  }
  system.matrix *= widths_.asDiagonal();
  return system;
}

std::optional<Eigen::Vector4d> PairContact::Solve(Eigen::Vector4d at, const Hold* hold) const {
  const Eigen::Vector4d lower = lower_ - kBeyond * widths_, upper = upper_ + kBeyond * widths_;
  double last = std::numeric_limits<double>::infinity();
  for (int k = 0; k < kContactSteps; ++k) {
    at = at.cwiseMax(lower).cwiseMin(upper);
    const System system = SystemAt(at, hold);
    const double error = system.values.cwiseAbs().maxCoeff();
    if (!std::isfinite(error)) return std::nullopt;
    if (error <= kSettled * tolerance_) return at;
    constexpr double kFalls = 0.9;
    constexpr int kFreeSteps = 6;
    if (k > kFreeSteps && error > kFalls * last) break;
    last = error;
    Eigen::Vector4d step;
    bool solved = false;
    if (system.matrix.rows() == 4) {
      step = Eigen::Matrix4d(system.matrix).partialPivLu().solve(system.values);
      solved = step.allFinite() && step.cwiseAbs().maxCoeff() < 1;
    }
    if (!solved) {
      constexpr double kRank = 1e-9;
      step = LeastNormSolution(system.matrix, system.values, kRank);
      if (!step.allFinite()) return std::nullopt;
      const double longest = step.cwiseAbs().maxCoeff();
      constexpr double kLongest = 0.25;
      if (longest > kLongest) step *= kLongest / longest;
    }
    at -= widths_.cwiseProduct(step);
  }
  // A tenth of the tolerance does: rounding, or a slow end at a pole.
  at = at.cwiseMax(lower).cwiseMin(upper);
  const System system = SystemAt(at, hold);
  constexpr double kGoodEnough = 0.1;
  if (system.values.cwiseAbs().maxCoeff() <= kGoodEnough * tolerance_) return at;
  return std::nullopt;
}

std::optional<Eigen::Vector4d> PairContact::InPlane(const Eigen::Vector4d& start,
                                                    const Eigen::Vector3d& normal,
                                                    const Eigen::Vector3d& through) const {
  const Hold hold{normal, through, -1};
  return Solve(start, &hold);
}

std::optional<Eigen::Vector4d> PairContact::Holding(const Eigen::Vector4d& start,
                                                    int parameter) const {
  Hold hold;
  hold.parameter = parameter;
  std::optional<Eigen::Vector4d> at = Solve(start, &hold);
  if (at) (*at)[parameter] = start[parameter];
  return at;
}

std::optional<Eigen::Vector4d> PairContact::Nearest(const Eigen::Vector4d& start) const {
  return Solve(start, nullptr);
}

std::optional<Eigen::Vector4d> PairContact::NearestTouch(const Eigen::Vector4d& start) const {
  return PairContact(a_, box_a_, b_, box_b_, MeetKind::kTouching, tolerance_).Nearest(start);
}

// Lengths of the derivatives by each parameter.
Eigen::Vector4d PairContact::SpeedsAt(const Eigen::Vector4d& at) const {
  const SurfaceJet a = a_.JetAt(box_a_, at[0], at[1]), b = b_.JetAt(box_b_, at[2], at[3]);
  return {a.du.norm(), a.dv.norm(), b.du.norm(), b.dv.norm()};
}

Eigen::Vector4d PairContact::AlongBorders(const MeetPoint& here, Eigen::Vector4d at) const {
  constexpr double kOn = 0.1;
  constexpr double kAlong = 1e-3;  // radians between a branch and the border it runs along
  const Eigen::Vector4d speeds = SpeedsAt(here.at);
  for (int i = 0; i < 4; ++i) {
    if (std::abs(here.velocity[i]) * speeds[i] > kAlong) continue;
    const double slack =
        std::min(kOn * tolerance_ / std::max(speeds[i], 1e-300), kBeyond * widths_[i]);
    for (const double border : {lower_[i], upper_[i]}) {
      if (std::abs(here.at[i] - border) <= slack && std::abs(at[i] - border) <= slack) {
        at[i] = border;
      }
    }
  }
  return at;
}

Eigen::Vector4d PairContact::OntoBorders(Eigen::Vector4d at) const {
  const Eigen::Vector4d speeds = SpeedsAt(at);
  constexpr double kOn = 0.01;
  constexpr double kOnOfTheBox = 1e-12;
  for (int i = 0; i < 4; ++i) {
    const double slack =
        std::max(std::min(kOn * tolerance_ / std::max(speeds[i], 1e-300), kBeyond * widths_[i]),
                 kOnOfTheBox * widths_[i]);
    if (std::abs(at[i] - lower_[i]) <= slack) at[i] = lower_[i];
    if (std::abs(at[i] - upper_[i]) <= slack) at[i] = upper_[i];
  }
  return at;
}

bool PairContact::Inside(const Eigen::Vector4d& at) const {
  return (at.array() >= lower_.array()).all() && (at.array() <= upper_.array()).all();
}

Eigen::Vector3d PairContact::First(const Eigen::Vector4d& at) const {
  return a_.PointAt(box_a_, at[0], at[1]);
}

Eigen::Vector3d PairContact::Second(const Eigen::Vector4d& at) const {
  return b_.PointAt(box_b_, at[2], at[3]);
}

bool PairContact::Coincident(const Eigen::Vector4d& at) const {
  const System system = SystemAt(at, nullptr);
  const Eigen::VectorXd changes = SingularValuesOf(system.matrix).values;
  // Two directions in which nothing changes.
  constexpr double kNothing = 1e-6;
  return changes[2] <= kNothing * changes[0];
}

MeetPoint PairContact::PointAt(const Eigen::Vector4d& at) const {
  const SurfaceJet a = a_.JetAt(box_a_, at[0], at[1]), b = b_.JetAt(box_b_, at[2], at[3]);
  const Eigen::Vector3d na = a.du.cross(a.dv), nb = b.du.cross(b.dv);
  const double area_a = na.norm(), area_b = nb.norm();
  MeetPoint p{at,
              (a.point + b.point) / 2,
              Eigen::Vector3d::Zero(),
              Eigen::Vector4d::Zero(),
              1,
              area_a > kParallelTangents * a.du.norm() * a.dv.norm() &&
                  area_b > kParallelTangents * b.du.norm() * b.dv.norm()};
  if (!p.regular) return p;
  const Eigen::Vector3d across = (na / area_a).cross(nb / area_b);
  p.sine = std::min(1.0, across.norm());
  if (kind_ == MeetKind::kTouching) {
    const System system = SystemAt(at, nullptr);
    const Eigen::Vector4d direction =
        widths_.cwiseProduct(SingularValuesOf(system.matrix).v.col(3));
    p.tangent = a.du * direction[0] + a.dv * direction[1];
  } else {
    p.regular = p.sine > kLeastContactSine;
    p.tangent = across;
  }
  const double length = p.tangent.norm();
  p.regular = p.regular && length > 0;
  if (!p.regular) return p;
  p.tangent /= length;
  const auto components = [&](const SurfaceJet& jet, const Eigen::Vector3d& normal, double area) {
    const Eigen::Vector3d unit = normal / area;
    return Eigen::Vector2d(p.tangent.cross(jet.dv).dot(unit) / area,
                           jet.du.cross(p.tangent).dot(unit) / area);
  };
  p.velocity << components(a, na, area_a), components(b, nb, area_b);
  return p;
}

}  // namespace batten::internal
