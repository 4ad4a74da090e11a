// SPDX-License-Identifier: MIT
#include "batten/fitting/curve_order.h"

#include <algorithm>
#include <cmath>
#include <compare>
#include <span>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/core/point_rank.h"
#include "fitting/core/unit_of.h"
#include "fitting/ordering/curve_inliers.h"
#include "fitting/ordering/curve_nodes.h"
#include "fitting/ordering/node_paths.h"
#include "fitting/ordering/path_branches.h"
#include "fitting/ordering/principal_polyline.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kRadiusInNoise = 3;   // in noise: least distance of nodes
constexpr double kRadius = 0.3;        // in spacings: least distance of nodes where noise is small
constexpr double kRadiusOfFew = 0.02;  // the same for few points, which are needed all
constexpr double kFewPoints = 1000;
constexpr double kMostNodes = 10000;
constexpr double kManyThick = 5000;            // points, whose noise needs no proof
constexpr double kTries[] = {1, 1.6, 2.5, 4};  // coarser and coarser while the points branch
constexpr double kMostLeftOut = 0.4;           // share of the points: more are no outliers
constexpr double kLongInNoise = 30;            // a shorter guide is no curve that the noise hides
constexpr double kOutlierInNoise = 6;
constexpr double kOutlierInLinks = 0.5;
constexpr double kOverhang = 3;         // of the tolerance, before and behind an open guide
constexpr double kRoughTurn = 0.6;      // the same with noise
constexpr double kSmoothTurn = 0.5;     // mean turn at nodes along curves without noise
constexpr double kFewestANode = 3;      // points, for a guide to be smoothed
constexpr double kShowsInLinks = 0.05;  // noise, for a guide through points to be smoothed
constexpr double kSmoothLinks = 3;
constexpr double kSmoothReach = 18;  // in noise
constexpr double kSmoothStep = 2;    // in noise
constexpr int kSmoothRounds = 2;

// Different points of a cloud around zero, of size about one, in an order that is their own.
struct OrderedPlaces {
  Eigen::Matrix3Xd points;
  std::vector<Eigen::Index> order;  // points of the cloud, place by place
  std::vector<size_t> first;        // of each place in that order, and behind the last
  Eigen::Vector3d middle;
  double unit;

  // Points of the cloud at a place.
  std::span<const Eigen::Index> Given(Eigen::Index place) const {
    const auto i = static_cast<size_t>(place);
    return {order.data() + first[i], first[i + 1] - first[i]};
  }
};

OrderedPlaces PlacesOf(const PointCloud& cloud) {
  const Eigen::Matrix3Xd& points = cloud.points();
  OrderedPlaces places;
  places.unit = UnitOf(points);
  places.middle = points.rowwise().minCoeff() / 2 + points.rowwise().maxCoeff() / 2;
  // By coordinates, then by number.
  struct Keyed {
    double x, y, z;
    Eigen::Index k;
    auto operator<=>(const Keyed&) const = default;
  };
  std::vector<Keyed> keyed(static_cast<size_t>(points.cols()));
  for (Eigen::Index k = 0; k < points.cols(); ++k)
    keyed[static_cast<size_t>(k)] = {points(0, k), points(1, k), points(2, k), k};
  std::sort(keyed.begin(), keyed.end());
  for (size_t i = 0; i < keyed.size(); ++i) {
    const Keyed &here = keyed[i], &before = keyed[i > 0 ? i - 1 : 0];
    const bool same = here.x == before.x && here.y == before.y && here.z == before.z;
    if (i == 0 || !same) places.first.push_back(i);
    places.order.push_back(here.k);
  }
  places.points.resize(3, std::ssize(places.first));
  for (size_t i = 0; i < places.first.size(); ++i) {
    places.points.col(static_cast<Eigen::Index>(i)) =
        (points.col(places.order[places.first[i]]) - places.middle) / places.unit;
  }
  places.first.push_back(keyed.size());
  return places;
}

// One trial of ordering the points, at one resolution.
struct OrderLook {
  std::vector<PrincipalPolyline> guides;
  std::vector<Eigen::Vector3d> meetings;
  std::vector<PolylinePlace> places;
  double turn = 0;       // mean at a node
  double link = 0;       // median
  double length = 0;     // of the longest guide
  double tolerance = 0;  // points farther from every guide are outliers
  Eigen::Index left_out = 0;
  bool evident = false;
};

double MedianLink(const std::vector<PrincipalPolyline>& guides) {
  std::vector<double> links;
  for (const PrincipalPolyline& guide : guides) {
    for (Eigen::Index i = 0; i < guide.links(); ++i) {
      links.push_back((guide.Next(i) - guide.nodes.col(i)).norm());
    }
  }
  return links.empty() ? 0 : Median(std::move(links));
}

bool IsOutlier(const OrderLook& look,
               const std::vector<double>& lengths,
               const PolylinePlace& place) {
  if (place.guide < 0 || place.distance > look.tolerance) return true;
  const double overhang = kOverhang * look.tolerance;
  return !look.guides[place.guide].closed &&
         (place.parameter < -overhang || place.parameter > lengths[place.guide] + overhang);
}

// Places every point on its guide, and outliers on none.
void PlacePoints(const OrderedPlaces& places, OrderLook& look, ThreadPool& pool) {
  look.places = PlacesOnPolylines(look.guides, places.points, pool);
  std::vector<double> lengths;
  for (const PrincipalPolyline& guide : look.guides)
    lengths.push_back(guide.ArcLengths().tail<1>()[0]);
  look.left_out = 0;
  for (PolylinePlace& place : look.places) {
    if (!IsOutlier(look, lengths, place)) continue;
    place.guide = -1;
    ++look.left_out;
  }
}

[[noreturn]] void RefuseScatter() {
  throw std::invalid_argument(
      "no points lie in a row along a curve: they are too few or too far from one another; give "
      "them in their order");
}

// Paths are those of the rows, the points that seem to lie along curves; with nodes that stay
// `radius` apart, in the middle of points of this noise.
OrderLook LookAt(const OrderedPlaces& places,
                 const Eigen::Matrix3Xd& rows,
                 double spacing,
                 double radius,
                 double noise,
                 ThreadPool& pool) {
  if (rows.cols() < 2) RefuseScatter();
  const Eigen::Matrix3Xd nodes = CurveNodes(rows, noise, radius, pool);
  const std::vector<NodePath> paths =
      CurvesAmong(LinkNodes(nodes, std::max(radius, spacing)), nodes);
  OrderLook look;
  look.meetings = MeetingPlaces(paths, nodes);
  look.turn = MeanTurn(paths, nodes);
  for (const NodePath& path : paths) {
    look.guides.push_back({nodes(Eigen::all, path.nodes), path.closed});
  }
  look.link = MedianLink(look.guides);
  if (!look.guides.empty()) look.length = look.guides.front().ArcLengths().tail<1>()[0];
  look.tolerance = std::max({kOutlierInNoise * noise, radius, kOutlierInLinks * look.link});
  PlacePoints(places, look, pool);
  return look;
}

// The points of one guide, in order along it.
std::vector<Eigen::Index> Along(const OrderLook& look, int guide) {
  std::vector<Eigen::Index> order;
  for (size_t i = 0; i < look.places.size(); ++i) {
    if (look.places[i].guide == guide) order.push_back(static_cast<Eigen::Index>(i));
  }
  std::stable_sort(order.begin(), order.end(), [&](Eigen::Index a, Eigen::Index b) {
    return look.places[a].parameter < look.places[b].parameter;
  });
  return order;
}

Eigen::VectorXd Parameters(const OrderLook& look, const std::vector<Eigen::Index>& order) {
  Eigen::VectorXd parameters(order.size());
  for (size_t i = 0; i < order.size(); ++i) parameters[i] = look.places[order[i]].parameter;
  return parameters;
}

double NoiseAcross(const OrderLook& look, const std::vector<Eigen::Index>& order, int dimension) {
  std::vector<double> distances;
  for (const Eigen::Index i : order) distances.push_back(look.places[i].distance);
  return distances.empty() ? 0 : SigmaOfDistances(std::move(distances), dimension);
}

// Standard deviation across the curve, from each point's distance to the parabola through two
// neighbours on either side; the median, so that single points and corners do not count.
double NoiseInOrder(const Eigen::Matrix3Xd& points, int dimension) {
  std::vector<double> distances;
  for (Eigen::Index i = 2; i + 2 < points.cols(); ++i) {
    const Eigen::Matrix<double, 3, 5> local = points.middleCols<5>(i - 2).colwise() - points.col(i);
    const Eigen::Vector3d chord = local.col(3) - local.col(1);
    if (!(chord.squaredNorm() > 0)) continue;
    Eigen::Vector4d along;
    along << -(local.col(1) - local.col(0)).norm() - local.col(1).norm(), -local.col(1).norm(),
        local.col(3).norm(), local.col(3).norm() + (local.col(4) - local.col(3)).norm();
    along /= along[3] - along[0];
    Eigen::Matrix<double, 4, 3> powers;
    powers << Eigen::Vector4d::Ones(), along, along.cwiseAbs2();
    const Eigen::Matrix3d gram = powers.transpose() * powers;
    const Eigen::Vector4d weights = powers * SymmetricSolution3(gram, Eigen::Vector3d::UnitX());
    Eigen::Vector3d off = weights[0] * local.col(0) + weights[1] * local.col(1) +
                          weights[2] * local.col(3) + weights[3] * local.col(4);
    off -= chord * (chord.dot(off) / chord.squaredNorm());
    const double distance = off.norm() / std::sqrt(1 + weights.squaredNorm());
    if (std::isfinite(distance)) distances.push_back(distance);
  }
  return distances.empty() ? 0 : SigmaOfDistances(std::move(distances), dimension);
}

// Guides of curves with several points a node, or with noise that shows against their links, become
// smooth middle lines.
void SmoothPolylines(const OrderedPlaces& places,
                     int dimension,
                     OrderLook& look,
                     ThreadPool& pool) {
  for (int round = 0; round < kSmoothRounds; ++round) {
    bool changed = false;
    for (int g = 0; g < static_cast<int>(look.guides.size()); ++g) {
      PrincipalPolyline& guide = look.guides[g];
      const std::vector<Eigen::Index> order = Along(look, g);
      if (order.size() < kFewestForNoise) continue;
      const Eigen::Matrix3Xd points = places.points(Eigen::all, order);
      const double length = guide.ArcLengths().tail<1>()[0];
      const bool dense = static_cast<double>(order.size()) * look.link >= kFewestANode * length;
      const double noise = round > 0 || dense ? NoiseAcross(look, order, dimension)
                                              : NoiseInOrder(points, dimension);
      if (!dense && noise < kShowsInLinks * look.link) continue;
      look.tolerance = std::max(look.tolerance, kOutlierInNoise * noise);
      guide = Smoothed(points,
                       Parameters(look, order),
                       guide.closed,
                       length,
                       std::max(kSmoothReach * noise, kSmoothLinks * look.link),
                       std::max(kSmoothStep * noise, look.link));
      changed = true;
    }
    if (!changed) return;
    PlacePoints(places, look, pool);
  }
}

// The part of a closed guide between two parameters, the second behind the first, as an open one.
PrincipalPolyline Opened(const PrincipalPolyline& guide, double from, double to) {
  const Eigen::VectorXd arcs = guide.ArcLengths();
  const double length = arcs[arcs.size() - 1];
  const auto at = [&](double parameter) -> Eigen::Vector3d {
    parameter = parameter >= length ? parameter - length : parameter;
    Eigen::Index i = std::upper_bound(arcs.begin(), arcs.end(), parameter) - arcs.begin() - 1;
    i = std::clamp<Eigen::Index>(i, 0, guide.links() - 1);
    const double t = (parameter - arcs[i]) / (arcs[i + 1] - arcs[i]);
    return guide.nodes.col(i) + t * (guide.Next(i) - guide.nodes.col(i));
  };
  std::vector<Eigen::Vector3d> nodes = {at(from)};
  for (const double round : {0.0, length}) {
    for (Eigen::Index i = 0; i < guide.nodes.cols(); ++i) {
      if (arcs[i] + round > from && arcs[i] + round < to) nodes.push_back(guide.nodes.col(i));
    }
  }
  nodes.push_back(at(to));
  PrincipalPolyline opened{Eigen::Matrix3Xd(3, nodes.size()), false};
  for (size_t i = 0; i < nodes.size(); ++i) opened.nodes.col(i) = nodes[i];
  return opened;
}

// Cuts a closed guide where its points leave the largest gap.
void CutAtLargestGap(PrincipalPolyline& guide,
                     std::vector<Eigen::Index>& order,
                     Eigen::VectorXd& parameters) {
  const double length = guide.ArcLengths().tail<1>()[0];
  const Eigen::Index m = parameters.size();
  Eigen::Index start = 0;
  double largest = parameters[0] + length - parameters[m - 1];
  for (Eigen::Index i = 1; i < m; ++i) {
    if (parameters[i] - parameters[i - 1] <= largest) continue;
    largest = parameters[i] - parameters[i - 1];
    start = i;
  }
  std::rotate(order.begin(), order.begin() + start, order.end());
  Eigen::VectorXd turned(m);
  for (Eigen::Index i = 0; i < m; ++i) {
    turned[i] = start + i < m ? parameters[start + i] : parameters[start + i - m] + length;
  }
  guide = Opened(guide, turned[0], turned[m - 1]);
  parameters = turned.array() - turned[0];
}

// Extends an open guide straight to its first and last points.
void ReachEnds(PrincipalPolyline& guide, Eigen::VectorXd& parameters) {
  const Eigen::Index last = guide.nodes.cols() - 1;
  const double before = parameters[0];
  const double behind = parameters[parameters.size() - 1] - guide.ArcLengths().tail<1>()[0];
  const Eigen::Vector3d in = (guide.nodes.col(1) - guide.nodes.col(0)).normalized();
  const Eigen::Vector3d out = (guide.nodes.col(last) - guide.nodes.col(last - 1)).normalized();
  if (before < 0) {
    guide.nodes.col(0) += before * in;
    parameters.array() -= before;
  }
  if (behind > 0) guide.nodes.col(last) += behind * out;
}

CurvePath PathOf(const OrderedPlaces& places,
                 const OrderLook& look,
                 int number,
                 const CurveOrderOptions& options,
                 int dimension) {
  PrincipalPolyline guide = look.guides[number];
  std::vector<Eigen::Index> order = Along(look, number);
  Eigen::VectorXd parameters = Parameters(look, order);
  CurvePath path;
  path.noise = NoiseAcross(look, order, dimension) * places.unit;
  if (guide.closed && options.closed == ClosedChoice::kNo) {
    CutAtLargestGap(guide, order, parameters);
  }
  if (!guide.closed) ReachEnds(guide, parameters);
  if (options.closed == ClosedChoice::kYes && guide.nodes.cols() > 2) guide.closed = true;
  path.closed = guide.closed;
  path.length = guide.ArcLengths().tail<1>()[0] * places.unit;
  const auto place = [&](Eigen::Index i) { return places.points.col(order[i]); };
  const auto count = static_cast<Eigen::Index>(order.size());
  path.gap = (place(0) - place(count - 1)).norm() * places.unit;
  std::vector<double> expanded;
  for (Eigen::Index i = 0; i < count; ++i) {
    if (guide.closed && i > 0) {
      path.gap = std::max(path.gap, (place(i) - place(i - 1)).norm() * places.unit);
    }
    for (const Eigen::Index k : places.Given(order[i])) {
      path.points.push_back(k);
      expanded.push_back(parameters[i] * places.unit);
    }
  }
  path.parameters = Eigen::Map<Eigen::VectorXd>(expanded.data(), count > 0 ? expanded.size() : 0);
  path.spacing = path.length / static_cast<double>(count);
  path.guide = (guide.nodes * places.unit).colwise() + places.middle;
  return path;
}

[[noreturn]] void RefuseBranches(const PointCloud& cloud,
                                 const OrderedPlaces& places,
                                 const OrderLook& look) {
  const Eigen::Vector3d world =
      cloud.origin() + places.middle + places.unit * look.meetings.front();
  std::ostringstream message;
  // As many digits as tell nodes apart.
  const double size = world.cwiseAbs().maxCoeff(), step = look.link * places.unit;
  const double digits = size > step ? std::log10(size / step) : 0;
  message.precision(static_cast<int>(std::clamp(digits + 2, 4.0, 17.0)));
  message << "the points branch near (" << world[0] << ", " << world[1];
  if (cloud.dimension() == 3) message << ", " << world[2];
  message << "): a curve neither branches nor crosses itself; fit its parts one by one, or give "
             "the points in their order";
  throw std::invalid_argument(message.str());
}

// The finest trial that gives simple curves: first as without noise, then with the estimated noise,
// then coarser.
OrderLook BestLook(const PointCloud& cloud,
                   const OrderedPlaces& places,
                   ThreadPool& pool,
                   const Progress& progress) {
  const std::vector<int> along = CurveInliers(places.points, pool);
  const Eigen::Matrix3Xd rows = places.points(Eigen::all, along);
  const CurveScale scale = ScaleOfCurves(rows);
  const auto count = static_cast<double>(rows.cols());
  const double share =
      count <= kFewPoints ? kRadiusOfFew : std::max(kRadius, 0.5 * count / kMostNodes);
  const double fine = share * scale.spacing;
  const bool thick = count > kManyThick && scale.noise > kRadiusInNoise * fine;
  OrderLook first = LookAt(places,
                           rows,
                           scale.spacing,
                           thick ? kRadiusInNoise * scale.noise : fine,
                           thick ? scale.noise : 0,
                           pool);
  const double most_out = kMostLeftOut * static_cast<double>(places.points.cols());
  const auto shows_curves = [&](const OrderLook& look, double rough) {
    return look.meetings.empty() && look.turn <= rough &&
           static_cast<double>(look.left_out) <= most_out;
  };
  first.evident = shows_curves(first, thick ? kRoughTurn : kSmoothTurn);
  if (first.evident) return first;
  bool looked = false;
  for (const double factor : kTries) {
    Report(progress, "order", 0.1 * factor);
    const double radius = factor * std::max(kRadiusInNoise * scale.noise, fine);
    const double noise = factor > 1 ? radius / kRadiusInNoise : scale.noise;
    OrderLook look = LookAt(places, rows, scale.spacing, radius, noise, pool);
    look.evident = shows_curves(look, kRoughTurn) && look.length >= kLongInNoise * noise;
    if (look.evident) return look;
    if (!looked && !look.meetings.empty()) first = std::move(look);
    looked = true;
  }
  if (first.meetings.empty()) return first;
  RefuseBranches(cloud, places, first);
}

}  // namespace

CurveOrder OrderAlongCurves(const PointCloud& cloud,
                            const CurveOrderOptions& options,
                            ThreadPool& pool,
                            const Progress& progress) {
  Report(progress, "order", 0);
  const OrderedPlaces places = cloud.size() > 0 ? PlacesOf(cloud) : OrderedPlaces{};
  if (places.points.cols() < 2) {
    throw std::invalid_argument("a curve needs at least two different points");
  }
  OrderLook look = BestLook(cloud, places, pool, progress);
  Report(progress, "order", 0.8);
  // Plane points in space are noisy in the plane only.
  const int directions = std::max(2, PointRank(places.points));
  SmoothPolylines(places, directions, look, pool);
  CurveOrder result;
  result.evident = look.evident;
  for (int g = 0; g < static_cast<int>(look.guides.size()); ++g) {
    if (Along(look, g).empty()) continue;
    result.paths.push_back(PathOf(places, look, g, options, directions));
  }
  if (result.paths.empty()) {
    RefuseScatter();
  }
  std::stable_sort(result.paths.begin(), result.paths.end(), [](const auto& a, const auto& b) {
    return a.length > b.length;
  });
  for (size_t i = 0; i < look.places.size(); ++i) {
    if (look.places[i].guide >= 0) continue;
    const std::span<const Eigen::Index> given = places.Given(static_cast<Eigen::Index>(i));
    result.outliers.insert(result.outliers.end(), given.begin(), given.end());
  }
  std::sort(result.outliers.begin(), result.outliers.end());
  Report(progress, "order", 1);
  return result;
}

}  // namespace batten
