// SPDX-License-Identifier: MIT
#include "fitting/wings/density_end.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "fitting/core/shared_constants.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr int kBinsPerFunction = 4;  // of the first guess
constexpr size_t kRank = 3;          // from the outermost point of a bin
constexpr double kStray = 1e-4;      // density beyond the end: strays do not pull it out
constexpr double kDone = 1e-4;       // noises: a smaller step ends the search
constexpr double kFewestPerFunction = 20;

// The end by the outermost points of bins.
std::optional<Eigen::VectorXd> FirstEnd(const EndingPoints& points) {
  const Eigen::Index functions = points.along.cols();
  const auto bins = static_cast<size_t>(kBinsPerFunction * functions);
  std::vector<std::vector<Eigen::Index>> members(bins);
  for (Eigen::Index k = 0; k < points.reach.size(); ++k) {
    const double place = points.place[k];
    if (!(place >= 0) || place > 1) continue;
    members[std::min(bins - 1, static_cast<size_t>(place * static_cast<double>(bins)))].push_back(
        k);
  }
  std::vector<Eigen::Index> outer;
  for (auto& some : members) {
    if (some.size() < 2 * kRank) continue;
    std::nth_element(some.begin(), some.begin() + kRank - 1, some.end(), [&](auto a, auto b) {
      return points.reach[a] != points.reach[b] ? points.reach[a] > points.reach[b] : a < b;
    });
    outer.push_back(some[kRank - 1]);
  }
  if (std::ssize(outer) < 2 * functions) return std::nullopt;
  const Eigen::MatrixXd rows = points.along(outer, Eigen::all);
  const Eigen::VectorXd values = points.reach(outer);
  return LeastSquares(rows, values);
}

struct Likelihood {
  double value = 0;
  Eigen::VectorXd gradient;
  Eigen::MatrixXd curvature;  // of the negative logarithm
};

}  // namespace

std::optional<Eigen::VectorXd> EndOfPoints(const EndingPoints& points,
                                           double noise,
                                           double window) {
  const std::optional<Eigen::VectorXd> first = FirstEnd(points);
  if (!first) return std::nullopt;
  const Eigen::VectorXd guess = points.along * *first;
  std::vector<Eigen::Index> inside;
  for (Eigen::Index k = 0; k < guess.size(); ++k) {
    if (points.place[k] >= 0 && points.place[k] <= 1 && points.reach[k] > guess[k] - window &&
        points.reach[k] < guess[k] + window)
      inside.push_back(k);
  }
  const Eigen::Index functions = points.along.cols();
  if (static_cast<double>(inside.size()) < kFewestPerFunction * static_cast<double>(functions))
    return std::nullopt;
  const Eigen::MatrixXd rows = points.along(inside, Eigen::all);
  const Eigen::VectorXd reach = points.reach(inside), low = guess(inside).array() - window;
  const auto at = [&](const Eigen::VectorXd& end, bool with_slopes) {
    Likelihood likelihood{
        0, Eigen::VectorXd::Zero(functions), Eigen::MatrixXd::Zero(functions, functions)};
    const Eigen::VectorXd ends = rows * end;
    for (Eigen::Index k = 0; k < ends.size(); ++k) {
      const double z = (ends[k] - reach[k]) / noise, length = ends[k] - low[k];
      if (!(length > 0)) return Likelihood{-HUGE_VAL, {}, {}};
      const double inner = std::erfc(-z / std::numbers::sqrt2) / 2 + kStray;
      likelihood.value += std::log(inner) - std::log(length);
      if (!with_slopes) continue;
      const double ratio =
          std::exp(-z * z / 2) / std::sqrt(2 * std::numbers::pi) / inner;  // of density
      likelihood.gradient += (ratio / noise - 1 / length) * rows.row(k).transpose();
      const double bend = std::max(0.0, ratio * (ratio + z)) / (noise * noise);
      likelihood.curvature += bend * rows.row(k).transpose() * rows.row(k);
    }
    return likelihood;
  };
  Eigen::VectorXd end = *first;
  double damping = 1e-3;
  Likelihood here = at(end, true);
  for (int step = 0; step < kMostIterations; ++step) {
    Eigen::MatrixXd matrix = here.curvature;
    const double scale = matrix.trace() / static_cast<double>(functions) +
                         static_cast<double>(reach.size()) / (window * window);
    matrix.diagonal().array() += damping * scale;
    const Eigen::VectorXd move = SymmetricSolution(matrix, here.gradient);
    const Eigen::VectorXd next = end + move;
    const double value = at(next, false).value;
    if (value > here.value) {
      const double farthest = (rows * move).cwiseAbs().maxCoeff();
      end = next;
      here = at(end, true);
      damping = std::max(1e-6, damping / 5);
      if (farthest < kDone * noise) break;
    } else {
      damping *= 8;
      if (damping > 1e8) break;
    }
  }
  const bool near = (rows * (end - *first)).cwiseAbs().maxCoeff() < window;
  return near ? std::optional(end) : std::nullopt;
}

}  // namespace batten::internal
