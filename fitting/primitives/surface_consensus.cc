// SPDX-License-Identifier: MIT
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "batten/fitting/statistics.h"
#include "fitting/primitives/normal_axes.h"
#include "fitting/primitives/surface_starts.h"

namespace batten::internal {
namespace {

constexpr double kParallel = 1e-3;  // sine of two normals: below, their lines meet nowhere

// A minimal sample of oriented points.
struct Sample {
  std::vector<Eigen::Vector3d> points, normals;
};

// The point nearest to two lines; none where they are parallel.
std::optional<Eigen::Vector3d> Meeting(const Eigen::Vector3d& p,
                                       const Eigen::Vector3d& d,
                                       const Eigen::Vector3d& q,
                                       const Eigen::Vector3d& e) {
  const double cosine = d.dot(e), sine2 = 1 - cosine * cosine;
  if (!(sine2 > kParallel * kParallel)) return std::nullopt;
  const Eigen::Vector3d from = q - p;
  const double along_d = (from.dot(d) - cosine * from.dot(e)) / sine2;
  const double along_e = (cosine * from.dot(d) - from.dot(e)) / sine2;
  return (p + along_d * d + q + along_e * e) / 2;
}

std::optional<FittedSurface> SphereOfSample(const Sample& s) {
  const auto center = Meeting(s.points[0], s.normals[0], s.points[1], s.normals[1]);
  if (!center) return std::nullopt;
  return SphereNear(
      s.points[0], *center, ((s.points[0] - *center).norm() + (s.points[1] - *center).norm()) / 2);
}

std::optional<FittedSurface> CylinderOfSample(const Sample& s) {
  const Eigen::Vector3d across = s.normals[0].cross(s.normals[1]);
  const double sine = across.norm();
  if (!(sine > kParallel)) return std::nullopt;
  const Eigen::Vector3d axis = across / sine;
  const Eigen::Vector3d q = s.points[1] - (s.points[1] - s.points[0]).dot(axis) * axis;
  const auto center = Meeting(s.points[0], s.normals[0], q, s.normals[1]);
  if (!center) return std::nullopt;
  return CylinderNear(
      s.points[0], *center, axis, ((s.points[0] - *center).norm() + (q - *center).norm()) / 2);
}

std::optional<FittedSurface> ConeOfSample(const Sample& s) {
  Eigen::Matrix3d planes, seen;
  Eigen::Vector3d heights;
  for (int i = 0; i < 3; ++i) {
    planes.row(i) = s.normals[i].transpose();
    heights[i] = s.normals[i].dot(s.points[i]);
  }
  constexpr double kFlat = 1e-4;  // determinant of unit normals: below, planes meet in no point
  if (!(std::abs(planes.determinant()) > kFlat)) return std::nullopt;
  const Eigen::Vector3d apex = planes.inverse() * heights;
  for (int i = 0; i < 3; ++i) seen.col(i) = (s.points[i] - apex).normalized();
  Eigen::Vector3d axis = (seen.col(1) - seen.col(0)).cross(seen.col(2) - seen.col(0)).normalized();
  if (!axis.allFinite()) return std::nullopt;
  if (axis.dot(seen.col(0)) < 0) axis = -axis;
  const double angle = std::acos(std::clamp(axis.dot(seen.col(0)), -1.0, 1.0));
  if (!(angle > kSharpestCone && angle < std::acos(kSharpestCone))) return std::nullopt;
  return ConeNear(s.points[0], apex, axis, angle);
}

std::optional<FittedSurface> Through(SurfaceKind kind, const Sample& sample) {
  switch (kind) {
    case SurfaceKind::kPlane:
      return PlaneAt(sample.points[0], sample.normals[0]);
    case SurfaceKind::kSphere:
      return SphereOfSample(sample);
    case SurfaceKind::kCylinder:
      return CylinderOfSample(sample);
    case SurfaceKind::kCone:
      return ConeOfSample(sample);
    case SurfaceKind::kTorus:
      break;
  }
  return std::nullopt;
}

double MedianDistance(const FittedSurface& shape, const Eigen::Matrix3Xd& points) {
  std::vector<double> distances;
  for (const auto& p : points.colwise()) distances.push_back(std::abs(shape.Distance(p)));
  return Median(std::move(distances));
}

}  // namespace

std::vector<FittedSurface> ConsensusStarts(SurfaceKind kind,
                                           const StartData& data,
                                           std::uint64_t seed) {
  constexpr int kSamples = 240, kJudged = 4;
  constexpr size_t kBest = 2;
  if (data.oriented.empty() || kind == SurfaceKind::kTorus) return {};
  const Eigen::Matrix3Xd& judges = data.judges.points;
  Eigen::Matrix3Xd some(3, (judges.cols() + kJudged - 1) / kJudged);
  for (Eigen::Index k = 0; k < some.cols(); ++k) some.col(k) = judges.col(kJudged * k);
  std::mt19937_64 engine(seed);
  std::vector<std::pair<double, FittedSurface>> best;
  for (int k = 0; k < kSamples; ++k) {
    const OrientedPoints& from = data.oriented[engine() % data.oriented.size()];
    Sample sample;
    for (int i = 0; i < 3; ++i) {
      const auto j =
          static_cast<Eigen::Index>(engine() % static_cast<std::uint64_t>(from.points.cols()));
      sample.points.push_back(from.points.col(j));
      sample.normals.push_back(from.normals.col(j));
    }
    const std::optional<FittedSurface> shape = Through(kind, sample);
    if (!shape || !shape->point.allFinite()) continue;
    best.emplace_back(MedianDistance(*shape, some), *shape);
    std::stable_sort(
        best.begin(), best.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    if (best.size() > kBest) best.pop_back();
  }
  std::vector<FittedSurface> starts;
  for (const auto& [distance, shape] : best) starts.push_back(shape);
  return starts;
}

}  // namespace batten::internal
