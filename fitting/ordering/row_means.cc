// SPDX-License-Identifier: MIT
#include "fitting/ordering/row_means.h"

#include <algorithm>
#include <cmath>
#include <memory>
#include <numeric>
#include <utility>
#include <vector>

namespace batten::internal {

RowMeans IncreasingRow(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& parameters) {
  std::vector<Eigen::Index> order(static_cast<size_t>(points.cols()));
  std::iota(order.begin(), order.end(), Eigen::Index{0});
  if (!std::is_sorted(parameters.begin(), parameters.end())) {
    std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
      return parameters[a] < parameters[b];
    });
  }
  RowMeans row{Eigen::Matrix3Xd(3, points.cols()), Eigen::VectorXd(points.cols())};
  Eigen::Index kept = 0;
  for (size_t k = 0; k < order.size();) {
    const double at = parameters[order[k]];
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    int count = 0;
    for (; k < order.size() && parameters[order[k]] == at; ++k, ++count)
      sum += points.col(order[k]);
    row.points.col(kept) = sum / count;
    row.parameters[kept++] = at;
  }
  row.points.conservativeResize(Eigen::NoChange, kept);
  row.parameters.conservativeResize(kept);
  return row;
}

double LengthPerParameter(const Eigen::Matrix3Xd& points, const Eigen::VectorXd& parameters) {
  constexpr Eigen::Index kBlocks = 400;
  const Eigen::Index blocks = std::min(kBlocks, points.cols());
  double length = 0, range = 0;
  Eigen::Vector3d before = Eigen::Vector3d::Zero();
  double parameter_before = 0;
  for (Eigen::Index b = 0; b < blocks; ++b) {
    const Eigen::Index begin = b * points.cols() / blocks, end = (b + 1) * points.cols() / blocks;
    const Eigen::Vector3d mean = points.middleCols(begin, end - begin).rowwise().mean();
    const double parameter = parameters.segment(begin, end - begin).mean();
    if (b > 0 && parameter > parameter_before) {
      length += (mean - before).stableNorm();
      range += parameter - parameter_before;
    }
    before = mean;
    parameter_before = parameter;
  }
  return range > 0 ? length / range : 1;
}

FittingProblem MeansOfRows(const FittingProblem& problem, Eigen::Index count) {
  const FittingData& all = problem.data();
  const SplineBasis& basis = problem.basis_u();
  const double period = basis.upper() - basis.lower();
  // Where a block lies across the seam, parameters are taken near the first of them.
  const auto mean_parameter = [&](Eigen::Index begin, const Eigen::VectorXd& shares) {
    const double first = all.parameters(0, begin);
    double sum = 0;
    for (Eigen::Index k = 0; k < shares.size(); ++k) {
      const double u = all.parameters(0, begin + k);
      sum += shares[k] * (basis.periodic() ? u + period * std::round((first - u) / period) : u);
    }
    if (basis.periodic()) sum -= period * std::floor((sum - basis.lower()) / period);
    return std::clamp(sum, basis.lower(), basis.upper());
  };
  const Eigen::Index blocks = std::min(count, problem.size());
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, blocks);
  data->values.resize(all.values.rows(), blocks);
  data->weights.resize(blocks);
  for (Eigen::Index b = 0; b < blocks; ++b) {
    const Eigen::Index begin = b * problem.size() / blocks,
                       size = (b + 1) * problem.size() / blocks - begin;
    if (all.weights.size() == 0) {
      data->values.col(b) = all.values.middleCols(begin, size).rowwise().mean();
      data->parameters(0, b) =
          mean_parameter(begin, Eigen::VectorXd::Constant(size, 1 / static_cast<double>(size)));
      data->weights[b] = static_cast<double>(size);
      continue;
    }
    const Eigen::VectorXd weights = all.weights.segment(begin, size);
    const double sum = weights.sum();
    data->weights[b] = sum;
    if (sum > 0) {
      data->values.col(b) = all.values.middleCols(begin, size) * weights / sum;
      data->parameters(0, b) = mean_parameter(begin, weights / sum);
    } else {
      data->values.col(b) = all.values.col(begin);
      data->parameters(0, b) = all.parameters(0, begin);
    }
  }
  data->weights /= data->weights.mean();
  return problem.WithData(std::move(data));
}

FittingProblem EveryFewData(const FittingProblem& problem, Eigen::Index count) {
  const FittingData& all = problem.data();
  if (problem.size() <= count) return problem;
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < count; ++k) kept.push_back(k * problem.size() / count);
  auto data = std::make_shared<FittingData>();
  data->parameters = all.parameters(Eigen::all, kept);
  data->values = all.values(Eigen::all, kept);
  if (all.weights.size() > 0) data->weights = all.weights(kept);
  return problem.WithData(std::move(data));
}

}  // namespace batten::internal
