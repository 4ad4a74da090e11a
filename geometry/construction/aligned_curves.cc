// SPDX-License-Identifier: MIT
#include "batten/geometry/aligned_curves.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/closure.h"
#include "batten/geometry/reverse.h"
#include "geometry/construction/curve_closure.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kPlaces = 64;        // compared on each curve, evenly over its domain
constexpr double kWorthIt = 0.98;  // of the sum of squares: below that a change is made

// Points at even shares of the domain from `start` on, about their middle; a closed curve goes on
// through its seam.
Eigen::Matrix3Xd PlacesOn(const NurbsCurve<3>& curve, bool closed, double start) {
  const double lower = curve.basis().lower(), length = curve.basis().upper() - lower;
  Eigen::Matrix3Xd points(3, kPlaces);
  for (int k = 0; k < kPlaces; ++k) {
    const double share = closed ? std::fmod(start + k / double{kPlaces}, 1.0) : k / (kPlaces - 1.0);
    points.col(k) = curve.At(lower + share * length);
  }
  return points.colwise() - points.rowwise().mean();
}

struct Candidate {
  double start = 0, misfit = kInfinity;
};

double Misfit(const NurbsCurve<3>& curve, double start, const Eigen::Matrix3Xd& beside) {
  return (PlacesOn(curve, true, start) - beside).squaredNorm();
}

// The best start of a closed curve: of all shifts by whole places, then by golden sections.
Candidate BestStart(const NurbsCurve<3>& curve, const Eigen::Matrix3Xd& beside) {
  const Eigen::Matrix3Xd points = PlacesOn(curve, true, 0);
  Candidate best;
  for (int shift = 0; shift < kPlaces; ++shift) {
    double misfit = 0;
    for (int k = 0; k < kPlaces; ++k) {
      misfit += (points.col((k + shift) % kPlaces) - beside.col(k)).squaredNorm();
    }
    if (misfit < best.misfit) best = {shift / double{kPlaces}, misfit};
  }
  constexpr double kGolden = 0.6180339887498949;
  double low = best.start - 1.0 / kPlaces, high = best.start + 1.0 / kPlaces;
  for (int k = 0; k < 40; ++k) {
    const double a = high - kGolden * (high - low), b = low + kGolden * (high - low);
    const bool left = Misfit(curve, 1 + a, beside) < Misfit(curve, 1 + b, beside);
    (left ? high : low) = left ? b : a;
  }
  const double middle = std::fmod(1 + (low + high) / 2, 1.0);
  const double misfit = Misfit(curve, middle, beside);
  return misfit < best.misfit ? Candidate{middle, misfit} : best;
}

Candidate BestOf(const NurbsCurve<3>& curve, bool closed, const Eigen::Matrix3Xd& beside) {
  if (closed) return BestStart(curve, beside);
  return {0, (PlacesOn(curve, false, 0) - beside).squaredNorm()};
}

}  // namespace

AlignedCurves Aligned(std::vector<NurbsCurve<3>> curves) {
  RequireThat(!curves.empty(), "Aligned", "there are no curves");
  RequireSameClosedness(curves, "Aligned", "curve");
  const bool closed = std::ranges::any_of(
      curves, [](const NurbsCurve<3>& curve) { return !IsPoint(curve) && Closed(curve); });
  AlignedCurves aligned{{curves.front()}, {{}}};
  for (std::size_t k = 1; k < curves.size(); ++k) {
    const Eigen::Matrix3Xd beside = PlacesOn(aligned.curves.back(), closed, 0);
    const NurbsCurve<3> reversed = Reversed(curves[k]);
    const double as_is = (PlacesOn(curves[k], closed, 0) - beside).squaredNorm();
    const Candidate kept = BestOf(curves[k], closed, beside);
    const Candidate turned = BestOf(reversed, closed, beside);
    const bool turn = turned.misfit < kWorthIt * kept.misfit;
    const Candidate& best = turn ? turned : kept;
    CurveAlignment change;
    if (best.misfit < kWorthIt * as_is) change = {turn, best.start};
    NurbsCurve<3> curve = change.reversed ? reversed : std::move(curves[k]);
    if (change.start > 0) {
      const double lower = curve.basis().lower(), length = curve.basis().upper() - lower;
      curve = BegunAt(curve, lower + change.start * length);
    }
    aligned.curves.push_back(std::move(curve));
    aligned.changes.push_back(change);
  }
  return aligned;
}

}  // namespace batten
