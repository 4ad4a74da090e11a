// SPDX-License-Identifier: MIT
// Foot points on curves: the one-parameter half of foot_point.h.
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "batten/geometry/bezier_span.h"
#include "batten/geometry/foot_point.h"

namespace batten {
namespace {

constexpr int kMaxCurveSteps = 120;
constexpr int kDeepest = 14;  // halvings of an arc
// Arcs of a curve are halved until they differ from their chords by at most this part of the
// length.
constexpr double kChordBend = 0.1;
constexpr double kSmallArc = 1e-4;  // least length over the diagonal of the curve's box
constexpr double kEpsilon = std::numeric_limits<double>::epsilon();

template <int Dim>
Eigen::Vector3d InSpace(const Eigen::Matrix<double, Dim, 1>& p) {
  if constexpr (Dim == 3) {
    return p;
  } else {
    return {p[0], p[1], 0};
  }
}

// A local minimum of |C(u) − q|²/2 between two parameters: Newton steps between the last parameters
// of descending and of rising distance, halving where they leave the interval or gain too little.
// The nearest point seen is returned. [Press et al. 2007, §9.4]
template <int Dim>
CurveFoot LocalFoot(
    const NurbsCurve<Dim>& curve, const Eigen::Vector3d& q, double u, double lower, double upper) {
  CurveFoot best;
  best.distance = std::numeric_limits<double>::infinity();
  const double least = 4 * kEpsilon * (std::max(std::abs(lower), std::abs(upper)) + upper - lower);
  double falls = lower, rises = upper, last_gradient = std::numeric_limits<double>::infinity();
  bool tried_lower = false, tried_upper = false;
  for (int iteration = 0; iteration < kMaxCurveSteps; ++iteration) {
    const auto derivatives = curve.Derivatives(u, 2);
    const Eigen::Vector3d point = InSpace<Dim>(derivatives.col(0)), difference = point - q;
    const Eigen::Vector3d first = InSpace<Dim>(derivatives.col(1));
    const double distance = difference.norm(), gradient = difference.dot(first);
    if (distance > best.distance) {  // uphill: a minimum lies between the best and here
      (u > best.u ? rises : falls) = u;
      const double middle = best.u + (u - best.u) / 2;
      if (std::abs(middle - best.u) <= least) break;
      u = middle;
      continue;
    }
    best = {u, point, distance};
    if (gradient == 0 || (u <= lower && gradient > 0) || (u >= upper && gradient < 0)) break;
    (gradient < 0 ? falls : rises) = u;
    tried_lower = tried_lower || u <= lower;
    tried_upper = tried_upper || u >= upper;
    const double curvature = first.squaredNorm() + difference.dot(InSpace<Dim>(derivatives.col(2)));
    double next = u - gradient / curvature;
    if (!(curvature > 0) || std::abs(gradient) > std::abs(last_gradient) / 2) {
      next = falls + (rises - falls) / 2;
    } else if (next >= rises) {
      next = rises == upper && !tried_upper ? upper : falls + (rises - falls) / 2;
    } else if (next <= falls) {
      next = falls == lower && !tried_lower ? lower : falls + (rises - falls) / 2;
    }
    if (std::abs(next - u) <= least) break;
    last_gradient = gradient;
    u = next;
  }
  return best;
}

}  // namespace

template <int Dim>
CurveFootPoints<Dim>::CurveFootPoints(NurbsCurve<Dim> curve) : curve_(std::move(curve)) {
  const SplineBasis& basis = curve_.basis();
  const auto& points = curve_.control_points();
  const double small =
      kSmallArc * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
  const auto at = [&](double u) { return InSpace<Dim>(curve_.At(u)); };
  std::vector<Eigen::Vector3d> samples;
  // Appends the arc from a to b, halved until its chord is nearly the curve.
  const auto add = [&](const auto& self, double a, double b, int depth) -> void {
    const Eigen::Vector3d start = at(a), chord = at(b) - start;
    const double squared = chord.squaredNorm();
    double bulge = 0, uneven = 0;
    for (const double t : {0.25, 0.5, 0.75}) {
      const Eigen::Vector3d x = at(a + t * (b - a)) - start;
      const double along = squared > 0 ? std::clamp(x.dot(chord) / squared, 0.0, 1.0) : 0;
      bulge = std::max(bulge, (x - along * chord).norm());
      uneven = std::max(uneven, (x - t * chord).norm());
    }
    if (depth == kDeepest || uneven <= kChordBend * std::max(std::sqrt(squared), small)) {
      parameters_.push_back(a);
      samples.push_back(start);
      // An arc too short to be halved may hide a cusp.
      const double hidden = uneven > kChordBend * std::sqrt(squared) ? 4 * uneven : 0;
      bulges_.push_back(2 * bulge + hidden + 64 * kEpsilon * points.cwiseAbs().maxCoeff());
      return;
    }
    self(self, a, a + (b - a) / 2, depth + 1);
    self(self, a + (b - a) / 2, b, depth + 1);
  };
  const int per_span = 2 * basis.degree();
  for (const int span : basis.Spans()) {
    const double a = basis.knots()[span], b = basis.knots()[span + 1];
    for (int k = 0; k < per_span; ++k) {
      add(add,
          a + (b - a) * k / per_span,
          k + 1 < per_span ? a + (b - a) * (k + 1) / per_span : b,
          0);
    }
  }
  parameters_.push_back(basis.upper());
  samples.push_back(at(basis.upper()));
  samples_.resize(3, static_cast<Eigen::Index>(samples.size()));
  for (size_t k = 0; k < samples.size(); ++k) {
    samples_.col(static_cast<Eigen::Index>(k)) = samples[k];
  }
}

// The arcs next to the lowest sample first, then every arc whose chord, less its bulge, is nearer
// than the best foot point so far.
template <int Dim>
CurveFoot CurveFootPoints<Dim>::Nearest(const Eigen::Vector3d& q) const {
  const Eigen::Index arcs = samples_.cols() - 1;
  const double upper = curve_.basis().upper();
  CurveFoot best;
  best.distance = std::numeric_limits<double>::infinity();
  const auto search = [&](Eigen::Index k) {
    const Eigen::Vector3d start = samples_.col(k), chord = samples_.col(k + 1) - start;
    const double squared = chord.squaredNorm();
    const double t = squared > 0 ? std::clamp((q - start).dot(chord) / squared, 0.0, 1.0) : 0.5;
    const double off = (start + t * chord - q).norm();
    if (off - bulges_[k] >= best.distance) return;
    // Derivatives at a knot are those of the next piece: an arc ends just before it.
    const double a = parameters_[k];
    const double b = k + 1 < arcs ? std::nextafter(parameters_[k + 1], a) : upper;
    const auto descend = [&](double u) {
      const CurveFoot foot = LocalFoot<Dim>(curve_, q, u, a, b);
      if (foot.distance < best.distance) best = foot;
    };
    descend(std::min(b, a + t * (b - a)));
    // Seen from afar, an arc may have a minimum near either end.
    if (off * off > squared) {
      descend(a);
      descend(b);
    }
  };
  Eigen::Index lowest;
  (samples_.colwise() - q).colwise().squaredNorm().minCoeff(&lowest);
  if (lowest > 0) search(lowest - 1);
  if (lowest < arcs) search(lowest);
  for (Eigen::Index k = 0; k < arcs; ++k) {
    if (k != lowest && k + 1 != lowest) search(k);
  }
  return best;
}

template <int Dim>
std::vector<CurveFoot> CurveFootPoints<Dim>::Nearest(const Eigen::Matrix3Xd& points,
                                                     ThreadPool& pool) const {
  std::vector<CurveFoot> feet(points.cols());
  pool.For(points.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) feet[k] = Nearest(points.col(k));
  });
  return feet;
}

template class CurveFootPoints<2>;
template class CurveFootPoints<3>;

}  // namespace batten
