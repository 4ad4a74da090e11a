// SPDX-License-Identifier: MIT
#include "fitting/wings/sheet_sides.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/core/mask_indices.h"
#include "fitting/wings/oriented_normals.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr int kSpacingOf = 6;             // the neighbour whose distance is the unit of length h
constexpr double kFlatEnough = 0.35;      // roughness of the core [measured: prototype]
constexpr double kTurned = 0.5;           // cosine to a neighbour's normal: less is another sheet
constexpr double kMostTurned = 0.1;       // share of such neighbours in the core
constexpr double kInsideCore = 0.8;       // share of neighbours in the core of points that stay
constexpr double kSecondSheet = 0.2;      // of the largest component: the nose splits the core
constexpr double kLeastCore = 0.4;        // share of the points; less is no smooth section
constexpr int kMostRounds = 30;           // of growth; each goes about one h
constexpr int kFewestLabelled = 4;        // within 2 h, for a point to be asked
constexpr int kAsked = 48;                // labelled neighbours
constexpr double kReach = 7, kDecay = 3;  // in h: farthest labelled neighbour, length of weights
constexpr double kOpposed = -0.3;         // cosine: less faces the other way
constexpr int kFewestOfSide = 6;
constexpr double kCalm = 3;               // ridge on second derivatives, against extrapolation
constexpr double kNear = 4, kOff = 6;     // noises: on a sheet, off the other
constexpr double kNearInSpacings = 0.25;  // h: points of coarse clouds are on no sheet beyond
constexpr double kClearer = 3;            // times nearer to its own sheet than to the other
constexpr double kMoatReach = 5;          // h, to labelled points of both sides
constexpr double kLeastNoise = 0.01;      // h: of exact points

// A quadric through labelled points of one side, at a query.
struct SideAt {
  double distance;  // of the query
  Eigen::Vector3d normal;
};

class Grower {
 public:
  Grower(const Eigen::Matrix3Xd& points, const Neighbourhoods& around, double h, double noise)
      : points_(points), around_(around), h_(h), noise_(std::max(noise, kLeastNoise * h)) {}

  // Adds labels round by round until hardly any are added.
  void Grow(SheetSides& sides) const {
    for (int round = 0; round < kMostRounds; ++round) {
      const std::vector<Eigen::Index> known = IndicesOf(sides.labelled);
      const Eigen::Matrix3Xd places = points_(Eigen::all, known);
      const std::vector<Eigen::Index> asked = Askable(sides.labelled);
      if (asked.empty()) return;
      const NeighbourIndex index(places);
      const std::vector<int> near = index.Nearest(points_(Eigen::all, asked), kAsked);
      std::vector<std::optional<Eigen::Vector3d>> found(asked.size());
      for (size_t i = 0; i < asked.size(); ++i)
        found[i] = NormalOf(asked[i], {near.data() + i * kAsked, kAsked}, known, sides.normals);
      Eigen::Index added = 0;
      for (size_t i = 0; i < asked.size(); ++i) {
        if (!found[i]) continue;
        sides.labelled[asked[i]] = true;
        sides.normals.col(asked[i]) = *found[i];
        ++added;
      }
      if (added * 2000 < points_.cols()) return;
    }
  }

  // Points without a label that have labelled ones facing both ways around them.
  PointMask MoatOf(const SheetSides& sides) const {
    PointMask moat = PointMask::Constant(points_.cols(), false);
    const std::vector<Eigen::Index> known = IndicesOf(sides.labelled),
                                    rest = IndicesOf(!sides.labelled);
    if (rest.empty()) return moat;
    const Eigen::Matrix3Xd places = points_(Eigen::all, known);
    const std::vector<int> near = NeighbourIndex(places).Nearest(points_(Eigen::all, rest), kAsked);
    for (size_t i = 0; i < rest.size(); ++i) {
      const size_t first = i * kAsked;
      const Eigen::Vector3d normal = sides.normals.col(known[static_cast<size_t>(near[first])]);
      int own = 0, other = 0;
      for (size_t j = first; j < first + kAsked; ++j) {
        const Eigen::Index at = known[static_cast<size_t>(near[j])];
        if ((points_.col(at) - points_.col(rest[i])).norm() > kMoatReach * h_) break;
        const double cosine = normal.dot(sides.normals.col(at));
        own += cosine > kTurned ? 1 : 0;
        other += cosine < kOpposed ? 1 : 0;
      }
      moat[rest[i]] = own > 0 && other > 0;
    }
    return moat;
  }

 private:
  std::vector<Eigen::Index> Askable(const PointMask& labelled) const {
    std::vector<Eigen::Index> asked;
    for (Eigen::Index k = 0; k < points_.cols(); ++k) {
      if (labelled[k]) continue;
      int count = 0;
      for (int j = 1; j < kOfPlane; ++j) {
        const int other = around_.At(k, j);
        if ((points_.col(other) - points_.col(k)).norm() > 2 * h_) break;
        count += labelled[other] ? 1 : 0;
      }
      if (count >= kFewestLabelled) asked.push_back(k);
    }
    return asked;
  }

  // The normal at a point of the sheet it is on, if that is clear.
  std::optional<Eigen::Vector3d> NormalOf(Eigen::Index at,
                                          std::span<const int> near,
                                          const std::vector<Eigen::Index>& known,
                                          const Eigen::Matrix3Xd& normals) const {
    const Eigen::Vector3d place = points_.col(at);
    const Eigen::Vector3d first = normals.col(known[static_cast<size_t>(near[0])]);
    std::array<std::vector<Eigen::Index>, 2> groups;
    for (const int j : near) {
      const Eigen::Index other = known[static_cast<size_t>(j)];
      if ((points_.col(other) - place).norm() > kReach * h_) break;
      const double cosine = first.dot(normals.col(other));
      if (cosine > kTurned) groups[0].push_back(other);
      if (cosine < kOpposed) groups[1].push_back(other);
    }
    std::array<std::optional<SideAt>, 2> sheets;
    for (size_t g = 0; g < 2; ++g) sheets[g] = SideOf(groups[g], place, normals);
    const auto distance = [&](size_t g) { return sheets[g] ? sheets[g]->distance : HUGE_VAL; };
    const size_t own = distance(0) <= distance(1) ? 0 : 1;
    if (!sheets[own]) return std::nullopt;
    const double near_by = distance(own), far = distance(1 - own);
    if (near_by > std::min(kNear * noise_, kNearInSpacings * h_)) return std::nullopt;
    const bool some_opposed = !groups[1 - own].empty();
    if (!sheets[1 - own] && some_opposed) return std::nullopt;
    if (sheets[1 - own] && (far < kOff * noise_ || far < kClearer * near_by)) return std::nullopt;
    return sheets[own]->normal;
  }

  std::optional<SideAt> SideOf(const std::vector<Eigen::Index>& group,
                               const Eigen::Vector3d& place,
                               const Eigen::Matrix3Xd& normals) const {
    if (std::ssize(group) < kFewestOfSide) return std::nullopt;
    Eigen::Vector3d normal = Eigen::Vector3d::Zero();
    for (const Eigen::Index k : group) normal += normals.col(k);
    if (normal.norm() < 1e-6) return std::nullopt;
    normal.normalize();
    const Eigen::Vector3d x = normal.unitOrthogonal(), y = normal.cross(x);
    using Vector6d = Eigen::Matrix<double, 6, 1>;
    Eigen::Matrix<double, 6, 6> matrix = Eigen::Matrix<double, 6, 6>::Zero();
    Vector6d right = Vector6d::Zero();
    for (const Eigen::Index k : group) {
      const Eigen::Vector3d way = (points_.col(k) - place) / h_;
      const double a = x.dot(way), b = y.dot(way);
      const double weight = std::exp(-way.squaredNorm() / (kDecay * kDecay));
      Vector6d row;
      row << 1, a, b, a * a, a * b, b * b;
      matrix += weight * row * row.transpose();
      right += weight * normal.dot(way) * row;
    }
    for (int d = 3; d < 6; ++d) matrix(d, d) += kCalm;
    for (int d = 0; d < 3; ++d) matrix(d, d) += 1e-9;
    const Vector6d solution = matrix.ldlt().solve(right);
    const double slope = std::hypot(solution[1], solution[2]);
    return SideAt{std::abs(solution[0]) * h_ / std::hypot(1, slope),
                  (normal - solution[1] * x - solution[2] * y).normalized()};
  }

  const Eigen::Matrix3Xd& points_;
  const Neighbourhoods& around_;
  double h_, noise_;
};

// Points of the core that hang together, by component, largest first.
std::vector<std::vector<Eigen::Index>> CoreParts(const OrientedNormals& oriented,
                                                 const Neighbourhoods& around) {
  const Eigen::Index count = oriented.normals.cols();
  const auto agree = [&](Eigen::Index a, Eigen::Index b) {
    return oriented.normals.col(a).dot(oriented.normals.col(b)) > kTurned;
  };
  std::vector<bool> open(static_cast<size_t>(count), false);
  for (Eigen::Index k = 0; k < count; ++k) {
    int turned = 0;
    for (int j = 1; j < kOfPlane; ++j) turned += agree(k, around.At(k, j)) ? 0 : 1;
    open[static_cast<size_t>(k)] =
        oriented.roughness[k] < kFlatEnough && turned < kMostTurned * (kOfPlane - 1);
  }
  // Links both ways, so that parts do not depend on the order.
  std::vector<std::vector<int>> links(static_cast<size_t>(count));
  for (Eigen::Index k = 0; k < count; ++k) {
    if (!open[static_cast<size_t>(k)]) continue;
    for (int j = 1; j < kOfGraph; ++j) {
      const int other = around.At(k, j);
      if (!open[static_cast<size_t>(other)] || !agree(k, other)) continue;
      links[static_cast<size_t>(k)].push_back(other);
      links[static_cast<size_t>(other)].push_back(static_cast<int>(k));
    }
  }
  std::vector<std::vector<Eigen::Index>> parts;
  for (Eigen::Index start = 0; start < count; ++start) {
    if (!open[static_cast<size_t>(start)]) continue;
    open[static_cast<size_t>(start)] = false;
    std::vector<Eigen::Index> part{start};
    for (size_t next = 0; next < part.size(); ++next) {
      for (const int other : links[static_cast<size_t>(part[next])]) {
        if (!open[static_cast<size_t>(other)]) continue;
        open[static_cast<size_t>(other)] = false;
        part.push_back(other);
      }
    }
    parts.push_back(std::move(part));
  }
  std::stable_sort(
      parts.begin(), parts.end(), [](const auto& a, const auto& b) { return a.size() > b.size(); });
  return parts;
}

// Turns the normals of a part away from the other.
void FaceAway(const std::vector<Eigen::Index>& part,
              const std::vector<Eigen::Index>& other,
              const Eigen::Matrix3Xd& points,
              Eigen::Matrix3Xd& normals) {
  const Eigen::Matrix3Xd places = points(Eigen::all, other);
  const std::vector<int> near = NeighbourIndex(places).Nearest(points(Eigen::all, part), 1);
  double towards = 0;
  for (size_t i = 0; i < part.size(); ++i)
    towards += normals.col(part[i]).dot((places.col(near[i]) - points.col(part[i])).normalized());
  if (towards > 0) normals(Eigen::all, part) *= -1;
}

}  // namespace

SheetSides TellSidesApart(const Eigen::Matrix3Xd& points,
                          const NeighbourIndex& index,
                          double noise) {
  const Eigen::Index count = points.cols();
  SheetSides sides;
  sides.labelled = PointMask::Constant(count, false);
  if (count < 1000) {
    sides.failure_reason = "too few points to tell the sides of a thin section apart";
    return sides;
  }
  const Neighbourhoods around{index.Nearest(points, kOfPlane)};
  std::vector<double> distances(static_cast<size_t>(count));
  for (Eigen::Index k = 0; k < count; ++k)
    distances[static_cast<size_t>(k)] =
        (points.col(around.At(k, kSpacingOf)) - points.col(k)).norm();
  sides.spacing = Median(std::move(distances));
  OrientedNormals oriented = OrientNormals(points, around);
  std::vector<std::vector<Eigen::Index>> parts = CoreParts(oriented, around);
  if (parts.empty()) {
    sides.failure_reason = "the points have no smooth sides";
    return sides;
  }
  const bool split = parts.size() > 1 && static_cast<double>(parts[1].size()) >
                                             kSecondSheet * static_cast<double>(parts[0].size());
  if (split) {
    FaceAway(parts[0], parts[1], points, oriented.normals);
    FaceAway(parts[1], parts[0], points, oriented.normals);
  }
  PointMask core = PointMask::Constant(count, false);
  for (size_t p = 0; p < (split ? 2u : 1u); ++p)
    for (const Eigen::Index k : parts[p]) core[k] = true;
  for (Eigen::Index k = 0; k < count; ++k) {
    int inside = 0;
    for (int j = 1; j < kOfPlane; ++j) inside += core[around.At(k, j)] ? 1 : 0;
    sides.labelled[k] = core[k] && inside > kInsideCore * (kOfPlane - 1);
  }
  const double share = static_cast<double>(sides.labelled.count()) / static_cast<double>(count);
  if (share < kLeastCore) {
    sides.failure_reason =
        "only " + Percent(share) + " of the points lie clearly on one side of a thin section";
    return sides;
  }
  sides.normals = std::move(oriented.normals);
  const Grower grower(points, around, sides.spacing, noise);
  grower.Grow(sides);
  sides.moat = grower.MoatOf(sides);
  return sides;
}

}  // namespace batten::internal
