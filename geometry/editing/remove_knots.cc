// SPDX-License-Identifier: MIT
#include "batten/geometry/remove_knots.h"

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "geometry/editing/deviation_bound.h"
#include "geometry/editing/knot_refinement.h"
#include "geometry/editing/knot_removal.h"
#include "batten/geometry/knot_vectors.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

// A curve is dealt with as a shape of the one direction u.
template <int Dim>
ControlRows RowsAlong(const NurbsCurve<Dim>& curve, Direction) {
  return RowsOf(curve);
}
ControlRows RowsAlong(const NurbsSurface& surface, Direction direction) {
  return RowsOf(surface, direction);
}
template <int Dim>
NurbsCurve<Dim> ShapeOf(const ControlRows& rows, const NurbsCurve<Dim>&, Direction) {
  return CurveOf<Dim>(rows);
}
NurbsSurface ShapeOf(const ControlRows& rows, const NurbsSurface& like, Direction direction) {
  return SurfaceOf(rows, direction, OtherBasis(like, direction)).WithTrims(like.trims());
}

// Bézier pieces over the knots of `original`, of which `shape` has some.
template <int Dim>
ControlRows PiecesOver(const NurbsCurve<Dim>& original, const NurbsCurve<Dim>& shape) {
  return BezierRows(RowsOf(shape), original.basis().knots());
}
ControlRows PiecesOver(const NurbsSurface& original, const NurbsSurface& shape) {
  const SplineBasis &u = original.basis_u(), &v = original.basis_v();
  const std::vector<double> missing = MissingKnots(shape.basis_v(), v);
  const ControlRows rows = Cut(RowsOf(shape, Direction::kV), v.lower(), v.upper(), missing);
  const NurbsSurface same_v = SurfaceOf(rows, Direction::kV, shape.basis_u());
  return BezierRows(RowsOf(same_v, Direction::kU), u.knots());
}

template <int Dim>
int DegreeAcross(const NurbsCurve<Dim>&) {
  return 0;
}
int DegreeAcross(const NurbsSurface& surface) { return surface.basis_v().degree(); }

// Measures how far shapes with fewer knots are from the one it was made with.
template <typename Shape>
class DeviationFrom {
 public:
  explicit DeviationFrom(const Shape& original)
      : original_(original), pieces_(PiecesOver(original, original)) {}

  // A bound that may be a few times the truth where that is below the tolerance, and near the truth
  // where it is not; above the tolerance if the truth is.
  double Within(double tolerance, const Shape& shape) const {
    const double quick =
        BezierDeviation(pieces_, PiecesOver(original_, shape), DegreeAcross(original_));
    if (quick <= tolerance) return quick;
    return std::min(quick, DeviationBound(original_, shape, tolerance));
  }

  // The bound of what is left of the knots, as near as it can be had.
  double Finally(const KnotRemoval<Shape>& removal) const {
    if (removal.removed == 0) return 0;
    return std::min(removal.error, DeviationBound(original_, removal.shape));
  }

 private:
  const Shape& original_;
  ControlRows pieces_;
};

void CheckTolerance(const std::string& function, double tolerance) {
  if (tolerance >= 0) return;
  Reject(function, "tolerance = " + NumberText(tolerance) + " is not a number of at least 0");
}

// How often a knot can be removed: an end of the domain must stay one.
int Removable(const SplineBasis& basis, double u) {
  if (basis.periodic() && (u == basis.lower() || u == basis.upper())) {
    return basis.Multiplicity(basis.lower()) - 1;
  }
  const auto inside = basis.knots().begin() + basis.degree() + 1;
  return static_cast<int>(std::count(inside, basis.knots().begin() + basis.size(), u));
}

void CheckKnot(const std::string& name, const SplineBasis& basis, double u, int times) {
  const std::string what = name + " = " + NumberText(u);
  const int removable = Removable(basis, u);
  if (removable == 0) {
    const bool end = u == basis.lower() || u == basis.upper();
    Reject("RemoveKnot",
           what + (end ? " is an end of the domain " : " is not a knot of the domain ") +
               IntervalText(basis.lower(), basis.upper()) + (end ? ", which must stay" : ""));
  }
  if (times < 1 || times > removable) {
    Reject("RemoveKnot",
           "times = " + std::to_string(times) + " is not in [1, " + std::to_string(removable) +
               "]: so often can the knot " + NumberText(u) + " be removed");
  }
}

template <typename Shape>
KnotRemoval<Shape> Removed(
    const Shape& shape, Direction direction, double u, int times, double tolerance) {
  CheckTolerance("RemoveKnot", tolerance);
  const SplineBasis basis = RowsAlong(shape, direction).basis;
  CheckKnot(std::is_same_v<Shape, NurbsSurface> ? "at" : "u", basis, u, times);
  if (basis.periodic() && u == basis.upper()) u = basis.lower();
  const DeviationFrom<Shape> deviation(shape);
  KnotRemoval<Shape> best{shape, 0, 0};
  while (best.removed < times) {
    const auto less = WithoutKnot(RowsAlong(best.shape, direction), u);
    if (!less) break;
    Shape next = ShapeOf(less->rows, best.shape, direction);
    const double error = deviation.Within(tolerance, next);
    if (!(error <= tolerance)) break;
    best = {std::move(next), best.removed + 1, error};
  }
  best.error = deviation.Finally(best);
  return best;
}

// A knot that may go, and how far that would move the shape when it was last looked at.
struct Candidate {
  Direction direction;
  double knot;
  double move;
};

void AppendCandidates(const SplineBasis& basis, Direction direction, std::vector<Candidate>& all) {
  for (const auto& [knot, multiplicity] : DomainKnots(basis)) {
    if (basis.periodic() && knot == basis.upper()) continue;  // the seam once
    if (Removable(basis, knot) > 0) all.push_back({direction, knot, 0});
  }
}
template <int Dim>
std::vector<Candidate> CandidatesOf(const NurbsCurve<Dim>& curve) {
  std::vector<Candidate> all;
  AppendCandidates(curve.basis(), Direction::kU, all);
  return all;
}
std::vector<Candidate> CandidatesOf(const NurbsSurface& surface) {
  std::vector<Candidate> all;
  AppendCandidates(surface.basis_u(), Direction::kU, all);
  AppendCandidates(surface.basis_v(), Direction::kV, all);
  return all;
}

// Takes the candidate that was least when last looked at and looks again: if it is no longer least
// it waits, otherwise it goes, or is given up because the whole deviation would be too large.
template <typename Shape>
KnotRemoval<Shape> AllRemoved(const Shape& shape, double tolerance) {
  CheckTolerance("RemoveKnots", tolerance);
  const DeviationFrom<Shape> deviation(shape);
  std::vector<Candidate> waiting = CandidatesOf(shape);
  const auto later = [](const Candidate& a, const Candidate& b) { return a.move > b.move; };
  KnotRemoval<Shape> best{shape, 0, 0};
  while (!waiting.empty()) {
    std::pop_heap(waiting.begin(), waiting.end(), later);
    Candidate candidate = waiting.back();
    waiting.pop_back();
    const auto less = WithoutKnot(RowsAlong(best.shape, candidate.direction), candidate.knot);
    if (!less) continue;
    candidate.move = less->move;
    if (!waiting.empty() && less->move > waiting.front().move) {
      waiting.push_back(candidate);
      std::push_heap(waiting.begin(), waiting.end(), later);
      continue;
    }
    Shape next = ShapeOf(less->rows, best.shape, candidate.direction);
    // The sum of the moves is a bound too, and costs nothing; but over periodic knots, which repeat
    // only to rounding, it does not see what that does.
    const bool exact = !less->rows.basis.periodic();
    double error = exact ? best.error + less->move : std::numeric_limits<double>::infinity();
    if (!(error <= tolerance)) error = deviation.Within(tolerance, next);
    if (!(error <= tolerance)) continue;
    best = {std::move(next), best.removed + 1, error};
    if (Removable(RowsAlong(best.shape, candidate.direction).basis, candidate.knot) == 0) continue;
    waiting.push_back(candidate);
    std::push_heap(waiting.begin(), waiting.end(), later);
  }
  best.error = deviation.Finally(best);
  return best;
}

}  // namespace

template <int Dim>
KnotRemoval<NurbsCurve<Dim>> RemoveKnot(const NurbsCurve<Dim>& curve,
                                        double u,
                                        int times,
                                        double tolerance) {
  return Removed(curve, Direction::kU, u, times, tolerance);
}

KnotRemoval<NurbsSurface> RemoveKnot(
    const NurbsSurface& surface, Direction direction, double at, int times, double tolerance) {
  return Removed(surface, direction, at, times, tolerance);
}

template <int Dim>
KnotRemoval<NurbsCurve<Dim>> RemoveKnots(const NurbsCurve<Dim>& curve, double tolerance) {
  return AllRemoved(curve, tolerance);
}

KnotRemoval<NurbsSurface> RemoveKnots(const NurbsSurface& surface, double tolerance) {
  return AllRemoved(surface, tolerance);
}

template KnotRemoval<NurbsCurve<2>> RemoveKnot(const NurbsCurve<2>&, double, int, double);
template KnotRemoval<NurbsCurve<3>> RemoveKnot(const NurbsCurve<3>&, double, int, double);
template KnotRemoval<NurbsCurve<2>> RemoveKnots(const NurbsCurve<2>&, double);
template KnotRemoval<NurbsCurve<3>> RemoveKnots(const NurbsCurve<3>&, double);

}  // namespace batten
