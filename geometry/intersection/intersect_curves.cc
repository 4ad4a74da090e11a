// SPDX-License-Identifier: MIT
#include "batten/geometry/intersect_curves.h"

#include <cmath>
#include <utility>

#include "batten/geometry/foot_point.h"
#include "batten/geometry/make_curve.h"
#include "geometry/intersection/arc_meets.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

template <int Dim>
Eigen::Vector3d MiddleOf(const NurbsCurve<Dim>& curve) {
  const auto& points = curve.control_points();
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  middle.head<Dim>() = (points.rowwise().maxCoeff() + points.rowwise().minCoeff()) / 2;
  return middle;
}

template <int Dim>
NurbsCurve<Dim> MovedBack(const NurbsCurve<Dim>& curve, const Eigen::Vector3d& origin) {
  auto points = curve.control_points();
  points.colwise() -= origin.head<Dim>();
  return NurbsCurve<Dim>(curve.basis(), std::move(points), curve.weights());
}

constexpr int kMostSteps = 25;   // of an iteration that starts in the middle of an arc
constexpr double kStill = 1e-3;  // of the tolerance: a step that ends it

// What is beyond rounding of the coordinates.
template <typename First, typename Second>
double WorkingTolerance(const char* function,
                        const First& first,
                        const Second& second,
                        double tolerance) {
  RequirePositive(function, "tolerance", tolerance);
  constexpr double kUnits = 16, kEpsilon = 0x1p-52;
  const double largest = std::max(first.control_points().cwiseAbs().maxCoeff(),
                                  second.control_points().cwiseAbs().maxCoeff());
  return std::max(tolerance, kUnits * kEpsilon * largest);
}

// Whether a parameter that was solved for belongs to an interval; rounding is granted.
bool Within(double x, double low, double high) {
  const double slack = 1e-9 * (high - low);
  return x >= low - slack && x <= high + slack;
}

template <int Dim>
class CurveTarget {
 public:
  CurveTarget(const NurbsCurve<Dim>& curve, const Eigen::Vector3d& origin)
      : arcs_(curve, origin), feet_(MovedBack(curve, origin)) {}

  int roots() const { return arcs_.roots(); }
  int Halve(int k) { return arcs_.Halve(k); }
  double Size(int k) const { return arcs_[k].size; }
  double Flatness(int k) const { return arcs_[k].flatness; }

  bool Separated(const NetArc& arc, int k, double gap) const {
    const NetArc& other = arcs_[k];
    if (BoxesApart(arc.bounds, other.bounds, gap)) return true;
    const Eigen::Vector3d &a = arc.tangent.axis, &b = other.tangent.axis;
    Eigen::Vector3d across = a.cross(b);
    const double sine = across.norm();
    constexpr double kAlike = 1e-3;
    if (sine > kAlike) {
      across /= sine;
      return ApartAlong(arc.points, other.points, across, gap) ||
             ApartAlong(arc.points, other.points, across.cross(a), gap) ||
             ApartAlong(arc.points, other.points, across.cross(b), gap);
    }
    // Alike: across both, in the direction from the one to the other.
    Eigen::Vector3d between = other.bounds.center() - arc.bounds.center();
    between -= between.dot(a) * a;
    const double length = between.norm();
    return length > gap && ApartAlong(arc.points, other.points, between / length, gap);
  }

  double Angle(const NetArc& arc, int k) const {
    return LineAngle(arc.tangent.axis, arcs_[k].tangent.axis);
  }

  bool Transversal(const NetArc& arc, int k) const {
    return Angle(arc, k) * kSafe > arc.tangent.spread + arcs_[k].tangent.spread;
  }

  // Gauss–Newton for the least distance, kept in the domains.
  std::optional<ArcMeeting> Solve(const ArcTree& arcs,
                                  const NetArc& arc,
                                  int k,
                                  double tolerance) const {
    const NetArc& other = arcs_[k];
    double s = arc.Middle(), t = other.Middle(), moved = kInfinity;
    for (int i = 0; i < kMostSteps && moved > kStill * tolerance; ++i) {
      const auto a = arcs.JetAt(s), b = arcs_.JetAt(t);
      Eigen::Matrix<double, 3, 2> jacobian;
      jacobian << a.col(1), -b.col(1);
      const Eigen::Vector2d step = jacobian.colPivHouseholderQr().solve(a.col(0) - b.col(0));
      if (!step.allFinite()) return std::nullopt;
      const double next_s = std::clamp(s - step[0], arcs.lower(), arcs.upper());
      const double next_t = std::clamp(t - step[1], arcs_.lower(), arcs_.upper());
      moved = std::abs(next_s - s) * a.col(1).norm() + std::abs(next_t - t) * b.col(1).norm();
      s = next_s;
      t = next_t;
    }
    if (moved > kStill * tolerance) return std::nullopt;
    if (!Within(s, arc.u0, arc.u1) || !Within(t, other.u0, other.u1)) return std::nullopt;
    const double distance = (arcs.JetAt(s).col(0) - arcs_.JetAt(t).col(0)).norm();
    return ArcMeeting{s, {t, 0}, distance, false};
  }

  TargetFoot Foot(const Eigen::Vector3d& point) const {
    const CurveFoot foot = feet_.Nearest(point);
    return {{foot.u, 0}, foot.distance};
  }

  double AngleAt(const Eigen::Vector3d& direction, const Eigen::Vector2d& at) const {
    return LineAngle(direction, arcs_.JetAt(at[0]).col(1));
  }

  bool Next(const Eigen::Vector2d& x, const Eigen::Vector2d& y) const {
    const double length = arcs_.upper() - arcs_.lower(), apart = std::abs(x[0] - y[0]);
    constexpr double kNext = 1e-3;
    return std::min(apart, length - apart) <= kNext * length;
  }

 private:
  static constexpr double kSafe = 0.8;

  ArcTree arcs_;
  CurveFootPoints<Dim> feet_;
};

template <int Dim>
CurveIntersection<Dim> Meet(const char* function,
                            const NurbsCurve<Dim>& first,
                            const NurbsCurve<Dim>& second,
                            double tolerance) {
  const double working = WorkingTolerance(function, first, second, tolerance);
  const double size =
      std::min(BoxDiagonal(first.control_points()), BoxDiagonal(second.control_points()));
  const Eigen::Vector3d origin = MiddleOf(first);
  ArcTree arcs(first, origin);
  CurveTarget<Dim> target(second, origin);
  const ArcMeets meets = ArcMeetSearch(function, arcs, target, size, working).Run();
  CurveIntersection<Dim> result;
  for (const ArcMeeting& one : meets.points) {
    result.points.push_back({one.u,
                             one.at[0],
                             (first.At(one.u) + second.At(one.at[0])) / 2,
                             one.distance,
                             one.tangential});
  }
  for (const ArcStretch& one : meets.overlaps) {
    const auto foot = [&](double u) { return target.Foot(arcs.JetAt(u).col(0)).at[0]; };
    result.overlaps.push_back({{one.from, one.to}, {foot(one.from), foot(one.to)}});
  }
  return result;
}

}  // namespace

template <int Dim>
CurveIntersection<Dim> IntersectCurves(const NurbsCurve<Dim>& first,
                                       const NurbsCurve<Dim>& second,
                                       double tolerance) {
  return Meet("IntersectCurves", first, second, tolerance);
}

template CurveIntersection<2> IntersectCurves(const NurbsCurve<2>&, const NurbsCurve<2>&, double);
template CurveIntersection<3> IntersectCurves(const NurbsCurve<3>&, const NurbsCurve<3>&, double);

template <int Dim>
CurveIntersection<Dim> IntersectLine(const NurbsCurve<Dim>& curve,
                                     const Eigen::Matrix<double, Dim, 1>& through,
                                     const Eigen::Matrix<double, Dim, 1>& direction,
                                     double tolerance) {
  constexpr const char* kFunction = "IntersectLine";
  RequirePositive(kFunction, "tolerance", tolerance);
  const double length = direction.norm();
  RequireThat(length > 0 && std::isfinite(length) && through.allFinite(),
              kFunction,
              "the point and the direction must be finite, and the direction not zero");
  const Eigen::Matrix<double, Dim, 1> unit = direction / length;
  // The stretch of the line beside the control points.
  const Eigen::RowVectorXd along = unit.transpose() * (curve.control_points().colwise() - through);
  const double margin = BoxDiagonal(curve.control_points()) / 2 + tolerance;
  const double from = along.minCoeff() - margin, to = along.maxCoeff() + margin;
  const NurbsCurve<Dim> line = MakeLine<Dim>(through + from * unit, through + to * unit);
  CurveIntersection<Dim> met = Meet(kFunction, curve, line, tolerance);
  const auto distance = [&](double t) { return from + t * (to - from); };
  for (CurveMeeting<Dim>& one : met.points) one.second = distance(one.second);
  for (CurveOverlap& one : met.overlaps) {
    one.second = {distance(one.second.lower), distance(one.second.upper)};
  }
  return met;
}

template CurveIntersection<2> IntersectLine(const NurbsCurve<2>&,
                                            const Eigen::Vector2d&,
                                            const Eigen::Vector2d&,
                                            double);
template CurveIntersection<3> IntersectLine(const NurbsCurve<3>&,
                                            const Eigen::Vector3d&,
                                            const Eigen::Vector3d&,
                                            double);

namespace {

class SurfaceTarget {
 public:
  SurfaceTarget(const NurbsSurface& surface, const Eigen::Vector3d& origin)
      : patches_(surface, origin), feet_(surface.Translated(-origin)) {}

  int roots() const { return patches_.roots(); }
  int Halve(int k) { return patches_.Halve(k); }
  double Size(int k) const { return patches_[k].size(); }
  double Flatness(int k) const { return patches_[k].flatness; }

  bool Separated(const NetArc& arc, int k, double gap) const {
    const NetPatch& patch = patches_[k];
    if (BoxesApart(arc.bounds, patch.bounds, gap)) return true;
    if (!patch.normal.known()) return false;
    const Eigen::Vector3d& n = patch.normal.axis;
    if (ApartAlong(arc.points, patch.points, n, gap)) return true;
    const Eigen::Vector3d across = n.cross(arc.tangent.axis);
    const double sine = across.norm();
    constexpr double kAlike = 1e-3;
    return sine > kAlike && (ApartAlong(arc.points, patch.points, across / sine, gap) ||
                             ApartAlong(arc.points, patch.points, n.cross(across) / sine, gap));
  }

  bool Transversal(const NetArc& arc, int k) const {
    const NetPatch& patch = patches_[k];
    constexpr double kMostSpread = 0.7, kSafe = 0.8;
    return patch.normal.spread < kMostSpread &&
           Angle(arc, k) * kSafe > arc.tangent.spread + patch.normal.spread;
  }

  double Angle(const NetArc& arc, int k) const {
    return std::numbers::pi / 2 - LineAngle(arc.tangent.axis, patches_[k].normal.axis);
  }

  std::optional<ArcMeeting> Solve(const ArcTree& arcs,
                                  const NetArc& arc,
                                  int k,
                                  double tolerance) const {
    const NetPatch& patch = patches_[k];
    const ParameterBox& box = patches_.SmoothBoxOf(k);
    Eigen::Vector3d x(arc.Middle(), patch.Middle()[0], patch.Middle()[1]);
    const Eigen::Vector3d lower(arcs.lower(), box.u0, box.v0), upper(arcs.upper(), box.u1, box.v1);
    double moved = kInfinity;
    for (int i = 0; i < kMostSteps && moved > kStill * tolerance; ++i) {
      const auto c = arcs.JetAt(x[0]);
      const SurfaceJet s = patches_.JetAt(box, x[1], x[2]);
      Eigen::Matrix3d jacobian;
      jacobian << c.col(1), -s.du, -s.dv;
      const Eigen::Vector3d step = jacobian.partialPivLu().solve(c.col(0) - s.point);
      if (!step.allFinite()) return std::nullopt;
      const Eigen::Vector3d next = (x - step).cwiseMax(lower).cwiseMin(upper);
      moved = (next - x).cwiseAbs().dot(jacobian.colwise().norm());
      x = next;
    }
    if (moved > kStill * tolerance) return std::nullopt;
    if (!Within(x[0], arc.u0, arc.u1) || !Within(x[1], patch.box.u0, patch.box.u1) ||
        !Within(x[2], patch.box.v0, patch.box.v1)) {
      return std::nullopt;
    }
    const double distance = (arcs.JetAt(x[0]).col(0) - patches_.PointAt(box, x[1], x[2])).norm();
    return ArcMeeting{x[0], {x[1], x[2]}, distance, false};
  }

  TargetFoot Foot(const Eigen::Vector3d& point) const {
    const SurfaceFoot foot = feet_.Nearest(point);
    return {{foot.u, foot.v}, foot.distance};
  }

  double AngleAt(const Eigen::Vector3d& direction, const Eigen::Vector2d& at) const {
    const auto normal = feet_.surface().NormalAt(at[0], at[1]);
    if (!normal || direction.squaredNorm() == 0) return 0;
    return std::numbers::pi / 2 - LineAngle(direction, *normal);
  }

  bool Next(const Eigen::Vector2d&, const Eigen::Vector2d&) const { return true; }

  // Inside the trims, or within the tolerance of what is.
  bool Counts(const Eigen::Vector3d& point, double tolerance) const {
    return !feet_.surface().trimmed() || feet_.Nearest(point).distance <= tolerance;
  }

 private:
  PatchTree patches_;
  SurfaceFootPoints feet_;
};

}  // namespace

CurveSurfaceIntersection IntersectCurveSurface(const NurbsCurve<3>& curve,
                                               const NurbsSurface& surface,
                                               double tolerance) {
  constexpr const char* kFunction = "IntersectCurveSurface";
  const double working = WorkingTolerance(kFunction, curve, surface, tolerance);
  const double size =
      std::min(BoxDiagonal(curve.control_points()), BoxDiagonal(surface.control_points()));
  const Eigen::Vector3d origin = MiddleOf(curve);
  ArcTree arcs(curve, origin);
  SurfaceTarget target(surface, origin);
  const ArcMeets meets = ArcMeetSearch(kFunction, arcs, target, size, working).Run();
  CurveSurfaceIntersection result;
  for (const ArcMeeting& one : meets.points) {
    const Eigen::Vector3d on_surface = surface.At(one.at[0], one.at[1]);
    if (!target.Counts(on_surface - origin, working)) continue;
    result.points.push_back(
        {one.u, one.at, (curve.At(one.u) + on_surface) / 2, one.distance, one.tangential});
  }
  for (const ArcStretch& one : meets.overlaps) {
    const auto foot = [&](double u) { return target.Foot(arcs.JetAt(u).col(0)).at; };
    result.overlaps.push_back({{one.from, one.to}, foot(one.from), foot(one.to)});
  }
  return result;
}

}  // namespace batten
