// SPDX-License-Identifier: MIT
#include "fitting/flattening/flattened_base.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kNear = 1;        // reaches in the plane between nodes that lie on each other …
constexpr double kFarApart = 3.5;  // … and more than so many in space

}  // namespace

std::vector<FlatteningAttempt> FlatteningAttempts() {
  const FlatteningAttempt first;
  FlatteningAttempt strict;
  strict.nodes.most *= 4;
  strict.nodes.most_neighbours = 24;
  strict.nodes.own_neighbours = true;
  strict.graph.longest = 2.2;
  strict.graph.steepest = 0.35;
  strict.graph.least_cosine = 0.7;
  FlatteningAttempt close = strict;
  close.nodes.most *= 4;
  close.nodes.most_neighbours = 16;
  close.graph.steepest = 0.25;
  return {first, strict, close};
}

double OverlapOf(const SheetGraph& graph, const Eigen::Matrix3Xd& plan) {
  const Eigen::Index n = graph.nodes.size();
  constexpr int kLookedAt = 9;
  const std::vector<int> near = NeighbourIndex(plan).Nearest(plan, kLookedAt);
  const auto each = static_cast<Eigen::Index>(near.size()) / n;
  Eigen::Index covered = 0;
  for (Eigen::Index i = 0; i < n; ++i) {
    const bool lies_on_another =
        std::any_of(near.begin() + i * each, near.begin() + (i + 1) * each, [&](int j) {
          return (plan.col(j) - plan.col(i)).norm() < kNear * graph.nodes.reach[i] &&
                 (graph.nodes.places.col(j) - graph.nodes.places.col(i)).norm() >
                     kFarApart * graph.nodes.reach[i];
        });
    if (lies_on_another) ++covered;
  }
  return static_cast<double>(covered) / static_cast<double>(n);
}

std::string SeveralSheets(double share) {
  return "the points hang together in several sheets, or in none: the largest part holds " +
         Percent(share) + " of them; fit one part of the cloud at a time";
}

void PutAnywhere(Eigen::Index count, double spacing, double margin, FlattenedBase& base) {
  base.length_u = base.length_v = spacing + 2 * margin;
  base.parameters.setConstant(2, count, base.length_u / 2);
  base.reached = PointMask::Constant(count, false);
}

void CheckBaseInput(const std::string& function,
                    const Eigen::Matrix3Xd& points,
                    const NeighbourIndex& index,
                    double spacing,
                    double noise,
                    double margin) {
  if (points.cols() == 0) throw std::invalid_argument(function + ": no points");
  if (index.size() != points.cols()) {
    throw std::invalid_argument(function + ": index must hold the points; it holds " +
                                std::to_string(index.size()) + " of " +
                                std::to_string(points.cols()));
  }
  const auto rule = [&](const char* name, double value) {
    if (value >= 0 && std::isfinite(value)) return;
    throw std::invalid_argument(function + ": " + name + " must not be negative; it is " +
                                std::to_string(value));
  };
  rule("spacing", spacing);
  rule("noise", noise);
  rule("margin", margin);
}

}  // namespace batten::internal
