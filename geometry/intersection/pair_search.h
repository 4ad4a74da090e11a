// SPDX-License-Identifier: MIT
// All branches in which two surfaces meet, found by subdivision. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <map>
#include <memory>
#include <set>
#include <utility>
#include <vector>

#include "batten/geometry/foot_point.h"
#include "geometry/intersection/branch_tracer.h"
#include "geometry/intersection/patch_tree.h"

namespace batten::internal {

// A part of the first surface that is everywhere within the tolerance of the second.
struct ContactPatch {
  ParameterBox box;
  int patch_a, patch_b;  // a pair in which it was seen
};

struct FoundMeets {
  std::vector<TracedBranch> branches;
  std::vector<MeetPoint> corners;  // places where they meet and no branch goes on
  std::vector<ContactPatch> contacts;
};

// Pairs of patches are halved until they
//  (1) are separated (Separated),
//  (2) or have normal cones that share no line: then a branch between them has no loop and is
//      monotone along the cross product of the cones' axes [Sederberg & Meyers 1988], and Newton's
//      method finds a place of it inside both patches; a branch through it is traced unless it is.
//      At a border of a smooth box the branch must be monotone across it too, so that it can't
//      leave and come back, or run along it, unless the patches are flat to a quarter of the
//      tolerance,
//  (3) or the first lies all over within the tolerance of the second, by samples, or both are flat
//      and alike to the tolerance: a contact,
//  (4) or are smaller than the tolerance.
// Throws std::invalid_argument naming a place where more than kMostMeetPairs pairs are looked at.
class PairSearch {
 public:
  static constexpr std::int64_t kMostMeetPairs = 3'000'000;

  // The trees are of the surfaces moved by −origin, and so is the second one.
  PairSearch(PatchTree& a, PatchTree& b, NurbsSurface moved_b, double tolerance);
  FoundMeets Run();

  // The foot points on the second surface; none where no contact was looked for.
  const SurfaceFootPoints* feet() const { return feet_b_.get(); }

 private:
  using Pair = std::pair<int, int>;

  void Compare(const Pair& pair);
  bool Decided(const Pair& pair);
  void FindInSmall(const Pair& pair);
  void Found(const PairContact& contact, const Pair& pair, const Eigen::Vector4d& at);
  bool MeetsBordersOnce(const PatchTree& tree,
                        int patch,
                        const Pair& pair,
                        const Eigen::Vector3d& tangent,
                        double turn) const;
  std::array<double, 4> BoxesOf(const Pair& pair) const;
  bool Known(const Pair& pair, const MeetPoint& place) const;
  bool Coincides(const Pair& pair);
  void Subdivide(const Pair& pair);
  PairContact ContactOf(const Pair& pair) const;
  std::vector<Pair> RootPairs() const;

  PatchTree &a_, &b_;
  NurbsSurface moved_b_;
  double tolerance_;
  std::unique_ptr<SurfaceFootPoints> feet_b_;
  std::vector<Pair> pairs_;
  std::set<int> coincides_;  // patches of the first surface
  std::map<std::array<double, 4>, std::vector<std::size_t>> by_boxes_;  // branches of smooth boxes
  std::int64_t seen_ = 0;
  FoundMeets found_;
};

}  // namespace batten::internal
