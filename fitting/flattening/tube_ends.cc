// SPDX-License-Identifier: MIT
#include "fitting/flattening/tube_ends.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <numbers>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/core/shared_constants.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr double kBinInSpacings = 4;
constexpr double kLeastBins = 12, kMostBins = 96;
constexpr int kMostHarmonics = PeriodicWave::kMostHarmonics;
constexpr int kEndRounds = 4;     // of bins below the wave of the round before
constexpr int kReweightings = 6;  // of bins that have no place near the edge

int BinOf(double u, double period, int bins) {
  const double share = u / period - std::floor(u / period);
  return std::min(bins - 1, static_cast<int>(share * bins));
}

// The lowest place of every bin above a wave.
struct Lowest {
  std::vector<double> u, height;
};

Lowest LowestAbove(const PeriodicWave& wave,
                   const std::vector<Eigen::Vector2d>& places,
                   double period,
                   int bins) {
  std::vector<double> height(static_cast<size_t>(bins), kInfinity), u(static_cast<size_t>(bins), 0);
  for (const Eigen::Vector2d& place : places) {
    const int bin = BinOf(place[0], period, bins);
    const double over = place[1] - wave.At(place[0]);
    if (over >= height[bin]) continue;
    height[bin] = over;
    u[bin] = place[0];
  }
  Lowest lowest;
  for (int bin = 0; bin < bins; ++bin) {
    if (height[bin] == kInfinity) continue;
    lowest.u.push_back(u[bin]);
    lowest.height.push_back(height[bin]);
  }
  return lowest;
}

// Corrects the wave to pass through most of the lowest places; higher harmonics cost more.
void FollowLowest(const Lowest& lowest, double spacing, PeriodicWave& wave) {
  const auto count = static_cast<Eigen::Index>(lowest.u.size());
  const Eigen::Index terms = wave.coefficients.size();
  Eigen::MatrixXd rows(count, terms);
  for (Eigen::Index k = 0; k < count; ++k) rows.row(k) = wave.TermsAt(lowest.u[k]).transpose();
  const Eigen::Map<const Eigen::VectorXd> heights(lowest.height.data(), count);
  Eigen::VectorXd weights = Eigen::VectorXd::Ones(count), steps = Eigen::VectorXd::Zero(terms);
  std::vector<double> sizes(static_cast<size_t>(count));
  for (int round = 0; round < kReweightings; ++round) {
    Eigen::MatrixXd gram = rows.transpose() * weights.asDiagonal() * rows;
    const double total = weights.sum();
    for (Eigen::Index k = 0; k < terms; ++k) {
      const double harmonic = static_cast<double>((k + 1) / 2);
      gram(k, k) +=
          1e-3 * total * harmonic * harmonic / (kMostHarmonics * kMostHarmonics) + 1e-12 * total;
    }
    steps = SymmetricSolution(gram, rows.transpose() * (weights.asDiagonal() * heights));
    const Eigen::VectorXd off = heights - rows * steps;
    for (Eigen::Index k = 0; k < count; ++k) sizes[k] = std::abs(off[k]);
    const double scale = std::max(kMadToSigma * Median(sizes), spacing / 2);
    for (Eigen::Index k = 0; k < count; ++k) {
      const double t = off[k] / (kTukeyTuning * scale);
      weights[k] = std::abs(t) < 1 ? (1 - t * t) * (1 - t * t) : 1e-6;
    }
  }
  wave.coefficients += steps;
}

PeriodicWave WaveUnder(const Eigen::Matrix2Xd& places,
                       const PointMask& mask,
                       double period,
                       double spacing) {
  const int bins =
      static_cast<int>(std::clamp(period / (kBinInSpacings * spacing), kLeastBins, kMostBins));
  std::vector<double> lowest(static_cast<size_t>(bins), kInfinity);
  for (Eigen::Index k = 0; k < places.cols(); ++k) {
    double& least = lowest[BinOf(places(0, k), period, bins)];
    if (mask[k]) least = std::min(least, places(1, k));
  }
  // What lies deeper inside than its bin's lowest place by some bins cannot be at the edge.
  const double depth = 4 * period / bins;
  std::vector<Eigen::Vector2d> near;
  for (Eigen::Index k = 0; k < places.cols(); ++k) {
    if (mask[k] && places(1, k) < lowest[BinOf(places(0, k), period, bins)] + depth) {
      near.emplace_back(places.col(k));
    }
  }
  PeriodicWave wave(period, std::min(kMostHarmonics, bins / 4));
  for (int round = 0; round < kEndRounds && !near.empty(); ++round) {
    FollowLowest(LowestAbove(wave, near, period, bins), spacing, wave);
  }
  return wave;
}

}  // namespace

PeriodicWave::PeriodicWave(double period, int harmonics)
    : coefficients(Eigen::VectorXd::Zero(2 * harmonics + 1)), period_(period) {}

PeriodicWave::Terms PeriodicWave::TermsAt(double u) const {
  const double angle = 2 * std::numbers::pi * u / period_;
  const std::complex<double> step(std::cos(angle), std::sin(angle));
  std::complex<double> turned = 1;
  Terms terms(coefficients.size());
  terms[0] = 1;
  for (Eigen::Index k = 1; k < terms.size(); k += 2) {
    turned *= step;
    terms[k] = turned.real();
    terms[k + 1] = turned.imag();
  }
  return terms;
}

double PeriodicWave::At(double u) const { return TermsAt(u).dot(coefficients); }

TubeEnds EndsOf(const Eigen::Matrix2Xd& places,
                const PointMask& mask,
                double period,
                double spacing) {
  Eigen::Matrix2Xd mirrored = places;
  mirrored.row(1) *= -1;
  TubeEnds ends{WaveUnder(places, mask, period, spacing),
                WaveUnder(mirrored, mask, period, spacing)};
  ends.high.coefficients *= -1;
  return ends;
}

}  // namespace batten::internal
