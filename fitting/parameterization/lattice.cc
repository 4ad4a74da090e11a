// SPDX-License-Identifier: MIT
#include "fitting/parameterization/lattice.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "batten/fitting/point_mask.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kLooks = 1000;  // points of a first look
// Share of them that differ in a coordinate, above which it is no lattice's: of a lattice of 4000
// rows 0.89 do, of scattered points all.
constexpr double kDiffer = 0.9;
constexpr double kOff = 0.01;         // of a step, from the lattice: digits in files leave 1e-4
constexpr double kSameValue = 1e-7;   // of the range of a coordinate
constexpr double kLeastFilled = 0.6;  // share of the nodes: masked rasters, no scan lines
constexpr std::int64_t kLeastRows = 4;

// The evenly spaced values of one coordinate.
struct LatticeRows {
  double first, step;
  std::int64_t count;

  // The row of a value, −1 between rows.
  std::int64_t Of(double value) const {
    const double at = (value - first) / step, row = std::round(at);
    return std::abs(at - row) <= kOff ? static_cast<std::int64_t>(row) : -1;
  }
};

// The rows of a coordinate by the least difference of some values of it.
std::optional<LatticeRows> RowsOf(const Eigen::Matrix3Xd& points, int axis) {
  std::vector<double> some;
  for (const Eigen::Index k : SampleIndices(points.cols(), kLooks, 1))
    some.push_back(points(axis, k));
  std::sort(some.begin(), some.end());
  const double range = some.back() - some.front();
  if (!(range > 0)) return {};
  double step = range;
  std::size_t different = 1;
  for (std::size_t k = 1; k < some.size(); ++k) {
    const double gap = some[k] - some[k - 1];
    if (!(gap > kSameValue * range)) continue;
    ++different;
    step = std::min(step, gap);
  }
  if (static_cast<double>(different) > kDiffer * static_cast<double>(some.size())) return {};
  const double low = points.row(axis).minCoeff(), high = points.row(axis).maxCoeff();
  const double steps = std::round((high - low) / step);
  return LatticeRows{low, (high - low) / steps, static_cast<std::int64_t>(steps) + 1};
}

bool FillNodes(const Eigen::Matrix3Xd& points,
               const std::array<std::optional<LatticeRows>, 3>& rows,
               int across,
               int along) {
  if (!rows[across] || !rows[along]) return false;
  const auto [u, v] = std::pair(*rows[across], *rows[along]);
  if (u.count < kLeastRows || v.count < kLeastRows) return false;
  if (!(static_cast<double>(points.cols()) >=
        kLeastFilled * static_cast<double>(u.count) * static_cast<double>(v.count)))
    return false;
  std::vector<char> taken(static_cast<std::size_t>(u.count * v.count), 0);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const std::int64_t i = u.Of(points(across, k)), j = v.Of(points(along, k));
    if (i < 0 || j < 0) return false;
    char& node = taken[static_cast<std::size_t>(i * v.count + j)];
    if (node != 0) return false;
    node = 1;
  }
  return true;
}

}  // namespace

std::optional<int> AxisOfLatticeHeights(const Eigen::Matrix3Xd& points) {
  if (points.cols() < kLeastRows * kLeastRows) return {};
  std::array<std::optional<LatticeRows>, 3> rows;
  for (int axis = 0; axis < 3; ++axis) rows[axis] = RowsOf(points, axis);
  for (const int axis : {2, 1, 0})
    if (FillNodes(points, rows, (axis + 1) % 3, (axis + 2) % 3)) return axis;
  return {};
}

}  // namespace batten::internal
