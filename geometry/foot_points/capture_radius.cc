// SPDX-License-Identifier: MIT
#include "geometry/foot_points/capture_radius.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/bezier/bernstein_polynomial.h"
#include "geometry/foot_points/capture_radius_kernel.h"
#include "geometry/numeric/bounding_volume_tree.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr int kCuts = 2;
constexpr int kMostRings = 2;
constexpr double kSafe = 0.9;  // of m²/Λ; far more than rounding

int Padded(int count) { return (count + kReachLanes - 1) / kReachLanes * kReachLanes; }

}  // namespace

// Parts are numbered row by row over the whole surface: part = i · parts_v + j.
class CaptureRadius::Builder {
 public:
  explicit Builder(const FootTable& table)
      : table_(table),
        p_(table.degree_u()),
        q_(table.degree_v()),
        parts_u_(kCuts * table.u.cells()),
        parts_v_(kCuts * table.v.cells()),
        padded_u_(Padded(p_ * (q_ + 1))),
        padded_v_(Padded((p_ + 1) * q_)),
        stride_(3 * (padded_u_ + padded_v_)) {
    const auto count = static_cast<size_t>(parts_u_) * static_cast<size_t>(parts_v_);
    tangents_.resize(count * static_cast<size_t>(stride_));
    bounds_.resize(count);
    boxes_.resize(count);
  }

  void Run(std::vector<Part>& parts) {
    for (int piece = 0; piece < table_.pieces(); ++piece) Cut(piece);
    tree_ = BoundingVolumeTree(boxes_);
    parts.resize(boxes_.size());
    for (int i = 0; i < parts_u_; ++i) {
      for (int j = 0; j < parts_v_; ++j) {
        const int piece = i / kCuts * table_.v.cells() + j / kCuts;
        parts[static_cast<size_t>(kCuts * kCuts * piece + i % kCuts * kCuts + j % kCuts)] =
            Measure(i, j);
      }
    }
  }

 private:
  // Bounds of the second derivatives' lengths, and the mean tangents.
  struct Bounds {
    double uu = 0, uv = 0, vv = 0;
    Eigen::Vector3d u, v;
  };
  // Parts of one direction: `count` of them from `first`, going round if need be.
  struct Stretch {
    int first, count;
  };

  void Cut(int piece) {
    const int numbers = 4 * (p_ + 1) * (q_ + 1), room = numbers + kReadPast;
    std::vector<double> memory(static_cast<size_t>(7 * room));
    double* const whole = memory.data();
    std::copy_n(table_.bezier(piece), numbers, whole);
    double* const halves[2] = {whole + room, whole + 2 * room};
    HalveFirst(whole, p_, q_, 4, halves[0], halves[1]);
    const int i = piece / table_.v.cells(), j = piece % table_.v.cells();
    for (int a = 0; a < kCuts; ++a) {
      double* const quarters[2] = {whole + (3 + 2 * a) * room, whole + (4 + 2 * a) * room};
      HalveSecond(halves[a], p_, q_, 4, quarters[0], quarters[1]);
      for (int b = 0; b < kCuts; ++b) {
        SetPart(kCuts * i + a,
                kCuts * j + b,
                quarters[b],
                kCuts / (table_.u.high(i) - table_.u.low(i)),
                kCuts / (table_.v.high(j) - table_.v.low(j)),
                piece);
      }
    }
  }

  // From the Bézier points of the part about the piece's centre.
  void SetPart(int i, int j, const double* net, double per_u, double per_v, int piece) {
    const int part = i * parts_v_ + j, w = q_ + 1;
    const auto at = [&](int r, int s) {
      return Eigen::Vector3d(Eigen::Map<const Eigen::Vector3d>(net + 4 * (r * w + s)));
    };
    Eigen::AlignedBox3d box;
    Bounds bounds;
    bounds.u.setZero();
    bounds.v.setZero();
    double* const u = tangents_.data() + static_cast<std::ptrdiff_t>(part) * stride_;
    double* const v = u + 3 * padded_u_;
    int next_u = 0, next_v = 0;
    const auto keep = [](const Eigen::Vector3d& tangent, double* rows, int padded, int& next) {
      for (int d = 0; d < 3; ++d) rows[d * padded + next] = tangent[d];
      ++next;
    };
    for (int r = 0; r <= p_; ++r) {
      for (int s = 0; s <= q_; ++s) {
        box.extend(at(r, s));
        if (r < p_) {
          const Eigen::Vector3d tangent = p_ * per_u * (at(r + 1, s) - at(r, s));
          bounds.u += tangent;
          keep(tangent, u, padded_u_, next_u);
        }
        if (s < q_) {
          const Eigen::Vector3d tangent = q_ * per_v * (at(r, s + 1) - at(r, s));
          bounds.v += tangent;
          keep(tangent, v, padded_v_, next_v);
        }
        if (r + 2 <= p_) {
          const Eigen::Vector3d bend = at(r + 2, s) - 2 * at(r + 1, s) + at(r, s);
          bounds.uu = std::max(bounds.uu, bend.squaredNorm());
        }
        if (s + 2 <= q_) {
          const Eigen::Vector3d bend = at(r, s + 2) - 2 * at(r, s + 1) + at(r, s);
          bounds.vv = std::max(bounds.vv, bend.squaredNorm());
        }
        if (r < p_ && s < q_) {
          const Eigen::Vector3d bend = at(r + 1, s + 1) - at(r + 1, s) - at(r, s + 1) + at(r, s);
          bounds.uv = std::max(bounds.uv, bend.squaredNorm());
        }
      }
    }
    bounds.u /= p_ * w;
    bounds.v /= q_ * (p_ + 1);
    FillUp(u, padded_u_, next_u);
    FillUp(v, padded_v_, next_v);
    for (double* const bound : {&bounds.uu, &bounds.uv, &bounds.vv}) *bound = std::sqrt(*bound);
    bounds.uu *= p_ * (p_ - 1) * per_u * per_u;
    bounds.uv *= p_ * q_ * per_u * per_v;
    bounds.vv *= q_ * (q_ - 1) * per_v * per_v;
    const Eigen::Vector3d& centre = table_.centres[piece];
    const Eigen::Vector3d slack = Eigen::Vector3d::Constant(16 * kEpsilon * table_.radii[piece]) +
                                  4 * kEpsilon * centre.cwiseAbs();
    boxes_[static_cast<size_t>(part)] = {centre + box.min() - slack, centre + box.max() + slack};
    bounds_[static_cast<size_t>(part)] = bounds;
  }

  // Rows are filled up with their first number.
  static void FillUp(double* rows, int padded, int from) {
    for (int d = 0; d < 3; ++d) {
      std::fill(rows + d * padded + from, rows + (d + 1) * padded, rows[d * padded]);
    }
  }

  // As many neighbours on both sides as the surface is smooth across, at most `rings`.
  Stretch Around(const FootAxis& axis, int at, int rings) const {
    const int count = kCuts * axis.cells();
    const auto smooth_after = [&](int k) {  // between the part k and the next
      return k % kCuts != kCuts - 1 || axis.SmoothAfter(k / kCuts);
    };
    Stretch stretch{at, 1};
    for (int k = 0; k < rings; ++k) {
      const int before = (stretch.first + count - 1) % count;
      if (!smooth_after(before)) break;
      stretch.first = before;
      ++stretch.count;
    }
    for (int k = 0, last = at; k < rings && smooth_after(last); ++k) {
      last = (last + 1) % count;
      ++stretch.count;
    }
    stretch.count = std::min(stretch.count, count);
    return stretch;
  }

  static bool Holds(const Stretch& stretch, int count, int k) {
    return (k - stretch.first + count) % count < stretch.count;
  }

  Part Measure(int i, int j) const {
    Part best;
    for (int rings = 1; rings <= kMostRings; ++rings) {
      bool by_boxes = false;
      const Part part = MeasureIn(i, j, rings, by_boxes);
      if (part.reach > best.reach) best = part;
      if (!by_boxes) break;
    }
    return best;
  }

  // `by_boxes`: whether what is outside of the rectangle decides.
  Part MeasureIn(int i, int j, int rings, bool& by_boxes) const {
    const auto part = static_cast<size_t>(i * parts_v_ + j);
    const Stretch in_u = Around(table_.u, i, rings), in_v = Around(table_.v, j, rings);
    const Bounds& own = bounds_[part];
    // The mean tangents as Q·R, R = (a b; 0 c).
    const double a = own.u.norm();
    const Eigen::Vector3d first = own.u / a;
    const double b = first.dot(own.v);
    const Eigen::Vector3d rest = own.v - b * first;
    const double c = rest.norm();
    const Eigen::Vector3d second = rest / c;
    if (!(a > 0 && c > kEpsilon * std::abs(b))) return {};
    TangentRanges u{{kInfinity, kInfinity}, {-kInfinity, -kInfinity}}, v = u;
    double uu = 0, uv = 0, vv = 0;
    for (int k = 0; k < in_u.count; ++k) {
      const int row = (in_u.first + k) % parts_u_ * parts_v_;
      for (int l = 0; l < in_v.count;) {
        const int column = (in_v.first + l) % parts_v_;
        const int run = std::min(in_v.count - l, parts_v_ - column);
        const double* const from =
            tangents_.data() + static_cast<std::ptrdiff_t>(row + column) * stride_;
        WidenRanges(from, run, stride_, padded_u_, first.data(), second.data(), u);
        WidenRanges(from + 3 * padded_u_, run, stride_, padded_v_, first.data(), second.data(), v);
        for (int n = 0; n < run; ++n) {
          const Bounds& there = bounds_[static_cast<size_t>(row + column + n)];
          uu = std::max(uu, there.uu);
          uv = std::max(uv, there.uv);
          vv = std::max(vv, there.vv);
        }
        l += run;
      }
    }
    // Least eigenvalue of the symmetric part of any Qᵀ J R⁻¹.
    const double slant = b / a;
    const double low_across = std::min(slant * u.low[0], slant * u.high[0]);
    const double high_across = std::max(slant * u.low[0], slant * u.high[0]);
    const double most_across = std::max(slant * u.low[1], slant * u.high[1]);
    const double xx = u.low[0] / a, yy = (v.low[1] - most_across) / c;
    const double low_xy = (v.low[0] - high_across) / c + u.low[1] / a;
    const double high_xy = (v.high[0] - low_across) / c + u.high[1] / a;
    const double xy = std::max(-low_xy, high_xy) / 2;
    const double least = (xx + yy) / 2 - std::hypot((xx - yy) / 2, xy);
    if (!(least > 0)) return {};
    // |S_δδ| in the same coordinates.
    const double size = std::abs(slant);
    const double bend_xx = uu / (a * a), bend_xy = (uv + size * uu) / (a * c),
                 bend_yy = (vv + 2 * size * uv + size * size * uu) / (c * c);
    const double bend = std::hypot(std::hypot(bend_xx, bend_yy), std::sqrt(2.0) * bend_xy);
    const Eigen::AlignedBox3d& box = boxes_[part];
    const double half = box.diagonal().norm() / 2;
    const double near = bend > 0 ? std::min(half, kSafe * least * least / bend) : half;
    const double half_u = (table_.u.high(i / kCuts) - table_.u.low(i / kCuts)) / 2;
    const double half_v = (table_.v.high(j / kCuts) - table_.v.low(j / kCuts)) / 2;
    Part result;
    result.stretch2 = least * least;
    result.bend = bend;
    result.per_xx = 1 / (a * half_u);
    result.xy = b * half_v;
    result.per_yy = 1 / (c * half_v);
    result.size = table_.radii[i / kCuts * table_.v.cells() + j / kCuts];
    const double apart = DistanceToOthers(box, 2 * near, in_u, in_v);
    by_boxes = apart < 2 * near;
    result.reach = std::min(near, (1 - 1e-9) / 2 * apart);
    return result;
  }

  // Of the box from those of parts not in the rectangle, as far as that is at most `limit`.
  double DistanceToOthers(const Eigen::AlignedBox3d& box,
                          double limit,
                          const Stretch& in_u,
                          const Stretch& in_v) const {
    const Eigen::Vector3d centre = box.center();
    const double far = limit + box.diagonal().norm() / 2;
    near_.clear();
    tree_.Within(centre.data(), far * far * (1 + 1e-9), near_);
    double squared = limit * limit;
    for (const BoundingVolumeTree::Near& near : near_) {
      if (Holds(in_u, parts_u_, near.box / parts_v_) &&
          Holds(in_v, parts_v_, near.box % parts_v_)) {
        continue;
      }
      squared =
          std::min(squared, box.squaredExteriorDistance(boxes_[static_cast<size_t>(near.box)]));
    }
    return std::sqrt(squared);
  }

  const FootTable& table_;
  const int p_, q_, parts_u_, parts_v_, padded_u_, padded_v_;
  const std::ptrdiff_t stride_;
  std::vector<double> tangents_;  // Bernstein coefficients of S_u and S_v
  std::vector<Bounds> bounds_;
  std::vector<Eigen::AlignedBox3d> boxes_;
  BoundingVolumeTree tree_;
  mutable std::vector<BoundingVolumeTree::Near> near_;
};

CaptureRadius::CaptureRadius(const FootTable& table) {
  if (table.rational || !table.monomial() || table.degree_u() == 0 || table.degree_v() == 0) return;
  Builder(table).Run(parts_);
}

double CaptureRadius::Miss(
    int piece, double x, double y, double distance, double gx, double gy) const {
  if (parts_.empty()) return kInfinity;
  const Part& part = parts_[static_cast<size_t>(4 * piece + (x > 0 ? 2 : 0) + (y > 0 ? 1 : 0))];
  if (!(distance < part.reach)) return kInfinity;
  // Coordinates of places and points are off by so much.
  const double off = 16 * kEpsilon * (part.size + distance);
  const double sx = gx * part.per_xx, sy = (gy - part.xy * sx) * part.per_yy;
  const double slope = std::hypot(sx, sy) + off;
  return slope * slope / (part.stretch2 - distance * part.bend) + 4 * distance * off + off * off;
}

}  // namespace batten::internal
