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
  Refinement(const RingPlaces& coarse, const RingPlaces& fine, bool corner)
      : coarse_(coarse), rows_(Eigen::MatrixXd::Zero(fine.size(), coarse.size())) {
    AddCentre(corner);
    for (int k = 0; k < coarse.valence; ++k) {
      for (int i = 1; i <= fine.rings; ++i) {
        for (int j = 0; j <= fine.rings; ++j) {
          if (coarse.open && k == 0 && j == 0) {
            AddOnCrease(fine.At(k, i, j), k, i);
          } else {
            AddVertex(fine.At(k, i, j), k, i, j);
          }
        }
      }
    }
    for (int i = 1; coarse.open && i <= fine.rings; ++i) {
      AddOnCrease(fine.At(coarse.valence, i, 0), coarse.valence, i);
    }
  }
  Eigen::MatrixXd rows() && { return std::move(rows_); }

 private:
  void AddCentre(bool corner) {
    const int n = coarse_.valence;
    if (coarse_.open) {
      rows_(0, 0) = corner ? 1 : 0.75;
      if (corner) return;
      rows_(0, coarse_.At(0, 1, 0)) += 0.125;
      rows_(0, coarse_.At(n, 1, 0)) += 0.125;
      return;
    }
    rows_(0, 0) = (n - 2.0) / n;
    for (int k = 0; k < n; ++k) {
      const double share = 1.0 / (double(n) * n);
      rows_(0, coarse_.At(k, 1, 0)) += share;
      AddFace(0, k, 0, 0, share);
    }
  }

  // A cubic spline's own points.
  void AddOnCrease(int row, int k, int i) {
    const int a = i / 2;
    if (i % 2 == 1) {
      rows_(row, coarse_.At(k, a, 0)) += 0.5;
      rows_(row, coarse_.At(k, a + 1, 0)) += 0.5;
      return;
    }
    rows_(row, coarse_.At(k, a, 0)) += 0.75;
    rows_(row, coarse_.At(k, a - 1, 0)) += 0.125;
    rows_(row, coarse_.At(k, a + 1, 0)) += 0.125;
  }

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

ExtraordinaryRing::ExtraordinaryRing(const RingKind& kind)
    : coarse_{kind.sectors, 2, kind.open}, fine_{kind.sectors, 3, kind.open} {
  if (!kind.open && kind.sectors < 3)
    Reject("ExtraordinaryRing", "a vertex has three edges or more");
  const Eigen::MatrixXd step = Refinement(coarse_, fine_, kind.corner).rows();
  // Of the finer net the two inner rings, which are refined again.
  Eigen::MatrixXd inner(coarse_.size(), coarse_.size());
  inner.row(0) = step.row(0);
  for (int i = 1; i <= 2; ++i) {
    for (int k = 0; k < kind.sectors; ++k) {
      for (int j = 0; j <= 2; ++j) inner.row(coarse_.At(k, i, j)) = step.row(fine_.At(k, i, j));
    }
    if (!kind.open) continue;
    inner.row(coarse_.At(kind.sectors, i, 0)) = step.row(fine_.At(kind.sectors, i, 0));
  }
  refined_.resize(kFinest + 1);
  refined_[1] = step;
  for (int level = 2; level <= kFinest; ++level) refined_[level] = refined_[level - 1] * inner;
}

const ExtraordinaryRing& ExtraordinaryRing::Of(const RingKind& kind) {
  static std::mutex mutex;
  static std::map<RingKind, std::unique_ptr<const ExtraordinaryRing>> rings;
  const std::lock_guard<std::mutex> lock(mutex);
  auto& ring = rings[kind];
  if (!ring) ring = std::make_unique<const ExtraordinaryRing>(kind);
  return *ring;
}

ExtraordinaryRing::Piece ExtraordinaryRing::PieceAt(double u, double v, int sector) const {
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
    for (int j = 0; j < 4; ++j) piece.places[4 * i + j] = fine_.At(sector, a + i - 1, b + j - 1);
  }
  piece.beyond.down = fine_.open && sector == 0 && b == 0;
  piece.beyond.left = fine_.open && sector == fine_.valence - 1 && a == 0;
  return piece;
}

Eigen::MatrixXd ExtraordinaryRing::Rows(const Piece& piece) const {
  const Eigen::MatrixXd& refined = refined_[piece.level];
  Eigen::MatrixXd rows(16, refined.cols());
  for (int k = 0; k < 16; ++k) {
    if (piece.places[k] >= 0) rows.row(k) = refined.row(piece.places[k]);
  }
  piece.beyond.Fill([&](int k) { return rows.row(k); });
  return rows;
}

}  // namespace batten::internal
