// SPDX-License-Identifier: MIT
#include "batten/fitting/ordered_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/statistics.h"

namespace batten {
namespace {

constexpr double kNarrowestRange = 1e-12;  // of the parameters' size: room for knots between them
constexpr double kLeastRange = 1e-60;      // fairness takes its inverse to the third power
constexpr double kLeastSize = 1e-100;      // squares of smaller numbers vanish
constexpr Eigen::Index kFewForNoise = 12;
constexpr double kStepInNoise = 10;         // steps so long are hardly changed by noise
constexpr Eigen::Index kFewestBlocks = 12;  // fewer would lose the shape
constexpr double kMedianOfRayleigh = 1.1774100225154747;  // √(2 ln 2): two directions across

[[noreturn]] void Refuse(const std::string& reason) { throw std::invalid_argument(reason); }

// Indices of the points in increasing order of the given parameters; equal ones stay in place.
std::vector<Eigen::Index> OrderOf(const Eigen::Matrix2Xd& parameters, bool keep_order) {
  std::vector<Eigen::Index> order(static_cast<size_t>(parameters.cols()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  const auto before = [&](Eigen::Index a, Eigen::Index b) {
    return parameters(0, a) < parameters(0, b);
  };
  if (!keep_order) {
    std::stable_sort(order.begin(), order.end(), before);
    return order;
  }
  const auto fall = std::is_sorted_until(order.begin(), order.end(), before);
  if (fall != order.end()) {
    Refuse("the given parameters decrease at point " + std::to_string(*fall + 1) +
           ": they do not follow the order of the points");
  }
  return order;
}

void RequireSize(const Eigen::Matrix3Xd& points) {
  const double size = (points.colwise() - points.col(0)).cwiseAbs().maxCoeff();
  if (!(size > 0)) {
    Refuse("a curve needs at least 2 different points; all " + std::to_string(points.cols()) +
           " are the same");
  }
  if (size < kLeastSize) Refuse("the points differ by less than 1e-100: scale them up");
}

void RequireRange(const Eigen::Matrix2Xd& parameters) {
  const double low = parameters.row(0).minCoeff(), high = parameters.row(0).maxCoeff();
  if (!(high > low)) Refuse("the given parameters u are all equal: they say nothing of the order");
  if (!(high - low > kNarrowestRange * std::max(std::abs(low), std::abs(high)))) {
    Refuse("the given parameters u hardly differ against their size: subtract an origin from them");
  }
  if (high - low < kLeastRange) {
    Refuse("the given parameters u differ by less than 1e-60: scale them up");
  }
}

// Merges runs of equal points of the sorted cloud.
void MergeRuns(const PointCloud& cloud,
               const std::vector<Eigen::Index>& order,
               bool given,
               OrderedPoints& result) {
  std::vector<Eigen::Index> kept;
  result.place.resize(order.size());
  const auto same = [&](Eigen::Index a, Eigen::Index b) {
    return cloud.points().col(a) == cloud.points().col(b) &&
           (!given || cloud.parameters()(0, a) == cloud.parameters()(0, b));
  };
  Eigen::VectorXd weights(cloud.size());
  for (const Eigen::Index k : order) {
    const double weight = cloud.weights().size() > 0 ? cloud.weights()[k] : 1;
    if (kept.empty() || !same(kept.back(), k)) {
      weights[static_cast<Eigen::Index>(kept.size())] = 0;
      kept.push_back(k);
    }
    const auto last = static_cast<Eigen::Index>(kept.size()) - 1;
    weights[last] += weight;
    result.place[static_cast<size_t>(k)] = last;
  }
  result.cloud = cloud.Picked(kept);
  result.repeats = cloud.size() - result.cloud.size();
  if (result.repeats > 0) result.cloud.set_weights(weights.head(result.cloud.size()));
}

// Means of `width` points in a row, and where they stand among the points' indices.
struct Blocks {
  Eigen::Matrix3Xd means;
  std::vector<double> places;
};

Blocks BlockMeans(const Eigen::Matrix3Xd& points, Eigen::Index width) {
  const Eigen::Index count = points.cols() / width;
  Blocks blocks{Eigen::Matrix3Xd(3, count), {}};
  for (Eigen::Index b = 0; b < count; ++b) {
    const Eigen::Index begin = b * points.cols() / count, end = (b + 1) * points.cols() / count;
    blocks.means.col(b) = points.middleCols(begin, end - begin).rowwise().mean();
    blocks.places.push_back(0.5 * static_cast<double>(begin + end - 1));
  }
  return blocks;
}

double MeanStep(const Eigen::Matrix3Xd& points) {
  const Eigen::Index steps = points.cols() - 1;
  return (points.rightCols(steps) - points.leftCols(steps)).colwise().stableNorm().sum() /
         static_cast<double>(steps);
}

// Noise makes every step longer and uneven; means of several points step farther and scatter less.
// The narrowest blocks whose noise is a tenth of their step, single points where they already are
// that good.
Blocks SteadyBlocks(const Eigen::Matrix3Xd& points, double noise) {
  Eigen::Index width = 1;
  for (;;) {
    Blocks blocks = BlockMeans(points, width);
    const double scatter = noise / std::sqrt(static_cast<double>(width));
    const Eigen::Index wider = width + (width + 3) / 4;
    if (MeanStep(blocks.means) >= kStepInNoise * scatter || points.cols() / wider < kFewestBlocks) {
      return blocks;
    }
    width = wider;
  }
}

// Steps of neighbouring blocks by their distances, summed up, even inside, and brought to [0, 1].
Eigen::VectorXd Parameters(const Eigen::Matrix3Xd& points,
                           CurveParameterization kind,
                           double noise) {
  if (kind == CurveParameterization::kUniform) {
    return Eigen::VectorXd::LinSpaced(points.cols(), 0, 1);
  }
  const Blocks blocks = SteadyBlocks(points, noise);
  std::vector<double> sums{0};
  for (Eigen::Index b = 1; b < blocks.means.cols(); ++b) {
    const double chord = (blocks.means.col(b) - blocks.means.col(b - 1)).stableNorm();
    sums.push_back(sums.back() +
                   (kind == CurveParameterization::kChord ? chord : std::sqrt(chord)));
  }
  Eigen::VectorXd parameters(points.cols());
  size_t b = 0;  // the piece between blocks b and b + 1, which the ends prolong
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const auto place = static_cast<double>(k);
    while (b + 2 < sums.size() && place >= blocks.places[b + 1]) ++b;
    const double share = (place - blocks.places[b]) / (blocks.places[b + 1] - blocks.places[b]);
    parameters[k] = sums[b] + share * (sums[b + 1] - sums[b]);
  }
  const double first = parameters[0], length = parameters[points.cols() - 1] - first;
  parameters = (parameters.array() - first) / length;
  parameters[points.cols() - 1] = 1;
  return parameters;
}

// The values at t of the four Lagrange polynomials over the nodes; false where nodes coincide.
bool Lagrange(const double (&nodes)[4], double t, double (&values)[4]) {
  for (int i = 0; i < 4; ++i) {
    values[i] = 1;
    for (int j = 0; j < 4; ++j) {
      if (j == i) continue;
      if (nodes[i] == nodes[j]) return false;
      values[i] *= (t - nodes[j]) / (nodes[i] - nodes[j]);
    }
  }
  return true;
}

double NoiseAcross(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& u, int dimension) {
  // The direction along the curve is taken over many points, where the noise of two is small
  // against their distance.
  const Eigen::Index reach = std::clamp<Eigen::Index>(points.cols() / 32, 2, 32);
  std::vector<double> offsets;
  for (Eigen::Index k = 2; k + 2 < points.cols(); ++k) {
    const Eigen::Index near[4] = {k - 2, k - 1, k + 1, k + 2};
    double values[4];
    if (!Lagrange({u[near[0]], u[near[1]], u[near[2]], u[near[3]]}, u[k], values)) continue;
    Eigen::Vector3d offset = points.col(k);
    double variance = 1;
    for (int i = 0; i < 4; ++i) {
      offset -= values[i] * points.col(near[i]);
      variance += values[i] * values[i];
    }
    const Eigen::Index before = std::max<Eigen::Index>(0, k - reach),
                       behind = std::min(points.cols() - 1, k + reach);
    const Eigen::Vector3d along = (points.col(behind) - points.col(before)).stableNormalized();
    offset -= along * along.dot(offset);
    offsets.push_back(offset.norm() / std::sqrt(variance));
  }
  if (static_cast<Eigen::Index>(offsets.size()) + 4 < kFewForNoise) return 0;
  const double median = Median(std::move(offsets));
  return dimension == 2 ? kMadToSigma * median : median / kMedianOfRayleigh;
}

}  // namespace

const char* Name(CurveParameterization parameterization) {
  switch (parameterization) {
    case CurveParameterization::kGiven:
      return "given";
    case CurveParameterization::kUniform:
      return "uniform";
    case CurveParameterization::kChord:
      return "chord";
    case CurveParameterization::kCentripetal:
      return "centripetal";
  }
  return "";
}

OrderedPoints OrderPoints(const PointCloud& cloud,
                          CurveParameterization parameterization,
                          bool keep_order) {
  const bool given = parameterization == CurveParameterization::kGiven;
  if (cloud.size() == 0) Refuse("the cloud holds no points");
  RequireSize(cloud.points());
  std::vector<Eigen::Index> order(static_cast<size_t>(cloud.size()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  if (given) {
    if (cloud.parameters().cols() == 0) Refuse("the points have no parameters u");
    RequireRange(cloud.parameters());
    order = OrderOf(cloud.parameters(), keep_order);
  }
  OrderedPoints result;
  MergeRuns(cloud, order, given, result);
  const Eigen::Matrix3Xd& points = result.cloud.points();
  result.spacing = MeanStep(points);
  const auto noise = [&](const Eigen::VectorXd& u) {
    return NoiseAcross(points, u, cloud.dimension());
  };
  if (given) {
    result.parameters = result.cloud.parameters().row(0);
    result.noise = noise(result.parameters);
    return result;
  }
  // Uneven steps of exact points look like noise when counted evenly, noise looks like uneven steps
  // when measured: what both find is noise, and steps freed of it show it better.
  result.noise = std::min(noise(Parameters(points, CurveParameterization::kUniform, 0)),
                          noise(Parameters(points, CurveParameterization::kChord, 0)));
  result.noise = noise(Parameters(points, CurveParameterization::kChord, result.noise));
  result.parameters = Parameters(points, parameterization, result.noise);
  return result;
}

}  // namespace batten
