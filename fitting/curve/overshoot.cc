// SPDX-License-Identifier: MIT
#include "fitting/curve/overshoot.h"

#include <algorithm>
#include <utility>
#include <vector>

#include "batten/geometry/curve_evaluator.h"
#include "fitting/core/shared_constants.h"
#include "fitting/curve/span_layout.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kEnoughToCount = 20000;
constexpr double kNoise = 10, kOfSize = 0.01;
constexpr double kOutside = 0.25;  // of the data's size: no place is so far outside their box
constexpr double kBack = 0.01;     // of a chord

// A sample of the curve with the data before and after it, the same one twice beyond the ends of an
// open curve.
template <int Dim>
struct SampleBetween {
  using Place = Eigen::Matrix<double, Dim, 1>;
  Place place, before, after;
  bool corner;  // between those data the curve may have one
};

// Visits samples along the curve for as long as `visit` returns true; whether it always did.
template <int Dim, typename Visit>
bool EverySampleBetween(const FittingProblem& problem,
                        const NurbsCurve<Dim>& curve,
                        const Visit& visit) {
  const FittingData& data = problem.data();
  const SplineBasis& basis = problem.basis_u();
  std::vector<std::pair<double, Eigen::Index>> order;
  for (Eigen::Index k = 0; k < problem.size(); ++k) {
    if (data.weights.size() == 0 || data.weights[k] > 0)
      order.emplace_back(data.parameters(0, k), k);
  }
  if (order.size() < 2) return true;
  std::sort(order.begin(), order.end());
  std::vector<double> corners;
  for (const int span : basis.Spans()) {
    const double knot = basis.knots()[static_cast<size_t>(span)];
    if (basis.Multiplicity(knot) >= basis.degree()) corners.push_back(knot);
  }
  const CurveEvaluator<Dim> evaluator(curve);
  for (const int span : basis.Spans()) {
    const double low = basis.knots()[static_cast<size_t>(span)],
                 high = basis.knots()[static_cast<size_t>(span) + 1];
    for (int s = 0; s < kSamplesOfSpan; ++s) {
      const double u = low + (s + 0.5) / kSamplesOfSpan * (high - low);
      const auto above =
          std::lower_bound(order.begin(), order.end(), std::pair(u, Eigen::Index{0}));
      // Around a closed curve the last datum is followed by the first.
      const auto around = [&](const auto& closed, const auto& open) {
        return basis.periodic() ? closed.second : open.second;
      };
      const Eigen::Index next =
          above == order.end() ? around(order.front(), order.back()) : above->second;
      const Eigen::Index last =
          above == order.begin() ? around(order.back(), order.front()) : (above - 1)->second;
      const double begin = above == order.begin() ? basis.lower() : (above - 1)->first,
                   end = above == order.end() ? basis.upper() : above->first;
      const auto corner = std::upper_bound(corners.begin(), corners.end(), begin);
      if (!visit(SampleBetween<Dim>{evaluator.At(u),
                                    data.values.col(last),
                                    data.values.col(next),
                                    corner != corners.end() && *corner < end}))
        return false;
    }
  }
  return true;
}

template <int Dim>
bool Stays(const FittingProblem& problem, const NurbsCurve<Dim>& curve, double noise) {
  const auto& values = problem.data().values;
  const Eigen::Matrix<double, Dim, 1> first = values.rowwise().minCoeff(),
                                      last = values.rowwise().maxCoeff();
  const double size = (last - first).norm();
  const double slack = kNoise * noise + kOfSize * size;
  return EverySampleBetween<Dim>(problem, curve, [&](const SampleBetween<Dim>& sample) {
    const Eigen::Matrix<double, Dim, 1> side = sample.after - sample.before,
                                        from = sample.place - sample.before;
    const double chord = side.norm();
    const double along = chord > 0 ? std::clamp(from.dot(side) / (chord * chord), 0.0, 1.0) : 0.0;
    if (!((from - along * side).norm() <= chord + slack)) return false;
    const double outside = (first - sample.place).cwiseMax(sample.place - last).maxCoeff();
    return outside <= kOutside * size;
  });
}

template <int Dim>
bool RunsOn(const FittingProblem& problem, const NurbsCurve<Dim>& curve, double noise) {
  Eigen::Matrix<double, Dim, 1> last = curve.At(curve.basis().lower());
  double back = 0;
  return EverySampleBetween<Dim>(problem, curve, [&](const SampleBetween<Dim>& sample) {
    const Eigen::Matrix<double, Dim, 1> side = sample.after - sample.before,
                                        move = sample.place - last;
    last = sample.place;
    const double chord = side.norm(), step = chord > 0 ? move.dot(side) / chord : 0.0;
    back = step >= 0 || sample.corner ? 0 : back - step;
    // As far back as noise takes the data themselves.
    return back <= kBack * chord + kThreeSigmas * noise;
  });
}

// Whether every span has data at enough different places to determine a polynomial curve: of so
// many equal parts of it, half hold data, and few in a row are empty, beyond which it would
// extrapolate.
bool WellHeld(const FittingProblem& problem) {
  const SplineBasis& basis = problem.basis_u();
  const int enough = basis.degree() + 1, parts = 2 * enough;
  std::vector<char> holds(static_cast<size_t>(basis.size()) * static_cast<size_t>(parts), 0);
  const Eigen::Index stride = std::max<Eigen::Index>(1, problem.size() / kEnoughToCount);
  for (Eigen::Index k = 0; k < problem.size(); k += stride) {
    if (problem.data().weights.size() > 0 && !(problem.data().weights[k] > 0)) continue;
    const double u = problem.data().parameters(0, k);
    const int span = basis.Span(u);
    const double low = basis.knots()[static_cast<size_t>(span)],
                 high = basis.knots()[static_cast<size_t>(span) + 1];
    const int part = std::clamp(static_cast<int>((u - low) / (high - low) * parts), 0, parts - 1);
    holds[static_cast<size_t>(span) * static_cast<size_t>(parts) + static_cast<size_t>(part)] = 1;
  }
  const std::vector<int> spans = basis.Spans();
  return std::all_of(spans.begin(), spans.end(), [&](int span) {
    const auto first = holds.begin() + static_cast<std::ptrdiff_t>(span) * parts;
    if (std::count(first, first + parts, 1) < enough) return false;
    return std::search_n(first, first + parts, enough / 2 + 1, char{0}) == first + parts;
  });
}

}  // namespace

bool HasOvershoot(const FittingProblem& problem,
                  const Eigen::MatrixXd& control_points,
                  const Eigen::VectorXd& weights,
                  double noise) {
  if (weights.size() == 0 && WellHeld(problem)) return false;
  return control_points.rows() == 2
             ? !Stays<2>(problem, NurbsCurve<2>(problem.basis_u(), control_points, weights), noise)
             : !Stays<3>(problem, NurbsCurve<3>(problem.basis_u(), control_points, weights), noise);
}

bool TurnsBack(const FittingProblem& problem, const Eigen::MatrixXd& control_points, double noise) {
  return control_points.rows() == 2
             ? !RunsOn<2>(problem, NurbsCurve<2>(problem.basis_u(), control_points), noise)
             : !RunsOn<3>(problem, NurbsCurve<3>(problem.basis_u(), control_points), noise);
}

namespace {

template <int Dim>
double SizeOf(const NurbsCurve<Dim>& curve) {
  const CurveEvaluator<Dim> evaluator(curve);
  Eigen::Matrix<double, Dim, 1> low = evaluator.At(curve.basis().lower()), high = low;
  for (const int span : curve.basis().Spans()) {
    const double begin = curve.basis().knots()[static_cast<size_t>(span)],
                 end = curve.basis().knots()[static_cast<size_t>(span) + 1];
    for (int s = 1; s <= kSamplesOfSpan; ++s) {
      const Eigen::Matrix<double, Dim, 1> place =
          evaluator.At(begin + (end - begin) * s / kSamplesOfSpan);
      low = low.cwiseMin(place);
      high = high.cwiseMax(place);
    }
  }
  return (high - low).norm();
}

}  // namespace

double SampledSize(const SplineBasis& basis,
                   const Eigen::MatrixXd& control_points,
                   const Eigen::VectorXd& weights) {
  return control_points.rows() == 2 ? SizeOf(NurbsCurve<2>(basis, control_points, weights))
                                    : SizeOf(NurbsCurve<3>(basis, control_points, weights));
}

}  // namespace batten::internal
