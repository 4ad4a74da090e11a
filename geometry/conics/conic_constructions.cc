// SPDX-License-Identifier: MIT
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "batten/geometry/conic_arc.h"
#include "geometry/numeric/conic_fit.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kMiss = 1e-6;  // of the chord: what typed decimals may be off by

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;
template <int Dim>
using Lifted = Eigen::Matrix<double, Dim + 1, 1>;  // homogeneous

template <int Dim>
Lifted<Dim> Lift(const Vector<Dim>& v, double w) {
  Lifted<Dim> lifted;
  lifted << v, w;
  return lifted;
}

// Both ends with weight one and the middle column, where all are given from `origin`.
template <int Dim>
ConicArc<Dim> ArcFrom(const Vector<Dim>& origin,
                      const Vector<Dim>& start,
                      const Lifted<Dim>& middle,
                      const Vector<Dim>& end) {
  ConicArc<Dim> arc;
  arc.columns << Lift<Dim>(start + origin, 1),
      Lift<Dim>(middle.template head<Dim>() + middle[Dim] * origin, middle[Dim]),
      Lift<Dim>(end + origin, 1);
  return arc;
}

// Products of what is larger are no numbers.
template <typename Places>
void RequireSized(const char* function, const Places& places) {
  constexpr double kLargest = 1e100;
  RequireThat(places.cwiseAbs().maxCoeff() <= kLargest,
              function,
              "coordinates beyond 1e100 can't be worked with: scale the points");
}

template <int Dim>
Vector<Dim> Direction(const char* function, const char* name, const Vector<Dim>& v) {
  RequireThat(
      v.allFinite() && v.norm() > 0, function, std::string(name) + " is not a finite direction");
  return v.normalized();
}

// Where the tangents cross, seen from the start; at infinity, (T, 0), where they are parallel.
template <int Dim>
Lifted<Dim> Crossing(const char* function,
                     const Vector<Dim>& chord,
                     const Vector<Dim>& start_tangent,
                     const Vector<Dim>& end_tangent) {
  constexpr double kParallel = 1e-12;
  RequireSized(function, chord);
  RequireThat(chord.allFinite() && chord.norm() > 0,
              function,
              "start and end are one point: give two that differ");
  const Vector<Dim> T0 = Direction<Dim>(function, "start_tangent", start_tangent);
  const Vector<Dim> T2 = Direction<Dim>(function, "end_tangent", end_tangent);
  for (const auto& [T, name] : {std::pair{T0, "start_tangent"}, {T2, "end_tangent"}}) {
    const double off = (chord - chord.dot(T) * T).norm();
    RequireThat(off > kParallel * chord.norm(),
                function,
                std::string(name) + " runs along the chord: the arc would be a line");
  }
  if ((T2 - T2.dot(T0) * T0).norm() <= kParallel) return Lift<Dim>(T0, 0);
  Eigen::Matrix<double, Dim, 2> lines;
  lines << T0, -T2;
  const Eigen::Vector2d at = LeastSquares(lines, chord);
  const double gap = (lines * at - chord).norm();
  RequireThat(
      gap <= kMiss * chord.norm(),
      function,
      "the tangents miss each other by " + NumberText(gap) + ", more than 1e-6 of the chord");
  return Lift<Dim>(at[0] * T0, 1);
}

// (x, y, 1) as a sum of the columns, and how far the sum misses it in the columns' plane.
template <int Dim>
Eigen::Vector3d Coordinates(const Eigen::Matrix<double, Dim + 1, 3>& columns,
                            const Lifted<Dim>& point,
                            double scale,
                            double* gap = nullptr) {
  Eigen::Matrix<double, Dim + 1, 3> scaled = columns;
  Lifted<Dim> target = point;
  scaled.row(Dim) *= scale;
  target[Dim] *= scale;
  const Eigen::Vector3d norms = scaled.colwise().norm().transpose();
  for (int i = 0; i < 3; ++i) scaled.col(i) /= norms[i];
  const Eigen::Vector3d b = LeastSquares(scaled, target);
  if (gap) *gap = (scaled * b - target).norm();
  return b.cwiseQuotient(norms);
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a[0] * b[1] - a[1] * b[0];
}

// Moved along the gradient until F vanishes to rounding; how far is measured against `tolerance`.
Eigen::Vector2d OnConic(const ImplicitConic& conic,
                        const Eigen::Vector2d& given,
                        const char* name,
                        double tolerance) {
  constexpr int kSteps = 8;
  Eigen::Vector2d p = given;
  for (int k = 0; k < kSteps; ++k) {
    const Eigen::Vector2d gradient = conic.GradientAt(p);
    if (!(gradient.norm() > 0)) break;
    const Eigen::Vector2d step = conic.At(p) / gradient.squaredNorm() * gradient;
    if (!step.allFinite()) break;
    p -= step;
    if (k == 0 && step.norm() > 2 * tolerance) break;
  }
  const double gap = (p - given).norm();
  RequireThat(gap <= tolerance,
              "ArcOf",
              std::string(name) + " is " + NumberText(gap) + " off the conic, more than " +
                  NumberText(tolerance));
  return p;
}

void RequireProper(const ImplicitConic& conic) {
  const ConicLocus locus = ClassifyConic(conic);
  RequireThat(locus.index() < 4,
              "ArcOf",
              "the conic is degenerate (" + NameOf(locus) +
                  "): no arc of an ellipse, parabola or "
                  "hyperbola lies on it");
}

// Everything seen from `start`, which is the origin.
Eigen::Vector3d MiddleColumn(const ImplicitConic& local,
                             const Eigen::Vector2d& end,
                             const std::optional<Eigen::Vector2d>& via) {
  const Eigen::Matrix3d Q = local.Matrix();
  const Eigen::Vector3d p0(0, 0, 1), p2(end[0], end[1], 1);
  Eigen::Vector3d pole = (Q * p0).cross(Q * p2);
  pole /= pole.head<2>().norm();
  const double square = -p0.dot(Q * p2) / (2 * pole.dot(Q * pole));
  RequireThat(square > 0 && std::isfinite(square),
              "ArcOf",
              "start and end lie on different branches of the hyperbola");
  Eigen::Vector3d middle = std::sqrt(square) * pole;
  if (via) {
    Eigen::Matrix3d columns;
    columns << p0, middle, p2;
    const Eigen::Vector3d b = Coordinates<2>(columns, Lift<2>(*via, 1), end.norm());
    RequireThat(b[0] > 0 && b[2] > 0, "ArcOf", "the arc through via runs through infinity");
    if (b[1] < 0) middle = -middle;
  } else if (constexpr double kHalf = 1e-12; std::abs(middle[2]) <= kHalf) {
    if (Cross(end, middle.head<2>()) > 0) middle = -middle;
  } else if (middle[2] < 0) {
    middle = -middle;
  }
  RequireThat(middle[2] > -1, "ArcOf", "the arc between the points runs through infinity");
  return middle;
}

// The plane of points: its frame, and how far they are off it.
template <int Dim>
Eigen::Matrix<double, Dim, 2> PlaneOf(const Eigen::Matrix<double, Dim, 5>& centred, double* off) {
  const SingularValues spread = SingularValuesOf(centred.transpose());
  *off = Dim > 2 ? spread.values[Dim - 1] : 0;
  return spread.v.leftCols(2);
}

void RequireNoThreeOnALine(const Eigen::Matrix2Xd& points, double size) {
  constexpr double kLine = 1e-9;
  for (int i = 0; i < 5; ++i) {
    for (int j = i + 1; j < 5; ++j) {
      const double apart = (points.col(i) - points.col(j)).norm();
      const std::string pair = std::to_string(i + 1) + " and " + std::to_string(j + 1);
      RequireThat(apart > kLine * size,
                  "ConicArcThroughFive",
                  "points " + pair + " coincide: a conic needs five different points");
      for (int k = j + 1; k < 5; ++k) {
        const double height =
            std::abs(Cross(points.col(j) - points.col(i), points.col(k) - points.col(i))) / apart;
        RequireThat(height > kLine * size,
                    "ConicArcThroughFive",
                    "points " + std::to_string(i + 1) + ", " + std::to_string(j + 1) + " and " +
                        std::to_string(k + 1) + " lie on one line, " + NumberText(height) +
                        " off it: the conic through the five is two lines");
      }
    }
  }
}

ConicArc<2> PlaneArcThroughFive(const Eigen::Matrix<double, 2, 5>& points) {
  const PlaneConic fitted = FitConic(points);
  const Eigen::Matrix2d M = fitted.axes * fitted.Quadratic() * fitted.axes.transpose();
  const Eigen::Vector2d linear = fitted.axes * fitted.Linear();
  const ImplicitConic conic{M(0, 0), 2 * M(0, 1), M(1, 1), linear[0], linear[1], fitted.Constant()};
  const Eigen::Vector2d start = points.col(0) - fitted.origin, end = points.col(4) - fitted.origin;
  const Eigen::Vector3d middle =
      MiddleColumn(conic.From(start), end - start, Eigen::Vector2d(points.col(2) - points.col(0)));
  const ConicArc<2> arc = ArcFrom<2>(points.col(0), {0, 0}, middle, end - start);
  for (int k = 1; k < 4; ++k) {
    Eigen::Matrix3d columns;
    columns << Eigen::Vector3d(0, 0, 1), middle, Lift<2>(end - start, 1);
    const Eigen::Vector2d p = points.col(k) - points.col(0);
    const Eigen::Vector3d b = Coordinates<2>(columns, Lift<2>(p, 1), (end - start).norm());
    RequireThat(b.minCoeff() > 0,
                "ConicArcThroughFive",
                "point " + std::to_string(k + 1) +
                    " is not between the first and the last on the conic: order the points along "
                    "it, and take none from the other branch of a hyperbola");
  }
  return arc;
}

}  // namespace

template <int Dim>
ConicArc<Dim> ConicArcThrough(const Vector<Dim>& start,
                              const Vector<Dim>& start_tangent,
                              const Vector<Dim>& end,
                              const Vector<Dim>& end_tangent,
                              const Vector<Dim>& point) {
  constexpr const char* kName = "ConicArcThrough";
  const Vector<Dim> chord = end - start, p = point - start;
  RequireThat(p.allFinite(), kName, "point is not finite");
  RequireSized(kName, p);
  const Lifted<Dim> crossing = Crossing<Dim>(kName, chord, start_tangent, end_tangent);
  Eigen::Matrix<double, Dim + 1, 3> columns;
  columns << Lift<Dim>(Vector<Dim>::Zero(), 1), crossing, Lift<Dim>(chord, 1);
  double gap = 0;
  const Eigen::Vector3d b = Coordinates<Dim>(columns, Lift<Dim>(p, 1), chord.norm(), &gap);
  RequireThat(gap <= kMiss * chord.norm(),
              kName,
              "point is " + NumberText(gap) +
                  " off the plane of the tangents, more than 1e-6 of "
                  "the chord");
  RequireThat(b[0] > 0 && b[2] > 0 && b[1] != 0,
              kName,
              "no arc with these ends and tangents passes through point without running through "
              "infinity; it must lie between the tangents, off the chord");
  const double w = b[1] / (2 * std::sqrt(b[0]) * std::sqrt(b[2]));
  RequireThat(w * crossing[Dim] > -1, kName, "the arc through point runs through infinity");
  return ArcFrom<Dim>(start, Vector<Dim>::Zero(), w * crossing, chord);
}

template <int Dim>
ConicArc<Dim> ConicArcOfRho(const Vector<Dim>& start,
                            const Vector<Dim>& start_tangent,
                            const Vector<Dim>& end,
                            const Vector<Dim>& end_tangent,
                            double rho) {
  constexpr const char* kName = "ConicArcOfRho";
  RequireThat(rho > 0 && rho < 1, kName, "rho = " + NumberText(rho) + " is not in (0, 1)");
  const Vector<Dim> chord = end - start;
  const Lifted<Dim> crossing = Crossing<Dim>(kName, chord, start_tangent, end_tangent);
  RequireThat(crossing[Dim] != 0,
              kName,
              "the tangents are parallel, and rho then says nothing; give a point of the arc");
  return ArcFrom<Dim>(start, Vector<Dim>::Zero(), rho / (1 - rho) * crossing, chord);
}

template <int Dim>
ConicArc<Dim> ConicArcOfShoulder(const Vector<Dim>& start,
                                 const Vector<Dim>& shoulder,
                                 const Vector<Dim>& end,
                                 double rho) {
  constexpr const char* kName = "ConicArcOfShoulder";
  RequireThat(rho >= 0 && rho < 1, kName, "rho = " + NumberText(rho) + " is not in [0, 1)");
  const Vector<Dim> chord = end - start, rise = shoulder - start - chord / 2;
  RequireThat(chord.allFinite() && rise.allFinite(), kName, "a point is not finite");
  RequireSized(kName, chord);
  RequireSized(kName, rise);
  RequireThat(chord.norm() > 0, kName, "start and end are one point: give two that differ");
  const double off = (rise - rise.dot(chord) / chord.squaredNorm() * chord).norm();
  constexpr double kFlat = 1e-12;
  RequireThat(off > kFlat * chord.norm(), kName, "the shoulder lies on the chord's line");
  // P1 = middle + rise / rho has the weight rho / (1 − rho).
  const Lifted<Dim> middle = Lift<Dim>((rho * chord / 2 + rise) / (1 - rho), rho / (1 - rho));
  return ArcFrom<Dim>(start, Vector<Dim>::Zero(), middle, chord);
}

template <int Dim>
ConicArc<Dim> ConicArcThroughFive(const Eigen::Matrix<double, Dim, 5>& points) {
  constexpr const char* kName = "ConicArcThroughFive";
  RequireThat(points.allFinite(), kName, "a point is not finite");
  RequireSized(kName, points);
  const Vector<Dim> middle = points.rowwise().mean();
  const Eigen::Matrix<double, Dim, 5> centred = points.colwise() - middle;
  const double size = centred.colwise().norm().maxCoeff();
  RequireThat(size > 0, kName, "the points coincide");
  double off = 0;
  const Eigen::Matrix<double, Dim, 2> plane = PlaneOf<Dim>(centred, &off);
  RequireThat(off <= kMiss * size,
              kName,
              "the points are " + NumberText(off) +
                  " off their plane, more than 1e-6 of their "
                  "extent");
  const Eigen::Matrix<double, 2, 5> flat = plane.transpose() * centred;
  RequireNoThreeOnALine(flat, size);
  const ConicArc<2> arc = PlaneArcThroughFive(flat);
  ConicArc<Dim> result;
  result.columns.row(Dim) = arc.columns.row(2);
  result.columns.template topRows<Dim>() =
      plane * arc.columns.topRows<2>() + middle * arc.columns.row(2);
  return result;
}

ConicArc<2> ArcOf(const ImplicitConic& conic,
                  const Eigen::Vector2d& start,
                  const Eigen::Vector2d& end,
                  const std::optional<Eigen::Vector2d>& via,
                  std::optional<double> tolerance) {
  RequireThat(start.allFinite() && end.allFinite(), "ArcOf", "an end is not finite");
  const double chord = (end - start).norm(), allowed = tolerance.value_or(kMiss * chord);
  RequireThat(
      allowed > 0,
      "ArcOf",
      "start and end are one point, or the tolerance is not positive: give two that differ");
  RequireProper(conic.From(start));
  const Eigen::Vector2d first = OnConic(conic, start, "start", allowed);
  const Eigen::Vector2d last = OnConic(conic, end, "end", allowed);
  std::optional<Eigen::Vector2d> through;
  if (via) through = OnConic(conic, *via, "via", allowed) - first;
  ImplicitConic local = conic.From(first);
  local.f = 0;
  return ArcFrom<2>(first, {0, 0}, MiddleColumn(local, last - first, through), last - first);
}

template ConicArc<2> ConicArcThrough<2>(const Eigen::Vector2d&,
                                        const Eigen::Vector2d&,
                                        const Eigen::Vector2d&,
                                        const Eigen::Vector2d&,
                                        const Eigen::Vector2d&);
template ConicArc<3> ConicArcThrough<3>(const Eigen::Vector3d&,
                                        const Eigen::Vector3d&,
                                        const Eigen::Vector3d&,
                                        const Eigen::Vector3d&,
                                        const Eigen::Vector3d&);
template ConicArc<2> ConicArcOfRho<2>(const Eigen::Vector2d&,
                                      const Eigen::Vector2d&,
                                      const Eigen::Vector2d&,
                                      const Eigen::Vector2d&,
                                      double);
template ConicArc<3> ConicArcOfRho<3>(const Eigen::Vector3d&,
                                      const Eigen::Vector3d&,
                                      const Eigen::Vector3d&,
                                      const Eigen::Vector3d&,
                                      double);
template ConicArc<2> ConicArcOfShoulder<2>(const Eigen::Vector2d&,
                                           const Eigen::Vector2d&,
                                           const Eigen::Vector2d&,
                                           double);
template ConicArc<3> ConicArcOfShoulder<3>(const Eigen::Vector3d&,
                                           const Eigen::Vector3d&,
                                           const Eigen::Vector3d&,
                                           double);
template ConicArc<2> ConicArcThroughFive<2>(const Eigen::Matrix<double, 2, 5>&);
template ConicArc<3> ConicArcThroughFive<3>(const Eigen::Matrix<double, 3, 5>&);

}  // namespace batten
