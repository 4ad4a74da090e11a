// SPDX-License-Identifier: MIT
#include "fitting/flattening/sheet_base.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "fitting/flattening/parameter_blending.h"
#include "geometry/numeric/number_text.h"
#include "geometry/numeric/smallest_rectangle.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kLeastNodes = 12;
constexpr double kTornApart = 4;  // reaches in the plane between ends of a contradicting edge

// The nodes' places in the plane, as points of space.
Eigen::Matrix3Xd PlanOf(const Flattening& unfolding) {
  Eigen::Matrix3Xd plan = Eigen::Matrix3Xd::Zero(3, unfolding.places.size());
  plan.row(0) = unfolding.places.real();
  plan.row(1) = unfolding.places.imag();
  return plan;
}

// Whether the sheet is one-sided: edges whose ends disagree about the upper side join parts that
// are far from each other in the plane.
bool IsOneSided(const SheetGraph& graph, const Flattening& unfolding) {
  const auto torn = [&](const SheetEdge& e) {
    return std::abs(unfolding.places[e.second] - unfolding.places[e.first]) >
           kTornApart * (graph.nodes.reach[e.first] + graph.nodes.reach[e.second]) / 2;
  };
  return std::count_if(graph.contradictions.begin(), graph.contradictions.end(), torn) >=
         kLeastTorn;
}

std::string RefusalOf(const FlattenedBase& base) {
  constexpr const char* kTakePart = "; fit a part of the cloud that is an open sheet";
  if (base.share < kConnectedShare) return SeveralSheets(base.share);
  if (!base.orientation_consistent) {
    return std::string("the sheet is one-sided, as a Moebius band") + kTakePart;
  }
  if (base.overlap > kFlatteningLimits.overlap) {
    return Percent(base.overlap) +
           " of the sheet comes to lie over another part of it when it is laid out flat: it is "
           "closed, or several layers touch" +
           kTakePart;
  }
  if (base.distortion > kFlatteningLimits.distortion) {
    return "lengths change by " + Percent(base.distortion) +
           " when the sheet is laid out flat: it is closed or too strongly curved" + kTakePart;
  }
  if (base.folded > kFlatteningLimits.folded) {
    return "the sheet folds over itself when it is laid out flat" + std::string(kTakePart);
  }
  return {};
}

// Badness of an attempt that does not serve.
double Badness(const FlattenedBase& base) {
  return base.distortion / kFlatteningLimits.distortion + base.folded / kFlatteningLimits.folded +
         base.overlap / kFlatteningLimits.overlap + (1 - base.share) / (1 - kConnectedShare) +
         (base.orientation_consistent ? 0 : 1);
}

// Flips all normals, if need be, so that the largest component of their sum is positive.
void LookFromAbove(SheetGraph& graph) {
  const Eigen::Vector3d mean = graph.nodes.normals.rowwise().sum();
  Eigen::Index largest;
  mean.cwiseAbs().maxCoeff(&largest);
  if (mean[largest] >= 0) return;
  for (Eigen::Index i = 0; i < graph.nodes.size(); ++i) graph.nodes.Flip(i);
}

// The corners of the hull of the places reached.
std::vector<Eigen::Vector2d> HullOf(const SpreadPlaces& spread, ThreadPool& pool) {
  constexpr Eigen::Index kBlock = 1 << 15;
  const Eigen::Index m = spread.places.cols(), blocks = (m + kBlock - 1) / kBlock;
  std::vector<std::vector<Eigen::Vector2d>> hulls(static_cast<size_t>(blocks));
  pool.For(blocks, 1, [&](std::ptrdiff_t block, std::ptrdiff_t) {
    std::vector<Eigen::Vector2d> places;
    const Eigen::Index end = std::min(m, (block + 1) * kBlock);
    for (Eigen::Index k = block * kBlock; k < end; ++k) {
      if (spread.reached[k]) places.emplace_back(spread.places.col(k));
    }
    hulls[block] = ConvexHullOf(std::move(places));
  });
  std::vector<Eigen::Vector2d> corners;
  for (const auto& hull : hulls) corners.insert(corners.end(), hull.begin(), hull.end());
  return ConvexHullOf(std::move(corners));
}

// Turns the axis by right angles: u along the longer side, and growing with the coordinate it has
// most to do with.
void ChooseAxes(TurnedRectangle& rectangle,
                const SpreadPlaces& spread,
                const Eigen::Matrix3Xd& points) {
  const Eigen::Vector2d sides = rectangle.high - rectangle.low;
  if (sides[1] > sides[0]) {
    rectangle.axis = {-rectangle.axis[1], rectangle.axis[0]};
    const Eigen::Vector2d low = rectangle.low, high = rectangle.high;
    rectangle.low = {low[1], -high[0]};
    rectangle.high = {high[1], -low[0]};
  }
  const Eigen::Vector3d middle = points.rowwise().mean();
  const Eigen::Vector3d grows =
      (points.colwise() - middle) * (rectangle.axis.transpose() * spread.places).transpose();
  Eigen::Index largest;
  grows.cwiseAbs().maxCoeff(&largest);
  if (grows[largest] >= 0) return;
  rectangle.axis *= -1;
  std::swap(rectangle.low, rectangle.high);
  rectangle.low *= -1;
  rectangle.high *= -1;
}

void PutIntoRectangle(const SpreadPlaces& spread,
                      const Eigen::Matrix3Xd& points,
                      double margin,
                      ThreadPool& pool,
                      FlattenedBase& base) {
  TurnedRectangle rectangle = SmallestRectangleAround(HullOf(spread, pool));
  ChooseAxes(rectangle, spread, points);
  const Eigen::Vector2d sides = rectangle.high - rectangle.low;
  base.length_u = sides[0] + 2 * margin;
  base.length_v = sides[1] + 2 * margin;
  base.parameters.resize(2, points.cols());
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Vector2d q = rectangle.ToFrame(spread.places.col(k)) - rectangle.low;
    base.parameters(0, k) = std::clamp(q[0] + margin, 0.0, base.length_u);
    base.parameters(1, k) = std::clamp(q[1] + margin, 0.0, base.length_v);
  }
  base.reached = spread.reached;
}

// Reason why the nodes cannot represent a sheet (too few, or on lines); empty if they may.
std::string RefusalOfNodes(const PoissonDiskSamples& nodes) {
  if (nodes.size() < kLeastNodes) {
    return "too few points, or too much noise, for a bent sheet: only " +
           std::to_string(nodes.size()) + " places of it can be told apart, and " +
           std::to_string(kLeastNodes) + " are needed";
  }
  if (nodes.LieAlongLines()) {
    return "the points lie along lines: nothing tells how a sheet runs between them; fit a curve, "
           "or a cloud with points in all directions";
  }
  return {};
}

// Connects and flattens the nodes; fills in the base's measures of the result.
FlattenedNodes LayOut(const PoissonDiskSamples& nodes,
                      const SheetGraphOptions& graph_options,
                      FlattenedBase& base) {
  FlattenedNodes flattened;
  flattened.graph = ConnectSheet(nodes, graph_options);
  base.share = flattened.graph.share;
  base.distortion = 1;
  if (!flattened.graph.edges.empty()) {
    LookFromAbove(flattened.graph);
    flattened.unfolding = FlattenArap(flattened.graph);
    base.distortion = flattened.unfolding.distortion;
    base.folded = flattened.unfolding.folded;
    base.overlap = OverlapOf(flattened.graph, PlanOf(flattened.unfolding));
    base.orientation_consistent = !IsOneSided(flattened.graph, flattened.unfolding);
  }
  base.failure_reason = RefusalOf(base);
  return flattened;
}

}  // namespace

SheetLayout::SheetLayout(const Eigen::Matrix3Xd& points,
                         const NeighbourIndex& index,
                         double spacing,
                         double noise,
                         double margin,
                         ThreadPool& pool,
                         const Progress& progress)
    : points_(points),
      index_(index),
      spacing_(spacing),
      noise_(noise),
      margin_(margin),
      pool_(pool),
      progress_(progress) {
  CheckBaseInput("SheetLayout", points, index, spacing, noise, margin);
  Attempt();
}

void SheetLayout::LookCloser() {
  while (!best_.ok() && !given_up_) Attempt();
}

void SheetLayout::Attempt() {
  const std::vector<FlatteningAttempt> looks = FlatteningAttempts();
  const FlatteningAttempt& look = looks[static_cast<size_t>(attempts_)];
  Report(progress_, "parameterize", 0.1);
  PoissonDiskSamples nodes = SamplePoissonDisk(points_, index_, noise_, look.nodes, pool_);
  const bool first = attempts_ == 0;
  given_up_ = ++attempts_ == std::ssize(looks);
  if (std::string failure_reason = RefusalOfNodes(nodes); !failure_reason.empty()) {
    if (first) best_.failure_reason = std::move(failure_reason);
    given_up_ = true;
  } else {
    Report(progress_, "parameterize", 0.3);
    FlattenedBase base;
    FlattenedNodes flattened = LayOut(nodes, look.graph, base);
    if (first || base.ok() || Badness(base) < Badness(best_)) {
      best_ = std::move(base);
      graph_ = std::move(flattened.graph);
      unfolding_ = std::move(flattened.unfolding);
    }
  }
  if (first) nodes_ = std::move(nodes);
}

FlattenedBase SheetLayout::Over(const Eigen::Matrix3Xd& some) const {
  Report(progress_, "parameterize", 0.6);
  FlattenedBase base = best_;
  if (graph_.edges.empty()) {
    PutAnywhere(some.cols(), spacing_, margin_, base);
  } else {
    PutIntoRectangle(
        BlendLocalCharts(graph_, unfolding_, some, noise_, pool_), some, margin_, pool_, base);
  }
  Report(progress_, "parameterize", 1);
  return base;
}

}  // namespace batten::internal
