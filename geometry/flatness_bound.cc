// SPDX-License-Identifier: MIT
#include "batten/geometry/flatness_bound.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "batten/geometry/bezier_span.h"

namespace batten {
namespace {

// The spans that are no slivers.
std::vector<int> SpansOf(const SplineBasis& basis) {
  std::vector<int> spans = basis.Spans();
  const double least = kSliverShare * (basis.upper() - basis.lower());
  std::erase_if(spans,
                [&](int span) { return basis.knots()[span + 1] - basis.knots()[span] <= least; });
  return spans;
}

std::vector<double> BreaksOf(const SplineBasis& basis) {
  std::vector<double> breaks;
  for (const int span : SpansOf(basis)) breaks.push_back(basis.knots()[span]);
  breaks.push_back(basis.upper());
  return breaks;
}

std::vector<Eigen::MatrixXd> BezierMatrices(const SplineBasis& basis) {
  std::vector<Eigen::MatrixXd> matrices;
  for (const int span : SpansOf(basis))
    matrices.push_back(BezierSpanMatrix(basis, span).transpose());
  return matrices;
}

// The cells [first, last) that the interval has more than an end in common with, or one of them
// where it is a point.
std::pair<int, int> CellsOf(const std::vector<double>& breaks, double lower, double upper) {
  const int cells = static_cast<int>(breaks.size()) - 1;
  const auto after = std::upper_bound(breaks.begin(), breaks.end(), lower);
  const int first = std::clamp(static_cast<int>(after - breaks.begin()) - 1, 0, cells - 1);
  int last = first + 1;
  while (last < cells && breaks[static_cast<std::size_t>(last)] < upper) ++last;
  return {first, last};
}

// The greatest of |Σ_{i<j} λ_i λ_j q_ij| / 2 over λ ≥ 0, Σ λ = 1, for values whose signs are left
// out: it lies on an edge, or inside where all three pull.
double GreatestOf(const std::array<double, 3>& q) {
  const double a = std::abs(q[0]), b = std::abs(q[1]), c = std::abs(q[2]);
  double greatest = std::max({a, b, c}) / 8;
  const double la = a * (b + c - a), lb = b * (c + a - b), lc = c * (a + b - c);
  const double sum = la + lb + lc;
  if (la > 0 && lb > 0 && lc > 0 && sum > 0) greatest = std::max(greatest, a * b * c / sum / 2);
  return greatest;
}

// Two more differences of rows of Bézier points along one direction, or one along each.
Eigen::Matrix4Xd Differences(const Eigen::Matrix4Xd& points, int n, int m, bool along_first) {
  Eigen::Matrix4Xd result(4, along_first ? n * (m + 1) : (n + 1) * m);
  Eigen::Index to = 0;
  if (along_first) {
    for (int k = 0; k < n * (m + 1); ++k) result.col(to++) = points.col(k + m + 1) - points.col(k);
    return result;
  }
  for (int i = 0; i <= n; ++i) {
    for (int j = 0; j < m; ++j) {
      const int k = i * (m + 1) + j;
      result.col(to++) = points.col(k + 1) - points.col(k);
    }
  }
  return result;
}

}  // namespace

FlatnessBound::FlatnessBound(const NurbsSurface& surface)
    : p_(surface.basis_u().degree()),
      q_(surface.basis_v().degree()),
      breaks_u_(BreaksOf(surface.basis_u())),
      breaks_v_(BreaksOf(surface.basis_v())) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  const std::vector<int> spans_u = SpansOf(u), spans_v = SpansOf(v);
  const std::vector<Eigen::MatrixXd> matrices_u = BezierMatrices(surface.basis_u()),
                                     matrices_v = BezierMatrices(surface.basis_v());
  for (std::size_t s = 0; s < spans_u.size(); ++s) {
    for (std::size_t t = 0; t < spans_v.size(); ++t) {
      Eigen::Matrix4Xd points = Eigen::Matrix4Xd::Zero(4, (p_ + 1) * (q_ + 1));
      for (int i = 0; i <= p_; ++i) {
        Eigen::Matrix4Xd row(4, q_ + 1);
        for (int j = 0; j <= q_; ++j) {
          const int a = spans_u[s] - p_ + i, b = spans_v[t] - q_ + j;
          const double weight =
              surface.rational() ? surface.weights()[a * surface.size_v() + b] : 1.0;
          row.col(j) << weight * surface.control_point(a, b), weight;
        }
        row = (row * matrices_v[t]).eval();
        for (int k = 0; k <= p_; ++k)
          points.middleCols(k * (q_ + 1), q_ + 1) += matrices_u[s](i, k) * row;
      }
      if (!surface.rational()) points.row(3).setOnes();
      nodes_.push_back(NodeOf(
          {breaks_u_[s], breaks_v_[t]}, {breaks_u_[s + 1], breaks_v_[t + 1]}, std::move(points)));
    }
  }
  constexpr std::size_t kMemory = std::size_t{1} << 28;
  const auto columns = static_cast<std::size_t>(4 * (p_ + 1) * (q_ + 1));
  most_nodes_ = nodes_.size() + kMemory / (sizeof(Node) + columns * 4 * sizeof(double));
}

FlatnessBound::Node FlatnessBound::NodeOf(Eigen::Array2d lower,
                                          Eigen::Array2d upper,
                                          Eigen::Matrix4Xd points) const {
  Node node{lower, upper, std::move(points), {}, 0};
  node.least_weight = node.points.row(3).minCoeff();
  const double du = upper[0] - lower[0], dv = upper[1] - lower[1];
  const Eigen::Matrix4Xd along_u = Differences(node.points, p_, q_, true);
  if (p_ > 1) node.seconds[0] = p_ * (p_ - 1) / (du * du) * Differences(along_u, p_ - 1, q_, true);
  node.seconds[1] = p_ * q_ / (du * dv) * Differences(along_u, p_ - 1, q_, false);
  if (q_ > 1) {
    node.seconds[2] = q_ * (q_ - 1) / (dv * dv) *
                      Differences(Differences(node.points, p_, q_, false), p_, q_ - 1, false);
  }
  return node;
}

// De Casteljau at the middle. False where no more nodes are kept, or none lies between.
bool FlatnessBound::Halve(int number, int direction) {
  if (nodes_[number].first_half >= 0) return true;
  if (nodes_.size() + 2 > most_nodes_) return false;
  const Node& node = nodes_[number];
  const double middle = node.lower[direction] / 2 + node.upper[direction] / 2;
  if (!(node.lower[direction] < middle && middle < node.upper[direction])) return false;
  Eigen::Matrix4Xd left = node.points, right = node.points;
  const int n = direction == 0 ? p_ : q_, stride = direction == 0 ? q_ + 1 : 1;
  const int lines = direction == 0 ? q_ + 1 : p_ + 1, next = direction == 0 ? 1 : q_ + 1;
  for (int line = 0; line < lines; ++line) {
    const int first = line * next;
    for (int step = 1; step <= n; ++step) {
      left.col(first + (step - 1) * stride) = right.col(first);
      for (int k = 0; k <= n - step; ++k) {
        right.col(first + k * stride) =
            (right.col(first + k * stride) + right.col(first + (k + 1) * stride)) / 2;
      }
    }
    left.col(first + n * stride) = right.col(first);
  }
  Eigen::Array2d below = node.upper, above = node.lower;
  below[direction] = above[direction] = middle;
  Node first = NodeOf(node.lower, below, std::move(left));
  Node second = NodeOf(above, node.upper, std::move(right));
  nodes_[number].first_half = static_cast<int>(nodes_.size());
  nodes_.push_back(std::move(first));
  nodes_.push_back(std::move(second));
  return true;
}

void FlatnessBound::Cover(const Eigen::Array2d& lower, const Eigen::Array2d& upper) {
  const auto [first_u, last_u] = CellsOf(breaks_u_, lower[0], upper[0]);
  const auto [first_v, last_v] = CellsOf(breaks_v_, lower[1], upper[1]);
  const int columns = static_cast<int>(breaks_v_.size()) - 1;
  cover_.clear();
  for (int i = first_u; i < last_u; ++i) {
    for (int j = first_v; j < last_v; ++j) cover_.push_back(i * columns + j);
  }
}

FlatnessBound::Result FlatnessBound::BoundOver(const std::array<Eigen::Vector2d, 3>& corners,
                                               const Eigen::Array2d& size,
                                               const Eigen::Vector4d& plane) const {
  constexpr double kFar = std::numeric_limits<double>::infinity();
  std::array<Range, 3> ranges{Range{kFar, -kFar}, Range{kFar, -kFar}, Range{kFar, -kFar}};
  double weight = kFar;
  for (const int number : cover_) {
    const Node& node = nodes_[number];
    weight = std::min(weight, node.least_weight);
    for (std::size_t k = 0; k < 3; ++k) {
      for (Eigen::Index c = 0; c < node.seconds[k].cols(); ++c) {
        const double value = plane.dot(node.seconds[k].col(c));
        ranges[k] = {std::min(ranges[k].low, value), std::max(ranges[k].high, value)};
      }
    }
  }
  std::array<double, 3> middle{}, half{};
  for (std::size_t k = 0; k < 3; ++k) {
    if (ranges[k].low > ranges[k].high) continue;  // a direction of degree 1
    middle[k] = ranges[k].low / 2 + ranges[k].high / 2;
    half[k] = ranges[k].high / 2 - ranges[k].low / 2;
  }
  // Exact for the middles of the ranges; what second derivatives may differ from those counts
  // with the variances of the corners' u and v, at most a quarter of their squared ranges.
  Result result{};
  std::array<double, 3> along;
  for (int e = 0; e < 3; ++e) {
    const Eigen::Vector2d d = corners[(e + 2) % 3] - corners[(e + 1) % 3];
    const double uu = d[0] * d[0], uv = 2 * d[0] * d[1], vv = d[1] * d[1];
    along[e] = (middle[0] * uu + middle[1] * uv + middle[2] * vv) / weight;
    result.bends[e] = std::abs(along[e]) / 8 +
                      (half[0] * uu + half[1] * std::abs(uv) + half[2] * vv) / 8 / weight;
  }
  result.distance =
      GreatestOf(along) + (half[0] * size[0] * size[0] + 2 * half[1] * size[0] * size[1] +
                           half[2] * size[1] * size[1]) /
                              8 / weight;
  return result;
}

FlatnessBound::Result FlatnessBound::Over(const std::array<Eigen::Vector2d, 3>& corners,
                                          const Eigen::Vector3d& normal,
                                          double offset,
                                          double enough) {
  const Eigen::Vector4d plane(normal[0], normal[1], normal[2], -offset);
  const Eigen::Array2d lower = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
  const Eigen::Array2d upper = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
  const Eigen::Array2d size = upper - lower;
  Cover(lower, upper);
  for (;;) {
    const Result result = BoundOver(corners, size, plane);
    if (result.distance <= enough) return result;
    bool any = false;
    finer_.clear();
    for (const int number : cover_) {
      const Eigen::Array2d ratio = (nodes_[number].upper - nodes_[number].lower) /
                                   size.max(std::numeric_limits<double>::min());
      // A direction in which the triangle has no size is not halved for ever.
      const bool by_v = size[1] > 0 && (!(size[0] > 0) || ratio[1] > ratio[0]);
      const int direction = by_v ? 1 : 0;
      // Halves made before may be across the other direction: those are as good.
      const bool large = ratio[direction] > 1 && size[direction] > 0;
      if (!large || !Halve(number, direction)) {
        finer_.push_back(number);
        continue;
      }
      any = true;
      const int first = nodes_[number].first_half;
      for (const int half : {first, first + 1}) {
        const Node& node = nodes_[half];
        const bool beside =
            ((node.upper <= lower && lower < upper) || (node.lower >= upper && lower < upper))
                .any();
        if (!beside) finer_.push_back(half);
      }
    }
    if (!any) return result;
    std::swap(cover_, finer_);
  }
}

}  // namespace batten
