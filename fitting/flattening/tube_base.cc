// SPDX-License-Identifier: MIT
#include "fitting/flattening/tube_base.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/flattening/cohomology_basis.h"
#include "fitting/flattening/parameter_blending.h"
#include "fitting/flattening/planar_edges.h"
#include "fitting/flattening/tube_ends.h"
#include "fitting/flattening/tube_parameter_smoothing.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kLeastTubeNodes = 40;
constexpr double kFilledLoop = 10;       // reaches; a shorter loop is a gap between nodes, no hole
constexpr double kHole = 0.5;            // times the longest loop: shorter ones go round holes
constexpr double kSpacingOfNodes = 1.3;  // in reaches
constexpr double kLeastRound = 16;       // nodes
constexpr double kOpenAngle = 2.1;       // radians between neighbours of a node at an edge
constexpr int kTubeTornApart = 7;        // edges between ends of a contradicting edge
constexpr double kLeastLeft = 0.3;  // of a tube's length where its ends come nearest to each other

// Places of the plane on a cylinder as long round as the period: neighbours across the seam are
// neighbours there.
Eigen::Matrix3Xd OnCylinder(const Eigen::VectorXcd& places, double period) {
  const double radius = period / (2 * std::numbers::pi);
  Eigen::Matrix3Xd round(3, places.size());
  for (Eigen::Index i = 0; i < places.size(); ++i) {
    const double angle = places[i].real() / radius;
    round.col(i) << radius * std::cos(angle), radius * std::sin(angle), places[i].imag();
  }
  return round;
}

// Whether the sheet is one-sided: edges whose ends disagree about the upper side join parts that
// are far from each other along the other edges.
bool IsOneSided(const SheetGraph& graph) {
  const std::vector<std::vector<int>> neighbours = NeighboursOf(graph.nodes.size(), graph.edges);
  const auto torn = [&](const SheetEdge& edge) {
    std::vector<int> seen{edge.first}, front = seen;
    for (int step = 0; step < kTubeTornApart; ++step) {
      std::vector<int> next;
      for (const int i : front) next.insert(next.end(), neighbours[i].begin(), neighbours[i].end());
      std::sort(next.begin(), next.end());
      next.erase(std::unique(next.begin(), next.end()), next.end());
      front.clear();
      std::set_difference(
          next.begin(), next.end(), seen.begin(), seen.end(), std::back_inserter(front));
      seen.insert(seen.end(), front.begin(), front.end());
      std::sort(seen.begin(), seen.end());
      if (std::binary_search(front.begin(), front.end(), edge.second)) return false;
    }
    return true;
  };
  return std::count_if(graph.contradictions.begin(), graph.contradictions.end(), torn) >=
         kLeastTorn;
}

// Number of nodes that have no neighbour over a wide angle.
Eigen::Index NodesAtEdges(Eigen::Index n, const std::vector<PlanarEdge>& edges) {
  std::vector<std::vector<double>> angles(static_cast<size_t>(n));
  for (const PlanarEdge& e : edges) {
    angles[e.first].push_back(std::arg(e.from_first));
    angles[e.second].push_back(std::arg(e.from_second));
  }
  return std::count_if(angles.begin(), angles.end(), [](std::vector<double>& around) {
    std::sort(around.begin(), around.end());
    double widest = around.front() + 2 * std::numbers::pi - around.back();
    for (size_t k = 1; k < around.size(); ++k) widest = std::max(widest, around[k] - around[k - 1]);
    return widest > kOpenAngle;
  });
}

double MedianReach(const PoissonDiskSamples& nodes) {
  return Median({nodes.reach.begin(), nodes.reach.end()});
}

// Number of nodes needed for enough of them round the tube, by the curvature at the nodes.
Eigen::Index NodesNeeded(const PoissonDiskSamples& nodes) {
  std::vector<double> bends;
  for (Eigen::Index i = 0; i < nodes.size(); ++i) {
    const double half = (nodes.curvature(0, i) + nodes.curvature(2, i)) / 2;
    const double spread =
        std::hypot((nodes.curvature(0, i) - nodes.curvature(2, i)) / 2, nodes.curvature(1, i));
    bends.push_back((std::abs(half) + spread) * nodes.reach[i]);
  }
  const double round =
      2 * std::numbers::pi / (kSpacingOfNodes * std::max(1e-9, Median(std::move(bends))));
  const double more = std::pow(std::max(1.0, kLeastRound / round), 2);
  return static_cast<Eigen::Index>(static_cast<double>(nodes.size()) * std::min(more, 16.0));
}

// Reason why the loops found are not those of a tube with two ends; empty if they are.
std::string RefusalOfLoops(const std::vector<SheetLoop>& loops,
                           Eigen::Index at_edges,
                           const PoissonDiskSamples& nodes) {
  const auto long_ones = std::count_if(loops.begin(), loops.end(), [&](const SheetLoop& loop) {
    return loop.length > kHole * loops.front().length;
  });
  const double edge = static_cast<double>(at_edges) * kSpacingOfNodes * MedianReach(nodes);
  const bool has_ends = loops.empty() ? at_edges * 100 > nodes.size()
                                      : edge > loops.front().length;  // two ends have twice that
  if (loops.empty() && has_ends) {
    return "the sheet does not close round: every way along it can be drawn together; fit it as an "
           "open sheet";
  }
  if (loops.empty()) {
    return "the points close on all sides, as a ball: one NURBS surface cannot cover that as a "
           "tube; fit a part of the cloud, or a sphere or a surface of revolution";
  }
  if (!has_ends) {
    return "the points close in more than one direction, as a torus or something with handles, and "
           "have no ends: one NURBS surface cannot cover that as a tube; fit a part of the cloud";
  }
  if (static_cast<int>(loops.size()) == kMostLoops) {
    return "there are many ways round: the sheet has many large holes, or its points lie along "
           "lines; fit a part of the cloud";
  }
  if (long_ones > 1) {
    return "the tube branches, or has a hole nearly as large as its section: one NURBS surface "
           "cannot cover it; cut the cloud into tubes with two ends each";
  }
  return {};
}

std::string RefusalOfRoll(const FlattenedBase& base) {
  constexpr const char* kTakePart = "; fit a part of the cloud";
  if (base.overlap > kFlatteningLimits.overlap) {
    return Percent(base.overlap) +
           " of the tube comes to lie over another part of it when it is rolled off: it has "
           "pockets or branches" +
           kTakePart;
  }
  if (base.distortion > kFlatteningLimits.distortion) {
    return "lengths change by " + Percent(base.distortion) +
           " when the tube is rolled off: it widens or bends too strongly" + kTakePart;
  }
  if (base.folded > kFlatteningLimits.folded) {
    return "the tube folds over itself when it is rolled off" + std::string(kTakePart);
  }
  return {};
}

// Turns the result over, so that normals point the other way.
void Mirror(FlattenedNodes& rolled) {
  Flattening& u = rolled.unfolding;
  for (Eigen::Index i = 0; i < rolled.graph.nodes.size(); ++i) rolled.graph.nodes.Flip(i);
  u.places = u.places.conjugate().eval();
  // y changes its sign in the tangent planes too: conj(a conj(q) + b q) = conj(a) q + conj(b)
  // conj(q).
  u.conformal = u.conformal.conjugate().eval();
  u.anticonformal = u.anticonformal.conjugate().eval();
}

// Whether normals point away from the opposite side of the tube.
bool LooksOutwards(const FlattenedNodes& rolled) {
  const Eigen::VectorXcd& places = rolled.unfolding.places;
  const double period = rolled.unfolding.period;
  const PoissonDiskSamples& nodes = rolled.graph.nodes;
  const std::vector<int> opposite =
      NeighbourIndex(OnCylinder(places, period))
          .Nearest(OnCylinder(places.array() + period / 2, period), 1);
  Eigen::Index outwards = 0;
  for (Eigen::Index i = 0; i < nodes.size(); ++i) {
    if (nodes.normals.col(i).dot(nodes.places.col(i) - nodes.places.col(opposite[i])) > 0) {
      ++outwards;
    }
  }
  return 2 * outwards >= nodes.size();
}

// Orients the axes: v grows with the coordinate it correlates with most, and normals point
// outwards.
void ChooseAxes(FlattenedNodes& rolled) {
  if (!LooksOutwards(rolled)) Mirror(rolled);
  Flattening& u = rolled.unfolding;
  const Eigen::Matrix3Xd& places = rolled.graph.nodes.places;
  const Eigen::Vector3d grows = (places.colwise() - places.rowwise().mean()) * u.places.imag();
  Eigen::Index largest;
  grows.cwiseAbs().maxCoeff(&largest);
  if (grows[largest] >= 0) return;
  u.places *= -1;
  u.conformal *= -1;
  u.anticonformal *= -1;
}

double Wrapped(double u, double period) {
  const double rest = u - period * std::floor(u / period);
  return rest < period ? rest : 0.0;
}

// Lays both ends on lines of constant v, lengths along the tube shared out between them.
void Straighten(double spacing, FlattenedBase& base) {
  const TubeEnds ends = EndsOf(base.parameters, base.reached, base.length_u, spacing);
  const double length = ends.high.coefficients[0] - ends.low.coefficients[0];
  constexpr int kLooks = 256;
  double least = length;
  for (int k = 0; k < kLooks; ++k) {
    const double u = base.length_u * k / kLooks;
    least = std::min(least, ends.high.At(u) - ends.low.At(u));
  }
  if (!(least > kLeastLeft * length)) return;
  for (Eigen::Index k = 0; k < base.parameters.cols(); ++k) {
    const double low = ends.low.At(base.parameters(0, k)),
                 high = ends.high.At(base.parameters(0, k));
    base.parameters(1, k) = (base.parameters(1, k) - low) / (high - low) * length;
  }
}

void PutIntoStrip(const FlattenedNodes& rolled,
                  const Eigen::Matrix3Xd& points,
                  double spacing,
                  double noise,
                  double margin,
                  ThreadPool& pool,
                  FlattenedBase& base) {
  SpreadPlaces spread = BlendLocalCharts(rolled.graph, rolled.unfolding, points, noise, pool);
  base.parameters = std::move(spread.places);
  base.reached = std::move(spread.reached);
  base.length_u = rolled.unfolding.period;
  for (double& u : base.parameters.row(0)) u = Wrapped(u, base.length_u);
  Straighten(spacing, base);
  double low = 0, high = 0;
  bool any = false;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    if (!base.reached[k]) continue;
    const double v = base.parameters(1, k);
    low = any ? std::min(low, v) : v;
    high = any ? std::max(high, v) : v;
    any = true;
  }
  base.length_v = high - low + 2 * margin;
  for (double& v : base.parameters.row(1)) v = std::clamp(v - low + margin, 0.0, base.length_v);
}

// Connects and flattens the nodes; fills in the base's measures of the result.
FlattenedNodes RollOff(const PoissonDiskSamples& nodes,
                       const SheetGraphOptions& graph_options,
                       FlattenedBase& base) {
  FlattenedNodes rolled;
  rolled.graph = ConnectSheet(nodes, graph_options);
  base.share = rolled.graph.share;
  base.distortion = 1;
  if (base.share < kConnectedShare) {
    base.failure_reason = SeveralSheets(base.share);
    return rolled;
  }
  base.orientation_consistent = !IsOneSided(rolled.graph);
  if (!base.orientation_consistent) {
    base.failure_reason = "the sheet is one-sided, as a Moebius band; fit a part of the cloud";
    return rolled;
  }
  const std::vector<PlanarEdge> edges = PlanarEdges(rolled.graph);
  const std::vector<SheetLoop> loops =
      CohomologyBasis(rolled.graph.nodes, edges, kFilledLoop, kMostLoops);
  base.failure_reason =
      RefusalOfLoops(loops, NodesAtEdges(rolled.graph.nodes.size(), edges), rolled.graph.nodes);
  if (!base.failure_reason.empty()) return rolled;
  rolled.unfolding = FlattenTubeArap(rolled.graph, edges, loops.front().crossings);
  base.distortion = rolled.unfolding.distortion;
  base.folded = rolled.unfolding.folded;
  base.overlap =
      OverlapOf(rolled.graph, OnCylinder(rolled.unfolding.places, rolled.unfolding.period));
  base.failure_reason = RefusalOfRoll(base);
  if (base.ok()) ChooseAxes(rolled);
  return rolled;
}

}  // namespace

FlattenedBase FlattenTube(const Eigen::Matrix3Xd& points,
                          const NeighbourIndex& index,
                          double spacing,
                          double noise,
                          double margin,
                          ThreadPool& pool,
                          const Progress& progress) {
  CheckBaseInput("FlattenTube", points, index, spacing, noise, margin);
  FlattenedBase base;
  FlattenedNodes rolled;
  for (FlatteningAttempt attempt : FlatteningAttempts()) {
    Report(progress, "parameterize", 0.1);
    PoissonDiskSamples nodes = SamplePoissonDisk(points, index, noise, attempt.nodes, pool);
    base = {};
    if (nodes.size() < kLeastTubeNodes) {
      base.failure_reason = "too few points, or too much noise, for a tube: only " +
                            std::to_string(nodes.size()) + " places of it can be told apart, and " +
                            std::to_string(kLeastTubeNodes) + " are needed";
      break;
    }
    if (const Eigen::Index needed = NodesNeeded(nodes); needed > nodes.size()) {
      attempt.nodes.most = std::max(attempt.nodes.most, needed);
      nodes = SamplePoissonDisk(points, index, noise, attempt.nodes, pool);
    }
    Report(progress, "parameterize", 0.3);
    rolled = RollOff(nodes, attempt.graph, base);
    if (base.ok()) break;
  }
  Report(progress, "parameterize", 0.6);
  if (base.ok()) {
    PutIntoStrip(rolled, points, spacing, noise, margin, pool, base);
    SmoothTubeParameters(points, pool, base);
  } else {
    PutAnywhere(points.cols(), spacing, margin, base);
  }
  Report(progress, "parameterize", 1);
  return base;
}

}  // namespace batten::internal
