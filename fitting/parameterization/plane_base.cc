// SPDX-License-Identifier: MIT
#include "fitting/parameterization/plane_base.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>
#include <queue>
#include <vector>

#include "batten/fitting/point_mask.h"
#include "batten/fitting/refused_data.h"
#include "batten/fitting/statistics.h"
#include "fitting/core/rounding.h"
#include "fitting/neighbours/normals.h"
#include "fitting/parameterization/lattice.h"
#include "fitting/parameterization/normal_cone.h"
#include "fitting/parameterization/projection_overlap.h"
#include "geometry/numeric/dense_solvers.h"
#include "geometry/numeric/smallest_rectangle.h"

namespace batten::internal {
namespace {

constexpr double kAxisIsGoodEnough = 0.75;      // times the best direction's cosine
constexpr double kParallelIsGoodEnough = 1.15;  // times the smallest rectangle's area
constexpr double kSteepShare = 0.05;            // share of the normals that may be steeper
constexpr double kFoldedShare = 0.02;           // share of the sheet that may face away from it
constexpr double kWall = 0.05;                  // cosine: less than 3° from the vertical
constexpr double kLiesOpen = 0.3;               // cosine: 73° from it
constexpr double kWallShare = 0.6;              // share of the sheet that may be walls
constexpr double kDoubleLayerFraction = 0.1;    // share of places in layers; above, too many

// Cosine with the axis that all but a small share of the normals exceed, whatever their sign.
double Openness(const Eigen::Matrix3Xd& normals,
                const Eigen::Vector3d& axis,
                double share = kSteepShare) {
  std::vector<double> cosines;
  cosines.reserve(static_cast<size_t>(normals.cols()));
  for (Eigen::Index k = 0; k < normals.cols(); ++k)
    cosines.push_back(std::abs(normals.col(k).dot(axis)));
  return Quantile(std::move(cosines), share);
}

// Normals with signs that agree between neighbours, in pieces bounded by creases.
struct SheetSides {
  Eigen::Matrix3Xd normals;
  std::vector<int> piece;
  int pieces = 0;
};

// Propagates the sign over each sample's neighbours, first where two normals differ least.
// [Hoppe et al. 1992, §3.3]
SheetSides AgreeOnSides(const Eigen::Matrix3Xd& places, Eigen::Matrix3Xd normals) {
  constexpr int kNeighbours = 9;   // with the sample itself
  constexpr double kCrease = 0.5;  // cosine: 60°
  const Eigen::Index count = places.cols();
  const std::vector<int> near = NeighbourIndex(places).Nearest(places, kNeighbours);
  const auto each = static_cast<Eigen::Index>(near.size()) / count;
  SheetSides sides{std::move(normals), std::vector<int>(static_cast<size_t>(count), -1), 0};
  struct Step {
    double cosine;
    Eigen::Index from, to;
    bool operator<(const Step& other) const { return cosine < other.cosine; }
  };
  for (Eigen::Index first = 0; first < count; ++first) {
    if (sides.piece[first] >= 0) continue;
    std::priority_queue<Step> steps;
    steps.push({1, first, first});
    while (!steps.empty()) {
      const Step step = steps.top();
      steps.pop();
      if (sides.piece[step.to] >= 0) continue;
      sides.piece[step.to] = sides.pieces;
      if (sides.normals.col(step.from).dot(sides.normals.col(step.to)) < 0) {
        sides.normals.col(step.to) *= -1;
      }
      for (Eigen::Index j = 0; j < each; ++j) {
        const Eigen::Index next = near[step.to * each + j];
        const double cosine = std::abs(sides.normals.col(step.to).dot(sides.normals.col(next)));
        if (sides.piece[next] < 0 && cosine > kCrease) steps.push({cosine, step.to, next});
      }
    }
    ++sides.pieces;
  }
  return sides;
}

// Axis of the smallest cone about the normals of the largest piece, which all point to one side. A
// steep sheet, whose unsigned normals cover nearly all directions, has such a cone too.
std::optional<Eigen::Vector3d> NormalConeOfSide(const SheetSides& sides) {
  constexpr int kRounds = 200;
  std::vector<int> sizes(static_cast<size_t>(sides.pieces), 0);
  for (const int piece : sides.piece) ++sizes[static_cast<size_t>(piece)];
  const auto largest =
      static_cast<int>(std::max_element(sizes.begin(), sizes.end()) - sizes.begin());
  std::vector<Eigen::Index> kept;
  for (Eigen::Index k = 0; k < sides.normals.cols(); ++k)
    if (sides.piece[static_cast<size_t>(k)] == largest) kept.push_back(k);
  const Eigen::Matrix3Xd normals = sides.normals(Eigen::all, kept);
  const Eigen::Vector3d mean = normals.rowwise().sum();
  if (!(mean.norm() > 0)) return std::nullopt;
  return NormalCone(normals, mean.normalized(), {kSteepShare, true, kRounds});
}

// Folds of a sheet along an axis: parts that clearly face away from it while most of their piece
// faces along it, so that the sheet goes under itself. Walls parallel to the axis are no folds.
struct Folds {
  double sheet = 0;  // share of the sheet
  double plan = 0;   // share of what it covers, seen along the axis
};

Folds FoldsAlong(const SheetSides& sides, const Eigen::Vector3d& axis) {
  std::vector<Eigen::Vector2d> counts(static_cast<size_t>(sides.pieces), Eigen::Vector2d::Zero());
  std::vector<Eigen::Vector2d> areas = counts;
  const Eigen::RowVectorXd cosines = axis.transpose() * sides.normals;
  for (Eigen::Index k = 0; k < cosines.size(); ++k) {
    if (std::abs(cosines[k]) <= kWall) continue;
    const int side = cosines[k] > 0 ? 0 : 1;
    counts[sides.piece[k]][side] += 1;
    areas[sides.piece[k]][side] += std::abs(cosines[k]);
  }
  Folds folds;
  for (size_t piece = 0; piece < counts.size(); ++piece) {
    const int away = counts[piece][0] < counts[piece][1] ? 0 : 1;
    folds.sheet += counts[piece][away];
    folds.plan += areas[piece][away];
  }
  folds.sheet /= static_cast<double>(cosines.size());
  folds.plan /= std::max(cosines.cwiseAbs().sum(), 1e-300);
  return folds;
}

// Whether the sheet folds. Signs are unreliable where flanks are closer than the samples: a fold of
// a good part of the plan is believed only if it shows as layers.
bool IsFolded(const Folds& folds, double overlap, double allowed) {
  constexpr double kNoLayers = 0.01;
  return folds.sheet > allowed && (folds.plan <= kDoubleLayerFraction || overlap > kNoLayers);
}

// The smallest rectangle, or the one along the axes where that is hardly larger.
TurnedRectangle RectangleOf(const std::vector<Eigen::Vector2d>& hull) {
  const TurnedRectangle best = SmallestRectangleAround(hull);
  const TurnedRectangle parallel = RectangleAlong(hull, Eigen::Vector2d::UnitX());
  return parallel.area <= kParallelIsGoodEnough * best.area ? parallel : best;
}

// The frame of a direction: u along the projection of x (or y), so that plans keep their axes.
Eigen::Matrix3d FrameOf(const Eigen::Vector3d& normal) {
  Eigen::Matrix3d axes;
  const Eigen::Vector3d along =
      std::abs(normal[0]) < 0.9 ? Eigen::Vector3d::UnitX() : Eigen::Vector3d::UnitY();
  axes.col(2) = normal;
  axes.col(0) = (along - along.dot(normal) * normal).normalized();
  axes.col(1) = normal.cross(axes.col(0));
  return axes;
}

// Normals at places, side by side.
Eigen::Matrix3Xd NormalsAt(const Eigen::Matrix3Xd& places,
                           const Eigen::Matrix3Xd& points,
                           const NeighbourIndex& index,
                           int neighbours,
                           ThreadPool& pool) {
  Eigen::Matrix3Xd normals(3, places.cols());
  pool.For(places.cols(), 256, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
    normals.middleCols(begin, end - begin) =
        EstimateNormals(index, points, places.middleCols(begin, end - begin), neighbours);
  });
  return normals;
}

// Candidate directions over which a sheet with vertical walls may be a height field: the coordinate
// axes, the direction closest to most normals, and the principal axes of the points.
std::vector<Eigen::Vector3d> UprightDirections(const Eigen::Matrix3Xd& normals,
                                               const Eigen::Matrix3d& principal_axes) {
  std::vector<Eigen::Vector3d> directions;
  for (const int d : {2, 1, 0}) directions.push_back(Eigen::Vector3d::Unit(d));
  const Eigen::Matrix3d scatter = normals * normals.transpose();
  directions.push_back(EigenOf3(scatter).vectors.col(2));
  for (int d = 0; d < 3; ++d) directions.push_back(principal_axes.col(d));
  return directions;
}

// Among the directions in which the sheet neither folds (but for `allowed_fold`) nor lies in
// layers, the one in which it is least steep; the first ones, the coordinate axes, are preferred
// where they serve nearly as well.
std::optional<Eigen::Vector3d> UnfoldedAxis(const SheetSides& sides,
                                            const std::vector<Eigen::Vector3d>& directions,
                                            const Eigen::Matrix3Xd& points,
                                            const Eigen::Vector3d& mean,
                                            double spacing,
                                            double allowed_fold,
                                            ThreadPool& pool) {
  constexpr double kSlack = 0.01;         // of overlap
  constexpr double kEquallySteep = 0.05;  // in cosine
  struct Candidate {
    Eigen::Vector3d axis;
    double openness, overlap;
    bool preferred, serves;
  };
  std::vector<Candidate> candidates(directions.size());
  pool.For(std::ssize(directions), 1, [&](std::ptrdiff_t at, std::ptrdiff_t) {
    const auto k = static_cast<size_t>(at);
    Candidate& own = candidates[k] = {directions[k], 0, 1, k < 3, false};  // coordinate axes first
    // Rejects edge-on directions: a good part must face the axis, less of it for a coordinate axis.
    const double open_part = Openness(sides.normals, own.axis, kWallShare);
    if (open_part < (own.preferred ? kWall : kLiesOpen)) return;
    own.openness = Openness(sides.normals, own.axis);
    own.overlap = LayeredPlaces(
        points, mean, FrameOf(own.axis), spacing, std::tan(std::acos(std::min(1.0, own.openness))));
    own.serves = !IsFolded(FoldsAlong(sides, own.axis), own.overlap, allowed_fold);
  });
  std::erase_if(candidates, [](const Candidate& c) { return !c.serves; });
  double least_overlap = kDoubleLayerFraction;
  for (const Candidate& c : candidates) least_overlap = std::min(least_overlap, c.overlap);
  std::erase_if(candidates, [&](const Candidate& c) { return c.overlap > least_overlap + kSlack; });
  if (candidates.empty()) return std::nullopt;
  const auto best = std::max_element(
      candidates.begin(), candidates.end(), [](const Candidate& a, const Candidate& b) {
        return a.openness < b.openness;
      });
  const double good_enough =
      std::min(kAxisIsGoodEnough * best->openness, best->openness - kEquallySteep);
  for (const Candidate& c : candidates) {
    if (c.preferred && c.openness >= good_enough) return c.axis;
  }
  return best->axis;
}

// The base in one direction: its frame, rectangle and overlap.
PlaneBase BaseAlong(Eigen::Vector3d axis,
                    double openness,
                    const Eigen::Matrix3Xd& points,
                    const Eigen::Vector3d& mean,
                    double spacing,
                    double margin) {
  int largest;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0) axis = -axis;
  PlaneBase base;
  base.axes = FrameOf(axis);
  base.steepness = std::acos(std::clamp(openness, 0.0, 1.0));
  std::vector<Eigen::Vector2d> plan;
  plan.reserve(static_cast<size_t>(points.cols()));
  const Eigen::Vector3d along_u = base.axes.col(0), along_v = base.axes.col(1);
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Vector3d from = points.col(k) - mean;
    plan.emplace_back(along_u.dot(from), along_v.dot(from));
  }
  const TurnedRectangle r = RectangleOf(ConvexHullOf(std::move(plan)));
  if (!(r.area > 0)) {
    throw RefusedData("all points lie on a line: a surface needs points in two directions");
  }
  const Eigen::Vector3d u = base.axes.col(0) * r.axis[0] + base.axes.col(1) * r.axis[1];
  base.axes.col(0) = u;
  base.axes.col(1) = axis.cross(u);
  base.origin =
      mean + base.axes.col(0) * (r.low[0] - margin) + base.axes.col(1) * (r.low[1] - margin);
  base.length_u = r.high[0] - r.low[0] + 2 * margin;
  base.length_v = r.high[1] - r.low[1] + 2 * margin;
  base.overlap = LayeredPlaces(points, base.origin, base.axes, spacing, std::tan(base.steepness));
  return base;
}

// Sums of squares and products of coordinates about a place.
Eigen::Matrix3d ScatterAbout(const Eigen::Matrix3Xd& points, const Eigen::Vector3d& mean) {
  Eigen::Matrix3d scatter = Eigen::Matrix3d::Zero();
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const Eigen::Vector3d from = points.col(k) - mean;
    for (int d = 0; d < 3; ++d) scatter.col(d) += from[d] * from;
  }
  return scatter;
}

}  // namespace

PlaneBase FindPlaneBase(const Eigen::Matrix3Xd& points,
                        const NeighbourIndex& index,
                        double spacing,
                        double margin,
                        std::uint64_t seed,
                        ThreadPool& pool) {
  if (points.cols() < 3) throw RefusedData("a surface needs at least 3 different points");
  const Eigen::Vector3d mean = points.rowwise().mean();
  const double size = (points.colwise() - mean).cwiseAbs().maxCoeff();
  if (size > 0 && size < kLeastSize) {
    throw RefusedData("the points differ by less than 1e-100: scale them up");
  }
  const Eigen::Matrix3d scatter = ScatterAbout(points, mean) / static_cast<double>(points.cols());
  const SymmetricEigen3 pca = EigenOf3(scatter);
  const double across = std::sqrt(std::max(0.0, pca.values[1]));
  const double along = std::sqrt(std::max(0.0, pca.values[2]));
  if (!(across > 1e-7 * along)) {
    throw RefusedData("all points lie on a line: a surface needs points in two directions");
  }

  constexpr Eigen::Index kSamples = 4000;  // points at which normals are estimated
  const std::vector<Eigen::Index> samples = SampleIndices(points.cols(), kSamples, seed);
  const Eigen::Matrix3Xd places = points(Eigen::all, samples);
  Eigen::Matrix3Xd normals = NormalsAt(places, points, index, points.cols() < 200 ? 12 : 30, pool);
  if (points.cols() < 12) {
    normals = pca.vectors.col(0).replicate(1, static_cast<Eigen::Index>(samples.size()));
  }

  if (const std::optional<int> lattice = AxisOfLatticeHeights(points)) {
    const Eigen::Vector3d up = Eigen::Vector3d::Unit(*lattice);
    PlaneBase base = BaseAlong(up, Openness(normals, up), points, mean, spacing, margin);
    base.lattice = true;
    base.overlap = 0;
    return base;
  }

  constexpr int kStarts = 3, kRounds = 61;
  std::optional<SheetSides> sides;
  std::vector<std::optional<Eigen::Vector3d>> trials(kStarts + 1);
  pool.For(kStarts + 1, 1, [&](std::ptrdiff_t start, std::ptrdiff_t) {
    if (start == 0) {
      sides = AgreeOnSides(places, normals);
      trials[kStarts] = NormalConeOfSide(*sides);
    } else {
      trials[start - 1] =
          NormalCone(normals, pca.vectors.col(start - 1), {kSteepShare, false, kRounds});
    }
  });
  Eigen::Vector3d axis = pca.vectors.col(0);
  double openness = -1;
  for (const std::optional<Eigen::Vector3d>& trial : trials) {
    const double trial_openness = trial ? Openness(normals, *trial) : -1;
    if (trial_openness > openness + 1e-12) {
      openness = trial_openness;
      axis = *trial;
    }
  }
  const Eigen::Vector3d of_cone = axis;
  for (const int d : {2, 1, 0}) {
    const Eigen::Vector3d candidate = Eigen::Vector3d::Unit(d);
    const double candidate_openness = Openness(normals, candidate);
    if (candidate_openness >= kAxisIsGoodEnough * openness && candidate_openness > 0.1) {
      axis = candidate;
      openness = candidate_openness;
      break;
    }
  }
  PlaneBase base = BaseAlong(axis, openness, points, mean, spacing, margin);
  // A cone about normals of either sign may be that of a sheet that folds over the plane. Another
  // direction must be clearly better, or rough clouds would turn with their noise.
  const double folded = FoldsAlong(*sides, axis).sheet;
  if (folded > kFoldedShare || base.overlap > kDoubleLayerFraction) {
    const double allowed = folded > 0 ? std::min(kFoldedShare, folded / 2) : kFoldedShare;
    auto upright = UprightDirections(normals, pca.vectors);
    upright.push_back(of_cone);
    if (const auto unfolded = UnfoldedAxis(*sides, upright, points, mean, spacing, allowed, pool)) {
      base = BaseAlong(*unfolded, Openness(normals, *unfolded), points, mean, spacing, margin);
    }
  }
  return base;
}

}  // namespace batten::internal
