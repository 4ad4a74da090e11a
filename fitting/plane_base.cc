// SPDX-License-Identifier: MIT
#include "batten/fitting/plane_base.h"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "batten/fitting/cloud_statistics.h"
#include "batten/fitting/normals.h"
#include "batten/fitting/statistics.h"

namespace batten {
namespace {

constexpr double kAxisIsGoodEnough = 0.75;      // of the best direction's cosine
constexpr double kParallelIsGoodEnough = 1.15;  // of the smallest rectangle's area
constexpr double kSteepShare = 0.05;            // of the normals may be steeper

// The cosine that all but a small share of the normals keep with the axis, whatever their sign.
double Openness(const Eigen::Matrix3Xd& normals, const Eigen::Vector3d& axis) {
  std::vector<double> cosines;
  cosines.reserve(static_cast<size_t>(normals.cols()));
  for (Eigen::Index k = 0; k < normals.cols(); ++k)
    cosines.push_back(std::abs(normals.col(k).dot(axis)));
  return Quantile(std::move(cosines), kSteepShare);
}

// Towards the axis of the smallest cone about the normals: repeated means of those that are
// steepest. [Bădoiu & Clarkson 2003, for balls]
Eigen::Vector3d ConeAxis(const Eigen::Matrix3Xd& normals, Eigen::Vector3d axis) {
  Eigen::Vector3d best = axis;
  double best_openness = Openness(normals, axis);
  for (int round = 1; round <= 60; ++round) {
    std::vector<double> cosines(static_cast<size_t>(normals.cols()));
    for (Eigen::Index k = 0; k < normals.cols(); ++k)
      cosines[k] = std::abs(normals.col(k).dot(axis));
    const double low = Quantile(cosines, kSteepShare), high = Quantile(cosines, 2 * kSteepShare);
    Eigen::Vector3d steep = Eigen::Vector3d::Zero();
    for (Eigen::Index k = 0; k < normals.cols(); ++k) {
      if (cosines[k] < low || cosines[k] > high) continue;
      steep += normals.col(k).dot(axis) < 0 ? (-normals.col(k)).eval() : normals.col(k).eval();
    }
    if (!(steep.norm() > 0)) break;
    axis = (axis + steep.normalized() / (1.0 + round)).normalized();
    const double openness = Openness(normals, axis);
    if (openness > best_openness) {
      best_openness = openness;
      best = axis;
    }
  }
  return best;
}

// Andrew's monotone chain, counter-clockwise, without the collinear.
std::vector<Eigen::Vector2d> ConvexHull(std::vector<Eigen::Vector2d> points) {
  std::sort(points.begin(), points.end(), [](const auto& a, const auto& b) {
    return a[0] != b[0] ? a[0] < b[0] : a[1] < b[1];
  });
  std::vector<Eigen::Vector2d> hull;
  const auto turn =
      [](const Eigen::Vector2d& o, const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
        return (a - o)[0] * (b - o)[1] - (a - o)[1] * (b - o)[0];
      };
  for (int pass = 0; pass < 2; ++pass) {
    const size_t floor = hull.size() + 1;
    for (const auto& p : points) {
      while (hull.size() > floor && turn(hull[hull.size() - 2], hull.back(), p) <= 0)
        hull.pop_back();
      hull.push_back(p);
    }
    hull.pop_back();
    std::reverse(points.begin(), points.end());
  }
  return hull;
}

struct Rectangle {
  double area = std::numeric_limits<double>::infinity();
  Eigen::Vector2d axis = Eigen::Vector2d::UnitX();
  Eigen::Vector2d low, high;  // extents along the axis and its left normal
};

Rectangle RectangleAlong(const std::vector<Eigen::Vector2d>& hull, const Eigen::Vector2d& axis) {
  Rectangle r;
  r.axis = axis;
  r.low.setConstant(std::numeric_limits<double>::infinity());
  r.high = -r.low;
  for (const auto& p : hull) {
    const Eigen::Vector2d q(p.dot(axis), axis[0] * p[1] - axis[1] * p[0]);
    r.low = r.low.cwiseMin(q);
    r.high = r.high.cwiseMax(q);
  }
  r.area = (r.high - r.low).prod();
  return r;
}

// A side of the smallest rectangle lies on a side of the hull.
Rectangle SmallestRectangle(const std::vector<Eigen::Vector2d>& hull) {
  Rectangle best;
  for (size_t i = 0; i < hull.size(); ++i) {
    const Eigen::Vector2d side = hull[(i + 1) % hull.size()] - hull[i];
    if (!(side.norm() > 0)) continue;
    const Rectangle r = RectangleAlong(hull, side.normalized());
    if (r.area < best.area) best = r;
  }
  const Rectangle parallel = RectangleAlong(hull, Eigen::Vector2d::UnitX());
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

// The share of places, 4 spacings wide, whose points lie in layers: a gap in height that no slope
// explains, with a good part of the points on either side.
double OverlapShare(const Eigen::Matrix3Xd& local, double spacing, double steepest_tangent) {
  constexpr double kPlaceInSpacings = 4;
  constexpr double kLayerShare = 0.3;
  const double cell = kPlaceInSpacings * spacing;
  std::map<std::pair<long, long>, std::vector<double>> heights;
  for (Eigen::Index k = 0; k < local.cols(); ++k) {
    heights[{std::lround(std::floor(local(0, k) / cell)),
             std::lround(std::floor(local(1, k) / cell))}]
        .push_back(local(2, k));
  }
  constexpr double kSteepestSlope = 2;  // steeper places hold a continuum of heights, without a gap
  const double gap = 1.5 * cell * std::clamp(steepest_tangent, 1.0, kSteepestSlope);
  size_t places = 0, layered = 0;
  for (auto& [place, h] : heights) {
    if (h.size() < 4) continue;
    ++places;
    std::sort(h.begin(), h.end());
    const auto layer =
        std::max<size_t>(2, static_cast<size_t>(kLayerShare * static_cast<double>(h.size())));
    for (size_t k = layer; k + layer <= h.size(); ++k) {
      if (h[k] - h[k - 1] > gap) {
        ++layered;
        break;
      }
    }
  }
  return places > 0 ? static_cast<double>(layered) / static_cast<double>(places) : 0;
}

}  // namespace

PlaneBase FindPlaneBase(const Eigen::Matrix3Xd& points,
                        const NeighbourIndex& index,
                        double spacing,
                        double margin,
                        const PlaneBaseOptions& options) {
  if (points.cols() < 3) throw std::invalid_argument("a surface needs at least 3 different points");
  const Eigen::Vector3d mean = points.rowwise().mean();
  const Eigen::Matrix3Xd centred = points.colwise() - mean;
  const Eigen::Matrix3d scatter =
      centred * centred.transpose() / static_cast<double>(points.cols());
  const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> pca(scatter);
  const double across = std::sqrt(std::max(0.0, pca.eigenvalues()[1]));
  const double along = std::sqrt(std::max(0.0, pca.eigenvalues()[2]));
  if (!(across > 1e-7 * along)) {
    throw std::invalid_argument(
        "all points lie on a line: a surface needs points in two directions");
  }

  const std::vector<Eigen::Index> samples =
      SampleIndices(points.cols(), options.samples, options.seed);
  Eigen::Matrix3Xd normals =
      EstimateNormals(index, points, points(Eigen::all, samples), points.cols() < 200 ? 12 : 30);
  if (points.cols() < 12) normals = pca.eigenvectors().col(0);

  Eigen::Vector3d axis = pca.eigenvectors().col(0);
  double openness = -1;
  for (int start = 0; start < 3; ++start) {
    const Eigen::Vector3d trial = ConeAxis(normals, pca.eigenvectors().col(start));
    const double trial_openness = Openness(normals, trial);
    if (trial_openness > openness + 1e-12) {
      openness = trial_openness;
      axis = trial;
    }
  }
  for (const int d : {2, 1, 0}) {
    const Eigen::Vector3d candidate = Eigen::Vector3d::Unit(d);
    const double candidate_openness = Openness(normals, candidate);
    if (candidate_openness >= kAxisIsGoodEnough * openness && candidate_openness > 0.1) {
      axis = candidate;
      openness = candidate_openness;
      break;
    }
  }
  int largest;
  axis.cwiseAbs().maxCoeff(&largest);
  if (axis[largest] < 0) axis = -axis;

  PlaneBase base;
  base.axes = FrameOf(axis);
  base.steepness = std::acos(std::clamp(openness, 0.0, 1.0));
  const Eigen::Matrix3Xd local = base.axes.transpose() * centred;
  std::vector<Eigen::Vector2d> plan(static_cast<size_t>(local.cols()));
  for (Eigen::Index k = 0; k < local.cols(); ++k) plan[k] = local.col(k).head<2>();
  const Rectangle r = SmallestRectangle(ConvexHull(std::move(plan)));
  if (!(r.area > 0)) {
    throw std::invalid_argument(
        "all points lie on a line: a surface needs points in two directions");
  }
  const Eigen::Vector3d u = base.axes.col(0) * r.axis[0] + base.axes.col(1) * r.axis[1];
  base.axes.col(0) = u;
  base.axes.col(1) = axis.cross(u);
  base.origin =
      mean + base.axes.col(0) * (r.low[0] - margin) + base.axes.col(1) * (r.low[1] - margin);
  base.length_u = r.high[0] - r.low[0] + 2 * margin;
  base.length_v = r.high[1] - r.low[1] + 2 * margin;
  base.overlap = OverlapShare(base.ToFrame(points), spacing, std::tan(base.steepness));
  return base;
}

}  // namespace batten
