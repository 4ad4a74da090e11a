// SPDX-License-Identifier: MIT
#include "fitting/ordering/principal_polyline.h"

#include <algorithm>
#include <cmath>

#include "batten/fitting/neighbours.h"
#include "fitting/core/shared_constants.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr int kNearNodes = 4;  // whose links are looked at
constexpr int kFewestInWindow = 8;

struct PolylineSpot {
  int guide;
  Eigen::Index node;
};

// Looks one link over and keeps the place when it is the nearest yet.
void Look(const PrincipalPolyline& guide,
          int number,
          const Eigen::VectorXd& arcs,
          Eigen::Index link,
          const Eigen::Vector3d& point,
          PolylinePlace& best) {
  const Eigen::Vector3d from = guide.nodes.col(link), along = guide.Next(link) - from;
  const double length = along.norm();
  if (!(length > 0)) return;
  double t = along.dot(point - from) / (length * length);
  if (guide.closed || link > 0) t = std::max(t, 0.0);
  if (guide.closed || link + 1 < guide.links()) t = std::min(t, 1.0);
  const double distance = (point - from - t * along).norm();
  if (best.guide >= 0 && distance >= best.distance) return;
  best = {number, arcs[link] + t * length, distance};
}

}  // namespace

Eigen::VectorXd PrincipalPolyline::ArcLengths() const {
  Eigen::VectorXd arcs = Eigen::VectorXd::Zero(links() + 1);
  for (Eigen::Index i = 0; i < links(); ++i)
    arcs[i + 1] = arcs[i] + (Next(i) - nodes.col(i)).norm();
  return arcs;
}

std::vector<PolylinePlace> PlacesOnPolylines(const std::vector<PrincipalPolyline>& guides,
                                             const Eigen::Matrix3Xd& points,
                                             ThreadPool& pool) {
  std::vector<PolylineSpot> spots;
  std::vector<Eigen::VectorXd> arcs;
  for (int g = 0; g < static_cast<int>(guides.size()); ++g) {
    for (Eigen::Index i = 0; i < guides[g].nodes.cols(); ++i) spots.push_back({g, i});
    arcs.push_back(guides[g].ArcLengths());
  }
  Eigen::Matrix3Xd nodes(3, spots.size());
  for (size_t i = 0; i < spots.size(); ++i) {
    nodes.col(i) = guides[spots[i].guide].nodes.col(spots[i].node);
  }
  const NeighbourIndex index(nodes);
  const int k = static_cast<int>(std::min<Eigen::Index>(kNearNodes, nodes.cols()));
  std::vector<PolylinePlace> places(points.cols());
  pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const std::vector<int> nearest = index.Nearest(points.middleCols(begin, end - begin), k);
    for (std::ptrdiff_t i = begin; i < end; ++i) {
      for (int j = 0; j < k; ++j) {
        const PolylineSpot& spot = spots[nearest[(i - begin) * k + j]];
        const PrincipalPolyline& guide = guides[spot.guide];
        const Eigen::Index count = guide.nodes.cols();
        for (const Eigen::Index link : {spot.node - 1, spot.node}) {
          const Eigen::Index around = guide.closed ? (link + count) % count : link;
          if (around < 0 || around >= guide.links()) continue;
          Look(guide, spot.guide, arcs[spot.guide], around, points.col(i), places[i]);
        }
      }
    }
  });
  return places;
}

PrincipalPolyline Smoothed(const Eigen::Matrix3Xd& points,
                           const Eigen::VectorXd& parameters,
                           bool closed,
                           double length,
                           double reach,
                           double step) {
  const Eigen::Index m = points.cols();
  const double first = closed ? 0 : parameters[0];
  const double last = closed ? length : parameters[m - 1];
  const double most = std::min(static_cast<double>(m), std::ceil((last - first) / step));
  const auto links = std::max<Eigen::Index>(closed ? 4 : 1, static_cast<Eigen::Index>(most));
  PrincipalPolyline guide{Eigen::Matrix3Xd(3, closed ? links : links + 1), closed};
  // Point k of an endless row: round and round where closed.
  const auto parameter = [&](Eigen::Index k) {
    const Eigen::Index round = k < 0 ? -1 : k >= m ? 1 : 0;
    return parameters[k - round * m] + static_cast<double>(round) * length;
  };
  const Eigen::Index low = closed ? -m : 0, high = closed ? 2 * m : m;
  Eigen::Index begin = low, end = low;
  for (Eigen::Index i = 0; i < guide.nodes.cols(); ++i) {
    const double centre =
        first + (last - first) * static_cast<double>(i) / static_cast<double>(links);
    while (begin < high && parameter(begin) < centre - reach) ++begin;
    while (end < high && parameter(end) <= centre + reach) ++end;
    Eigen::Index from = std::min(begin, end), to = end;
    double width = reach;
    while (to - from < kFewestInWindow && (from > low || to < high)) {
      const bool below =
          to == high || (from > low && centre - parameter(from - 1) < parameter(to) - centre);
      width = 1.2 * std::abs(centre - parameter(below ? --from : to++));
    }
    Eigen::Matrix3d gram = Eigen::Matrix3d::Zero();
    Eigen::Matrix3d right = Eigen::Matrix3d::Zero();
    for (Eigen::Index k = from; k < to; ++k) {
      const double t = width > 0 ? (parameter(k) - centre) / width : 0;  // all in one place
      const double bell = std::max(0.0, 1 - t * t);
      const Eigen::Vector3d powers(1, t, t * t);
      gram.noalias() += bell * powers * powers.transpose();
      right.noalias() += bell * powers * points.col(((k % m) + m) % m).transpose();
    }
    gram.diagonal().array() += 1e-9 * gram(0, 0) * Eigen::Array3d(0, 1, 1);
    guide.nodes.col(i) = SymmetricSolutions3(gram, right).row(0).transpose();
  }
  return guide;
}

}  // namespace batten::internal
