// SPDX-License-Identifier: MIT
#include "geometry/mesh/triangle_proof.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>

#include "geometry/bezier/bezier_span.h"

namespace batten::internal {
namespace {

constexpr double kThinTriangle = 0x1p-28;
constexpr int kMostBoxes = 300;  // for a triangle or segment

// Rows of coefficients: `count` of them, `stride` apart.
struct Row {
  double* first;
  int degree, stride;

  double& operator[](int k) const { return first[k * stride]; }
};

// The polynomial on [0, 1] becomes its part on [from, to]. De Casteljau twice, all means.
void Restrict(const Row& row, double from, double to) {
  if (to < 1) {
    for (int step = 1; step <= row.degree; ++step) {
      for (int k = row.degree; k >= step; --k) row[k] = (1 - to) * row[k - 1] + to * row[k];
    }
  }
  if (from > 0) {
    const double share = to > 0 ? from / to : 0;
    for (int step = 1; step <= row.degree; ++step) {
      for (int k = 0; k <= row.degree - step; ++k) {
        row[k] = (1 - share) * row[k] + share * row[k + 1];
      }
    }
  }
}

// `row` becomes its upper half, `lower` its lower one.
void HalveRow(const Row& row, const Row& lower) {
  for (int step = 0; step <= row.degree; ++step) {
    lower[step] = row[0];
    for (int k = 0; k < row.degree - step; ++k) row[k] = (row[k] + row[k + 1]) / 2;
  }
}

double Cross(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return a[0] * b[1] - a[1] * b[0];
}

// Where a box lies against a triangle, whose bounding box it meets.
enum class Side { kBeside, kAcross, kWithin };
Side SideOf(const Eigen::Array2d& lower,
            const Eigen::Array2d& upper,
            const std::array<Eigen::Vector2d, 3>& corners) {
  const Eigen::Vector2d middle = (lower + upper).matrix() / 2;
  const Eigen::Vector2d half = (upper - lower).matrix() / 2;
  bool within = true;
  for (int e = 0; e < 3; ++e) {
    const Eigen::Vector2d along = corners[(e + 1) % 3] - corners[e];
    const double height = Cross(along, middle - corners[e]);
    const double reach = std::abs(along[0]) * half[1] + std::abs(along[1]) * half[0];
    if (height + reach <= 0 && reach > 0) return Side::kBeside;
    within = within && height >= reach;
  }
  return within ? Side::kWithin : Side::kAcross;
}

bool Holds(const std::array<Eigen::Vector2d, 3>& corners, const Eigen::Vector2d& place) {
  for (int e = 0; e < 3; ++e) {
    if (Cross(corners[(e + 1) % 3] - corners[e], place - corners[e]) < 0) return false;
  }
  return true;
}

// The place, moved into the triangle by leaving out corners that would count less than nothing.
Eigen::Vector2d Within(const std::array<Eigen::Vector2d, 3>& corners,
                       const Eigen::Vector2d& place) {
  std::array<double, 3> shares;
  double sum = 0;
  for (int e = 0; e < 3; ++e) {
    const Eigen::Vector2d &a = corners[(e + 1) % 3], &b = corners[(e + 2) % 3];
    shares[e] = std::max(Cross(b - a, place - a), 0.0);
    sum += shares[e];
  }
  if (!(sum > 0)) return (corners[0] + corners[1] + corners[2]) / 3;
  return (shares[0] * corners[0] + shares[1] * corners[1] + shares[2] * corners[2]) / sum;
}

// The Bézier points of a patch along the diagonal of its domain, or along the other one.
// S(t, t) = Σ_k B_{k,p+q}(t) Σ_{i+j=k} C(p,i) C(q,j) / C(p+q,k) P_ij.
Eigen::Matrix4Xd Diagonal(const Eigen::Matrix4Xd& points, int p, int q, bool falling) {
  Eigen::Matrix4Xd result = Eigen::Matrix4Xd::Zero(4, p + q + 1);
  Eigen::VectorXd sums = Eigen::VectorXd::Zero(p + q + 1);
  double choose_p = 1;
  for (int i = 0; i <= p; ++i) {
    double choose = choose_p;
    for (int j = 0; j <= q; ++j) {
      result.col(i + j) += choose * points.col(i * (q + 1) + (falling ? q - j : j));
      sums[i + j] += choose;
      choose *= static_cast<double>(q - j) / (j + 1);
    }
    choose_p *= static_cast<double>(p - i) / (i + 1);
  }
  return result * sums.cwiseInverse().asDiagonal();
}

// Which part of [from, to] has its coordinate in [lower, upper].
void Clip(double from, double to, double lower, double upper, double& first, double& last) {
  const double along = to - from;
  if (along == 0) return;
  const double a = (lower - from) / along, b = (upper - from) / along;
  first = std::max(first, std::min(a, b));
  last = std::min(last, std::max(a, b));
}

}  // namespace

TriangleProof::Axis::Axis(const SplineBasis& basis) {
  const double sliver = kThinTriangle * (basis.upper() - basis.lower());
  double left_out = 0;  // together, of those just before
  for (const int span : basis.Spans()) {
    const double low = basis.knots()[span], high = basis.knots()[span + 1];
    left_out += high - low;
    if (left_out <= sliver) continue;
    left_out = 0;
    spans.push_back(span);
    lower.push_back(low);
    upper.push_back(high);
    matrices.push_back(BezierSpanMatrix(basis, span));
  }
}

std::pair<int, int> TriangleProof::Axis::Meeting(double from, double to) const {
  const auto after = std::upper_bound(lower.begin(), lower.end(), from);
  int first = std::max(static_cast<int>(after - lower.begin()) - 1, 0);
  if (from < to && upper[first] <= from && first + 1 < static_cast<int>(spans.size())) ++first;
  int last = first + 1;
  while (last < static_cast<int>(spans.size()) && lower[last] < to) ++last;
  return {first, last};
}

TriangleProof::TriangleProof(const NurbsSurface& surface)
    : surface_(surface),
      p_(surface.basis_u().degree()),
      q_(surface.basis_v().degree()),
      u_(surface.basis_u()),
      v_(surface.basis_v()),
      points_(u_.spans.size() * v_.spans.size()) {
  constexpr std::size_t kMostBytes = std::size_t{1} << 28;
  const auto columns = static_cast<std::size_t>((p_ + 1) * (q_ + 1));
  kept_ = points_.size() * columns * 4 * sizeof(double) <= kMostBytes;
  ratios_.resize(columns);
}

Eigen::Matrix4Xd TriangleProof::MadePoints(int cell_u, int cell_v) const {
  const Eigen::MatrixXd &to_u = u_.matrices[cell_u], &to_v = v_.matrices[cell_v];
  Eigen::Matrix4Xd points = Eigen::Matrix4Xd::Zero(4, (p_ + 1) * (q_ + 1));
  Eigen::Matrix4Xd row(4, q_ + 1);
  for (int i = 0; i <= p_; ++i) {
    for (int j = 0; j <= q_; ++j) {
      const int a = u_.spans[cell_u] - p_ + i, b = v_.spans[cell_v] - q_ + j;
      const double weight = surface_.rational() ? surface_.weights()[a * surface_.size_v() + b] : 1;
      row.col(j) << weight * surface_.control_point(a, b), weight;
    }
    row = (row * to_v.transpose()).eval();
    for (int k = 0; k <= p_; ++k) points.middleCols(k * (q_ + 1), q_ + 1) += to_u(k, i) * row;
  }
  if (!surface_.rational()) points.row(3).setOnes();
  return points;
}

const Eigen::Matrix4Xd& TriangleProof::PointsOf(int cell_u, int cell_v) {
  if (!kept_) {
    made_ = MadePoints(cell_u, cell_v);
    return made_;
  }
  Eigen::Matrix4Xd& points = points_[static_cast<std::size_t>(cell_u) * v_.spans.size() +
                                     static_cast<std::size_t>(cell_v)];
  if (points.cols() == 0) points = MadePoints(cell_u, cell_v);
  return points;
}

std::optional<Eigen::Vector2d> TriangleProof::OffPlane(const std::array<Eigen::Vector2d, 3>& given,
                                                       const Eigen::Vector3d& normal,
                                                       double offset,
                                                       double tolerance) {
  std::array<Eigen::Vector2d, 3> corners = given;
  const double area = Cross(corners[1] - corners[0], corners[2] - corners[0]);
  if (area < 0) std::swap(corners[1], corners[2]);
  if (!(area != 0)) return corners[0];
  const Eigen::Array2d lower = corners[0].cwiseMin(corners[1]).cwiseMin(corners[2]);
  const Eigen::Array2d upper = corners[0].cwiseMax(corners[1]).cwiseMax(corners[2]);
  const Eigen::RowVector4d plane(normal[0], normal[1], normal[2], -offset);
  const auto [first_u, last_u] = u_.Meeting(lower[0], upper[0]);
  const auto [first_v, last_v] = v_.Meeting(lower[1], upper[1]);
  const auto columns = static_cast<std::size_t>((p_ + 1) * (q_ + 1));
  left_ = kMostBoxes;
  for (int i = first_u; i < last_u; ++i) {
    for (int j = first_v; j < last_v; ++j) {
      const Eigen::Array2d cell_lower(u_.lower[i], v_.lower[j]);
      const Eigen::Array2d size = Eigen::Array2d(u_.upper[i], v_.upper[j]) - cell_lower;
      const Box box{lower.max(cell_lower), upper.min(cell_lower + size), 0};
      if (!(box.lower < box.upper).all() || SideOf(box.lower, box.upper, corners) == Side::kBeside)
        continue;
      boxes_.resize(2 * columns);
      const Eigen::Matrix4Xd& points = PointsOf(i, j);
      Eigen::Map<Eigen::RowVectorXd>(boxes_.data(), points.cols()) = plane * points;
      Eigen::Map<Eigen::RowVectorXd>(boxes_.data() + columns, points.cols()) = points.row(3);
      const Eigen::Array2d from = ((box.lower - cell_lower) / size).max(0);
      const Eigen::Array2d to = ((box.upper - cell_lower) / size).min(1);
      for (const std::size_t part : {std::size_t{0}, columns}) {
        if (part > 0 && !surface_.rational()) break;
        double* first = boxes_.data() + part;
        for (int k = 0; k <= q_; ++k) Restrict({first + k, p_, q_ + 1}, from[0], to[0]);
        for (int k = 0; k <= p_; ++k) Restrict({first + k * (q_ + 1), q_, 1}, from[1], to[1]);
      }
      waiting_.assign(1, box);
      if (const auto place = Search(corners, tolerance)) return place;
    }
  }
  return std::nullopt;
}

// Halves the boxes that wait until all are proven, or one is not.
std::optional<Eigen::Vector2d> TriangleProof::Search(const std::array<Eigen::Vector2d, 3>& corners,
                                                     double tolerance) {
  const int row = q_ + 1;
  const auto columns = static_cast<std::size_t>((p_ + 1) * row);
  while (!waiting_.empty()) {
    const Box box = waiting_.back();
    const double* f = boxes_.data() + box.at;
    const double* w = f + columns;
    int off = 0;
    for (std::size_t k = 0; k < columns; ++k) {
      ratios_[k] = f[k] / w[k];
      off |= !(std::abs(ratios_[k]) <= tolerance);  // what is no number is off too
    }
    const Side side = off == 0 ? Side::kBeside : SideOf(box.lower, box.upper, corners);
    if (side == Side::kBeside) {
      waiting_.pop_back();
      boxes_.resize(box.at);
      continue;
    }
    // The corners' coefficients are values of the surface.
    for (const int i : {0, p_}) {
      for (const int j : {0, q_}) {
        const Eigen::Vector2d place(i == 0 ? box.lower[0] : box.upper[0],
                                    j == 0 ? box.lower[1] : box.upper[1]);
        if (std::abs(ratios_[i * row + j]) > tolerance && Holds(corners, place)) return place;
      }
    }
    if (--left_ < 0) return Within(corners, ((box.lower + box.upper) / 2).matrix());
    // Across the direction in which there is more to gain: where values bend, and, at the sides of
    // the triangle, where they differ.
    std::array<double, 2> gains{};
    const auto differ = [&](int direction, int k, int next, bool second) {
      const double first = ratios_[k + next] - ratios_[k];
      if (side == Side::kAcross) gains[direction] = std::max(gains[direction], std::abs(first));
      if (!second) return;
      const double bend = ratios_[k + 2 * next] - ratios_[k + next] - first;
      gains[direction] = std::max(gains[direction], std::abs(bend));
    };
    for (int i = 0; i <= p_; ++i) {
      for (int j = 0; j <= q_; ++j) {
        if (i < p_) differ(0, i * row + j, row, i + 1 < p_);
        if (j < q_) differ(1, i * row + j, 1, j + 1 < q_);
      }
    }
    const int direction = gains[0] >= gains[1] ? 0 : 1;
    const double middle = (box.lower[direction] + box.upper[direction]) / 2;
    if (!(box.lower[direction] < middle && middle < box.upper[direction])) {
      return Within(corners, ((box.lower + box.upper) / 2).matrix());
    }
    Halve(box, direction);
  }
  return std::nullopt;
}

// The last box gives way to its halves.
void TriangleProof::Halve(const Box& box, int direction) {
  const auto columns = static_cast<std::size_t>((p_ + 1) * (q_ + 1));
  const std::size_t next = box.at + 2 * columns;
  boxes_.resize(next + 2 * columns);
  for (const std::size_t part : {std::size_t{0}, columns}) {
    double* upper = boxes_.data() + box.at + part;
    double* lower = boxes_.data() + next + part;
    if (part > 0 && !surface_.rational()) {
      std::fill(lower, lower + columns, 1.0);
    } else if (direction == 0) {
      for (int k = 0; k <= q_; ++k) HalveRow({upper + k, p_, q_ + 1}, {lower + k, p_, q_ + 1});
    } else {
      for (int k = 0; k <= p_; ++k) {
        HalveRow({upper + k * (q_ + 1), q_, 1}, {lower + k * (q_ + 1), q_, 1});
      }
    }
  }
  const double middle = (box.lower[direction] + box.upper[direction]) / 2;
  waiting_.back().lower[direction] = middle;
  waiting_.push_back({box.lower, box.upper, next});
  waiting_.back().upper[direction] = middle;
}

std::optional<Eigen::Vector2d> TriangleProof::OffLine(const Eigen::Vector2d& from,
                                                      const Eigen::Vector2d& to,
                                                      const Eigen::Vector3d& point,
                                                      const Eigen::Vector3d& direction,
                                                      double tolerance) {
  const Eigen::Array2d lower = from.cwiseMin(to), upper = from.cwiseMax(to);
  const auto [first_u, last_u] = u_.Meeting(lower[0], upper[0]);
  const auto [first_v, last_v] = v_.Meeting(lower[1], upper[1]);
  const bool falling = (to[0] - from[0]) * (to[1] - from[1]) < 0;
  struct Part {
    double first, last;
    Eigen::Matrix4Xd points;
  };
  int left = kMostBoxes;
  for (int i = first_u; i < last_u; ++i) {
    for (int j = first_v; j < last_v; ++j) {
      double first = 0, last = 1;
      Clip(from[0], to[0], u_.lower[i], u_.upper[i], first, last);
      Clip(from[1], to[1], v_.lower[j], v_.upper[j], first, last);
      if (!(first < last)) continue;
      const Eigen::Vector2d start = from + first * (to - from), end = from + last * (to - from);
      const Eigen::Array2d cell_lower(u_.lower[i], v_.lower[j]);
      const Eigen::Array2d size = Eigen::Array2d(u_.upper[i], v_.upper[j]) - cell_lower;
      const Eigen::Array2d a = ((start.array().min(end.array()) - cell_lower) / size).max(0).min(1);
      const Eigen::Array2d b = ((start.array().max(end.array()) - cell_lower) / size).max(0).min(1);
      Eigen::Matrix4Xd patch = PointsOf(i, j);
      for (int c = 0; c < 4; ++c) {
        double* data = patch.data() + c;
        for (int k = 0; k <= q_; ++k) Restrict({data + 4 * k, p_, 4 * (q_ + 1)}, a[0], b[0]);
        for (int k = 0; k <= p_; ++k) Restrict({data + 4 * k * (q_ + 1), q_, 4}, a[1], b[1]);
      }
      // The curve runs from the lower u to the upper one, or along v where u stays.
      const bool back = to[0] != from[0] ? to[0] < from[0] : to[1] < from[1];
      std::vector<Part> parts;
      parts.push_back({back ? last : first, back ? first : last, Diagonal(patch, p_, q_, falling)});
      while (!parts.empty()) {
        Part part = std::move(parts.back());
        parts.pop_back();
        bool near = true;
        for (Eigen::Index k = 0; k < part.points.cols(); ++k) {
          const Eigen::Vector3d off = part.points.col(k).head<3>() / part.points(3, k) - point;
          near = near && (off - direction.dot(off) * direction).norm() <= tolerance;
        }
        if (near) continue;
        const double middle = (part.first + part.last) / 2;
        const Eigen::Vector2d place = from + middle * (to - from);
        if (--left < 0) return place;
        Part other{part.first, middle, part.points};
        const int degree = static_cast<int>(part.points.cols()) - 1;
        for (int c = 0; c < 4; ++c) {
          HalveRow({part.points.data() + c, degree, 4}, {other.points.data() + c, degree, 4});
        }
        part.first = middle;
        const Eigen::Vector3d off = part.points.col(0).head<3>() / part.points(3, 0) - point;
        if ((off - direction.dot(off) * direction).norm() > tolerance) return place;
        parts.push_back(std::move(part));
        parts.push_back(std::move(other));
      }
    }
  }
  return std::nullopt;
}

}  // namespace batten::internal
