// SPDX-License-Identifier: MIT
#include "fitting/revolution/cylindrical_chart.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/core/shared_constants.h"
#include "fitting/flattening/winding_number.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr double kClear = 2.2;        // reaches from the axis …
constexpr double kFarOut = 0.5;       // … or of the median radius
constexpr double kLeastClosed = 0.5;  // of the profile: so much counts as closed round the axis
constexpr double kHole = 3;           // spacings; a smaller gap at the axis is no hole
constexpr int kCountedAtPole = 32;    // points that tell the spacing there

double Wrapped(double angle) { return angle - kTurn * std::round(angle / kTurn); }

// Counts the edges that cross each of equal parts of the circle.
std::vector<int> CrossingsOf(const RevolutionSamples& round,
                             const SamplesAboutAxis& seen,
                             const std::vector<double>& steps,
                             int parts) {
  std::vector<int> counts(static_cast<size_t>(parts), 0);
  for (size_t e = 0; e < steps.size(); ++e) {
    const auto [i, j] = round.graph.edges[e];
    if (!seen.clear[i] || !seen.clear[j]) continue;
    const double from = steps[e] >= 0 ? seen.angles[i] : seen.angles[j];
    const auto at = [&](double angle) {
      return static_cast<int>(std::floor((angle / kTurn + 1) * parts));
    };
    for (int part = at(from); part <= at(from + std::abs(steps[e])); ++part) {
      ++counts[part % parts];
    }
  }
  return counts;
}

struct Gap {
  double middle = 0;
  double crossed = 0;  // edges over it, relative to the mean
};

// Finds the middle of the widest run of parts that the fewest edges cross.
Gap WidestGap(const std::vector<int>& counts) {
  const int parts = static_cast<int>(counts.size());
  double mean = 0;
  for (const int count : counts) mean += static_cast<double>(count) / parts;
  const int least = *std::min_element(counts.begin(), counts.end());
  const double few = least + 0.1 * mean;
  int best = 0, best_start = 0;
  for (int start = 0; start < parts; ++start) {
    int run = 0;
    while (run < parts && counts[(start + run) % parts] <= few) ++run;
    if (run > best) {
      best = run;
      best_start = start;
    }
  }
  return {kTurn * (best_start + 0.5 * best) / parts, mean > 0 ? least / mean : 0};
}

struct Cylindric {
  double angle, r, along;
};

struct NearAxis {
  double r, along;
};

// Position of the axis along the profile by a parabola fitted to the points next to it, with its
// standard deviation. The profile itself is straight beyond its last node, and would place the
// axis of a round end too far out.
struct AxisPlace {
  double along, deviation;
};
AxisPlace PlaceOfAxis(const std::vector<NearAxis>& points, size_t counted) {
  const auto n = static_cast<Eigen::Index>(counted);
  Eigen::MatrixX3d design(n, 3);
  Eigen::VectorXd along(n);
  for (Eigen::Index k = 0; k < n; ++k) {
    const auto& [r, at] = points[static_cast<size_t>(k)];
    design.row(k) << 1, r / points[counted - 1].r, std::pow(r / points[counted - 1].r, 2);
    along[k] = at;
  }
  const Eigen::Matrix3d inverse = (design.transpose() * design).inverse();
  const Eigen::Vector3d parabola = inverse * (design.transpose() * along);
  const double squares = (along - design * parabola).squaredNorm();
  return {parabola[0], std::sqrt(squares / static_cast<double>(n - 3) * inverse(0, 0))};
}

// Position of the pole at an end of the profile, if there is one: points come so near to the axis
// that there is no hole, and the profile meets the axis or, beyond its last node, several points
// do. `way` is 1 at the far end, −1 at the near one.
std::optional<double> PoleAt(std::vector<NearAxis> points,
                             const std::optional<double>& of_profile,
                             int way,
                             double turn,
                             double spacing,
                             double noise) {
  constexpr size_t kSeveral = 4;
  if (points.size() < kSeveral) return std::nullopt;
  const size_t counted = std::min<size_t>(kCountedAtPole, points.size());
  std::partial_sort(points.begin(),
                    points.begin() + static_cast<std::ptrdiff_t>(counted),
                    points.end(),
                    [](const NearAxis& a, const NearAxis& b) { return a.r < b.r; });
  const double nearest = points[0].r, farthest = points[counted - 1].r;
  const double area = turn / 2 * (farthest * farthest - nearest * nearest);
  const double own =
      std::clamp(std::sqrt(area / static_cast<double>(counted - 1)), spacing / 4, 4 * spacing);
  if (nearest > kHole * own + noise) return std::nullopt;
  if (!of_profile && points[kSeveral - 1].r > kHole * std::min(own, spacing) + noise) {
    return std::nullopt;
  }
  if (counted == kCountedAtPole) {
    const AxisPlace place = PlaceOfAxis(points, counted);
    const bool clear =
        std::abs(place.along - of_profile.value_or(place.along)) > kThreeSigmas * place.deviation;
    if (!of_profile || clear) return place.along;
  }
  return of_profile ? *of_profile : points[0].along + way * points[0].r;
}

}  // namespace

SamplesAboutAxis CylindricalCoordinates(const RevolutionSamples& round, const AxisFrame& frame) {
  const PoissonDiskSamples& nodes = round.nodes();
  const Eigen::Index n = nodes.size();
  SamplesAboutAxis seen{Eigen::Matrix2Xd(2, n),
                        Eigen::VectorXd(n),
                        Eigen::Matrix2Xd(2, n),
                        std::vector<bool>(static_cast<size_t>(n)),
                        Median({nodes.reach.begin(), nodes.reach.end()}),
                        0};
  for (Eigen::Index i = 0; i < n; ++i) {
    const Eigen::Vector3d p = frame.ToFrame(nodes.places.col(i));
    const Eigen::Vector3d normal = frame.axes.transpose() * nodes.normals.col(i);
    const double r = std::hypot(p[0], p[1]);
    seen.places.col(i) << r, p[2];
    seen.angles[i] = std::atan2(p[1], p[0]);
    Eigen::Vector2d meridian(r > 0 ? (p[0] * normal[0] + p[1] * normal[1]) / r : 0, normal[2]);
    const double length = meridian.norm();
    seen.normals.col(i) = length > 1e-6 ? (meridian / length).eval() : Eigen::Vector2d(1, 0);
  }
  const Eigen::VectorXd radii = seen.places.row(0);
  seen.mean_radius = radii.mean();
  const double middle = Median({radii.begin(), radii.end()});
  for (Eigen::Index i = 0; i < n; ++i) {
    seen.clear[i] = radii[i] > std::min(kClear * nodes.reach[i], kFarOut * middle);
  }
  return seen;
}

WayRound FindWayRound(const RevolutionSamples& round,
                      const SamplesAboutAxis& seen,
                      const std::vector<double>& along,
                      double period) {
  constexpr int kParts = 720;
  constexpr double kHardlyCrossed = 0.25, kWellCrossed = 0.5;
  WayRound way;
  std::vector<double> steps;  // of the angle along the edges, each in (−π, π]
  for (const auto& [i, j] : round.graph.edges)
    steps.push_back(Wrapped(seen.angles[j] - seen.angles[i]));
  const GraphSteps graph{&round.graph.edges, steps, seen.size()};
  way.share = ClosedFraction(graph, seen.clear, kTurn / 2, along, kChartBand * seen.reach, period);
  const Gap gap = WidestGap(CrossingsOf(round, seen, steps, kParts));
  way.closed =
      way.share >= kLeastClosed || (way.share >= kLeastClosed / 2 && gap.crossed >= kHardlyCrossed);
  way.winds = !way.closed && gap.crossed >= kWellCrossed;
  double low = kTurn, high = 0;
  for (Eigen::Index i = 0; i < seen.size(); ++i) {
    if (!seen.clear[i] || seen.places(0, i) < kFarOut * seen.mean_radius) continue;
    double angle = seen.angles[i] - gap.middle;
    angle -= kTurn * std::floor(angle / kTurn);
    low = std::min(low, angle);
    high = std::max(high, angle);
  }
  way.start = gap.middle + low;
  way.turn = std::max(0.0, high - low);
  return way;
}

void AssignParameters(const CylindricalChart& chart,
                      const RoundCloud& cloud,
                      ThreadPool& pool,
                      RevolutionParameterization& base) {
  const Eigen::Matrix3Xd& points = cloud.points;
  const double spacing = cloud.spacing, margin = cloud.margin;
  const Eigen::Index m = points.cols();
  std::vector<Cylindric> seen(static_cast<size_t>(m));
  const double middle = chart.way.start + chart.way.turn / 2;  // of the open range
  pool.For(m, kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto k = begin; k < end; ++k) {
      const Eigen::Vector3d p = chart.frame.ToFrame(points.col(k));
      const double r = std::hypot(p[0], p[1]);
      const double angle = std::atan2(p[1], p[0]);
      seen[k] = {chart.way.closed ? angle : Wrapped(angle - middle), r, chart.along({r, p[2]})};
    }
  });
  // Ends of the open ranges: points beyond the nodes by less than the nodes are apart.
  const double beyond = 1.5 * chart.reach;
  const double half = chart.way.turn / 2;
  double left = -half, right = half, low = chart.low, high = chart.high;
  std::vector<NearAxis> at_low, at_high;
  const double window = 6 * std::max(chart.reach, spacing);
  for (const auto& [angle, r, along] : seen) {
    if (along < chart.low + window) at_low.push_back({r, along});
    if (along > chart.high - window) at_high.push_back({r, along});
    if (along < low && along > chart.low - beyond) low = along;
    if (along > high && along < chart.high + beyond) high = along;
    if (chart.way.closed || r < kFarOut * chart.mean_radius) continue;
    const double slack = half + beyond / r;
    if (angle < left && angle > -slack) left = angle;
    if (angle > right && angle < slack) right = angle;
  }
  const double swept = chart.way.closed ? kTurn : right - left;
  base.periodic_u = chart.way.closed;
  base.periodic_v = chart.period > 0;
  const std::optional<double> low_pole =
      chart.period > 0 ? std::nullopt
                       : PoleAt(std::move(at_low), chart.low_pole, -1, swept, spacing, cloud.noise);
  const std::optional<double> high_pole =
      chart.period > 0
          ? std::nullopt
          : PoleAt(std::move(at_high), chart.high_pole, 1, swept, spacing, cloud.noise);
  // Among few points both may be sought, and found, in one place: then there is none.
  const double first = low_pole.value_or(low), last = high_pole.value_or(high);
  base.pole_start = first < last && low_pole.has_value();
  base.pole_end = first < last && high_pole.has_value();
  const double widened = chart.way.closed ? 0 : margin / chart.mean_radius;
  base.turn = std::min(swept + 2 * widened, kTurn);
  base.length_u = base.turn * chart.mean_radius;
  const double from_u = chart.way.closed ? 0 : (left + right) / 2 - base.turn / 2;
  double from_v = 0;
  if (base.periodic_v) {
    base.length_v = chart.period;
  } else {
    from_v = base.pole_start ? first : low - margin;
    base.length_v = (base.pole_end ? last : high + margin) - from_v;
  }
  base.parameters.resize(2, m);
  for (Eigen::Index k = 0; k < m; ++k) {
    double u = (seen[k].angle - from_u) * chart.mean_radius, v = seen[k].along - from_v;
    if (base.periodic_u) {
      if (u < 0) u += base.length_u;
      if (u >= base.length_u) u = 0;
    }
    base.parameters(0, k) = std::clamp(u, 0.0, base.length_u);
    base.parameters(1, k) = std::clamp(v, 0.0, base.length_v);
  }
}

}  // namespace batten::internal
