// SPDX-License-Identifier: MIT
#include "geometry/subdivision/extraordinary_ring.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <memory>
#include <mutex>

#include "geometry/numeric/reject.h"

namespace batten::internal {
namespace {

// Rows of a refined net from a coarse one of the same vertex. [Catmull & Clark 1978]
class Refinement {
 public:
  Refinement(const RingPlaces& coarse, const RingPlaces& fine)
      : coarse_(coarse), rows_(Eigen::MatrixXd::Zero(fine.size(), coarse.size())) {
    const int n = coarse.valence;
    rows_(0, 0) = (n - 2.0) / n;
    for (int k = 0; k < n; ++k) {
      const double share = 1.0 / (double(n) * n);
      rows_(0, coarse.At(k, 1, 0)) += share;
      AddFace(0, k, 0, 0, share);
      for (int i = 1; i <= fine.rings; ++i) {
        for (int j = 0; j <= fine.rings; ++j) AddVertex(fine.At(k, i, j), k, i, j);
      }
    }
  }
  Eigen::MatrixXd rows() && { return std::move(rows_); }

 private:
  // The face whose lowest corner is (i, j), which may lie across an edge of the sector.
  void AddFace(int row, int k, int i, int j, double factor) {
    for (int a = 0; a < 2; ++a) {
      for (int b = 0; b < 2; ++b) rows_(row, coarse_.At(k, i + a, j + b)) += factor / 4;
    }
  }

  void AddVertex(int row, int k, int i, int j) {
    const int a = i / 2, b = j / 2;
    if (i % 2 == 1 && j % 2 == 1) return AddFace(row, k, a, b, 1.0);
    if (i % 2 == 1) return AddEdge(row, k, a, b, a + 1, b, a, b - 1, a, b);
    if (j % 2 == 1) return AddEdge(row, k, a, b, a, b + 1, a - 1, b, a, b);
    constexpr double kShare = 1.0 / 16;
    rows_(row, coarse_.At(k, a, b)) += 0.5;
    for (const auto& [p, q] : {std::pair{1, 0}, {0, 1}, {-1, 0}, {0, -1}}) {
      rows_(row, coarse_.At(k, a + p, b + q)) += kShare;
    }
    for (const int p : {-1, 0}) {
      for (const int q : {-1, 0}) AddFace(row, k, a + p, b + q, kShare);
    }
  }

  void AddEdge(int row, int k, int i, int j, int i2, int j2, int f, int g, int f2, int g2) {
    rows_(row, coarse_.At(k, i, j)) += 0.25;
    rows_(row, coarse_.At(k, i2, j2)) += 0.25;
    AddFace(row, k, f, g, 0.25);
    AddFace(row, k, f2, g2, 0.25);
  }

  const RingPlaces& coarse_;
  Eigen::MatrixXd rows_;
};

}  // namespace

CubicWeights UniformCubic(double t) {
  const double s = 1 - t;
  return {{s * s * s / 6,
           (3 * t * t * t - 6 * t * t + 4) / 6,
           (3 * s * s * s - 6 * s * s + 4) / 6,
           t * t * t / 6},
          {-s * s / 2, (3 * t * t - 4 * t) / 2, -(3 * s * s - 4 * s) / 2, t * t / 2},
          {s, 3 * t - 2, 3 * s - 2, t}};
}

ExtraordinaryRing::ExtraordinaryRing(int valence) : coarse_{valence, 2}, fine_{valence, 3} {
  if (valence < 3) Reject("ExtraordinaryRing", "a vertex has three edges or more");
  const Eigen::MatrixXd step = Refinement(coarse_, fine_).rows();
  // Of the finer net the two inner rings, which are refined again.
  Eigen::MatrixXd inner(coarse_.size(), coarse_.size());
  inner.row(0) = step.row(0);
  for (int k = 0; k < valence; ++k) {
    for (int i = 1; i <= 2; ++i) {
      for (int j = 0; j <= 2; ++j) inner.row(coarse_.At(k, i, j)) = step.row(fine_.At(k, i, j));
    }
  }
  refined_.resize(kFinest + 1);
  refined_[1] = step;
  for (int level = 2; level <= kFinest; ++level) refined_[level] = refined_[level - 1] * inner;
}

const ExtraordinaryRing& ExtraordinaryRing::Of(int valence) {
  static std::mutex mutex;
  static std::map<int, std::unique_ptr<const ExtraordinaryRing>> rings;
  const std::lock_guard<std::mutex> lock(mutex);
  auto& ring = rings[valence];
  if (!ring) ring = std::make_unique<const ExtraordinaryRing>(valence);
  return *ring;
}

ExtraordinaryRing::Piece ExtraordinaryRing::PieceAt(double u, double v) const {
  const double nearest = std::ldexp(1.0, -kFinest);
  if (std::max(u, v) < nearest) {
    const double farther = std::max(u, v) > 0 ? nearest / std::max(u, v) : 0.0;
    u = farther > 0 ? u * farther : nearest;
    v = farther > 0 ? v * farther : nearest;
  }
  Piece piece{};
  piece.level = std::clamp(-std::ilogb(std::max(u, v)), 1, kFinest);
  piece.scale = std::ldexp(1.0, piece.level);
  piece.u = u * piece.scale;
  piece.v = v * piece.scale;
  const int a = piece.u >= 1, b = piece.v >= 1;
  piece.u -= a;
  piece.v -= b;
  for (int i = 0; i < 4; ++i) {
    for (int j = 0; j < 4; ++j) piece.places[4 * i + j] = fine_.At(0, a + i - 1, b + j - 1);
  }
  return piece;
}

Eigen::VectorXd ExtraordinaryRing::LimitPoint() const {
  const int n = coarse_.valence;
  Eigen::VectorXd weights = Eigen::VectorXd::Zero(coarse_.size());
  const double share = 1.0 / (n * (n + 5.0));
  weights[0] = n / (n + 5.0);
  for (int k = 0; k < n; ++k) {
    weights[coarse_.At(k, 1, 0)] = 4 * share;
    weights[coarse_.At(k, 1, 1)] = share;
  }
  return weights;
}

}  // namespace batten::internal
