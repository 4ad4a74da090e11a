// SPDX-License-Identifier: MIT
#include "batten/geometry/curve_chain.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <string>
#include <utility>

#include "batten/geometry/clamp.h"
#include "batten/geometry/closure.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/join.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "geometry/numeric/construction_checks.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kCubic = 3;

template <int Dim>
Eigen::Matrix<double, Dim, 1> EndOf(const NurbsCurve<Dim>& curve, bool upper) {
  return curve.At(upper ? curve.basis().upper() : curve.basis().lower());
}

// The remaining curve nearest to an end of the chain.
struct NextCurve {
  size_t index = 0;
  bool at_end = true;     // of the chain, or at its start
  bool reversed = false;  // to run on in the chain's sense
  double gap = HUGE_VAL;
};

template <int Dim>
NextCurve Nearest(const std::vector<NurbsCurve<Dim>>& curves,
                  const std::vector<size_t>& left,
                  const Eigen::Matrix<double, Dim, 1>& start,
                  const Eigen::Matrix<double, Dim, 1>& end,
                  double tolerance) {
  NextCurve best;
  const auto look = [&](bool at_end) {
    for (const size_t k : left) {
      for (const bool upper : {!at_end, at_end}) {
        const double gap = (EndOf(curves[k], upper) - (at_end ? end : start)).norm();
        if (gap < best.gap) best = {k, at_end, upper == at_end, gap};
        if (gap <= tolerance) return true;
      }
    }
    return false;
  };
  if (!look(true)) look(false);
  return best;
}

// A closed chain's ends moved together.
template <int Dim>
NurbsCurve<Dim> ClosedUp(const NurbsCurve<Dim>& curve, double tolerance) {
  const auto& points = curve.control_points();
  const Eigen::Index last = points.cols() - 1;
  const double gap = (points.col(last) - points.col(0)).norm();
  if (gap == 0 || gap > tolerance) return curve;
  typename NurbsCurve<Dim>::Points closed = points;
  closed.col(0) += (points.col(last) - points.col(0)) / 2;
  closed.col(last) = closed.col(0);
  return NurbsCurve<Dim>(
      curve.basis(), std::move(closed), curve.rational() ? curve.weights() : Eigen::VectorXd());
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> Unified(const std::vector<NurbsCurve<Dim>>& curves,
                        double tolerance,
                        const std::vector<std::string>& names) {
  const auto name = [&](size_t k) {
    return k < names.size() ? names[k] : "curve " + std::to_string(k + 1);
  };
  RequireThat(!curves.empty(), "Unified", "there is no curve");
  RequireThat(tolerance >= 0, "Unified", "tolerance is not a number of at least 0");
  int degree = kCubic;
  for (size_t k = 0; k < curves.size(); ++k) {
    degree = std::max(degree, curves[k].basis().degree());
    RequireThat(curves.size() == 1 || !(curves[k].basis().periodic() || Closed(curves[k])),
                "Unified",
                name(k) + " is closed: nothing can go on from it; leave it out, or split it");
  }
  const auto raised = [&](const NurbsCurve<Dim>& curve) {
    return Elevated(Clamped(curve), degree - curve.basis().degree());
  };
  NurbsCurve<Dim> chain = raised(curves[0]);
  std::vector<size_t> left;
  for (size_t k = 1; k < curves.size(); ++k) left.push_back(k);
  while (!left.empty()) {
    const NextCurve next =
        Nearest<Dim>(curves, left, EndOf(chain, false), EndOf(chain, true), tolerance);
    RequireThat(next.gap <= tolerance,
                "Unified",
                "no curve goes on within the tolerance " + RoundedText(tolerance) +
                    ": the nearest, " + name(next.index) + ", is " + RoundedText(next.gap) +
                    " from an end of the chain");
    NurbsCurve<Dim> curve = raised(curves[next.index]);
    if (next.reversed) curve = Reversed(curve);
    chain = next.at_end ? Join(chain, curve, tolerance) : Join(curve, chain, tolerance);
    left.erase(std::find(left.begin(), left.end(), next.index));
  }
  return curves.size() > 1 ? ClosedUp(chain, tolerance) : chain;
}

template <int Dim>
std::vector<CurvePieceShape> PieceShapes(const NurbsCurve<Dim>& curve,
                                         const ClassifyOptions& options) {
  const SplineBasis& basis = curve.basis();
  const bool spans = basis.degree() == 2;
  std::vector<double> cuts{basis.lower()};
  for (const KnotMultiplicity& knot : DomainKnots(basis)) {
    const bool inside = knot.knot > basis.lower() && knot.knot < basis.upper();
    if (inside && (spans || knot.multiplicity >= basis.degree())) cuts.push_back(knot.knot);
  }
  cuts.push_back(basis.upper());
  std::vector<CurvePieceShape> pieces;
  for (size_t k = 0; k + 1 < cuts.size(); ++k) {
    const bool whole = cuts.size() == 2;
    const CurveShape shape =
        ClassifyShape(whole ? curve : Segment(curve, cuts[k], cuts[k + 1]), options);
    CurvePieceShape* last = pieces.empty() || spans ? nullptr : &pieces.back();
    if (last && last->shape.index() == shape.index() && !std::holds_alternative<FreeForm>(shape)) {
      const CurveShape both = ClassifyShape(Segment(curve, last->lower, cuts[k + 1]), options);
      if (both.index() == shape.index()) {
        last->upper = cuts[k + 1];
        last->shape = both;
        continue;
      }
    }
    pieces.push_back({cuts[k], cuts[k + 1], shape});
  }
  return pieces;
}

template NurbsCurve<2> Unified(const std::vector<NurbsCurve<2>>&,
                               double,
                               const std::vector<std::string>&);
template NurbsCurve<3> Unified(const std::vector<NurbsCurve<3>>&,
                               double,
                               const std::vector<std::string>&);
template std::vector<CurvePieceShape> PieceShapes(const NurbsCurve<2>&, const ClassifyOptions&);
template std::vector<CurvePieceShape> PieceShapes(const NurbsCurve<3>&, const ClassifyOptions&);

}  // namespace batten
