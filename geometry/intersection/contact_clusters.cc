// SPDX-License-Identifier: MIT
#include "geometry/intersection/contact_clusters.h"

#include <algorithm>
#include <cmath>
#include <numeric>
#include <optional>

namespace batten::internal {
namespace {

// Numbers of contacts whose boxes touch, cluster by cluster. O(n log n + pairs beside each other).
std::vector<std::vector<int>> ClustersOf(const std::vector<ContactPatch>& contacts) {
  std::vector<int> order(contacts.size()), leader(contacts.size());
  std::iota(order.begin(), order.end(), 0);
  std::iota(leader.begin(), leader.end(), 0);
  std::sort(order.begin(), order.end(), [&](int x, int y) {
    return contacts[x].box.u0 < contacts[y].box.u0;
  });
  const auto root = [&](int k) {
    while (leader[k] != k) k = leader[k] = leader[leader[k]];
    return k;
  };
  std::vector<int> active;
  for (const int k : order) {
    const ParameterBox& box = contacts[k].box;
    std::erase_if(active, [&](int other) { return contacts[other].box.u1 < box.u0; });
    for (const int other : active) {
      const ParameterBox& beside = contacts[other].box;
      if (beside.v0 <= box.v1 && box.v0 <= beside.v1) leader[root(k)] = root(other);
    }
    active.push_back(k);
  }
  std::vector<std::vector<int>> clusters(contacts.size());
  for (std::size_t k = 0; k < contacts.size(); ++k) {
    clusters[root(static_cast<int>(k))].push_back(static_cast<int>(k));
  }
  std::erase_if(clusters, [](const std::vector<int>& cluster) { return cluster.empty(); });
  return clusters;
}

class ContactReader {
 public:
  ContactReader(const PatchTree& a,
                const PatchTree& b,
                const SurfaceFootPoints& feet_b,
                const FoundMeets& found,
                double tolerance)
      : a_(a),
        b_(b),
        feet_b_(feet_b),
        found_(found),
        tolerance_(tolerance),
        reach_(8 * std::sqrt(tolerance * std::min(a.size(), b.size()))) {}

  ContactResult Read() {
    for (const std::vector<int>& cluster : ClustersOf(found_.contacts)) {
      Eigen::AlignedBox3d box;
      for (const int k : cluster) box.extend(a_[found_.contacts[k].patch_a].bounds);
      if (box.diagonal().norm() <= reach_) {
        AddTouch(cluster);
      } else {
        ReadExtended(cluster);
      }
    }
    return std::move(result_);
  }

 private:
  PairContact TouchingIn(const ContactPatch& patch) const {
    return PairContact(a_,
                       a_.SmoothBoxOf(patch.patch_a),
                       b_,
                       b_.SmoothBoxOf(patch.patch_b),
                       MeetKind::kTouching,
                       tolerance_);
  }

  // The middle of the first patch and its foot on the second surface, kept in the smooth boxes.
  Eigen::Vector4d StartIn(const ContactPatch& patch, const PairContact& contact) const {
    Eigen::Vector4d at;
    const double u = patch.box.u0 / 2 + patch.box.u1 / 2, v = patch.box.v0 / 2 + patch.box.v1 / 2;
    const Eigen::Vector3d point = a_.JetAt(a_.SmoothBoxOf(patch.patch_a), u, v).point;
    const SurfaceFoot foot = feet_b_.Nearest(point);
    at << u, v, foot.u, foot.v;
    return at.cwiseMax(contact.lower()).cwiseMin(contact.upper());
  }

  bool PassedBy(const std::vector<TracedBranch>& branches,
                const MeetPoint& place,
                double reach) const {
    return std::any_of(branches.begin(), branches.end(), [&](const TracedBranch& branch) {
      return branch.Passes(place, reach);
    });
  }

  void AddTouch(const std::vector<int>& cluster) {
    std::optional<MeetPoint> best;
    double least = kNowhere;
    for (const int k : cluster) {
      const PairContact contact = TouchingIn(found_.contacts[k]);
      const Eigen::Vector4d start = StartIn(found_.contacts[k], contact);
      const auto settled = contact.Nearest(start);
      const bool good = settled && contact.Inside(contact.OntoBorders(*settled));
      const Eigen::Vector4d at = good ? contact.OntoBorders(*settled) : start;
      // A settled place counts as nearer than any that is not.
      const double gap = (contact.First(at) - contact.Second(at)).norm() - (good ? tolerance_ : 0);
      if (gap >= least) continue;
      least = gap;
      best = contact.PointAt(at);
      if (good) break;
    }
    if (!best || least > tolerance_) return;
    best->regular = false;
    const bool passed = PassedBy(found_.branches, *best, reach_);
    const bool known =
        std::any_of(result_.touches.begin(), result_.touches.end(), [&](const SurfaceTouch& other) {
          return (other.point - best->point).norm() <= reach_;
        });
    if (known) return;
    // Where branches pass but no parallel normals are found they only come near to touching.
    if (passed && best->sine > kParallel) return;
    result_.touches.push_back({best->point, best->at.head<2>(), best->at.tail<2>(), passed});
  }

  void ReadExtended(const std::vector<int>& cluster) {
    // What is left when all branches are traced.
    struct Left {
      int contact;
      MeetPoint place;
    };
    std::vector<Left> left;
    const auto passed = [&](const Left& one) {
      const double reach = a_[found_.contacts[one.contact].patch_a].size() + reach_;
      return PassedBy(result_.branches, one.place, reach) ||
             PassedBy(found_.branches, one.place, reach);
    };
    for (const int k : cluster) {
      const PairContact contact = TouchingIn(found_.contacts[k]);
      const Eigen::Vector4d start = StartIn(found_.contacts[k], contact);
      if ((contact.First(start) - contact.Second(start)).norm() > 2 * tolerance_) continue;
      Left one{k, contact.PointAt(start)};
      one.place.regular = false;
      if (!passed(one) && !Traced(contact, start)) left.push_back(one);
    }
    std::erase_if(left, passed);
    std::optional<SurfaceOverlap> overlap;
    for (const Left& one : left) {
      const ContactPatch& patch = found_.contacts[one.contact];
      const MeetPoint& place = one.place;
      const Eigen::Vector4d& at = place.at;
      if (!overlap)
        overlap = {{at[0], at[0], at[1], at[1]}, {at[2], at[2], at[3], at[3]}, place.point};
      Widen(overlap->first, patch.box.u0, patch.box.v0);
      Widen(overlap->first, patch.box.u1, patch.box.v1);
      for (const double s : {patch.box.u0, patch.box.u1}) {
        for (const double t : {patch.box.v0, patch.box.v1}) {
          const SurfaceFoot foot =
              feet_b_.Nearest(a_.JetAt(a_.SmoothBoxOf(patch.patch_a), s, t).point);
          Widen(overlap->second, foot.u, foot.v);
        }
      }
    }
    if (overlap) result_.overlaps.push_back(*overlap);
  }

  static void Widen(ParameterBox& box, double u, double v) {
    box = {std::min(box.u0, u), std::max(box.u1, u), std::min(box.v0, v), std::max(box.v1, v)};
  }

  bool Traced(const PairContact& contact, const Eigen::Vector4d& start) {
    const auto at = contact.Nearest(start);
    if (!at || !contact.Inside(contact.OntoBorders(*at)) || contact.Coincident(*at)) return false;
    TracedBranch branch = TraceBranch(contact, *at);
    double length = 0;
    for (std::size_t k = 1; k < branch.stations.size(); ++k) {
      length += (branch.stations[k].point - branch.stations[k - 1].point).norm();
    }
    if (length <= reach_) return false;
    result_.branches.push_back(std::move(branch));
    return true;
  }

  static constexpr double kNowhere = 1e300;
  static constexpr double kParallel = 1e-3;  // radians: normals of a touch

  const PatchTree &a_, &b_;
  const SurfaceFootPoints& feet_b_;
  const FoundMeets& found_;
  double tolerance_, reach_;
  ContactResult result_;
};

}  // namespace

ContactResult ExplainContacts(const PatchTree& a,
                              const PatchTree& b,
                              const SurfaceFootPoints& feet_b,
                              const FoundMeets& found,
                              double tolerance) {
  return ContactReader(a, b, feet_b, found, tolerance).Read();
}

}  // namespace batten::internal
