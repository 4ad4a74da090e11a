// SPDX-License-Identifier: MIT
#include "geometry/mesh/loop_parameters.h"

#include <cmath>
#include <limits>
#include <numeric>

#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

// How long a way is across the line from a to b.
double Across(const Eigen::Vector3d& way, const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
  const Eigen::Vector3d along = (b - a).stableNormalized();
  return (way - way.dot(along) * along).norm();
}

bool Far(const SplineBasis& basis, double x, double y, int spans) {
  return std::abs(basis.Span(x) - basis.Span(y)) > spans;
}

// Halves a piece of a loop until it is straight enough.
class LoopHalving {
 public:
  LoopHalving(const NurbsCurve<2>& loop,
              const SurfaceEvaluator& surface,
              double tolerance,
              double beside)
      : loop_(loop), surface_(surface), tolerance_(tolerance), beside_(beside) {}

  // Appends `lower` and the parameters up to `upper`, without that.
  void Add(double lower, double upper, std::vector<double>& parameters, int depth = 0) const {
    constexpr int kDeepest = 22;
    const Eigen::Vector2d a = loop_.At(lower), b = loop_.At(upper);
    if (depth < kDeepest && !Straight(lower, a, upper, b)) {
      const double middle = std::midpoint(lower, upper);
      Add(lower, middle, parameters, depth + 1);
      Add(middle, upper, parameters, depth + 1);
    } else {
      parameters.push_back(lower);
    }
  }

 private:
  bool Straight(double lower,
                const Eigen::Vector2d& a,
                double upper,
                const Eigen::Vector2d& b) const {
    constexpr int kMostSpans = 8;  // of the loop: seven places show what it does there
    const SplineBasis& basis_u = surface_.surface().basis_u();
    const SplineBasis& basis_v = surface_.surface().basis_v();
    if (Far(basis_u, a[0], b[0], basis_u.degree()) || Far(basis_v, a[1], b[1], basis_v.degree()) ||
        Far(loop_.basis(), lower, upper, kMostSpans * loop_.basis().degree())) {
      return false;
    }
    const Eigen::Vector3d first = surface_.At(a[0], a[1]), last = surface_.At(b[0], b[1]);
    for (const double share : {0.5, 0.25, 0.75, 0.125, 0.375, 0.625, 0.875}) {
      const Eigen::Vector2d on_loop = loop_.At(lower + share * (upper - lower));
      const Eigen::Vector2d on_line = a + share * (b - a);
      const Eigen::Vector3d curve = surface_.At(on_loop[0], on_loop[1]);
      const Eigen::Vector3d line = surface_.At(on_line[0], on_line[1]);
      if (DistanceFromSegment(curve, first, last) > tolerance_ ||
          DistanceFromSegment(line, first, last) > tolerance_ ||
          Across(curve - line, first, last) > beside_) {
        return false;
      }
    }
    return true;
  }

  const NurbsCurve<2>& loop_;
  const SurfaceEvaluator& surface_;
  double tolerance_, beside_;
};

}  // namespace

std::vector<double> LoopParameters(const NurbsCurve<2>& loop,
                                   const SurfaceEvaluator& surface,
                                   double tolerance) {
  constexpr int kCurved = 4;  // pieces of a span to begin with, unless it is straight
  const SplineBasis& basis = loop.basis();
  const int parts = basis.degree() == 1 ? 1 : kCurved;
  const LoopHalving halving(loop, surface, tolerance, std::numeric_limits<double>::infinity());
  std::vector<double> parameters;
  for (const int span : basis.Spans()) {
    const double lower = basis.knots()[span], upper = basis.knots()[span + 1];
    const auto at = [&](int k) { return k == parts ? upper : lower + (upper - lower) * k / parts; };
    for (int k = 0; k < parts; ++k) halving.Add(at(k), at(k + 1), parameters);
  }
  return parameters;
}

std::vector<double> EdgeParameters(const NurbsCurve<2>& curve,
                                   const SurfaceEvaluator& surface,
                                   double tolerance,
                                   double beside) {
  const SplineBasis& basis = curve.basis();
  const LoopHalving halving(curve, surface, tolerance, beside);
  std::vector<double> parameters;
  double lower = basis.lower();
  for (const int span : basis.Spans()) {
    const double upper = basis.knots()[span + 1];
    const bool corner = upper == basis.upper() || basis.Multiplicity(upper) >= basis.degree();
    if (!corner) continue;
    halving.Add(lower, upper, parameters);
    lower = upper;
  }
  return parameters;
}

}  // namespace batten::internal
