// SPDX-License-Identifier: MIT
#include "batten/geometry/plane_section.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "batten/geometry/closure.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/join.h"
#include "batten/geometry/reverse.h"
#include "geometry/bezier/bernstein.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/measure/narrow_spans.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/nurbs/placed_curve.h"
#include "geometry/section/section_fit.h"
#include "geometry/section/section_trace.h"

namespace batten {
using namespace internal;
namespace {

// |normal| = 1.
Plane Checked(const char* function, const Plane& plane) {
  const double length = plane.normal.stableNorm();
  RequireThat(std::isfinite(length) && length > 0, function, "plane.normal is zero or not finite");
  RequireThat(std::isfinite(plane.offset / length),
              function,
              "plane.offset = " + NumberText(plane.offset) + " is not finite");
  return {plane.normal / length, plane.offset / length};
}

// The straight line in the domain along an edge, with the iso-curve there, above on its left where
// the inside is above and on its right where that is below.
SectionCurve EdgeCurve(const NurbsSurface& surface, const Plane& unit, int edge) {
  const bool fixed_u = edge < 2, upper = edge % 2 == 1;
  const SplineBasis& fixed = fixed_u ? surface.basis_u() : surface.basis_v();
  const SplineBasis& along = fixed_u ? surface.basis_v() : surface.basis_u();
  const double at = upper ? fixed.upper() : fixed.lower();
  const double ends[] = {along.lower(), along.upper()};
  Eigen::Matrix2d places;
  places.row(fixed_u ? 0 : 1).setConstant(at);
  places.row(fixed_u ? 1 : 0) << ends[0], ends[1];
  SectionCurve curve{NurbsCurve<2>(SplineBasis::Clamped(1, ends), places),
                     IsoCurve(surface, fixed_u ? Direction::kU : Direction::kV, at),
                     false};
  constexpr double kInside = 1e-3;
  const double in = at + (upper ? -kInside : kInside) * (fixed.upper() - fixed.lower());
  const double middle = (ends[0] + ends[1]) / 2;
  const Eigen::Vector3d inside = fixed_u ? surface.At(in, middle) : surface.At(middle, in);
  const bool above = unit.normal.dot(inside) > unit.offset;
  if (above != (fixed_u == upper)) {
    curve = {Reversed(curve.parameters), Reversed(curve.points), false};
  }
  return curve;
}

// The edges in the plane that are no points; of a seam, which is two of them, one.
std::vector<SectionCurve> EdgeCurves(const NurbsSurface& surface,
                                     const Plane& unit,
                                     const std::array<bool, 4>& in_plane) {
  const CollapsedEdgeSet collapsed = CollapsedEdges(surface);
  const bool points[] = {
      collapsed.u_lower, collapsed.u_upper, collapsed.v_lower, collapsed.v_upper};
  std::vector<SectionCurve> curves;
  for (int edge = 0; edge < 4; ++edge) {
    const Direction direction = edge < 2 ? Direction::kU : Direction::kV;
    const bool again = edge % 2 == 1 && in_plane[edge - 1] && Closed(surface, direction);
    if (in_plane[edge] && !points[edge] && !again) {
      curves.push_back(EdgeCurve(surface, unit, edge));
    }
  }
  return curves;
}

}  // namespace

double HeightAbove(const Plane& plane, const Eigen::Vector3d& x) {
  const Plane unit = Checked("HeightAbove", plane);
  return unit.normal.dot(x) - unit.offset;
}

// About the middle of the control points, so that small shapes far away keep their digits.
PlaneSection Section(const NurbsSurface& surface,
                     const Plane& plane,
                     const SectionOptions& options) {
  const Plane unit = Checked("Section", plane);
  if (options.tolerance) RequirePositive("Section", "tolerance", *options.tolerance);
  const auto& points = surface.control_points();
  const Eigen::Vector3d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
  const Eigen::Vector3d middle = low + (high - low) / 2;
  const NurbsSurface near = surface.Translated(-middle);
  const double offset = unit.offset - unit.normal.dot(middle);
  constexpr double kOfTheSize = 1e-9, kLeastOfTheSize = 1e-13, kUnits = 8;
  const double size = (high - low).norm();
  const double tolerance =
      std::max({options.tolerance.value_or(kOfTheSize * size),
                kLeastOfTheSize * size,
                kUnits * std::numeric_limits<double>::epsilon() * points.cwiseAbs().maxCoeff()});
  PlaneSection section;
  // A single point has no section.
  if (!(size > 0)) return section;
  RefuseNarrowSpans("Section", near, tolerance);
  const SectionTrace trace = TraceSection(near, unit.normal, offset, tolerance);
  FittedChains fitted = SectionFitter(near, unit.normal, offset, tolerance).Fit(trace);
  for (FittedChain& chain : fitted.curves) {
    section.curves.push_back(
        {std::move(chain.parameters), Translated(chain.points, middle), chain.closed});
  }
  section.touches = std::move(fitted.touches);
  section.contains_patch = trace.contains_patch;
  section.edges = EdgeCurves(surface, unit, trace.edges);
  return section;
}

std::vector<NurbsCurve<3>> JoinedInSpace(std::vector<NurbsCurve<3>> curves, double tolerance) {
  RequirePositive("JoinedInSpace", "tolerance", tolerance);
  const auto gap = [](const NurbsCurve<3>& a, const NurbsCurve<3>& b) {
    return (a.At(a.basis().upper()) - b.At(b.basis().lower())).norm();
  };
  std::vector<NurbsCurve<3>> joined;
  while (!curves.empty()) {
    NurbsCurve<3> whole = std::move(curves.back());
    curves.pop_back();
    for (bool grown = true; grown;) {
      grown = false;
      for (std::size_t k = 0; k < curves.size() && gap(whole, whole) > tolerance; ++k) {
        const bool behind = gap(whole, curves[k]) <= tolerance;
        if (!behind && gap(curves[k], whole) > tolerance) continue;
        whole = behind ? Join(whole, curves[k], tolerance) : Join(curves[k], whole, tolerance);
        curves.erase(curves.begin() + static_cast<std::ptrdiff_t>(k));
        grown = true;
        break;
      }
    }
    joined.push_back(std::move(whole));
  }
  std::reverse(joined.begin(), joined.end());
  return joined;
}

namespace {

// A stretch of parameters over which the curve is in the plane, to the tolerance.
struct Stretch {
  double from, to;
};

// Stretches that together hold every place in the plane.
class StretchSearch {
 public:
  explicit StretchSearch(double tolerance) : tolerance_(tolerance) {}

  // The rows of `fw` are the Bernstein coefficients over [a, b] of height times weight, and of the
  // weight.
  void Search(const Eigen::MatrixXd& fw, double a, double b, int depth) {
    const auto f = fw.row(0).array(), w = fw.row(1).array();
    if ((f > tolerance_ * w).all() || (f < -tolerance_ * w).all()) return;
    constexpr int kMostDepth = 48;
    const bool changes = (fw(0, 0) < 0) != (fw(0, fw.cols() - 1) < 0);
    if (depth == kMostDepth || (f.abs() <= tolerance_ * w).all()) {
      found_.push_back({a, b});
    } else if (changes && Monotone(fw.row(0))) {
      const double zero = Zero(fw, a, b);
      found_.push_back({zero, zero});
    } else {
      const auto [low, high] = SplitBernstein(fw, 0.5);
      Search(low, a, (a + b) / 2, depth + 1);
      Search(high, (a + b) / 2, b, depth + 1);
    }
  }

  const std::vector<Stretch>& found() const { return found_; }

 private:
  static bool Monotone(const Eigen::RowVectorXd& f) {
    const Eigen::Index n = f.size() - 1;
    const Eigen::ArrayXd steps = (f.tail(n) - f.head(n)).transpose().array();
    return (steps >= 0).all() || (steps <= 0).all();
  }

  static double Zero(const Eigen::MatrixXd& fw, double a, double b) {
    const bool rises = fw(0, 0) < 0;
    double low = 0, high = 1;
    constexpr int kHalvings = 60;
    for (int k = 0; k < kHalvings; ++k) {
      const double t = (low + high) / 2;
      ((DeCasteljau(fw.topRows(1), t)[0] < 0) == rises ? low : high) = t;
    }
    return a + (low + high) / 2 * (b - a);
  }

  double tolerance_;
  std::vector<Stretch> found_;
};

}  // namespace

std::vector<PlaneCrossing> Crossings(const NurbsCurve<3>& curve,
                                     const Plane& plane,
                                     double tolerance) {
  const Plane unit = Checked("Crossings", plane);
  RequirePositive("Crossings", "tolerance", tolerance);
  StretchSearch search(tolerance);
  for (const CurvePiece& piece : PiecesOf(curve)) {
    Eigen::MatrixXd fw(2, piece.points.cols());
    const double height = unit.normal.dot(piece.origin) - unit.offset;
    fw.row(1) = piece.points.row(3);
    fw.row(0) = unit.normal.transpose() * piece.points.topRows<3>() + height * fw.row(1);
    search.Search(fw, piece.u0, piece.u1, 0);
  }
  const auto height = [&](double u) { return unit.normal.dot(curve.At(u)) - unit.offset; };
  // Neighbours with nothing but the plane between them are one.
  std::vector<Stretch> stretches;
  for (const Stretch& one : search.found()) {
    const bool same =
        !stretches.empty() && std::abs(height((stretches.back().to + one.from) / 2)) <= tolerance;
    if (same) {
      stretches.back().to = one.to;
    } else {
      stretches.push_back(one);
    }
  }
  std::vector<PlaneCrossing> crossings;
  const double lower = curve.basis().lower(), upper = curve.basis().upper();
  for (std::size_t k = 0; k < stretches.size(); ++k) {
    const Stretch& one = stretches[k];
    const double before = (k > 0 ? stretches[k - 1].to : lower) / 2 + one.from / 2;
    const double behind =
        (k + 1 < stretches.size() ? stretches[k + 1].from : upper) / 2 + one.to / 2;
    const bool touches =
        one.from == lower || one.to == upper || (height(before) > 0) == (height(behind) > 0);
    const Eigen::Vector3d start = curve.At(one.from);
    const double extent = std::max((curve.At(one.to) - start).norm(),
                                   (curve.At(one.from / 2 + one.to / 2) - start).norm());
    // A touch within the tolerance is so long where curvatures are not below one over the size.
    const double size = BoxDiagonal(curve.control_points());
    const bool point = extent <= 4 * std::sqrt(tolerance * size);
    if (!point) {
      crossings.push_back({one.from, touches});
      crossings.push_back({one.to, touches});
      continue;
    }
    double low = one.from, high = one.to;
    constexpr int kHalvings = 60;
    const bool rises = height(before) < 0;
    for (int i = 0; i < kHalvings && !touches; ++i) {
      const double middle = (low + high) / 2;
      ((height(middle) < 0) == rises ? low : high) = middle;
    }
    crossings.push_back({(low + high) / 2, touches});
  }
  return crossings;
}

}  // namespace batten
