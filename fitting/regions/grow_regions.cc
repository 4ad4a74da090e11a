// SPDX-License-Identifier: MIT
#include "fitting/regions/grow_regions.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "fitting/regions/region_shape.h"

namespace batten::internal {
namespace {

constexpr std::size_t kPatch = 32;  // points of a seed: enough for the seven freedoms of a torus
constexpr double kAcross = 0.6;  // sine: beyond, a point on a shape is of a sheet that crosses it
constexpr double kRoughSeed = 0.3;  // rms sine: a seed there has an edge among its neighbours

struct Grown {
  FittedSurface shape;
  std::vector<int> points;
  bool passed = false;
};

class RegionGrower {
 public:
  RegionGrower(const RegionPoints& data, double sigma, ThreadPool& pool)
      : data_(data), sigma_(sigma), pool_(pool), seen_(static_cast<std::size_t>(data.size())) {
    labels_.label.assign(seen_.size(), kNoRegion);
  }

  RegionLabels Grow(const Progress& progress) && {
    std::vector<int> seeds(labels_.label.size());
    std::iota(seeds.begin(), seeds.end(), 0);
    std::stable_sort(
        seeds.begin(), seeds.end(), [&](int a, int b) { return data_.turn[a] < data_.turn[b]; });
    std::vector<bool> tried(seeds.size());
    for (std::size_t k = 0; k < seeds.size(); ++k) {
      const int seed = seeds[k];
      if (data_.turn[seed] > kRoughSeed) break;
      if (labels_.label[std::size_t(seed)] != kNoRegion || tried[std::size_t(seed)]) continue;
      const std::vector<int> patch = PatchAbout(seed);
      if (patch.size() < kPatch / 2) continue;
      Report(progress, "regions", double(k) / double(seeds.size()));
      std::vector<int> flat;
      if (auto best = BestFrom(patch, flat)) {
        std::sort(best->points.begin(), best->points.end());
        Append({best->shape, std::move(best->points)}, labels_);
      } else {
        // What lies about a failed seed would fail like it, and so would the rest of a large plane;
        // a small one may be a piece of a round face.
        if (flat.size() < 16 * kPatch) flat.clear();
        flat.insert(flat.end(), patch.begin(), patch.begin() + std::ssize(patch) / 4);
        for (const int point : flat) tried[std::size_t(point)] = true;
      }
    }
    return std::move(labels_);
  }

 private:
  bool Free(int point) const { return labels_.label[std::size_t(point)] == kNoRegion; }

  // Free points about the seed on its sheet.
  std::vector<int> PatchAbout(int seed) {
    std::vector<int> patch{seed};
    seen_[std::size_t(seed)] = true;
    for (std::size_t k = 0; k < patch.size() && patch.size() < kPatch; ++k) {
      for (const int other : data_.Around(patch[k])) {
        if (seen_[std::size_t(other)] || !Free(other) || patch.size() >= kPatch) continue;
        const double turn = data_.normals.col(patch[k]).cross(data_.normals.col(other)).norm();
        if (turn > kSameSheet) continue;
        seen_[std::size_t(other)] = true;
        patch.push_back(other);
      }
    }
    for (const int point : patch) seen_[std::size_t(point)] = false;
    return patch;
  }

  // Points near the shape that hang together with the seed's patch; `ring` gets free points next to
  // them that are not too far off.
  std::vector<int> Reached(const std::vector<int>& patch,
                           const FittedSurface& shape,
                           std::vector<int>& ring) const {
    std::vector<bool> seen(labels_.label.size());
    std::vector<int> reached;
    const double near = kFarFromShape * sigma_;
    const auto look = [&](int point) {
      if (seen[std::size_t(point)] || !Free(point)) return;
      seen[std::size_t(point)] = true;
      const double off = std::abs(shape.Distance(data_.points.col(point)));
      constexpr double kRing = 3;
      if (!(off <= kRing * near)) return;
      if (NormalOff(data_, point, shape) > kAcross) return;
      (off <= near ? reached : ring).push_back(point);
    };
    for (const int point : patch) look(point);
    for (std::size_t k = 0; k < reached.size(); ++k) {
      for (const int other : data_.Around(reached[k])) look(other);
    }
    return reached;
  }

  // The points three rings and more from their border, where a neighbour that joins smoothly may
  // have begun; all where those are few.
  std::vector<int> Inside(const std::vector<int>& points) const {
    constexpr int kRings = 3;
    constexpr std::size_t kShare = 4;
    std::vector<int> ring(labels_.label.size(), -1);
    for (const int point : points) ring[std::size_t(point)] = kRings;
    std::vector<int> inside = points;
    for (int r = 0; r < kRings; ++r) {
      std::vector<int> kept;
      for (const int point : inside) {
        const auto around = data_.Around(point);
        const bool border = std::any_of(around.begin(), around.end(), [&](int other) {
          return ring[std::size_t(other)] == r - 1;
        });
        if (border) {
          ring[std::size_t(point)] = r;
        } else {
          kept.push_back(point);
        }
      }
      inside = std::move(kept);
    }
    return inside.size() >= std::max(std::size_t{kFewestPoints}, points.size() / kShare) ? inside
                                                                                         : points;
  }

  // One kind's shape and the points it explains.
  Grown GrownAs(SurfaceKind kind, const std::vector<int>& patch) const {
    constexpr int kMostRounds = 16;
    constexpr double kMore = 1.02;  // growth below is none
    Grown best;
    auto shape = ShapeThrough(data_, patch, kind, sigma_);
    for (int round = 0; shape && round < kMostRounds; ++round) {
      std::vector<int> ring;
      std::vector<int> reached = Reached(patch, *shape, ring);
      const bool more = double(reached.size()) > kMore * double(best.points.size());
      if (reached.size() > best.points.size()) {
        best.shape = *shape;
        best.points = std::move(reached);
      }
      if (!more) break;
      std::vector<int> members = best.points;
      members.insert(members.end(), ring.begin(), ring.end());
      // Few points may have led to another minimum.
      const bool few = members.size() < 4 * kPatch;
      shape = ShapeThrough(data_, members, kind, sigma_, few ? nullptr : &best.shape);
    }
    if (best.points.size() < kFewestPoints) return best;
    const std::vector<int> inside = Inside(best.points);
    const auto settled = ShapeThrough(data_, inside, kind, sigma_, &best.shape);
    if (!settled) return best;
    best.shape = *settled;
    best.passed = TestShape(data_, inside, best.shape, sigma_).passed;
    return best;
  }

  // `flat` gets the points on the plane about the patch.
  std::optional<Grown> BestFrom(const std::vector<int>& patch, std::vector<int>& flat) const {
    std::array<Grown, kSurfaceKinds.size()> grown;
    pool_.For(std::ssize(grown), 1, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      for (auto k = begin; k < end; ++k) {
        grown[std::size_t(k)] = GrownAs(kSurfaceKinds[std::size_t(k)], patch);
      }
    });
    flat = grown[0].points;
    std::size_t most = 0;
    for (const Grown& one : grown) {
      if (one.passed) most = std::max(most, one.points.size());
    }
    if (most < kFewestPoints) return std::nullopt;
    for (Grown& one : grown) {
      if (one.passed && double(one.points.size()) >= kAsMany * double(most)) return std::move(one);
    }
    return std::nullopt;
  }

  const RegionPoints& data_;
  const double sigma_;
  ThreadPool& pool_;
  RegionLabels labels_;
  std::vector<bool> seen_;  // all false between calls
};

}  // namespace

void Append(Region region, RegionLabels& labels) {
  for (const int point : region.points)
    labels.label[std::size_t(point)] = static_cast<int>(labels.regions.size());
  labels.regions.push_back(std::move(region));
}

RegionLabels GrowRegions(const RegionPoints& data,
                         double sigma,
                         const Progress& progress,
                         ThreadPool& pool) {
  return RegionGrower(data, sigma, pool).Grow(progress);
}

std::optional<FittedSurface> SimplestShape(const RegionPoints& data,
                                           const std::vector<int>& members,
                                           double sigma,
                                           ThreadPool& pool) {
  std::array<std::optional<FittedSurface>, kSurfaceKinds.size()> passed;
  const auto attempt = [&](std::size_t k) {
    auto shape = ShapeThrough(data, members, kSurfaceKinds[k], sigma);
    if (shape && TestShape(data, members, *shape, sigma).passed) passed[k] = shape;
  };
  attempt(0);
  if (passed[0]) return passed[0];
  pool.For(std::ssize(passed) - 1, 1, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    for (auto k = begin; k < end; ++k) attempt(std::size_t(k) + 1);
  });
  for (const auto& shape : passed) {
    if (shape) return shape;
  }
  return std::nullopt;
}

}  // namespace batten::internal
