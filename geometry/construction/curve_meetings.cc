// SPDX-License-Identifier: MIT
#include "geometry/construction/curve_meetings.h"

#include <algorithm>
#include <cmath>

#include "batten/geometry/closure.h"

namespace batten::internal {
namespace {

constexpr double kSamePlace = 1e-7;  // of the domain: meetings so near are one

struct Pair {
  int i, j;
  double squared;
};

// Squared distances of all samples; column j belongs to sample j of b.
Eigen::MatrixXd SquaredDistances(const Eigen::Matrix3Xd& a, const Eigen::Matrix3Xd& b) {
  Eigen::MatrixXd squared(a.cols(), b.cols());
  for (Eigen::Index j = 0; j < b.cols(); ++j) {
    squared.col(j) = (a.colwise() - b.col(j)).colwise().squaredNorm().transpose();
  }
  return squared;
}

// Pairs of samples nearer than the pairs next to them, nearest first.
std::vector<Pair> NearPairs(const Eigen::MatrixXd& squared) {
  const int rows = static_cast<int>(squared.rows()), columns = static_cast<int>(squared.cols());
  std::vector<Pair> pairs;
  for (int j = 0; j < columns; ++j) {
    for (int i = 0; i < rows; ++i) {
      const int top = std::max(i - 1, 0), left = std::max(j - 1, 0);
      const int height = std::min(i + 1, rows - 1) - top + 1;
      const int width = std::min(j + 1, columns - 1) - left + 1;
      const double here = squared(i, j);
      if (i > 0 && squared(i - 1, j) < here) continue;
      if (i + 1 < rows && squared(i + 1, j) < here) continue;
      if (j > 0 && squared(i, j - 1) < here) continue;
      if (j + 1 < columns && squared(i, j + 1) < here) continue;
      if (here <= squared.block(top, left, height, width).minCoeff()) pairs.push_back({i, j, here});
    }
  }
  std::ranges::sort(pairs, {}, &Pair::squared);
  return pairs;
}

// The nearest place from (s, t) on, inside both domains. [Gauss–Newton, damped]
ClosestApproach Descended(const SampledCurve& a, const SampledCurve& b, double s, double t) {
  constexpr int kMostSteps = 100;
  const SplineBasis& basis_a = a.curve().basis();
  const SplineBasis& basis_b = b.curve().basis();
  double damping = 1e-12;
  CurveJet<3> on_a = a.evaluator().JetAt(s), on_b = b.evaluator().JetAt(t);
  for (int step = 0; step < kMostSteps; ++step) {
    const Eigen::Vector3d apart = on_a.point - on_b.point;
    const double aa = on_a.first.squaredNorm(), bb = on_b.first.squaredNorm();
    const double ab = on_a.first.dot(on_b.first);
    const double g = apart.dot(on_a.first), h = -apart.dot(on_b.first);
    const double da = aa * (1 + damping), db = bb * (1 + damping);
    const double determinant = da * db - ab * ab;
    if (!(determinant > 0)) break;
    double to_s = s + (-g * db - h * ab) / determinant;
    double to_t = t + (-h * da - g * ab) / determinant;
    // At an end the other parameter goes on alone.
    if (to_s < basis_a.lower() || to_s > basis_a.upper()) {
      to_s = std::clamp(to_s, basis_a.lower(), basis_a.upper());
      to_t = t + (-h + ab * (to_s - s)) / db;
    }
    if (to_t < basis_b.lower() || to_t > basis_b.upper()) {
      to_t = std::clamp(to_t, basis_b.lower(), basis_b.upper());
      to_s = std::clamp(s + (-g + ab * (to_t - t)) / da, basis_a.lower(), basis_a.upper());
    }
    const CurveJet<3> next_a = a.evaluator().JetAt(to_s), next_b = b.evaluator().JetAt(to_t);
    if (!((next_a.point - next_b.point).squaredNorm() < apart.squaredNorm())) {
      if (damping > 1e6) break;
      damping = std::max(damping * 16, 1e-4);
      continue;
    }
    damping /= 16;
    s = to_s;
    t = to_t;
    on_a = next_a;
    on_b = next_b;
  }
  return {s, t, (on_a.point - on_b.point).norm()};
}

double AtBeginning(const SampledCurve& curve, double at) {
  const SplineBasis& basis = curve.curve().basis();
  const double length = basis.upper() - basis.lower();
  return curve.closed() && basis.upper() - at <= kSamePlace * length ? basis.lower() : at;
}

}  // namespace

SampledCurve::SampledCurve(const NurbsCurve<3>& curve) : evaluator_(curve), closed_(Closed(curve)) {
  const SplineBasis& basis = curve.basis();
  constexpr int kLeast = 24;  // in all
  const std::vector<int> spans = basis.Spans();
  const int places = std::max(basis.degree() + 1, kLeast / static_cast<int>(spans.size()) + 1);
  for (const int span : spans) {
    const double begin = basis.knots()[span], end = basis.knots()[span + 1];
    for (int k = 0; k < places; ++k) parameters_.push_back(begin + (end - begin) * k / places);
  }
  parameters_.push_back(basis.upper());
  evaluator_.Points(parameters_, points_);
}

std::vector<ClosestApproach> Meetings(const SampledCurve& a,
                                      const SampledCurve& b,
                                      double tolerance) {
  constexpr std::size_t kMostStarts = 16;
  const double length_a = a.curve().basis().upper() - a.curve().basis().lower();
  const double length_b = b.curve().basis().upper() - b.curve().basis().lower();
  std::vector<ClosestApproach> meetings;
  ClosestApproach nearest{0, 0, std::numeric_limits<double>::infinity()};
  const std::vector<Pair> pairs = NearPairs(SquaredDistances(a.points(), b.points()));
  for (std::size_t k = 0; k < std::min(pairs.size(), kMostStarts); ++k) {
    ClosestApproach found = Descended(a, b, a.parameters()[pairs[k].i], b.parameters()[pairs[k].j]);
    found.s = AtBeginning(a, found.s);
    found.t = AtBeginning(b, found.t);
    if (found.gap < nearest.gap) nearest = found;
    const bool known = std::ranges::any_of(meetings, [&](const ClosestApproach& other) {
      return std::abs(other.s - found.s) <= kSamePlace * length_a &&
             std::abs(other.t - found.t) <= kSamePlace * length_b;
    });
    if (found.gap <= tolerance && !known) meetings.push_back(found);
  }
  if (meetings.empty()) meetings.push_back(nearest);
  std::ranges::sort(meetings, {}, &ClosestApproach::gap);
  return meetings;
}

}  // namespace batten::internal
