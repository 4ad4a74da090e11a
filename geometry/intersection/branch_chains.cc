// SPDX-License-Identifier: MIT
#include "geometry/intersection/branch_chains.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <utility>

#include "geometry/bezier/cubic_chain.h"

namespace batten::internal {
namespace {

std::vector<MeetPoint> TurnedRound(const std::vector<MeetPoint>& run) {
  std::vector<MeetPoint> turned;
  for (auto k = run.rbegin(); k != run.rend(); ++k) turned.push_back(k->Reversed());
  return turned;
}

// Whether a branch runs along a border: then its places on the other side of a seam are others.
bool AlongBorder(const std::vector<MeetPoint>& stations) {
  for (int i = 0; i < 4; ++i) {
    const double first = stations.front().at[i];
    if (std::all_of(stations.begin(), stations.end(), [&](const MeetPoint& place) {
          return place.at[i] == first;
        })) {
      return true;
    }
  }
  return false;
}

// Branches that another one passes along wholly: both sides of a crease give them.
void DropDoubles(std::vector<TracedBranch>& branches, double reach) {
  for (std::size_t k = branches.size(); k-- > 0;) {
    std::vector<MeetPoint> stations = branches[k].stations;
    if (AlongBorder(stations)) {
      for (MeetPoint& place : stations) place.regular = false;
    }
    const auto doubled = [&](const TracedBranch& other) {
      return &other != &branches[k] && other.kind == branches[k].kind &&
             std::all_of(stations.begin(), stations.end(), [&](const MeetPoint& place) {
               return other.Passes(place, reach);
             });
    };
    if (std::any_of(branches.begin(), branches.end(), doubled)) {
      branches.erase(branches.begin() + static_cast<std::ptrdiff_t>(k));
    }
  }
}

double LengthOfRun(const std::vector<MeetPoint>& run) {
  double length = 0;
  for (std::size_t k = 1; k < run.size(); ++k) length += (run[k].point - run[k - 1].point).norm();
  return length;
}

// The cosine of the turn from the end of one run to the start of the next.
double TurnCosine(const std::vector<MeetPoint>& run, const std::vector<MeetPoint>& next) {
  const MeetPoint &a = run.back(), &b = next.front();
  const auto direction = [](const MeetPoint& place, const Eigen::Vector3d& chord) {
    return place.regular ? place.tangent : Eigen::Vector3d(chord.normalized());
  };
  return direction(a, a.point - run[run.size() - 2].point)
      .dot(direction(b, next[1].point - b.point));
}

class ChainMaker {
 public:
  ChainMaker(std::vector<TracedBranch> branches, double reach)
      : branches_(std::move(branches)), reach_(reach), used_(branches_.size(), false) {}

  std::vector<MeetChain> Make() {
    std::vector<MeetChain> chains;
    for (std::size_t k = 0; k < branches_.size(); ++k) {
      if (used_[k]) continue;
      used_[k] = true;
      MeetChain chain{{branches_[k].stations}, branches_[k].closed, branches_[k].kind};
      if (!chain.closed) {
        Extend(chain);
        if (!chain.closed) {
          Turn(chain);
          Extend(chain);
          Turn(chain);
        }
      }
      chains.push_back(std::move(chain));
    }
    return chains;
  }

 private:
  static void Turn(MeetChain& chain) {
    std::reverse(chain.runs.begin(), chain.runs.end());
    for (std::vector<MeetPoint>& run : chain.runs) run = TurnedRound(run);
  }

  void Extend(MeetChain& chain) {
    for (;;) {
      const std::vector<MeetPoint>& end = chain.runs.back();
      constexpr double kSharpest = -0.99;
      double best = kSharpest;
      std::optional<std::pair<std::size_t, bool>> next;
      for (std::size_t k = 0; k < branches_.size(); ++k) {
        if (used_[k] || branches_[k].closed || branches_[k].kind != chain.kind) continue;
        for (const bool turned : {false, true}) {
          const std::vector<MeetPoint>& run = branches_[k].stations;
          const MeetPoint& start = turned ? run.back() : run.front();
          if ((start.point - end.back().point).norm() > reach_) continue;
          const double cosine = TurnCosine(end, turned ? TurnedRound(run) : run);
          if (cosine > best) {
            best = cosine;
            next = {k, turned};
          }
        }
      }
      const MeetPoint& home = chain.runs.front().front();
      const bool long_enough = chain.runs.size() > 1 || LengthOfRun(end) > 4 * reach_;
      if (long_enough && (home.point - end.back().point).norm() <= reach_ &&
          TurnCosine(end, chain.runs.front()) >= best) {
        chain.closed = true;
        return;
      }
      if (!next) return;
      used_[next->first] = true;
      const std::vector<MeetPoint>& run = branches_[next->first].stations;
      chain.runs.push_back(next->second ? TurnedRound(run) : run);
    }
  }

  std::vector<TracedBranch> branches_;
  double reach_;
  std::vector<bool> used_;
};

struct Joint {
  int multiplicity = 2;
  bool jumps_first = false, jumps_second = false;
};

Joint JointOf(const MeetPoint& before, const MeetPoint& after, const Eigen::Vector4d& widths) {
  constexpr double kSame = 1e-9;
  // Places of one border are the same, those across a seam a period apart.
  const auto far = [&](int first) {
    constexpr double kJump = 1e-3;
    const Eigen::Vector4d apart = (before.at - after.at).cwiseQuotient(widths);
    return apart.segment<2>(first).cwiseAbs().maxCoeff() > kJump;
  };
  Joint joint;
  joint.jumps_first = far(0);
  joint.jumps_second = far(2);
  const bool smooth = before.regular && after.regular &&
                      (before.tangent - after.tangent).norm() <= kSame &&
                      (before.velocity - after.velocity).norm() <= kSame * before.velocity.norm();
  joint.multiplicity = smooth ? 2 : 3;
  return joint;
}

}  // namespace

std::vector<MeetChain> ChainsOf(std::vector<TracedBranch> branches, double reach) {
  DropDoubles(branches, reach);
  return ChainMaker(std::move(branches), reach).Make();
}

SurfaceBranch CurvesOf(const MeetChain& chain,
                       const Eigen::Vector4d& widths,
                       const Eigen::Vector3d& origin) {
  CubicChain<3> curve;
  CubicChain<2> first, second;
  std::vector<NurbsCurve<2>> on_first, on_second;
  double from = 0;
  const MeetPoint* before = nullptr;
  for (const std::vector<MeetPoint>& run : chain.runs) {
    Joint joint;
    if (before) joint = JointOf(*before, run.front(), widths);
    if (joint.jumps_first) on_first.push_back(first.Take());
    if (joint.jumps_second) on_second.push_back(second.Take());
    for (std::size_t k = 0; k + 1 < run.size(); ++k) {
      MeetArc arc = ArcBetween(run[k], run[k + 1]);
      if (k == 0 && before) arc.points.col(0) = before->point;
      const bool bare = !run[k].regular;
      const int multiplicity = k == 0 ? joint.multiplicity : bare ? 3 : 2;
      const double to = from + std::max(arc.length, 4e-16 * (1 + from));
      arc.points.colwise() += origin;
      curve.Add(arc.points, from, to, multiplicity);
      first.Add(arc.places.topRows<2>(), from, to, multiplicity);
      second.Add(arc.places.bottomRows<2>(), from, to, multiplicity);
      from = to;
    }
    before = &run.back();
  }
  on_first.push_back(first.Take());
  on_second.push_back(second.Take());
  NurbsCurve<3> whole = curve.Take();
  if (chain.closed) {
    NurbsCurve<3>::Points points = whole.control_points();
    points.rightCols<1>() = points.leftCols<1>();
    whole = NurbsCurve<3>(whole.basis(), std::move(points));
  }
  return {chain.kind == MeetKind::kTouching ? BranchKind::kTangential : BranchKind::kTransversal,
          chain.closed,
          std::move(whole),
          std::move(on_first),
          std::move(on_second)};
}

}  // namespace batten::internal
