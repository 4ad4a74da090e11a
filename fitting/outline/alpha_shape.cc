// SPDX-License-Identifier: MIT
#include "fitting/outline/alpha_shape.h"

#include <algorithm>
#include <boost/polygon/voronoi.hpp>
#include <cmath>
#include <cstdint>

#include "fitting/outline/empty_discs.h"

namespace batten::internal {
namespace {

using Index = Eigen::Index;
using Voronoi = boost::polygon::voronoi_diagram<double>;
using Site = boost::polygon::point_data<std::int32_t>;

constexpr double kExtent = 1 << 30;  // largest integer coordinate in magnitude

using Stretch = std::function<double(const Eigen::Vector2d&)>;

struct Edge {
  int from, to;  // of the points; what is covered is on the left
};

// Maps points to integer coordinates about the middle of their box.
class IntegerMap {
 public:
  explicit IntegerMap(const Eigen::Matrix2Xd& points) {
    const Eigen::Vector2d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    middle_ = low + (high - low) / 2;
    const double half = (high - low).maxCoeff() / 2;
    unit_ = half > 0 ? half / kExtent : 1.0;
  }
  Site To(const Eigen::Vector2d& place) const {
    const Eigen::Array2d scaled = ((place - middle_) / unit_).array().round();
    return {static_cast<std::int32_t>(scaled[0]), static_cast<std::int32_t>(scaled[1])};
  }
  Eigen::Vector2d From(double x, double y) const { return middle_ + unit_ * Eigen::Vector2d(x, y); }
  double unit() const { return unit_; }

 private:
  Eigen::Vector2d middle_;
  double unit_;
};

// A vertex of the diagram is the circumcentre of a triangle, or of a polygon on one circle. It is
// outside the shape if that circle is larger than the radius and holds no point of the whole cloud;
// the triangles outside are the same for the whole cloud and for the points that touch empty discs:
// a circle larger than the radius about the centre of an empty disc that holds any point would,
// grown from that disc, meet one first that touches an empty disc.
std::vector<Edge> BorderEdges(const Eigen::Matrix2Xd& points,
                              double radius,
                              const Stretch& stretch,
                              ThreadPool& pool) {
  const EmptyDiscs discs(points, radius, pool);
  const std::vector<int>& used = discs.touched();
  if (used.size() < 3) return {};
  const Eigen::Matrix2Xd chosen = points(Eigen::all, used);
  const IntegerMap map(chosen);
  std::vector<Site> sites;
  sites.reserve(used.size());
  for (Eigen::Index k = 0; k < chosen.cols(); ++k) sites.push_back(map.To(chosen.col(k)));
  Voronoi diagram;
  boost::polygon::construct_voronoi(sites.begin(), sites.end(), &diagram);
  const double limit = radius / map.unit();
  for (const auto& vertex : diagram.vertices()) {
    const Site& site = sites[vertex.incident_edge()->cell()->source_index()];
    const double circumradius = std::hypot(vertex.x() - site.x(), vertex.y() - site.y());
    if (!(circumradius > limit) || !discs.MayBeCentre(map.From(vertex.x(), vertex.y()))) continue;
    Eigen::Vector2d mean = Eigen::Vector2d::Zero();
    int count = 0;
    const auto* edge = vertex.incident_edge();
    do {
      mean += chosen.col(static_cast<Index>(edge->cell()->source_index()));
      ++count;
      edge = edge->rot_next();
    } while (edge != vertex.incident_edge());
    vertex.color(circumradius > limit * stretch(mean / count));
  }
  const auto outside = [](const auto* vertex) { return vertex == nullptr || vertex->color() != 0; };
  std::vector<Edge> edges;
  for (const auto& edge : diagram.edges()) {
    if (outside(edge.vertex0()) || !outside(edge.vertex1())) continue;
    edges.push_back({used[edge.twin()->cell()->source_index()], used[edge.cell()->source_index()]});
  }
  return edges;
}

// Chooses the next edge at a vertex where several begin: the first one clockwise from the incoming
// edge, so that the same covered wedge stays on the left.
size_t NextEdge(const Eigen::Matrix2Xd& points,
                const std::vector<Edge>& edges,
                const std::vector<char>& done,
                const Edge& last,
                size_t begin) {
  const Eigen::Vector2d back = points.col(last.from) - points.col(last.to);
  size_t best = edges.size();
  double least = 7;
  for (size_t e = begin; e < edges.size() && edges[e].from == last.to; ++e) {
    if (done[e]) continue;
    const Eigen::Vector2d way = points.col(edges[e].to) - points.col(edges[e].from);
    double angle = -std::atan2(back.x() * way.y() - back.y() * way.x(), back.dot(way));
    if (angle <= 0) angle += 2 * M_PI;
    if (angle < least) {
      least = angle;
      best = e;
    }
  }
  return best;
}

// Splits loops in two at a vertex they visit twice.
class Chains {
 public:
  Chains(const Eigen::Matrix2Xd& points, std::vector<Edge> edges)
      : points_(points), edges_(std::move(edges)), done_(edges_.size(), 0) {
    std::sort(edges_.begin(), edges_.end(), [&](const Edge& a, const Edge& b) {
      return a.from != b.from ? Before(a.from, b.from) : Before(a.to, b.to);
    });
    first_.assign(static_cast<size_t>(points.cols()), edges_.size());
    for (size_t e = edges_.size(); e-- > 0;) first_[edges_[e].from] = e;
    place_.assign(static_cast<size_t>(points.cols()), -1);
  }

  std::vector<Eigen::Matrix2Xd> Loops() {
    for (size_t e = 0; e < edges_.size(); ++e)
      if (!done_[e]) Follow(e);
    return std::move(loops_);
  }

 private:
  // Sorted by place, so that the result does not depend on the order of the points.
  bool Before(int a, int b) const {
    if (points_(0, a) != points_(0, b)) return points_(0, a) < points_(0, b);
    if (points_(1, a) != points_(1, b)) return points_(1, a) < points_(1, b);
    return a < b;
  }

  void Follow(size_t edge) {
    Visit(edges_[edge].from);
    while (edge < edges_.size() && !done_[edge]) {
      done_[edge] = 1;
      const Edge& last = edges_[edge];
      Visit(last.to);
      edge = NextEdge(points_, edges_, done_, last, first_[last.to]);
    }
    for (const int vertex : path_) place_[vertex] = -1;
    path_.clear();
  }

  void Visit(int vertex) {
    if (place_[vertex] >= 0) {
      const auto begin = static_cast<size_t>(place_[vertex]);
      Eigen::Matrix2Xd loop(2, static_cast<Eigen::Index>(path_.size() - begin));
      for (size_t i = begin; i < path_.size(); ++i) {
        loop.col(static_cast<Eigen::Index>(i - begin)) = points_.col(path_[i]);
        place_[path_[i]] = -1;
      }
      path_.resize(begin);
      if (loop.cols() > 2) loops_.push_back(std::move(loop));
    }
    place_[vertex] = static_cast<int>(path_.size());
    path_.push_back(vertex);
  }

  const Eigen::Matrix2Xd& points_;
  std::vector<Edge> edges_;
  std::vector<char> done_;
  std::vector<size_t> first_;
  std::vector<int> place_, path_;  // of a vertex in the path, −1 if not in it
  std::vector<Eigen::Matrix2Xd> loops_;
};

}  // namespace

std::vector<Eigen::Matrix2Xd> AlphaShape(const Eigen::Matrix2Xd& points,
                                         double radius,
                                         const Stretch& stretch,
                                         ThreadPool& pool) {
  return Chains(points, BorderEdges(points, radius, stretch, pool)).Loops();
}

}  // namespace batten::internal
