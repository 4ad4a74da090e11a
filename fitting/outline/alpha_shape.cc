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

using IsGap = std::function<bool(const Eigen::Matrix2Xd&, double)>;

struct Edge {
  int from, to;  // of the points; what is covered is on the left
};

// Maps points to integer coordinates, up to 2^30 in magnitude, about the middle of their box.
class IntegerMap {
 public:
  explicit IntegerMap(const Eigen::Matrix2Xd& points) {
    const Eigen::Vector2d low = points.rowwise().minCoeff(), high = points.rowwise().maxCoeff();
    middle_ = low + (high - low) / 2;
    const double half = (high - low).maxCoeff() / 2;
    unit_ = half > 0 ? half / (1 << 30) : 1.0;
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

// The Delaunay triangles of the points beside empty discs, as a Voronoi diagram. A vertex of the
// diagram is the circumcentre of a triangle, or of a polygon on one circle. Its circle is one of
// the whole cloud's where it is larger than the radius and holds no point: a circle larger than the
// radius about the centre of an empty disc that holds any point would, grown from that disc, meet
// one first that touches an empty disc.
class LargeCircles {
 public:
  LargeCircles(const Eigen::Matrix2Xd& points, double radius, ThreadPool& pool)
      : discs_(points, radius, pool),
        points_(points(Eigen::all, discs_.touched())),
        map_(points_),
        limit_(radius / map_.unit()) {
    if (points_.cols() < 3) return;
    sites_.reserve(discs_.touched().size());
    for (Index k = 0; k < points_.cols(); ++k) sites_.push_back(map_.To(points_.col(k)));
    boost::polygon::construct_voronoi(sites_.begin(), sites_.end(), &diagram_);
  }

  const Voronoi& diagram() const { return diagram_; }
  const std::vector<int>& used() const { return discs_.touched(); }

  // The radius of a vertex' circle, 0 where it is not large.
  double RadiusOf(const Voronoi::vertex_type& vertex) const {
    const Site& site = sites_[vertex.incident_edge()->cell()->source_index()];
    const double radius = std::hypot(vertex.x() - site.x(), vertex.y() - site.y());
    const bool large = radius > limit_ && discs_.MayBeCentre(map_.From(vertex.x(), vertex.y()));
    return large ? radius * map_.unit() : 0;
  }

 private:
  EmptyDiscs discs_;
  Eigen::Matrix2Xd points_;
  IntegerMap map_;
  double limit_;
  std::vector<Site> sites_;
  Voronoi diagram_;
};

// Those between the triangles of the shape and the others.
std::vector<Edge> BorderEdges(const Eigen::Matrix2Xd& points,
                              double radius,
                              const IsGap& is_gap,
                              ThreadPool& pool) {
  const LargeCircles circles(points, radius, pool);
  const std::vector<int>& used = circles.used();
  const auto point_of = [&](const auto& edge) { return used[edge.cell()->source_index()]; };
  for (const auto& vertex : circles.diagram().vertices()) {
    const double large = circles.RadiusOf(vertex);
    if (!(large > 0)) continue;
    std::vector<Index> corners;
    const auto* edge = vertex.incident_edge();
    do {
      corners.push_back(point_of(*edge));
      edge = edge->rot_next();
    } while (edge != vertex.incident_edge());
    vertex.color(is_gap(points(Eigen::all, corners), large));
  }
  const auto outside = [](const auto* vertex) { return vertex == nullptr || vertex->color() != 0; };
  std::vector<Edge> edges;
  for (const auto& edge : circles.diagram().edges()) {
    if (outside(edge.vertex0()) || !outside(edge.vertex1())) continue;
    edges.push_back({point_of(*edge.twin()), point_of(edge)});
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

std::vector<EmptyCircle> EmptyCircles(const Eigen::Matrix2Xd& points,
                                      double radius,
                                      ThreadPool& pool) {
  const LargeCircles circles(points, radius, pool);
  std::vector<EmptyCircle> found;
  for (const auto& vertex : circles.diagram().vertices()) {
    const double large = circles.RadiusOf(vertex);
    if (!(large > 0)) continue;
    EmptyCircle circle{Eigen::Vector2d::Zero(), large, 0};
    const auto corner = [&](const auto* edge) -> Eigen::Vector2d {
      return points.col(circles.used()[edge->cell()->source_index()]);
    };
    const auto* const start = vertex.incident_edge();
    double corners = 0;
    for (const auto* edge = start; corners == 0 || edge != start; edge = edge->rot_next()) {
      const Eigen::Vector2d a = corner(edge) - corner(start),
                            b = corner(edge->rot_next()) - corner(start);
      circle.area += std::abs(a.x() * b.y() - a.y() * b.x()) / 2;
      circle.place += corner(edge);
      ++corners;
    }
    circle.place /= corners;
    found.push_back(circle);
  }
  return found;
}

std::vector<Eigen::Matrix2Xd> AlphaShape(const Eigen::Matrix2Xd& points,
                                         double radius,
                                         const IsGap& is_gap,
                                         ThreadPool& pool) {
  if (points.cols() < 3) return {};
  return Chains(points, BorderEdges(points, radius, is_gap, pool)).Loops();
}

}  // namespace batten::internal
