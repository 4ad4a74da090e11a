// SPDX-License-Identifier: MIT
// The neighbourhood of a vertex with n ≥ 3 edges, as a net of its own.
#pragma once

#include <Eigen/Core>
#include <array>
#include <vector>

namespace batten::internal {

// The places of a net of R rings about a vertex: sector k = 0 … n − 1 holds the vertices (i, j),
// 0 ≤ i, j ≤ R, i along edge k and j along edge k + 1, counter-clockwise. Place 0 is the vertex.
struct RingPlaces {
  int valence, rings;

  int size() const { return 1 + valence * rings * (rings + 1); }

  // Of vertex (i, j) of sector k modulo n; one coordinate may be negative and is then in the sector
  // beside.
  int At(int k, int i, int j) const {
    if (i < 0) return At(k + 1, j, -i);
    if (j < 0) return At(k - 1, -j, i);
    if (i == 0) return j == 0 ? 0 : At(k + 1, j, 0);
    const int sector = ((k % valence) + valence) % valence;
    return 1 + (sector * rings + i - 1) * (rings + 1) + j;
  }
};

// The weights of a uniform cubic B-spline's four control points at t in [0, 1], and of its first
// and second derivative.
struct CubicWeights {
  std::array<double, 4> value, first, second;
};
CubicWeights UniformCubic(double t);

// Exact evaluation in sector 0 of a vertex: near it the surface is a uniform bicubic of a net that
// has been refined often enough. [Stam 1998, with matrices multiplied out instead of eigenvectors]
class ExtraordinaryRing {
 public:
  static constexpr int kFinest = 20;  // levels: nearer than 2^-20 is as near as evaluation goes

  explicit ExtraordinaryRing(int valence);

  // The one of a valence; made when first asked for, from any thread.
  static const ExtraordinaryRing& Of(int valence);

  const RingPlaces& coarse() const { return coarse_; }  // two rings: the net given
  const RingPlaces& fine() const { return fine_; }      // three rings: a refined net

  // The net refined `level` = 1 … kFinest times, of three rings, from that of two.
  const Eigen::MatrixXd& Refined(int level) const { return refined_[level]; }

  // The bicubic piece that holds the parameters (u, v) of sector 0, in [0,1]².
  struct Piece {
    int level;                   // of the refined net
    std::array<int, 16> places;  // in it: 4 × 4, along v fastest
    double u, v;                 // in the piece
    double scale;                // d(piece's parameter) / d(u), a power of two
  };
  Piece PieceAt(double u, double v) const;

  // Weights of the vertex's own limit position on the net of two rings. [Halstead et al. 1993]
  Eigen::VectorXd LimitPoint() const;

 private:
  RingPlaces coarse_, fine_;
  std::vector<Eigen::MatrixXd> refined_;
};

}  // namespace batten::internal
