// SPDX-License-Identifier: MIT
#include "fitting/primitives/shape_fitter.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/core/shared_constants.h"
#include "fitting/core/unit_of.h"
#include "fitting/primitives/sample_consensus.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kSample = 12000;  // points

// The distance in standard deviations that, of m normal errors, any exceeds in one cloud of a
// hundred.
double FarthestOf(Eigen::Index m) {
  return std::sqrt(2 * std::log(100 * static_cast<double>(std::max<Eigen::Index>(m, 10))));
}

double ScaleAbout(const FittedSurface& shape,
                  const ShapeData& data,
                  double so_far,
                  ThreadPool& pool) {
  return ScaleOf(SurfaceDistances(shape, data.points, pool).cwiseAbs(), so_far);
}

// Keeps the best few distinct candidates by their sums of squares; in robust fits squares are
// truncated at a common scale, that of the shape most points are closest to.
std::vector<ShapeCandidate> Ranked(std::vector<ShapeCandidate> candidates,
                                   const ShapeData& points,
                                   bool robust,
                                   bool last,
                                   size_t most,
                                   ThreadPool& pool) {
  constexpr double kSame = 1e-5, kFar = 60;
  double least = std::numeric_limits<double>::infinity();
  for (const ShapeCandidate& candidate : candidates) least = std::min(least, candidate.scale);
  for (ShapeCandidate& candidate : candidates) {
    const double cost =
        FormOf(candidate.shape, points, {robust ? Loss::kTruncated : Loss::kNone, least}, pool)
            .cost;
    candidate.cost = std::isfinite(cost) ? cost : std::numeric_limits<double>::infinity();
  }
  std::stable_sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) {
    return a.cost < b.cost;
  });
  std::vector<ShapeCandidate> best;
  for (const ShapeCandidate& candidate : candidates) {
    if (best.size() == most) break;
    // Candidates so many squared standard deviations behind cannot win on more points.
    const auto count = static_cast<double>(points.points.cols());
    if (!best.empty() && candidate.cost > (1 + kFar / count) * best.front().cost && last) break;
    const bool new_one = best.empty() || candidate.cost > (1 + kSame) * best.back().cost;
    if (new_one && std::isfinite(candidate.cost)) best.push_back(candidate);
  }
  return best;
}

// The kinds that are limits of a kind.
std::vector<SurfaceKind> SimplerKinds(SurfaceKind kind) {
  switch (kind) {
    case SurfaceKind::kPlane:
      return {};
    case SurfaceKind::kSphere:
    case SurfaceKind::kCylinder:
      return {SurfaceKind::kPlane};
    case SurfaceKind::kCone:
      return {SurfaceKind::kPlane, SurfaceKind::kCylinder};
    case SurfaceKind::kTorus:
      break;
  }
  return {SurfaceKind::kPlane, SurfaceKind::kSphere, SurfaceKind::kCylinder, SurfaceKind::kCone};
}

}  // namespace

ShapeFitter::ShapeFitter(const Eigen::Matrix3Xd& points,
                         const Eigen::VectorXd& weights,
                         const ShapeFitOptions& options,
                         ThreadPool& pool)
    : options_(options), pool_(pool) {
  unit_ = UnitOf(points);
  middle_ = (points.rowwise().minCoeff() + points.rowwise().maxCoeff()) / 2;
  data_.points.resize(3, points.cols());
  pool_.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const double scale = 1 / unit_;
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      data_.points.col(k) = scale * (points.col(k) - middle_);
    }
  });
  data_.weights = weights.size() > 0 ? (weights / weights.mean()).eval()
                                     : Eigen::VectorXd::Ones(points.cols()).eval();
  weights_ = data_.weights;
  start_ = MakeStartData(data_, kSample, options_.seed, pool_);
}

// Robust starts need enough points: among few, half always agree on some shape.
bool ShapeFitter::Robust(SurfaceKind kind) const {
  if (options_.loss) return *options_.loss != Loss::kNone;
  return data_.points.cols() >= 6 * FreedomsOf(kind);
}

std::vector<FittedSurface> ShapeFitter::StartsOf(SurfaceKind kind) {
  std::vector<FittedSurface> starts = MomentStarts(kind, start_);
  const auto add = [&](const std::vector<FittedSurface>& more) {
    starts.insert(starts.end(), more.begin(), more.end());
  };
  if (Robust(kind)) add(ConsensusStarts(kind, start_, options_.seed));
  if (kind == SurfaceKind::kCone || kind == SurfaceKind::kTorus) {
    for (const ShapeCandidate& cylinder : MinimaOf(SurfaceKind::kCylinder)) {
      add(StartsFromCylinder(kind, cylinder.shape, start_));
    }
  }
  return starts;
}

// Minimises from `start`; in robust fits in rounds, with Tukey's loss at the scale of the points
// about the current shape.
ShapeCandidate ShapeFitter::Settled(
    const FittedSurface& start, const ShapeData& points, int rounds, int steps, bool robust) {
  constexpr double kSteady = 1e-2;  // relative change of the scale
  if (!robust) return {Minimised(start, points, {}, rounds * steps, pool_).shape};
  const double given = options_.scale ? *options_.scale / unit_ : 0;
  ShapeCandidate settled{start, std::numeric_limits<double>::infinity()};
  const auto scale = [&] {
    return std::max(options_.rounding,
                    given > 0 ? given : ScaleAbout(settled.shape, points, settled.scale, pool_));
  };
  for (int round = 0; round < rounds; ++round) {
    const double next = scale();
    if (std::abs(settled.scale - next) <= kSteady * next) break;
    settled.scale = next;
    settled.shape = Minimised(settled.shape, points, {Loss::kTukey, next}, steps, pool_).shape;
  }
  settled.scale = scale();
  return settled;
}

// Three rounds of selection: a few steps on some hundreds of points for each candidate; the best
// until they converge; the best of those on the whole sample.
const ShapeFitter::Minima& ShapeFitter::MinimaOf(SurfaceKind kind) {
  constexpr size_t kSecondHeat = 6, kThirdHeat = 3;
  constexpr int kFewRounds = 3, kRounds = 20, kFewSteps = 3, kSteps = 6;
  Minima& minima = minima_[static_cast<size_t>(kind)];
  if (!minima.empty()) return minima;
  const bool robust = Robust(kind);
  const auto heat = [&](Minima from, const ShapeData& points, int rounds, int steps, size_t most) {
    const bool last = most == kThirdHeat;
    for (ShapeCandidate& candidate : from) {
      const FittedSurface start = candidate.shape.TouchingNear(start_.middle);
      candidate = Settled(start, points, rounds, steps, robust);
    }
    return Ranked(std::move(from), points, robust, last, most, pool_);
  };
  for (const FittedSurface& start : StartsOf(kind)) minima.push_back({start});
  minima = heat(std::move(minima), start_.judges, kFewRounds, kFewSteps, kSecondHeat);
  minima = heat(std::move(minima), start_.judges, kRounds, kSteps, kThirdHeat);
  minima = heat(std::move(minima), start_.sample, kRounds, kSteps, kThirdHeat);
  return minima;
}

// The loss that decides which points are outliers.
ShapeLoss ShapeFitter::Rejecting(double scale, SurfaceKind kind) const {
  if (!Robust(kind)) return {Loss::kNone, scale};
  if (options_.loss) return {Loss::kTukey, scale};
  return {Loss::kTruncated, FarthestOf(data_.points.cols()) / kTruncatedTuning * scale};
}

const ShapeData& ShapeFitter::Counting(const ShapeFit& fit) {
  data_.weights = fit.outliers.select(0, weights_.array());
  return data_;
}

void ShapeFitter::Minimise(const FittedSurface& start, const ShapeLoss& loss, ShapeFit& fit) {
  constexpr int kMostSteps = 200;  // more are of a shape that its points hardly determine
  fit.local = Minimised(start, data_, loss, kMostSteps, pool_).shape;
  fit.distances = SurfaceDistances(fit.local, data_.points, pool_);
}

// Adds other minima, and simpler kinds that are limits, whose excess on the sample, scaled to all
// points, is below kFarthest.
void ShapeFitter::AddAlternatives(ShapeFit& fit) {
  constexpr double kFarthest = 16;  // four standard deviations
  const double sigma = std::max(fit.sigma / unit_, options_.rounding);
  const double scale = FarthestOf(data_.points.cols()) / kTruncatedTuning * sigma;
  const auto points =
      static_cast<double>(data_.points.cols()) / static_cast<double>(start_.sample.points.cols());
  const auto cost = [&](const FittedSurface& shape) {
    return FormOf(shape, start_.sample, {Loss::kTruncated, scale}, pool_).cost;
  };
  const double own = cost(fit.local);
  const auto add = [&](const ShapeCandidate& other) {
    const double excess = 2 * points * (cost(other.shape) - own) / (sigma * sigma);
    if (excess < kFarthest) fit.alternatives.push_back({other.shape, std::max(0.0, excess)});
  };
  const Minima& minima = MinimaOf(fit.kind);
  for (size_t i = 1; i < minima.size(); ++i) add(minima[i]);
  for (const SurfaceKind kind : SimplerKinds(fit.kind)) {
    if (!MinimaOf(kind).empty()) add(MinimaOf(kind).front());
  }
}

ShapeFit ShapeFitter::Fit(SurfaceKind kind) {
  const int freedoms = FreedomsOf(kind);
  if (data_.points.cols() < freedoms) {
    throw std::invalid_argument(std::string("a ") + Name(kind) + " needs at least " +
                                std::to_string(freedoms) + " different points; there are " +
                                std::to_string(data_.points.cols()));
  }
  const Minima& minima = MinimaOf(kind);
  if (minima.empty())
    throw std::invalid_argument(std::string("no ") + Name(kind) + " fits the points");
  const ShapeCandidate found = minima.front();
  ShapeFit fit;
  fit.kind = kind;
  fit.freedoms = freedoms;
  data_.weights = weights_;
  const ShapeLoss rejecting = Rejecting(found.scale, kind);
  Minimise(found.shape, rejecting, fit);
  fit.outliers = fit.distances.unaryExpr(
      [&](double d) { return !(LossWeight(rejecting.loss, d, rejecting.scale) > 0); });
  fit.loss = {options_.loss.value_or(Loss::kNone), found.scale};
  if (fit.loss.loss != Loss::kNone && fit.loss.loss != Loss::kTukey) {
    Counting(fit);
    Minimise(fit.local, fit.loss, fit);
  }
  fit.shape = fit.local.Shape(unit_, middle_);
  fit.distances *= unit_;
  for (Eigen::Index k = 0; k < fit.distances.size(); ++k) {
    if (fit.outliers[k]) continue;
    fit.squares += weights_[k] * fit.distances[k] * fit.distances[k];
    ++fit.used;
  }
  const double left = std::max<double>(1, static_cast<double>(fit.used - freedoms));
  fit.sigma = std::sqrt(fit.squares / left);
  AddAlternatives(fit);
  return fit;
}

}  // namespace batten::internal
