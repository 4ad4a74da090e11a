// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_polygon.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "fitting/core/shared_constants.h"

namespace batten::internal {
namespace {

constexpr int kFewestPolygonCorners = 3, kMost = 400;  // sides of a span
constexpr double kLongestSide = 1;

std::vector<OutlinePolygon::Vertex> VerticesOf(const OutlineSpline& loop, double sagitta) {
  std::vector<OutlinePolygon::Vertex> vertices;
  const auto& knots = loop.basis.knots();
  const int p = loop.basis.degree();
  for (const int span : loop.basis.Spans()) {
    const double begin = knots[span], length = knots[span + 1] - begin;
    double bend = 0;  // a bound of |C''| over the span, by the differences of its control points
    for (int i = span - p; i + 2 <= span; ++i) {
      const auto slope = [&](int k) {
        return Eigen::Vector2d(
            p * (loop.points.col(loop.unknown[k + 1]) - loop.points.col(loop.unknown[k])) /
            (knots[k + p + 1] - knots[k + 1]));
      };
      const double width = knots[i + p + 1] - knots[i + 2];
      bend = std::max(bend, ((p - 1) * (slope(i + 1) - slope(i)) / width).norm());
    }
    const double sides = std::max(length * std::sqrt(bend / (8 * sagitta)), length / kLongestSide);
    const int count =
        static_cast<int>(std::clamp<double>(std::ceil(sides), kFewestPolygonCorners, kMost));
    for (int k = 0; k < count; ++k) {
      const double t = begin + length * k / count;
      vertices.push_back({t, loop.At(t)});
    }
  }
  vertices.push_back({loop.basis.upper(), vertices.front().place});
  return vertices;
}

}  // namespace

OutlinePolygon::OutlinePolygon(const std::vector<OutlineSpline>& loops,
                               double reach,
                               double sagitta)
    : reach_(reach), side_(2 * reach) {
  Eigen::Vector2d low = Eigen::Vector2d::Constant(std::numeric_limits<double>::infinity());
  Eigen::Vector2d high = -low;
  for (const OutlineSpline& loop : loops) {
    vertices_.push_back(VerticesOf(loop, sagitta));
    for (size_t k = 0; k + 1 < vertices_.back().size(); ++k) {
      segments_.push_back({static_cast<int>(vertices_.size()) - 1, k});
      low = low.cwiseMin(vertices_.back()[k].place);
      high = high.cwiseMax(vertices_.back()[k].place);
    }
  }
  constexpr double kMostCells = 1e7;
  const Eigen::Vector2d extent = (high - low).array() + 2 * reach;
  side_ = std::max(side_, std::sqrt(extent.prod() / kMostCells));
  corner_ = low.array() - reach;
  nu_ = static_cast<std::int64_t>(extent[0] / side_) + 1;
  nv_ = static_cast<std::int64_t>(extent[1] / side_) + 1;
  Enter();
  MarkInside();
}

void OutlinePolygon::Enter() {
  const auto for_each_cell = [&](const Segment& segment, const auto& act) {
    const auto& vertices = vertices_[segment.loop];
    const Eigen::Vector2d &a = vertices[segment.first].place,
                          &b = vertices[segment.first + 1].place;
    const Eigen::Array2d low = (a.cwiseMin(b) - corner_).array() - reach_;
    const Eigen::Array2d high = (a.cwiseMax(b) - corner_).array() + reach_;
    const auto cell = [&](double x, std::int64_t count) {
      return std::clamp<std::int64_t>(
          static_cast<std::int64_t>(std::floor(x / side_)), 0, count - 1);
    };
    for (std::int64_t j = cell(low[1], nv_); j <= cell(high[1], nv_); ++j)
      for (std::int64_t i = cell(low[0], nu_); i <= cell(high[0], nu_); ++i) act(j * nu_ + i);
  };
  begin_.assign(static_cast<size_t>(nu_ * nv_ + 1), 0);
  for (const Segment& segment : segments_)
    for_each_cell(segment, [&](std::int64_t cell) { ++begin_[cell + 1]; });
  for (size_t c = 1; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  entries_.resize(static_cast<size_t>(begin_.back()));
  std::vector<std::int64_t> next(begin_.begin(), begin_.end() - 1);
  for (size_t s = 0; s < segments_.size(); ++s)
    for_each_cell(segments_[s],
                  [&](std::int64_t cell) { entries_[next[cell]++] = static_cast<int>(s); });
}

// Along the middle of each row of cells, by the borders crossed.
void OutlinePolygon::MarkInside() {
  std::vector<std::vector<double>> crossings(static_cast<size_t>(nv_));
  for (const Segment& segment : segments_) {
    const Eigen::Vector2d a = vertices_[segment.loop][segment.first].place - corner_,
                          b = vertices_[segment.loop][segment.first + 1].place - corner_;
    const double low = std::min(a.y(), b.y()), high = std::max(a.y(), b.y());
    const auto first = static_cast<std::int64_t>(std::max(0.0, std::floor(low / side_ - 0.5)));
    for (std::int64_t j = first; j < nv_ && (static_cast<double>(j) + 0.5) * side_ < high; ++j) {
      const double v = (static_cast<double>(j) + 0.5) * side_;
      if (v < low) continue;
      crossings[j].push_back(a.x() + (v - a.y()) / (b.y() - a.y()) * (b.x() - a.x()));
    }
  }
  inside_.assign(static_cast<size_t>(nu_ * nv_), 0);
  for (std::int64_t j = 0; j < nv_; ++j) {
    std::sort(crossings[j].begin(), crossings[j].end());
    size_t passed = 0;
    for (std::int64_t i = 0; i < nu_; ++i) {
      const double u = (static_cast<double>(i) + 0.5) * side_;
      while (passed < crossings[j].size() && crossings[j][passed] < u) ++passed;
      inside_[j * nu_ + i] = passed % 2 != 0;
    }
  }
}

// By the borders crossed on the way to the middle of the cell, all of which are entered in it.
bool OutlinePolygon::IsInside(const Eigen::Vector2d& point, std::int64_t cell) const {
  const Eigen::Vector2d middle =
      corner_ + side_ * Eigen::Vector2d(static_cast<double>(cell % nu_) + 0.5,
                                        static_cast<double>(cell / nu_) + 0.5);
  const Eigen::Vector2d way = middle - point;
  const auto cross = [](const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
    return a.x() * b.y() - a.y() * b.x();
  };
  bool inside = inside_[cell] != 0;
  for (std::int64_t e = begin_[cell]; e < begin_[cell + 1]; ++e) {
    const Segment& segment = segments_[entries_[e]];
    const Eigen::Vector2d a = vertices_[segment.loop][segment.first].place - point,
                          b = vertices_[segment.loop][segment.first + 1].place - point;
    const double of_a = cross(way, a), of_b = cross(way, b);
    if ((of_a > 0) == (of_b > 0)) continue;
    const Eigen::Vector2d at = a + of_a / (of_a - of_b) * (b - a);
    const double share = at.dot(way);
    if (share > 0 && share < way.squaredNorm()) inside = !inside;
  }
  return inside;
}

OutlineFootPoint OutlinePolygon::FootOf(const Eigen::Vector2d& point, std::int64_t cell) const {
  double least = std::numeric_limits<double>::infinity();
  OutlineFootPoint foot{0, -1, 0, 0, Eigen::Vector2d::Zero()};
  Eigen::Vector2d nearest = point, normals = Eigen::Vector2d::Zero();
  int meeting = 0;  // sides at the nearest place
  for (std::int64_t e = begin_[cell]; e < begin_[cell + 1]; ++e) {
    const Segment& segment = segments_[entries_[e]];
    const Vertex &a = vertices_[segment.loop][segment.first],
                 &b = vertices_[segment.loop][segment.first + 1];
    const Eigen::Vector2d way = b.place - a.place;
    const double length = way.norm();
    if (!(length > 0)) continue;
    const double share = std::clamp(way.dot(point - a.place) / (length * length), 0.0, 1.0);
    const Eigen::Vector2d place = share == 1 ? b.place : Eigen::Vector2d(a.place + share * way);
    const double square = (point - place).squaredNorm();
    const Eigen::Vector2d right = Eigen::Vector2d(way.y(), -way.x()) / length;
    if (square == least && place == nearest) {
      normals += right;  // two sides that meet
      ++meeting;
    } else if (square < least) {
      least = square;
      nearest = place;
      normals = right;
      meeting = 1;
      foot.loop = segment.loop;
      foot.t = a.t + share * (b.t - a.t);
    }
  }
  const double distance = std::sqrt(least);
  // Nearer borders than those entered in the cell may be beyond the reach, and where more than two
  // sides meet their normals do not tell.
  const bool outside =
      distance > reach_ || meeting > 2 ? !IsInside(point, cell) : normals.dot(point - nearest) > 0;
  foot.outside = outside ? distance : -distance;
  foot.outward = distance > 1e-3 ? Eigen::Vector2d((point - nearest) / foot.outside)
                                 : Eigen::Vector2d(normals.normalized());
  return foot;
}

std::vector<OutlineFootPoint> OutlinePolygon::FootPointSet(const Eigen::Matrix2Xd& points,
                                                           ThreadPool& pool) const {
  const std::ptrdiff_t blocks = (points.cols() + kPointsPerTask - 1) / kPointsPerTask;
  std::vector<std::vector<OutlineFootPoint>> found(static_cast<size_t>(blocks));
  pool.For(points.cols(), kPointsPerTask, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const Eigen::Array2d place = (points.col(k) - corner_).array() / side_;
      OutlineFootPoint foot{
          k, -1, 0, std::numeric_limits<double>::infinity(), Eigen::Vector2d::Zero()};
      if ((place >= 0).all() && place[0] < static_cast<double>(nu_) &&
          place[1] < static_cast<double>(nv_)) {
        const std::int64_t cell =
            static_cast<std::int64_t>(place[1]) * nu_ + static_cast<std::int64_t>(place[0]);
        if (begin_[cell] != begin_[cell + 1]) {
          foot = FootOf(points.col(k), cell);
          foot.point = k;
        } else if (inside_[cell] != 0) {
          continue;
        }
      }
      if (foot.outside > -reach_) found[begin / kPointsPerTask].push_back(foot);
    }
  });
  std::vector<OutlineFootPoint> feet;
  for (const auto& block : found) feet.insert(feet.end(), block.begin(), block.end());
  return feet;
}

}  // namespace batten::internal
