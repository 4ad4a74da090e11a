// SPDX-License-Identifier: MIT
// A parameterization that one candidate offers for a cloud, and what candidates are made from.
#pragma once

#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/neighbours.h"
#include "batten/fitting/point_cloud.h"
#include "batten/fitting/surface_options.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/parameterization/parameterization.h"

namespace batten::internal {

// The inliers of a cloud with their neighbour index, and what else every candidate reads.
class BaseInput {
 public:
  // All is referred to, nothing copied but the inliers where there are outliers. `index` is that of
  // all points.
  BaseInput(const PointCloud& cloud,
            const NeighbourIndex& index,
            const CloudStatistics& statistics,
            const SurfaceFitOptions& options,
            ThreadPool& pool);
  BaseInput(const BaseInput&) = delete;
  BaseInput& operator=(const BaseInput&) = delete;

  const PointCloud& cloud;
  const CloudStatistics& statistics;
  const SurfaceFitOptions& options;
  ThreadPool& pool;

  const Eigen::Matrix3Xd& inliers() const { return own_ ? own_->points : cloud.points(); }
  const NeighbourIndex& index() const { return own_ ? own_->index : index_; }
  const std::vector<Eigen::Index>& places() const { return places_; }  // of inliers in the cloud
  double margin() const;  // by which open edges reach beyond the points

 private:
  struct Own {
    Eigen::Matrix3Xd points;
    NeighbourIndex index;
  };
  const NeighbourIndex& index_;
  std::vector<Eigen::Index> places_;
  std::optional<Own> own_;
};

// Some of the inliers, ascending; absent: all.
using InlierSubset = std::optional<std::vector<Eigen::Index>>;

struct BaseAttempt {
  Parameterization base;   // parameters of all points of the cloud
  PointMask reached;       // points with a place; parameters of the others are a guess
  bool complete = true;    // false: only the inliers asked for have places
  bool distorted = false;  // lengths change, or much of the domain is empty: others may be better
  bool certain = false;    // no candidate after it can be better, …
  bool ragged = false;     // … but a map that straightens its sides
  bool one_sided = false;  // refused since the surface has one side, as a Möbius band
  std::vector<std::string> warnings = {};
  std::string failure_reason = {};  // empty where it serves, else why not and what to do

  bool ok() const { return failure_reason.empty(); }
};

// Extends parameters of some inliers to the cloud: other points have no place.
BaseAttempt Attempt(const BaseInput& input,
                    const InlierSubset& some,
                    Parameterization&& base,
                    const PointMask& reached);
BaseAttempt Failure(std::string reason);

// One way to parameterize a cloud.
struct BaseMethod {
  std::string name;
  // Makes it for some inliers, or for more.
  std::function<BaseAttempt(const InlierSubset&)> make;
  bool smooth = false;       // its parameters have wrinkles to be smoothed before it is judged
  bool last_resort = false;  // made only where nothing before it predicts points to the noise, …
  bool straightens = false;  // … or the best so far is ragged
  bool of_two_sheets = false;  // made only where no other candidate serves a single sheet
};

}  // namespace batten::internal
