// SPDX-License-Identifier: MIT
// The neighbourhood of a vertex with n ≥ 3 edges, as a net of its own.
#pragma once

#include <Eigen/Core>
#include <array>
#include <compare>
#include <vector>

namespace batten::internal {

// The places of a net of R rings about a vertex: sector k = 0 … n − 1 holds the vertices (i, j),
// 0 ≤ i, j ≤ R, i along edge k and j along edge k + 1, counter-clockwise. Place 0 is the vertex. An
// open one lies between creases, its edges 0 and n.
struct RingPlaces {
  int valence, rings;
  bool open = false;

  int size() const { return 1 + valence * rings * (rings + 1) + (open ? rings : 0); }

  // Of vertex (i, j) of sector k, modulo n where all goes round; one coordinate may be negative and
  // is then in the sector beside. −1: beyond a crease.
  int At(int k, int i, int j) const {
    if (i < 0) return open && k == valence - 1 ? -1 : At(k + 1, j, -i);
    if (j < 0) return open && k == 0 ? -1 : At(k - 1, -j, i);
    if (i == 0) return j == 0 ? 0 : At(k + 1, j, 0);
    if (open && k == valence) return 1 + valence * rings * (rings + 1) + i - 1;
    const int sector = ((k % valence) + valence) % valence;
    return 1 + (sector * rings + i - 1) * (rings + 1) + j;
  }
};

// Rows and columns of a net of 4 × 4 points, 4i + j, that lie beyond creases. Each is as far beyond
// the next one as that is from the one after it, so that the spline's border is the crease's own
// and all of it what the rules of creases make.
struct NetBorders {
  bool left = false, down = false, right = false, up = false;  // i = 0, j = 0, i = 3, j = 3

  // point(k): a reference to the one of that index.
  template <typename Point>
  void Fill(Point point) const {
    for (int k = 0; k < 4; ++k) {
      if (left) point(k) = 2 * point(4 + k) - point(8 + k);
      if (right) point(12 + k) = 2 * point(8 + k) - point(4 + k);
    }
    for (int k = 0; k < 16; k += 4) {
      if (down) point(k) = 2 * point(k + 1) - point(k + 2);
      if (up) point(k + 3) = 2 * point(k + 2) - point(k + 1);
    }
  }
};

// The weights of a uniform cubic B-spline's four control points at t in [0, 1], and of its first
// and second derivative.
struct CubicWeights {
  std::array<double, 4> value, first, second;
};
CubicWeights UniformCubic(double t);

// What the rules of a vertex depend on.
struct RingKind {
  int sectors = 4;
  bool open = false, corner = false;  // as a QuadFan's

  auto operator<=>(const RingKind&) const = default;
};

// Exact evaluation in a sector of a vertex: near it the surface is a uniform bicubic of a net that
// has been refined often enough. [Stam 1998, with matrices multiplied out instead of eigenvectors]
class ExtraordinaryRing {
 public:
  static constexpr int kFinest = 20;  // levels: nearer than 2^-20 is as near as evaluation goes

  explicit ExtraordinaryRing(const RingKind& kind);

  // The one of a kind; made when first asked for, from any thread.
  static const ExtraordinaryRing& Of(const RingKind& kind);

  const RingPlaces& coarse() const { return coarse_; }  // two rings: the net given
  const RingPlaces& fine() const { return fine_; }      // three rings: a refined net

  // The net refined `level` = 1 … kFinest times, of three rings, from that of two.
  const Eigen::MatrixXd& Refined(int level) const { return refined_[level]; }

  // The bicubic piece that holds the parameters (u, v) of a sector, in [0,1]².
  struct Piece {
    int level;                   // of the refined net
    std::array<int, 16> places;  // in it: 4 × 4, along v fastest; −1 beyond borders
    NetBorders beyond;
    double u, v;   // in the piece
    double scale;  // d(piece's parameter) / d(u), a power of two
  };
  Piece PieceAt(double u, double v, int sector) const;
  // Its points (16 rows) as combinations of the net given.
  Eigen::MatrixXd Rows(const Piece& piece) const;

 private:
  RingPlaces coarse_, fine_;
  std::vector<Eigen::MatrixXd> refined_;
};

}  // namespace batten::internal
