// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_loop.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "fitting/core/rounding.h"
#include "fitting/outline/outline_corners.h"

namespace batten::internal {
namespace {

using Index = Eigen::Index;

constexpr double kSmoothed = 3;  // either way
constexpr double kLookedAt = 5;  // from a corner on, for what is …
constexpr double kOffSide = 1;   // … this far off its side

Eigen::Vector2d RightOf(const Eigen::Vector2d& way) { return {way.y(), -way.x()}; }

// Points evenly along a closed polygon, how far apart, and the edges of the polygon they lie on.
struct EvenPoints {
  Eigen::Matrix2Xd points;
  double step;
  std::vector<Index> edges;
};

EvenPoints Evenly(const Eigen::Matrix2Xd& polygon) {
  const Index n = polygon.cols();
  double length = 0;
  for (Index i = 0; i < n; ++i) length += (polygon.col((i + 1) % n) - polygon.col(i)).norm();
  const Index count = std::max<Index>(8, std::lround(length / kBorderStep));
  const double step = length / static_cast<double>(count);
  EvenPoints result{Eigen::Matrix2Xd(2, count), step, {}};
  Index edge = 0;
  double begin = 0, size = (polygon.col(1 % n) - polygon.col(0)).norm();
  for (Index k = 0; k < count; ++k) {
    const double at = step * static_cast<double>(k);
    while (at > begin + size && edge + 1 < n) {
      begin += size;
      ++edge;
      size = (polygon.col((edge + 1) % n) - polygon.col(edge)).norm();
    }
    const double share = size > 0 ? std::clamp((at - begin) / size, 0.0, 1.0) : 0.0;
    result.edges.push_back(edge);
    result.points.col(k) =
        polygon.col(edge) + share * (polygon.col((edge + 1) % n) - polygon.col(edge));
  }
  return result;
}

// Samples of the points first … last (wrapped), each smoothed by a line through those near it.
class StretchSmoothing {
 public:
  StretchSmoothing(const Eigen::Matrix2Xd& border, double step, const Outwards& outwards)
      : border_(border),
        reach_(std::clamp<Index>(border.cols() / 16, 2, std::lround(kSmoothed / step))),
        outwards_(outwards) {}

  OutlineSample Sample(Index i, Index first, Index last) const {
    const Index low = std::max(first, i - reach_), high = std::min(last, i + reach_);
    Eigen::Vector2d mean = Eigen::Vector2d::Zero(), slope = mean;
    double square = 0;
    const double middle = 0.5 * static_cast<double>(low + high);
    for (Index k = low; k <= high; ++k) mean += At(k);
    mean /= static_cast<double>(high - low + 1);
    for (Index k = low; k <= high; ++k) {
      const double from = static_cast<double>(k) - middle;
      slope += from * (At(k) - mean);
      square += from * from;
    }
    if (square > 0) slope /= square;
    const Eigen::Vector2d right = RightOf(slope.normalized());
    const Eigen::Vector2d place = mean + (static_cast<double>(i) - middle) * slope;
    const Eigen::Vector2d off = outwards_(At(i)) * right;
    return {place + off, At(i) + off, false, false, false, At(i), {}};
  }

 private:
  Eigen::Vector2d At(Index i) const {
    const Index n = border_.cols();
    return border_.col(((i % n) + n) % n);
  }

  const Eigen::Matrix2Xd& border_;
  Index reach_;
  const Outwards& outwards_;
};

// The number of points next to a corner, in one direction, that are off its side.
Index Rounded(const Eigen::Matrix2Xd& border,
              Index corner,
              int way,
              const OutlineLine& side,
              double step,
              Index most) {
  Index count = std::lround(kCornerGap / step);
  const auto looked = static_cast<Index>(kLookedAt / step);
  for (Index k = count; k < std::min(looked, most); ++k) {
    const Index n = border.cols();
    const Eigen::Vector2d from = border.col(((corner + way * k) % n + n) % n) - side.point;
    if (std::abs(RightOf(side.direction).dot(from)) > kOffSide) count = k + 1;
  }
  return count;
}

Eigen::Vector2d CornerMoved(const OutlineCorner& corner, double outwards) {
  const double half = corner.turn / 2;
  const Eigen::Vector2d along = (corner.before.direction + corner.after.direction).normalized();
  return corner.place + outwards / std::cos(half) * RightOf(along);
}

}  // namespace

OutlineLoop SampledOutline(const Eigen::Matrix2Xd& polygon, const Outwards& outwards) {
  const auto [border, step, edges] = Evenly(polygon);
  const std::vector<OutlineCorner> corners = OutlineCorners(border, step);
  const StretchSmoothing smoothing(border, step, outwards);
  OutlineLoop loop;
  std::vector<Index> indices;  // of the samples on the border
  const Index n = border.cols();
  const auto add = [&](Index i, OutlineSample sample) {
    loop.push_back(std::move(sample));
    indices.push_back(i % n);
  };
  if (corners.empty())
    for (Index i = 0; i < n; ++i) add(i, smoothing.Sample(i, -n, 2 * n));
  for (size_t c = 0; c < corners.size(); ++c) {
    const Eigen::Vector2d place = CornerMoved(corners[c], outwards(corners[c].place));
    add(corners[c].index, {place, place, true, false, false, border.col(corners[c].index), {}});
    const OutlineCorner& next = corners[(c + 1) % corners.size()];
    const Index end = c + 1 < corners.size() ? next.index : next.index + n;
    const Index room = (end - corners[c].index) / 3;
    const Index first =
        corners[c].index + Rounded(border, corners[c].index, 1, corners[c].after, step, room);
    const Index last = end - Rounded(border, next.index, -1, next.before, step, room);
    for (Index i = first; i <= last; ++i) add(i, smoothing.Sample(i, first, last));
  }
  for (size_t k = 0; k < loop.size(); ++k) {
    const Index last = edges[indices[(k + 1) % loop.size()]];
    for (Index edge = edges[indices[k]]; edge != last;) {
      edge = (edge + 1) % polygon.cols();
      loop[k].vertices.push_back(polygon.col(edge));
    }
  }
  return loop;
}

namespace {

// Leaves out vertices at which a pinned border turns back on itself, as it may among points on one
// line, such as those that were moved onto a side of the rectangle.
void DropSpikes(OutlineLoop& loop) {
  for (size_t k = 0, kept = 0; kept < loop.size() && loop.size() > 3;) {
    const size_t n = loop.size(), before = (k + n - 1) % n;
    const Eigen::Vector2d to = loop[k].place - loop[before].place,
                          on = loop[(k + 1) % n].place - loop[k].place;
    if (loop[before].pinned && loop[k].pinned && to.dot(on) <= 0 &&
        std::abs(to.x() * on.y() - to.y() * on.x()) <= kRelativelyEqual) {
      loop.erase(loop.begin() + static_cast<std::ptrdiff_t>(k));
      k = (k + n - 2) % (n - 1);  // the one before may turn back now
      kept = 0;
    } else {
      k = (k + 1) % n;
      ++kept;
    }
  }
}

}  // namespace

void PinToBorder(OutlineLoop& loop, const OutlinePin& pin) {
  const size_t n = loop.size();
  std::vector<char> near(n, 0);
  for (size_t k = 0; k < n; ++k) {
    if (loop[k].along_cut || loop[(k + n - 1) % n].along_cut) continue;
    near[k] = pin.Holds(loop[k]);
  }
  OutlineLoop result;
  // Corners at one place, where a sample lies on a vertex of the border, are one: the later.
  const auto same = [](const OutlineSample& one, const OutlineSample& other) {
    constexpr double kSame = 1e-5;  // spacings
    return one.corner && other.corner && (one.place - other.place).norm() <= kSame;
  };
  const auto add = [&](const OutlineSample& sample) {
    if (!result.empty() && same(result.back(), sample)) result.pop_back();
    result.push_back(sample);
  };
  for (size_t k = 0; k < n; ++k) {
    const OutlineSample& sample = loop[k];
    if (!near[k]) {
      add(sample);
      continue;
    }
    OutlineSample pinned;
    pinned.place = pinned.measured = pinned.border = sample.border;
    pinned.corner = true;
    pinned.pinned = sample.pinned || near[(k + 1) % n] != 0;
    const bool within = pinned.pinned && near[(k + n - 1) % n] != 0;
    // An end of an earlier pin may stand for a vertex.
    const bool on_border = sample.corner && sample.place == sample.border;
    if (!within || on_border) add(pinned);
    if (!pinned.pinned) {
      result.back().vertices = sample.vertices;
      continue;
    }
    for (const Eigen::Vector2d& vertex : sample.vertices) {
      pinned.place = pinned.measured = pinned.border = vertex;
      add(pinned);
    }
  }
  if (result.size() > 1 && same(result.back(), result.front())) result.pop_back();
  DropSpikes(result);
  loop = std::move(result);
}

Eigen::Matrix2Xd PolygonOf(const OutlineLoop& loop) {
  Eigen::Matrix2Xd polygon(2, static_cast<Index>(loop.size()));
  for (size_t i = 0; i < loop.size(); ++i) polygon.col(static_cast<Index>(i)) = loop[i].place;
  return polygon;
}

namespace {

// A part of a border inside the half plane, from entry to exit.
struct Chain {
  OutlineLoop samples;
  double in, out;  // along the edge, the way a border runs along it
};

class EdgeCut {
 public:
  EdgeCut(int axis, double sign, double at) : axis_(axis), at_(at) {
    inwards_ = Eigen::Vector2d::Zero();
    inwards_[axis] = sign;
    along_ = RightOf(inwards_);
  }

  void Take(const OutlineLoop& loop) {
    const size_t n = loop.size();
    size_t start = 0;  // a sample outside
    while (start < n && Inside(loop[start])) ++start;
    if (start == n) {
      whole_.push_back(loop);
      return;
    }
    for (size_t k = 0; k < n; ++k) {
      const OutlineSample &a = loop[(start + k) % n], &b = loop[(start + k + 1) % n];
      if (Inside(a) == Inside(b)) {
        if (Inside(a)) chains_.back().samples.push_back(b);
        continue;
      }
      OutlineSample crossing = Crossing(a, b);
      if (Inside(b)) {
        crossing.along_cut = a.along_cut;
        chains_.push_back({{crossing, b}, along_.dot(crossing.place), 0});
      } else {
        crossing.along_cut = true;
        chains_.back().samples.back().vertices.clear();
        chains_.back().out = along_.dot(crossing.place);
        chains_.back().samples.push_back(crossing);
      }
    }
  }

  // From where a chain goes out, on to the next that comes in.
  std::vector<OutlineLoop> Joined() {
    std::vector<char> used(chains_.size(), 0);
    for (size_t first = 0; first < chains_.size(); ++first) {
      if (used[first]) continue;
      OutlineLoop loop;
      for (size_t c = first;;) {
        used[c] = 1;
        loop.insert(loop.end(), chains_[c].samples.begin(), chains_[c].samples.end());
        size_t next = first;
        for (size_t d = 0; d < chains_.size(); ++d) {
          if ((used[d] && d != first) || chains_[d].in < chains_[c].out) continue;
          if (chains_[next].in < chains_[c].out || chains_[d].in < chains_[next].in) next = d;
        }
        if (next == first) break;
        c = next;
      }
      whole_.push_back(std::move(loop));
    }
    return std::move(whole_);
  }

 private:
  bool Inside(const OutlineSample& sample) const {
    return inwards_[axis_] * (sample.place[axis_] - at_) >= 0;
  }

  OutlineSample Crossing(const OutlineSample& a, const OutlineSample& b) const {
    const double share = (at_ - a.place[axis_]) / (b.place[axis_] - a.place[axis_]);
    OutlineSample result;
    result.place = a.place + share * (b.place - a.place);
    result.place[axis_] = at_;
    result.measured = result.border = result.place;
    result.corner = true;
    return result;
  }

  int axis_;
  double at_;
  Eigen::Vector2d inwards_, along_;
  std::vector<Chain> chains_;
  std::vector<OutlineLoop> whole_;
};

}  // namespace

std::vector<OutlineLoop> CutOutlines(const std::vector<OutlineLoop>& loops,
                                     int axis,
                                     double sign,
                                     double at) {
  EdgeCut cut(axis, sign, at);
  for (const OutlineLoop& loop : loops) cut.Take(loop);
  return cut.Joined();
}

}  // namespace batten::internal
