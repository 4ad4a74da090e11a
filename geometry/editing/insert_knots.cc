// SPDX-License-Identifier: MIT
#include "batten/geometry/insert_knots.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "geometry/editing/knot_refinement.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

// The knots in increasing order, each checked. Over a periodic basis the upper end is the lower.
std::vector<double> Checked(const std::string& function,
                            const std::string& name,
                            const SplineBasis& basis,
                            std::span<const double> knots) {
  std::vector<double> sorted(knots.begin(), knots.end());
  for (double& u : sorted) {
    if (!(u >= basis.lower() && u <= basis.upper())) {
      Reject(function,
             name + " = " + NumberText(u) + " is outside the domain " +
                 IntervalText(basis.lower(), basis.upper()));
    }
    if (basis.periodic() && u == basis.upper()) u = basis.lower();
  }
  std::sort(sorted.begin(), sorted.end());
  for (auto u = sorted.begin(); u != sorted.end();) {
    const auto next = std::upper_bound(u, sorted.end(), *u);
    const auto present = basis.Multiplicity(*u), more = static_cast<int>(next - u);
    if (present + more > basis.degree()) {
      Reject(function,
             name + " = " + NumberText(*u) + " would be a knot of multiplicity " +
                 std::to_string(present + more) + " (now " + std::to_string(present) +
                 "); at most the degree " + std::to_string(basis.degree()) + " is allowed");
    }
    u = next;
  }
  return sorted;
}

std::vector<double> Repeated(double knot, int times) {
  if (times < 1) Reject("InsertKnot", "times = " + std::to_string(times) + " is not at least 1");
  // More than any degree is refused later; a huge count must not fill the memory first.
  return std::vector<double>(std::min(times, 2 * kMaxDegree), knot);
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> InsertKnot(const NurbsCurve<Dim>& curve, double u, int times) {
  const auto knots = Checked("InsertKnot", "u", curve.basis(), Repeated(u, times));
  return Edited(curve, [&](const ControlRows& rows) { return Refined(rows, knots); });
}

NurbsSurface InsertKnot(const NurbsSurface& surface, Direction direction, double at, int times) {
  const ControlRows rows = RowsOf(surface, direction);
  const auto knots = Checked("InsertKnot", "at", rows.basis, Repeated(at, times));
  return SurfaceOf(Refined(rows, knots), direction, OtherBasis(surface, direction))
      .WithTrims(surface.trims());
}

template <int Dim>
NurbsCurve<Dim> RefineKnots(const NurbsCurve<Dim>& curve, std::span<const double> knots) {
  const auto sorted = Checked("RefineKnots", "u", curve.basis(), knots);
  return Edited(curve, [&](const ControlRows& rows) { return Refined(rows, sorted); });
}

NurbsSurface RefineKnots(const NurbsSurface& surface,
                         Direction direction,
                         std::span<const double> knots) {
  const ControlRows rows = RowsOf(surface, direction);
  const auto sorted = Checked("RefineKnots", "at", rows.basis, knots);
  return SurfaceOf(Refined(rows, sorted), direction, OtherBasis(surface, direction))
      .WithTrims(surface.trims());
}

template NurbsCurve<2> InsertKnot(const NurbsCurve<2>&, double, int);
template NurbsCurve<3> InsertKnot(const NurbsCurve<3>&, double, int);
template NurbsCurve<2> RefineKnots(const NurbsCurve<2>&, std::span<const double>);
template NurbsCurve<3> RefineKnots(const NurbsCurve<3>&, std::span<const double>);

}  // namespace batten
