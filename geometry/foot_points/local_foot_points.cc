// SPDX-License-Identifier: MIT
#include "batten/geometry/local_foot_points.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "geometry/evaluation/evaluation_lanes.h"
#include "geometry/foot_points/local_foot_points_kernel.h"
#include "geometry/numeric/constants.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kMostPasses = 24;  // cells a descent crosses before it is left to LocalFootPoint
// Points taken together: enough that cells fill their groups even where points have no order, few
// enough for a cache.
constexpr std::ptrdiff_t kPointsACell = 16, kLeastBlock = 2048, kMostBlock = 32768;

std::ptrdiff_t BlockOf(const SurfaceTable& table) {
  const std::ptrdiff_t cells = std::ptrdiff_t{table.u.span_count} * table.v.span_count;
  return std::clamp(kPointsACell * cells, kLeastBlock, kMostBlock);
}

// A descent that goes on: its point and all that FootPointLanes says of it.
struct Descent {
  int cell;
  int point;  // in the block
  double u, v, du, dv, squares, side, tries;
};

// What the blocks of one thread share, so that memory is not asked for again.
struct Workspace {
  std::vector<Descent> waiting, sorted;
  std::vector<int> places, points;
  std::vector<double> lanes;
  std::vector<CorrectionRun> runs;
};

Workspace& ThreadBlockWorkspace() {
  thread_local Workspace workspace;
  return workspace;
}

// The descents of one block of points, pass by pass: those of a cell together.
class Block {
 public:
  Block(const SurfaceEvaluator& surface,
        const Eigen::Matrix3Xd& points,
        const Eigen::Matrix2Xd& starts,
        LocalFootPointsKernel& feet)
      : surface_(surface),
        table_(surface.table()),
        points_(points),
        starts_(starts),
        foot_points_(feet),
        space_(ThreadBlockWorkspace()) {}

  void Run(std::ptrdiff_t begin, std::ptrdiff_t end) {
    begin_ = begin;
    if (table_.patches == nullptr) {
      for (std::ptrdiff_t k = begin; k < end; ++k) DescendAlone(k);
      return;
    }
    Start(end);
    for (int pass = 0; pass < kMostPasses && !space_.waiting.empty(); ++pass) {
      SortByCell();
      FillLanes();
      DescendInCells(table_, space_.runs.data(), space_.runs.size(), lanes_);
      Collect();
    }
    for (const Descent& one : space_.waiting) DescendAlone(begin_ + one.point);
  }

 private:
  static constexpr std::size_t kArrays = 11;

  int CellAt(double u, double v) const {
    return lanes::Locate(table_.u, u).span * table_.v.span_count + lanes::Locate(table_.v, v).span;
  }

  void Start(std::ptrdiff_t end) {
    space_.waiting.resize(static_cast<std::size_t>(end - begin_));
    for (std::ptrdiff_t k = begin_; k < end; ++k) {
      const double u = std::clamp(starts_(0, k), table_.u.lower, table_.u.upper);
      const double v = std::clamp(starts_(1, k), table_.v.lower, table_.v.upper);
      const int point = static_cast<int>(k - begin_);
      space_.waiting[static_cast<std::size_t>(point)] = {
          CellAt(u, v), point, u, v, 0, 0, kInfinity, 0, 0};
    }
  }

  // Cells one after the other, points in their order.
  void SortByCell() {
    const std::size_t cells = static_cast<std::size_t>(table_.u.span_count) *
                              static_cast<std::size_t>(table_.v.span_count);
    std::vector<Descent>& waiting = space_.waiting;
    if (waiting.size() < cells / 8) {
      std::sort(waiting.begin(), waiting.end(), [](const Descent& a, const Descent& b) {
        return a.cell < b.cell || (a.cell == b.cell && a.point < b.point);
      });
      return;
    }
    space_.places.assign(cells + 1, 0);
    for (const Descent& one : waiting) ++space_.places[static_cast<std::size_t>(one.cell) + 1];
    for (std::size_t cell = 0; cell < cells; ++cell) space_.places[cell + 1] += space_.places[cell];
    space_.sorted.resize(waiting.size());
    for (const Descent& one : waiting) {
      space_.sorted[static_cast<std::size_t>(space_.places[static_cast<std::size_t>(one.cell)]++)] =
          one;
    }
    waiting.swap(space_.sorted);
  }

  // Whole groups of eight a cell, the last one filled up with its last descent.
  void FillLanes() {
    const std::vector<Descent>& waiting = space_.waiting;
    space_.runs.clear();
    space_.points.clear();
    std::size_t next = 0;
    for (std::size_t k = 0; k < waiting.size();) {
      const int cell = waiting[k].cell;
      const std::size_t begin = next;
      for (; k < waiting.size() && waiting[k].cell == cell; ++k) ++next;
      next = (next + kFootPointLanes - 1) / kFootPointLanes * kFootPointLanes;
      space_.runs.push_back({cell / table_.v.span_count, cell % table_.v.span_count, begin, next});
    }
    if (space_.lanes.size() < kArrays * next) space_.lanes.resize(kArrays * next);
    space_.points.assign(next, -1);
    double* array[kArrays];
    for (std::size_t k = 0; k < kArrays; ++k) array[k] = space_.lanes.data() + k * next;
    std::size_t from = 0;
    for (const CorrectionRun& run : space_.runs) {
      for (std::size_t to = run.begin; to < run.end; ++to) {
        const bool fills = from == waiting.size() || waiting[from].cell != CellOf(run);
        const Descent& one = waiting[fills ? from - 1 : from];
        if (!fills) {
          space_.points[to] = one.point;
          ++from;
        }
        const auto q = points_.col(begin_ + one.point);
        for (int d = 0; d < 3; ++d) array[d][to] = q[d] - table_.centre[d];
        const double fields[] = {one.u, one.v, one.du, one.dv, one.squares, one.side, one.tries};
        for (std::size_t f = 0; f < 7; ++f) array[3 + f][to] = fields[f];
      }
    }
    lanes_ = {array[0],
              array[1],
              array[2],
              array[3],
              array[4],
              array[5],
              array[6],
              array[7],
              array[8],
              array[9],
              array[10]};
  }

  int CellOf(const CorrectionRun& run) const {
    return run.span_u * table_.v.span_count + run.span_v;
  }

  void Collect() {
    space_.waiting.clear();
    for (std::size_t at = 0; at < space_.points.size(); ++at) {
      const int point = space_.points[at];
      if (point < 0) continue;
      const std::ptrdiff_t k = begin_ + point;
      if (lanes_.state[at] == kFootSettled) {
        foot_points_.parameters(0, k) = std::clamp(lanes_.u[at], table_.u.lower, table_.u.upper);
        foot_points_.parameters(1, k) = std::clamp(lanes_.v[at], table_.v.lower, table_.v.upper);
        const double distance = std::sqrt(lanes_.squares[at]);
        foot_points_.distances[k] = lanes_.side[at] < 0 ? -distance : distance;
      } else if (lanes_.state[at] == kFootLeaves) {
        const double u = lanes_.u[at], v = lanes_.v[at], du = lanes_.du[at], dv = lanes_.dv[at];
        const int cell = CellAt(std::clamp(u + du, table_.u.lower, table_.u.upper),
                                std::clamp(v + dv, table_.v.lower, table_.v.upper));
        space_.waiting.push_back(
            {cell, point, u, v, du, dv, lanes_.squares[at], lanes_.side[at], lanes_.tries[at]});
      } else {
        DescendAlone(k);
      }
    }
  }

  void DescendAlone(std::ptrdiff_t k) {
    const Eigen::Vector3d q = points_.col(k);
    const SurfaceFoot foot = LocalFootPoint(surface_.surface(), q, starts_(0, k), starts_(1, k));
    const auto normal = surface_.NormalAt(foot.u, foot.v);
    const bool below = normal && normal->dot(q - foot.point) < 0;
    foot_points_.parameters.col(k) << foot.u, foot.v;
    foot_points_.distances[k] = below ? -foot.distance : foot.distance;
  }

  const SurfaceEvaluator& surface_;
  const SurfaceTable& table_;
  const Eigen::Matrix3Xd& points_;
  const Eigen::Matrix2Xd& starts_;
  LocalFootPointsKernel& foot_points_;
  Workspace& space_;
  std::ptrdiff_t begin_ = 0;
  FootPointLanes lanes_{};
};

}  // namespace

LocalFootPointsKernel LocalFootPoints(const SurfaceEvaluator& surface,
                                      const Eigen::Matrix3Xd& points,
                                      const Eigen::Matrix2Xd& starts,
                                      ThreadPool& pool) {
  if (points.cols() != starts.cols()) {
    throw std::invalid_argument("LocalFootPoints: " + std::to_string(starts.cols()) +
                                " starts do not fit " + std::to_string(points.cols()) + " points");
  }
  LocalFootPointsKernel feet{Eigen::Matrix2Xd(2, points.cols()), Eigen::VectorXd(points.cols())};
  pool.For(points.cols(), BlockOf(surface.table()), [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    Block(surface, points, starts, feet).Run(begin, end);
  });
  return feet;
}

}  // namespace batten
