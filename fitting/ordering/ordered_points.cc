// SPDX-License-Identifier: MIT
#include "batten/fitting/ordered_points.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/core/point_rank.h"
#include "fitting/core/rounding.h"
#include "fitting/ordering/curve_nodes.h"
#include "fitting/ordering/row_means.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kLeastRange = 1e-60;            // fairness takes its inverse to the third power
constexpr Eigen::Index kEnoughForNoise = 10000;  // for a median
constexpr double kStepInNoise = 10;              // in noise: noise hardly changes longer steps
constexpr Eigen::Index kMostBlocks = 2000;
constexpr Eigen::Index kFewestBlocks = 12;  // fewer would lose the shape

[[noreturn]] void Refuse(const std::string& reason) { throw std::invalid_argument(reason); }

// Brings indices of points into increasing order of the given parameters; equal ones stay in place.
void SortByParameters(const Eigen::Matrix2Xd& parameters,
                      bool keep_order,
                      std::vector<Eigen::Index>& order) {
  const auto before = [&](Eigen::Index a, Eigen::Index b) {
    return parameters(0, a) < parameters(0, b);
  };
  if (!keep_order) {
    std::stable_sort(order.begin(), order.end(), before);
    return;
  }
  const auto fall = std::is_sorted_until(order.begin(), order.end(), before);
  if (fall != order.end()) {
    Refuse("the given parameters decrease at point " + std::to_string(*fall + 1) +
           ": they do not follow the order of the points");
  }
}

void RequireSize(const Eigen::Matrix3Xd& points, const std::vector<Eigen::Index>& which) {
  double size = 0;
  for (const Eigen::Index k : which) {
    size = std::max(size, (points.col(k) - points.col(which[0])).cwiseAbs().maxCoeff());
  }
  if (!(size > 0)) {
    Refuse("a curve needs at least 2 different points; all " + std::to_string(which.size()) +
           " are the same");
  }
  if (size < kLeastSize) Refuse("the points differ by less than 1e-100: scale them up");
}

void RequireRange(const Eigen::Matrix2Xd& parameters) {
  const double low = parameters.row(0).minCoeff(), high = parameters.row(0).maxCoeff();
  if (!(high > low)) Refuse("the given parameters u are all equal: they say nothing of the order");
  if (!(high - low > kRelativeRounding * std::max(std::abs(low), std::abs(high)))) {
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
  result.place.assign(static_cast<size_t>(cloud.size()), -1);
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
  result.repeats = static_cast<Eigen::Index>(order.size()) - result.cloud.size();
  if (result.repeats > 0) result.cloud.set_weights(weights.head(result.cloud.size()));
}

// Means of `width` points in a row, and where they stand among the points' indices. Around a closed
// curve the first one is there again, one round later.
struct Blocks {
  Eigen::Matrix3Xd means;
  std::vector<double> places;
};

Blocks BlockMeans(const Eigen::Matrix3Xd& points, Eigen::Index width, bool closed) {
  const Eigen::Index count = points.cols() / width;
  Blocks blocks{Eigen::Matrix3Xd(3, count + (closed ? 1 : 0)), {}};
  for (Eigen::Index b = 0; b < count; ++b) {
    const Eigen::Index begin = b * points.cols() / count, end = (b + 1) * points.cols() / count;
    blocks.means.col(b) = points.middleCols(begin, end - begin).rowwise().mean();
    blocks.places.push_back(0.5 * static_cast<double>(begin + end - 1));
  }
  if (closed) {
    blocks.means.col(count) = blocks.means.col(0);
    blocks.places.push_back(blocks.places.front() + static_cast<double>(points.cols()));
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
// that good; never more than a few thousand, which are as good as all.
Blocks SteadyBlocks(const Eigen::Matrix3Xd& points, double noise, bool closed) {
  Eigen::Index width = noise > 0 ? std::max<Eigen::Index>(1, points.cols() / kMostBlocks) : 1;
  for (;;) {
    Blocks blocks = BlockMeans(points, width, closed);
    const double scatter = noise / std::sqrt(static_cast<double>(width));
    const Eigen::Index wider = width + (width + 3) / 4;
    if (MeanStep(blocks.means) >= kStepInNoise * scatter || points.cols() / wider < kFewestBlocks) {
      return blocks;
    }
    width = wider;
  }
}

// Steps of neighbouring blocks by their distances, summed up, even inside, and brought to [0, 1],
// around a closed curve to [0, 1).
Eigen::VectorXd Parameters(const Eigen::Matrix3Xd& points,
                           CurveParameterization kind,
                           double noise,
                           bool closed) {
  const Eigen::Index steps = points.cols() - (closed ? 0 : 1);
  if (kind == CurveParameterization::kUniform) {
    return Eigen::VectorXd::LinSpaced(points.cols(), 0, points.cols() - 1) /
           static_cast<double>(steps);
  }
  const Blocks blocks = SteadyBlocks(points, noise, closed);
  std::vector<double> sums{0};
  for (Eigen::Index b = 1; b < blocks.means.cols(); ++b) {
    const double chord = (blocks.means.col(b) - blocks.means.col(b - 1)).stableNorm();
    sums.push_back(sums.back() +
                   (kind == CurveParameterization::kChord ? chord : std::sqrt(chord)));
  }
  const double turn = sums.back();
  Eigen::VectorXd parameters(points.cols());
  size_t b = 0;  // the piece between blocks b and b + 1, which the ends prolong
  const auto at = [&](Eigen::Index index) {
    const auto place = static_cast<double>(index);
    while (b + 2 < sums.size() && place >= blocks.places[b + 1]) ++b;
    const double share = (place - blocks.places[b]) / (blocks.places[b + 1] - blocks.places[b]);
    return sums[b] + share * (sums[b + 1] - sums[b]);
  };
  // Around a closed curve the points before the first block come after the last one.
  const auto early =
      closed ? static_cast<Eigen::Index>(std::ceil(blocks.places.front())) : Eigen::Index{0};
  for (Eigen::Index k = early; k < points.cols(); ++k) parameters[k] = at(k);
  for (Eigen::Index k = 0; k < early; ++k) parameters[k] = at(k + points.cols()) - turn;
  const double first = parameters[0];
  const double length = closed ? turn : parameters[points.cols() - 1] - first;
  // Means of points that go back and forth may all coincide.
  if (noise > 0 && !(length > 0)) return Parameters(points, kind, 0, closed);
  parameters = (parameters.array() - first) / length;
  if (!closed) parameters[points.cols() - 1] = 1;
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

double NoiseAcross(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& u, int rank) {
  // The direction along the curve is taken over many points, where the noise of two is small
  // against their distance.
  const Eigen::Index reach = std::clamp<Eigen::Index>(points.cols() / 32, 2, 32);
  std::vector<double> offsets;
  const Eigen::Index stride = std::max<Eigen::Index>(1, points.cols() / kEnoughForNoise);
  for (Eigen::Index k = 2; k + 2 < points.cols(); k += stride) {
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
  if (offsets.size() + 4 < kFewestForNoise) return 0;
  return SigmaOfDistances(std::move(offsets), rank);
}

std::vector<Eigen::Index> Belonging(const PointCloud& cloud, const PointMask& left_out) {
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < cloud.size(); ++k) {
    if (left_out.size() == 0 || !left_out[k]) kept.push_back(k);
  }
  if (kept.empty()) Refuse("the cloud holds no points");
  return kept;
}

// A closed curve whose first point comes again at the end needs it once.
void DropRepeatedEnd(OrderedPoints& ordered) {
  const PointCloud& cloud = ordered.cloud;
  const Eigen::Index last = cloud.size() - 1;
  if (last < 2 || cloud.points().col(0) != cloud.points().col(last)) return;
  std::vector<Eigen::Index> kept(static_cast<size_t>(last));
  std::iota(kept.begin(), kept.end(), Eigen::Index{0});
  Eigen::VectorXd weights =
      cloud.weights().size() > 0 ? cloud.weights() : Eigen::VectorXd::Ones(cloud.size()).eval();
  weights[0] += weights[last];
  ordered.cloud = cloud.Picked(kept);
  ordered.cloud.set_weights(weights.head(last));
  for (Eigen::Index& place : ordered.place) {
    if (place == last) place = 0;
  }
  ++ordered.repeats;
}

void SetLengths(OrderedPoints& ordered, const Eigen::VectorXd& chord) {
  ordered.length = LengthPerParameter(ordered.cloud.points(), chord);
  ordered.lengths = chord * ordered.length;
}

}  // namespace

OrderedPoints OrderPoints(const PointCloud& cloud, const OrderOptions& options) {
  const bool given = options.parameterization == CurveParameterization::kGiven;
  std::vector<Eigen::Index> order = Belonging(cloud, options.left_out);
  RequireSize(cloud.points(), order);
  if (given) {
    if (cloud.parameters().cols() == 0) Refuse("the points have no parameters u");
    RequireRange(cloud.parameters());
    SortByParameters(cloud.parameters(), options.keep_order, order);
  }
  OrderedPoints result;
  MergeRuns(cloud, order, given, result);
  result.closed = options.closed && !given;
  if (result.closed) DropRepeatedEnd(result);
  const Eigen::Matrix3Xd& points = result.cloud.points();
  result.spacing = MeanStep(points);
  result.gap = (points.col(0) - points.col(points.cols() - 1)).stableNorm();
  const int rank = PointRank(points);
  const auto noise = [&](const Eigen::VectorXd& u) { return NoiseAcross(points, u, rank); };
  if (given) {
    result.parameters = result.cloud.parameters().row(0);
    result.lower = result.parameters[0];
    result.upper = result.parameters[result.parameters.size() - 1];
    result.noise = noise(result.parameters);
    SetLengths(result, Parameters(points, CurveParameterization::kChord, result.noise, false));
    return result;
  }
  const auto parameters = [&](CurveParameterization kind, double level) {
    return Parameters(points, kind, level, result.closed);
  };
  // Uneven steps of exact points look like noise when counted evenly, noise looks like uneven steps
  // when measured: what both find is noise, and steps freed of it show it better.
  result.noise = std::min(noise(parameters(CurveParameterization::kUniform, 0)),
                          noise(parameters(CurveParameterization::kChord, 0)));
  result.noise = noise(parameters(CurveParameterization::kChord, result.noise));
  const Eigen::VectorXd chord = parameters(CurveParameterization::kChord, result.noise);
  SetLengths(result, chord);
  const bool by_points = options.parameterization == CurveParameterization::kFoley ||
                         options.parameterization == CurveParameterization::kUniversal;
  if (by_points) {
    result.parameters =
        CurveParameters(points, options.parameterization, options.degree, result.closed)
            .head(points.cols());
  } else {
    result.parameters = options.parameterization == CurveParameterization::kChord
                            ? chord
                            : parameters(options.parameterization, result.noise);
  }
  return result;
}

OrderedPoints FollowPath(const PointCloud& cloud, const CurvePath& path) {
  OrderedPoints result;
  RequireSize(cloud.points(), path.points);
  MergeRuns(cloud, path.points, false, result);
  result.closed = path.closed;
  result.gap = path.gap;
  result.spacing = path.spacing;
  result.noise = path.noise;
  result.parameters.resize(result.cloud.size());
  const double length = path.length;
  for (size_t k = path.points.size(); k-- > 0;) {  // the first of equal points decides
    result.parameters[result.place[static_cast<size_t>(path.points[k])]] =
        std::min(path.parameters[static_cast<Eigen::Index>(k)] / length, 1.0);
  }
  result.length = length;
  result.lengths = result.parameters * length;
  // Noise below the links of the graph does not show in the guide.
  result.noise = std::max(
      path.noise,
      NoiseAcross(result.cloud.points(), result.lengths, PointRank(result.cloud.points())));
  if (path.closed) {
    result.parameters = result.parameters.unaryExpr([](double u) { return u < 1 ? u : u - 1; });
  } else {
    const double first = result.parameters.minCoeff(), last = result.parameters.maxCoeff();
    result.parameters = ((result.parameters.array() - first) / (last - first)).min(1.0);
  }
  return result;
}

}  // namespace batten
