// SPDX-License-Identifier: MIT
#include "fitting/flattening/parameter_blending.h"

#include <algorithm>
#include <cmath>
#include <complex>
#include <vector>

#include "batten/fitting/neighbours.h"

namespace batten::internal {
namespace {

using Complex = std::complex<double>;

constexpr int kChartNeighbours = 6;
constexpr double kSupport = 2;         // of a node, in reaches
constexpr double kReached = 3;         // highest score of a point on the sheet …
constexpr double kOffInNoise = 4;      // … which may be off a node's quadric by so much noise …
constexpr double kOffInReaches = 0.4;  // … and so much for what is wrong with the quadric
constexpr double kMostCurved = 0.5;    // curvature times reach that a node's quadric may have

// A node, ready to map points.
struct NodeMap {
  Eigen::Vector3d place, normal, tangent, binormal;
  Eigen::Matrix2d curvature;
  Complex at, conformal, anticonformal;
  Eigen::Vector3cd bend;
  double reach;

  double Score(const Eigen::Vector3d& point) const {
    const Eigen::Vector3d d = point - place;
    return (d.norm() + 2 * std::abs(d.dot(normal))) / reach;
  }

  Complex Chart(const Eigen::Vector2d& q) const {
    const Complex z(q[0], q[1]);
    const Complex linear = at + conformal * z + anticonformal * std::conj(z);
    if (bend.isZero(0)) return linear;
    return linear + bend[0] * z * z + bend[1] * std::norm(z) + bend[2] * std::conj(z * z);
  }

  // Signed distance from the quadric along the normal.
  double Off(const Eigen::Vector3d& d) const {
    const Eigen::Vector2d t(d.dot(tangent), d.dot(binormal));
    return std::abs(d.dot(normal) - t.dot(curvature * t) / 2);
  }

  Complex OnPlane(const Eigen::Vector3d& d) const {
    return Chart({d.dot(tangent), d.dot(binormal)});
  }

  // By the foot on the quadric h(t) = tᵀKt/2 and the length of the way there: with δ = n − h(t),
  // foot t + δKt, way q = f + (fᵀKf) Kf / 6, both to third order.
  Complex OnQuadric(const Eigen::Vector3d& d) const {
    const Eigen::Vector2d t(d.dot(tangent), d.dot(binormal));
    const Eigen::Vector2d slope = curvature * t;
    const Eigen::Vector2d foot = t + (d.dot(normal) - t.dot(slope) / 2) * slope;
    const Eigen::Vector2d foot_slope = curvature * foot;
    return Chart(foot + foot.dot(foot_slope) / 6 * foot_slope);
  }
};

std::vector<NodeMap> NodeMaps(const PoissonDiskSamples& nodes, const Flattening& unfolding) {
  std::vector<NodeMap> maps(static_cast<size_t>(nodes.size()));
  for (Eigen::Index i = 0; i < nodes.size(); ++i) {
    Eigen::Matrix2d curvature;
    curvature << nodes.curvature(0, i), nodes.curvature(1, i), nodes.curvature(1, i),
        nodes.curvature(2, i);
    const double bend = curvature.norm() * nodes.reach[i];
    if (bend > kMostCurved) curvature *= kMostCurved / bend;
    maps[i] = {nodes.places.col(i),
               nodes.normals.col(i),
               nodes.tangents.col(i),
               nodes.Binormal(i),
               curvature,
               unfolding.places[i],
               unfolding.conformal[i],
               unfolding.anticonformal[i],
               unfolding.bend.cols() > 0 ? unfolding.bend.col(i).eval() : Eigen::Vector3cd::Zero(),
               nodes.reach[i]};
  }
  return maps;
}

// Falls from 1 to 0 with two derivatives.
double Weight(double square) {
  return square < 1 ? (1 - square) * (1 - square) * (1 - square) : 0.0;
}

// Multiple of the period that brings a place nearest to another one.
double WholePeriods(const Complex& way, double period) {
  return period > 0 ? period * std::round(way.real() / period) : 0.0;
}

Complex Blend(const std::vector<NodeMap>& maps,
              const std::vector<int>& ring,
              const NodeMap& best,
              double period,
              const Eigen::Vector3d& point) {
  double total = 0;
  Complex sum = 0;
  for (const int j : ring) {
    const NodeMap& map = maps[j];
    const Eigen::Vector3d d = point - map.place;
    const double support = kSupport * map.reach;
    const double weight = Weight(d.squaredNorm() / (support * support));
    if (!(weight > 0)) continue;
    total += weight;
    sum += weight * (map.OnQuadric(d) + WholePeriods(best.at - map.at, period));
  }
  return total > 0 ? sum / total : best.OnPlane(point - best.place);
}

}  // namespace

SpreadPlaces BlendLocalCharts(const SheetGraph& graph,
                              const Flattening& unfolding,
                              const Eigen::Matrix3Xd& points,
                              double noise,
                              ThreadPool& pool) {
  const std::vector<NodeMap> maps = NodeMaps(graph.nodes, unfolding);
  const std::vector<std::vector<int>> rings =
      TwoRings(NeighboursOf(graph.nodes.size(), graph.edges));
  const NeighbourIndex index(graph.nodes.places);
  const auto asked = static_cast<int>(std::min<Eigen::Index>(kChartNeighbours, graph.nodes.size()));
  SpreadPlaces spread{Eigen::Matrix2Xd(2, points.cols()), PointMask(points.cols())};
  pool.For(points.cols(), 1024, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    const std::vector<int> near = index.Nearest(points.middleCols(begin, end - begin), asked);
    for (auto k = begin; k < end; ++k) {
      const Eigen::Vector3d point = points.col(k);
      const int* candidates = near.data() + (k - begin) * asked;
      int best = candidates[0];
      double least = maps[best].Score(point);
      for (int j = 1; j < asked; ++j) {
        const double score = maps[candidates[j]].Score(point);
        if (score < least) {
          least = score;
          best = candidates[j];
        }
      }
      const Complex z = Blend(maps, rings[best], maps[best], unfolding.period, point);
      spread.places.col(k) << z.real(), z.imag();
      spread.reached[k] =
          least <= kReached && maps[best].Off(point - maps[best].place) <=
                                   kOffInNoise * noise + kOffInReaches * maps[best].reach;
    }
  });
  return spread;
}

}  // namespace batten::internal
