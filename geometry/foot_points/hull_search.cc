// SPDX-License-Identifier: MIT
#include "geometry/foot_points/hull_search.h"

#include <Eigen/QR>
#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/bezier/bernstein_polynomial.h"
#include "geometry/foot_points/distance_certificate.h"
#include "geometry/foot_points/foot_kernels.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

// Control points looked at for one query: some ten milliseconds.
constexpr double kMostHullWork = 2e5;
constexpr double kNarrowest = 1e-13;  // of a piece: halves of less are no other places
constexpr int kMostWolfeRounds = 40;  // of Wolfe's method, which ends by itself but for rounding

}  // namespace

HullPoint::HullPoint(const Eigen::Matrix3Xd& points, double enough) {
  Eigen::Index nearest = 0;
  points.colwise().squaredNorm().minCoeff(&nearest);
  columns_[0] = static_cast<int>(nearest);
  shares_[0] = 1;
  count_ = 1;
  at_ = points.col(nearest);
  // Products of coordinates are off by so much of their sizes.
  const Eigen::Vector3d largest = points.cwiseAbs().rowwise().maxCoeff();
  for (int round = 0; round < kMostWolfeRounds; ++round) {
    const double length = at_.norm();
    if (!(length > 0)) return;
    const Eigen::Vector3d normal = at_ / length;
    Eigen::Index lowest = 0;
    const double least = (normal.transpose() * points).minCoeff(&lowest);
    bound_ = std::max(bound_, least - 8 * kEpsilon * normal.cwiseAbs().dot(largest));
    if (bound_ >= enough || least >= length * (1 - 4 * kEpsilon)) return;
    if (std::find(columns_, columns_ + count_, lowest) != columns_ + count_ || count_ == 4) return;
    columns_[count_] = static_cast<int>(lowest);
    shares_[count_++] = 0;
    if (!Project(points)) return;
  }
}

// To the point of the plane through the columns that is nearest to the origin or, where that is not
// between them, as far as they reach and on from there with fewer. Returns false where rounding
// leaves none.
bool HullPoint::Project(const Eigen::Matrix3Xd& points) {
  for (;;) {
    const Eigen::Vector3d base = points.col(columns_[0]);
    at_ = base;
    if (count_ == 1) return true;
    Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3> edges(3, count_ - 1);
    for (int k = 1; k < count_; ++k) edges.col(k - 1) = points.col(columns_[k]) - base;
    const Eigen::ColPivHouseholderQR<Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, 3>> qr(edges);
    const Eigen::VectorXd steps = qr.solve(-base);
    if (!steps.allFinite()) return false;
    double wanted[4] = {1 - steps.sum()};
    for (int k = 1; k < count_; ++k) wanted[k] = steps[k - 1];
    double along = 1;
    int first = -1;
    for (int k = 0; k < count_; ++k) {
      if (wanted[k] > 0) continue;
      const double share = shares_[k] > 0 ? shares_[k] / (shares_[k] - wanted[k]) : 0;
      if (first >= 0 && share >= along) continue;
      along = share;
      first = k;
    }
    for (int k = 0; k < count_; ++k) shares_[k] += along * (wanted[k] - shares_[k]);
    if (first < 0) {
      // Across the edges to the last digit: they may be a million times as long as it.
      const Eigen::Matrix3d q = qr.householderQ();
      const auto within = q.leftCols(qr.rank());
      for (int pass = 0; pass < 2; ++pass) at_ -= within * (within.transpose() * at_);
      return true;
    }
    Drop(first);
  }
}

void HullPoint::Drop(int k) {
  --count_;
  for (int l = k; l < count_; ++l) {
    columns_[l] = columns_[l + 1];
    shares_[l] = shares_[l + 1];
  }
}

HullSearch::HullSearch(const FootTable& table, const Eigen::Vector3d& q, const FoundFoot& start)
    : table_(table), q_(q), best_(start), left_(HUGE_VAL) {
  Eigen::AlignedBox3d all;
  for (const Eigen::AlignedBox3d& box : table.boxes) all.extend(box);
  per_extent_ = all.sizes().cwiseMax(kEpsilon * table.size).cwiseInverse();
}

void HullSearch::Add(int piece) {
  const Eigen::Vector3d local = q_ - table_.centres[static_cast<size_t>(piece)];
  Cell cell{0, piece, -1, 1, -1, 1, {}, 0, 0};
  cell.net = Eigen::Map<const Eigen::Matrix4Xd>(
      table_.bezier(piece), 4, Eigen::Index{table_.degree_u() + 1} * (table_.degree_v() + 1));
  cell.net.topRows<3>() -= local * cell.net.row(3);
  Push(std::move(cell));
}

// The distance that a cell's bound must reach to be done with it.
double HullSearch::Enough() const {
  const double squared = best_.distance * best_.distance;
  return std::sqrt(std::max(0.0, squared - AcceptableFootMiss(table_, squared)));
}

void HullSearch::Push(Cell cell) {
  const Eigen::Matrix3Xd points = cell.net.topRows<3>().array().rowwise() / cell.net.row(3).array();
  const double enough = Enough();
  const HullPoint hull(points, enough);
  cell.bound = std::max(cell.bound, hull.lower_bound());
  if (cell.bound >= enough) {
    left_ = std::min(left_, cell.bound);
    return;
  }
  const int p = table_.degree_u(), q = table_.degree_v();
  double x = 0, y = 0;
  for (int k = 0; k < hull.count(); ++k) {
    x += hull.share(k) * (p == 0 ? 0.5 : double(hull.column(k) / (q + 1)) / p);
    y += hull.share(k) * (q == 0 ? 0.5 : double(hull.column(k) % (q + 1)) / q);
  }
  cell.guess_x = cell.x0 + x * (cell.x1 - cell.x0);
  cell.guess_y = cell.y0 + y * (cell.y1 - cell.y0);
  heap_.push_back(std::move(cell));
  std::push_heap(
      heap_.begin(), heap_.end(), [](const Cell& a, const Cell& b) { return a.bound > b.bound; });
}

void HullSearch::Descend(int piece, double x, double y) {
  const FootPiece form{table_.local(piece),
                       table_.degree_u(),
                       table_.degree_v(),
                       table_.rational,
                       table_.monomial()};
  const Eigen::Vector3d local = q_ - table_.centres[static_cast<size_t>(piece)];
  const FootPlace place = DescendInPiece(form, local.data(), x, y, {-1, 1, -1, 1}, 0);
  const double distance = std::sqrt(place.squared);
  if (distance < best_.distance) best_ = {piece, place.x, place.y, distance, 0};
}

// In the direction in which the cell is longer, every axis measured by the shape's extent.
bool HullSearch::HalvesFirst(const Cell& cell) const {
  if (table_.degree_v() == 0) return true;
  const int p = table_.degree_u(), q = table_.degree_v(), w = q + 1;
  const auto at = [&](int r, int s) {
    return Eigen::Array3d(cell.net.col(r * w + s).head<3>() / cell.net(3, r * w + s));
  };
  double in_u = 0, in_v = 0;
  for (const int s : {0, q / 2, q}) {
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    for (int r = 0; r < p; ++r) sum += (at(r + 1, s) - at(r, s)).abs();
    in_u = std::max(in_u, (sum * per_extent_.array()).maxCoeff());
  }
  for (const int r : {0, p / 2, p}) {
    Eigen::Array3d sum = Eigen::Array3d::Zero();
    for (int s = 0; s < q; ++s) sum += (at(r, s + 1) - at(r, s)).abs();
    in_v = std::max(in_v, (sum * per_extent_.array()).maxCoeff());
  }
  return in_u >= in_v;
}

void HullSearch::Halve(const Cell& cell) {
  const bool first = HalvesFirst(cell);
  const double width = first ? cell.x1 - cell.x0 : cell.y1 - cell.y0;
  if (width < kNarrowest) {
    left_ = std::min(left_, cell.bound);
    return;
  }
  const int p = table_.degree_u(), q = table_.degree_v();
  const Eigen::Index numbers = cell.net.size();
  std::vector<double> memory(static_cast<size_t>(3 * (numbers + kReadPast)));
  double* const whole = memory.data();
  double* const halves[2] = {whole + numbers + kReadPast, whole + 2 * (numbers + kReadPast)};
  std::copy_n(cell.net.data(), numbers, whole);
  (first ? HalveFirst : HalveSecond)(whole, p, q, 4, halves[0], halves[1]);
  for (int half = 0; half < 2; ++half) {
    Cell part{cell.bound, cell.piece, cell.x0, cell.x1, cell.y0, cell.y1, {}, 0, 0};
    double& low = first ? part.x0 : part.y0;
    double& high = first ? part.x1 : part.y1;
    (half == 0 ? high : low) = low + (high - low) / 2;
    part.net = Eigen::Map<const Eigen::Matrix4Xd>(halves[half], 4, numbers / 4);
    Push(std::move(part));
  }
}

FoundFoot HullSearch::Run() {
  const auto later = [](const Cell& a, const Cell& b) { return a.bound > b.bound; };
  const double each = (table_.degree_u() + 1) * (table_.degree_v() + 1);
  for (double work = 0; !heap_.empty() && work < kMostHullWork; work += 2 * each) {
    if (heap_.front().bound >= Enough()) break;
    std::pop_heap(heap_.begin(), heap_.end(), later);
    const Cell cell = std::move(heap_.back());
    heap_.pop_back();
    Descend(cell.piece, cell.guess_x, cell.guess_y);
    Halve(cell);
  }
  FoundFoot found = best_;
  const double left = heap_.empty() ? left_ : std::min(left_, heap_.front().bound);
  found.lower_bound = std::min(found.distance, left);
  return found;
}

}  // namespace batten::internal
