// SPDX-License-Identifier: MIT
#include "geometry/foot_points/foot_search.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/foot_points/distance_certificate.h"
#include "geometry/foot_points/hull_search.h"

namespace batten::internal {
namespace {

// Samples at −2/3, 0 and 2/3 in each direction of a piece.
constexpr int kSamples = 3;

double SampleAt(int k) { return 2.0 * (k - 1) / 3; }

// A query farther than this many half diagonals from the middle is pulled onto the sphere of that
// radius to look up its start.
constexpr double kLookupRadius = 1.5;

// Coefficients of squared distances looked at before hulls are: some two milliseconds.
constexpr int kFirstWork = 8000;

}  // namespace

FootSearch::FootSearch(FootTable table)
    : table_(std::move(table)), boxes_(table_.boxes), reach_(table_) {
  const int in_v = table_.degree_v() == 0 ? 1 : kSamples;
  Eigen::Matrix3Xd samples(3, Eigen::Index{table_.pieces()} * kSamples * in_v);
  Eigen::Index column = 0;
  for (int piece = 0; piece < table_.pieces(); ++piece) {
    for (int k = 0; k < kSamples * in_v; ++k) {
      const double y = in_v == 1 ? 0 : SampleAt(k % in_v);
      samples.col(column++) = Position(piece, SampleAt(k / in_v), y);
    }
  }
  samples_ = PointKdTree(samples);
}

FootPiece FootSearch::Piece(int piece) const {
  return {table_.local(piece),
          table_.degree_u(),
          table_.degree_v(),
          table_.rational,
          table_.monomial()};
}

FoundFoot FootSearch::Descend(const Eigen::Vector3d& q, int piece, double x, double y) const {
  const int cells_u = table_.u.cells(), cells_v = table_.v.cells();
  const bool round_u = table_.u.periodic(), round_v = table_.v.periodic();
  const LocalBox whole{-1, 1, -1, 1};
  int i = piece / cells_v, j = piece % cells_v;
  unsigned entered = 0;  // the side the descent came through: it does not go back
  FootPlace place{};
  const int most = 2 * (cells_u + cells_v) + 8;
  for (int hop = 0; hop <= most; ++hop) {
    unsigned open = 0;
    if (i > 0 || round_u) open |= kBelowX;
    if (i + 1 < cells_u || round_u) open |= kAboveX;
    if (j > 0 || round_v) open |= kBelowY;
    if (j + 1 < cells_v || round_v) open |= kAboveY;
    if (hop == most) open = 0;
    const int here = i * cells_v + j;
    const Eigen::Vector3d local = q - table_.centres[here];
    place = DescendInPiece(Piece(here), local.data(), x, y, whole, open & ~entered);
    if (place.leaves == 0) break;
    x = place.x;
    y = place.y;
    entered = 0;
    if (place.leaves & (kBelowX | kAboveX)) {
      const bool below = place.leaves & kBelowX;
      i = (i + (below ? cells_u - 1 : 1)) % cells_u;
      x = below ? 1 : -1;
      entered |= below ? kAboveX : kBelowX;
    }
    if (place.leaves & (kBelowY | kAboveY)) {
      const bool below = place.leaves & kBelowY;
      j = (j + (below ? cells_v - 1 : 1)) % cells_v;
      y = below ? 1 : -1;
      entered |= below ? kAboveY : kBelowY;
    }
  }
  FoundFoot found{i * cells_v + j, place.x, place.y, std::sqrt(place.squared), 0};
  Pull(place, found);
  return found;
}

void FootSearch::Pull(const FootPlace& place, FoundFoot& found) const {
  const auto counts = [](const FootAxis& axis, int cell, double at, double g) {
    if (axis.periodic()) return true;
    return !(cell == 0 && at <= -1 && g > 0) && !(cell + 1 == axis.cells() && at >= 1 && g < 0);
  };
  const int i = found.piece / table_.v.cells(), j = found.piece % table_.v.cells();
  found.gx = counts(table_.u, i, place.x, place.gu) ? place.gu : 0;
  found.gy = counts(table_.v, j, place.y, place.gv) ? place.gv : 0;
}

FoundFoot FootSearch::Look(const Eigen::Vector3d& q, int piece, double x, double y) const {
  const Eigen::Vector3d local = q - table_.centres[piece];
  const FootPlace place = LookAtPlace(Piece(piece), local.data(), x, y);
  FoundFoot found{piece, x, y, std::sqrt(place.squared), 0};
  Pull(place, found);
  found.lower_bound = BoundByReach(found);
  return found;
}

double FootSearch::BoundByReach(const FoundFoot& found) const {
  const double miss =
      reach_.Miss(found.piece, found.x, found.y, found.distance, found.gx, found.gy);
  const double squared = found.distance * found.distance;
  if (!(miss <= AcceptableFootMiss(table_, squared))) return 0;
  return std::sqrt(std::max(0.0, squared - miss));
}

Eigen::Vector3d FootSearch::Position(int piece, double x, double y) const {
  Eigen::Vector3d position;
  EvaluatePosition(Piece(piece), x, y, position.data());
  return table_.centres[piece] + position;
}

Eigen::Vector3d FootSearch::Lookup(const Eigen::Vector3d& q) const {
  const Eigen::Vector3d out = q - table_.middle;
  const double far = out.norm();
  if (!(far > kLookupRadius * table_.size)) return q;
  return table_.middle + kLookupRadius * table_.size / far * out;
}

FoundFoot FootSearch::Nearest(const Eigen::Vector3d& q, FootWorkspace& workspace) const {
  const Eigen::Vector3d lookup = Lookup(q);
  const int sample = samples_.Nearest(lookup.data());
  const int in_v = table_.degree_v() == 0 ? 1 : kSamples, each = kSamples * in_v;
  const int at = sample % each;
  return Prove(q,
               Descend(q, sample / each, SampleAt(at / in_v), in_v == 1 ? 0 : SampleAt(at % in_v)),
               workspace);
}

FoundFoot FootSearch::NearestFrom(
    const Eigen::Vector3d& q, int piece, double x, double y, FootWorkspace& workspace) const {
  return Prove(q, Descend(q, piece, x, y), workspace);
}

FoundFoot FootSearch::Prove(const Eigen::Vector3d& q,
                            const FoundFoot& start,
                            FootWorkspace& workspace) const {
  if (const double bound = BoundByReach(start); bound > 0) {
    FoundFoot found = start;
    found.lower_bound = bound;
    return found;
  }
  FoundFoot found = ProveBySquares(q, start, kFirstWork, workspace);
  if (IsCertified(table_, found)) return found;
  HullSearch hulls(table_, q, found);
  workspace.near.clear();
  boxes_.Within(q.data(), found.distance * found.distance, workspace.near);
  for (const BoundingVolumeTree::Near& near : workspace.near) hulls.Add(near.box);
  const FoundFoot nearer = hulls.Run();
  if (IsCertified(table_, nearer)) return nearer;
  // Places that are equally near along a curve need many hulls, and few squares.
  found = ProveBySquares(q, nearer, DistanceCertificate::kMostWork, workspace);
  found.lower_bound = std::max(found.lower_bound, std::min(nearer.lower_bound, found.distance));
  return found;
}

FoundFoot FootSearch::ProveBySquares(const Eigen::Vector3d& q,
                                     const FoundFoot& start,
                                     int most_work,
                                     FootWorkspace& workspace) const {
  DistanceCertificate proof(table_, q, start, workspace.arena, nullptr, most_work);
  workspace.near.clear();
  boxes_.Within(q.data(), proof.squared(), workspace.near);
  for (const BoundingVolumeTree::Near& near : workspace.near) {
    if (near.squared_distance <= proof.squared()) proof.Check(near.box, near.squared_distance);
  }
  return proof.result();
}

}  // namespace batten::internal
