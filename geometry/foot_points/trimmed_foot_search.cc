// SPDX-License-Identifier: MIT
#include "geometry/foot_points/trimmed_foot_search.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "geometry/foot_points/distance_certificate.h"

namespace batten::internal {

TrimmedFootSearch::TrimmedFootSearch(const NurbsSurface& surface, const FootSearch& whole)
    : whole_(whole),
      region_(surface),
      loops_(surface, whole.table().middle, whole.table().size),
      on_loops_(loops_.Table()) {
  const FootTable& table = whole_.table();
  std::vector<Eigen::AlignedBox3d> boxes;
  for (int piece = 0; piece < table.pieces(); ++piece) {
    const int i = piece / table.v.cells(), j = piece % table.v.cells();
    const TrimRegion::Cover cover =
        region_.CoverOf({table.u.low(i), table.u.high(i), table.v.low(j), table.v.high(j)});
    if (cover == TrimRegion::Cover::kOutside) continue;
    pieces_.push_back(piece);
    cut_.push_back(cover == TrimRegion::Cover::kCut);
    boxes.push_back(table.boxes[piece]);
  }
  boxes_ = BoundingVolumeTree(boxes);
  AddSamples();
}

// The middles of a piece's 3 × 3 parts, as far as they count.
void TrimmedFootSearch::AddSamples() {
  std::vector<Eigen::Vector3d> points;
  for (const int piece : pieces_) {
    for (const double x : {-2.0 / 3, 0.0, 2.0 / 3}) {
      for (const double y : {-2.0 / 3, 0.0, 2.0 / 3}) {
        if (!Counts({piece, x, y, 0, 0})) continue;
        samples_.push_back({piece, x, y});
        points.push_back(whole_.Position(piece, x, y));
      }
    }
  }
  if (points.empty()) return;
  sample_tree_ = PointKdTree(Eigen::Map<const Eigen::Matrix3Xd>(
      points[0].data(), 3, static_cast<Eigen::Index>(points.size())));
}

bool TrimmedFootSearch::Counts(const FoundFoot& found) const {
  const FootTable& table = whole_.table();
  return region_.Contains(table.u.At(found.piece / table.v.cells(), found.x),
                          table.v.At(found.piece % table.v.cells(), found.y));
}

FoundFoot TrimmedFootSearch::At(const Eigen::Vector3d& q, int piece, double x, double y) const {
  return {piece, x, y, (whole_.Position(piece, x, y) - q).norm(), 0};
}

FoundFoot TrimmedFootSearch::OnLoops(const Eigen::Vector3d& q, FootWorkspace& workspace) const {
  const FoundFoot found = on_loops_.Nearest(q, workspace);
  const FootTable& table = whole_.table();
  const Eigen::Vector2d uv = loops_.At(found.piece, found.x);
  const double u = std::clamp(uv[0], table.u.lower(), table.u.upper());
  const double v = std::clamp(uv[1], table.v.lower(), table.v.upper());
  const int i = table.u.Find(u), j = table.v.Find(v);
  FoundFoot foot = At(q, i * table.v.cells() + j, table.u.Local(i, u), table.v.Local(j, v));
  foot.lower_bound = loops_.LowerBound(q, found.lower_bound);
  return foot;
}

// The nearest sample, and downhill from it where that leads to a place that counts; the place
// known where that is nearer.
FoundFoot TrimmedFootSearch::FromSample(const Eigen::Vector3d& q, const FoundFoot& known) const {
  if (samples_.empty()) return known;
  const Eigen::Vector3d lookup = whole_.Lookup(q);
  const Eigen::Vector3d to_known = whole_.Position(known.piece, known.x, known.y) - lookup;
  const int nearest = sample_tree_.Nearest(lookup.data(), to_known.squaredNorm());
  if (nearest < 0) return known;
  const Sample& sample = samples_[nearest];
  FoundFoot foot = whole_.Descend(q, sample.piece, sample.x, sample.y);
  if (!Counts(foot)) foot = At(q, sample.piece, sample.x, sample.y);
  return foot.distance < known.distance ? foot : known;
}

FoundFoot TrimmedFootSearch::Nearest(const Eigen::Vector3d& q,
                                     const FoundFoot& untrimmed,
                                     FootWorkspace& workspace) const {
  const FoundFoot on_loops = OnLoops(q, workspace);
  FoundFoot best = FromSample(q, on_loops);
  DistanceCertificate proof(whole_.table(), q, best, workspace.arena, &region_);
  workspace.near.clear();
  boxes_.Within(q.data(), proof.squared(), workspace.near);
  for (const BoundingVolumeTree::Near& near : workspace.near) {
    if (near.squared_distance > proof.squared()) continue;
    proof.Check(pieces_[near.box], near.squared_distance, cut_[near.box]);
  }
  best = proof.result();
  best.lower_bound = std::min(best.lower_bound, on_loops.lower_bound);
  // The proof holds where loops are proved not to be nearer by what it accepts.
  const double loops_squared = on_loops.lower_bound * on_loops.lower_bound;
  if (loops_squared < proof.squared() - proof.AcceptableMiss()) best.lower_bound = 0;
  best.lower_bound = std::max(best.lower_bound, untrimmed.lower_bound);
  return best;
}

}  // namespace batten::internal
