// SPDX-License-Identifier: MIT
#include "fitting/revolution/revolution_samples.h"

#include <cmath>
#include <string>

#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kLeastNodes = 24;
constexpr double kFlat = 0.02;   // thickness over length; below, a plane serves better
constexpr double kTurned = 0.1;  // share of contradicting edges; above, the shape is one-sided

SheetGraphOptions LooseOptions() {
  SheetGraphOptions loose;
  loose.steepest = 0.85;
  loose.least_cosine = 0.2;
  return loose;
}

std::string RefusalOf(const RevolutionSamples& round) {
  const PoissonDiskSamples& nodes = round.nodes();
  if (nodes.size() < kLeastNodes) {
    return "too few points, or too much noise, for a round shape: only " +
           std::to_string(nodes.size()) + " places of it can be told apart, and " +
           std::to_string(kLeastNodes) + " are needed";
  }
  if (nodes.LieAlongLines()) {
    return "the points lie along lines: nothing tells how a surface runs between them; fit a "
           "curve, or a cloud with points in all directions";
  }
  if (round.graph.share < kConnectedShare) {
    return "the points hang together in several parts, or in none: the largest holds " +
           std::to_string(std::lround(100 * round.graph.share)) +
           " % of them; fit one part of the cloud at a time";
  }
  const auto edges = static_cast<double>(round.graph.edges.size());
  const auto turned = static_cast<double>(round.graph.contradictions.size());
  if (turned > kTurned * (edges + turned)) {
    return "the surface has one side only; fit a part of the cloud that is an open sheet";
  }
  return {};
}

// Whether the nodes are a piece of a plane: a thin layer with normals across it. The normals of a
// narrow hoop lie along its layer.
bool IsFlat(const PoissonDiskSamples& nodes, const Eigen::Matrix3Xd& centred) {
  const SymmetricEigen3 solver = EigenOf3(centred * centred.transpose());
  const Eigen::Vector3d spread = solver.values.cwiseMax(0.0).cwiseSqrt();
  const Eigen::VectorXd across = nodes.normals.transpose() * solver.vectors.col(0);
  return spread[0] < kFlat * spread[2] &&
         across.squaredNorm() > static_cast<double>(nodes.size()) / 2;
}

}  // namespace

RevolutionSamples SampleRevolution(const Eigen::Matrix3Xd& points,
                                   const NeighbourIndex& index,
                                   double noise,
                                   ThreadPool& pool) {
  return RevolutionSamplesOf(SamplePoissonDisk(points, index, noise, {}, pool), noise);
}

RevolutionSamples RevolutionSamplesOf(const PoissonDiskSamples& nodes, double noise) {
  RevolutionSamples round;
  round.noise = noise;
  round.graph = ConnectSheet(nodes, {});
  if (round.graph.share < kConnectedShare) {
    SheetGraph loose = ConnectSheet(nodes, LooseOptions());
    if (loose.share > round.graph.share) round.graph = std::move(loose);
  }
  PoissonDiskSamples& own = round.graph.nodes;
  round.centre = own.places.rowwise().mean();
  const Eigen::Matrix3Xd centred = own.places.colwise() - round.centre;
  round.size = std::sqrt(centred.squaredNorm() / static_cast<double>(own.size()));
  if (own.normals.cwiseProduct(centred).sum() < 0) {
    for (Eigen::Index i = 0; i < own.size(); ++i) own.Flip(i);
  }
  round.failure_reason = RefusalOf(round);
  if (round.ok() && IsFlat(own, centred)) {
    round.failure_reason = "the points lie in a plane, which serves them as the base";
  }
  return round;
}

}  // namespace batten::internal
