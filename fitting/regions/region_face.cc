// SPDX-License-Identifier: MIT
#include "fitting/regions/region_face.h"

#include <stdexcept>
#include <utility>

#include "batten/fitting/poles.h"
#include "batten/fitting/trim_to_points.h"
#include "batten/geometry/make_surface.h"
#include "fitting/core/rounding.h"
#include "fitting/primitives/shape_estimate.h"
#include "fitting/primitives/surface_patch.h"
#include "fitting/primitives/surface_primitive.h"

namespace batten::internal {
namespace {

PointMask NoneOf(std::size_t count) {
  return PointMask::Constant(static_cast<Eigen::Index>(count), false);
}

// Which edges of the patch are one point.
Poles PolesOf(const ExactSurface& patch) {
  Poles poles;
  if (const auto* sphere = std::get_if<ExactSphere>(&patch)) {
    poles.turn = sphere->longitude.sweep;
    if (sphere->latitude.lower <= kAllLatitudes.lower + kRelativeRounding)
      poles.start = PoleKind::kSmooth;
    if (sphere->latitude.upper >= kAllLatitudes.upper - kRelativeRounding)
      poles.end = PoleKind::kSmooth;
  } else if (const auto* cone = std::get_if<ExactCone>(&patch)) {
    poles.turn = cone->angles.sweep;
    if (cone->radius_lower == 0) poles.start = PoleKind::kApex;
    if (cone->radius_upper == 0) poles.end = PoleKind::kApex;
  }
  return poles;
}

}  // namespace

FittedSurface Placed(FittedSurface shape, double scale, const Eigen::Vector3d& shift) {
  shape.point = scale * shape.point + shift;
  shape.curvature /= scale;
  shape.axis_curvature /= scale;
  return shape;
}

std::optional<RegionFace> FittedFace(const RegionPoints& data,
                                     const FittedSurface& shape,
                                     std::vector<int> points,
                                     std::vector<int> core,
                                     const Eigen::Vector3d& move,
                                     std::uint64_t seed,
                                     ThreadPool& pool) {
  const Eigen::Matrix3Xd some = (data.unit * data.points(Eigen::all, core)).colwise() + data.middle;
  try {
    ShapeFitter fitter(some, {}, {.rounding = data.rounding, .seed = seed}, pool);
    const ShapeFit fit = fitter.Fit(shape.kind);
    DescribedSurface described = Described(fit, fitter, some, move, data.rounding, pool);
    // From the fitter's unit to the cloud's, and to that of the regions.
    const FittedSurface in_cloud = Placed(fit.local, fitter.unit(), fitter.middle());
    return RegionFace{Placed(in_cloud, 1 / data.unit, -data.middle / data.unit),
                      std::move(points),
                      std::move(core),
                      std::move(described.summary),
                      std::move(described.warnings)};
  } catch (const std::invalid_argument&) {
    return std::nullopt;
  }
}

bool Determined(const RegionFace& face) {
  const PrimitiveSummary& p = face.numbers;
  const auto told = [&](const char* name, const std::optional<double>& value) {
    return !value || p.accuracy->Deviation(name) <= kVague * *value;
  };
  const auto turned = [&](const char* name, const std::optional<Eigen::Vector3d>& value) {
    return !value || p.accuracy->Deviation(name) <= kVagueAngle;
  };
  return turned("normal", p.normal) && turned("axis", p.axis) && told("radius", p.radius) &&
         told("major_radius", p.major_radius) && told("minor_radius", p.minor_radius) &&
         told("half_angle", p.half_angle);
}

void TakeShape(const RegionPoints& data,
               const FittedSurface& shape,
               const Eigen::Vector3d& move,
               RegionFace& face) {
  ThreadPool alone(1);
  face.shape = shape;
  const Eigen::Matrix3Xd core = data.points(Eigen::all, face.core);
  const ExactSurface patch = PatchOf(shape, core, NoneOf(face.core.size()), alone);
  PrimitiveSummary numbers = NumbersOf(shape.Shape(data.unit, data.middle),
                                       Placed(patch, data.unit, data.middle + move),
                                       data.unit * core.rowwise().mean() + data.middle,
                                       move);
  numbers.kind = std::move(face.numbers.kind);
  numbers.scale = face.numbers.scale;
  numbers.why = std::move(face.numbers.why);
  numbers.accuracy = std::move(face.numbers.accuracy);
  face.numbers = std::move(numbers);
}

PartFace CoveredFace(const RegionPoints& data,
                     const RegionFace& face,
                     const Eigen::Vector3d& move,
                     std::vector<std::string>& warnings,
                     ThreadPool& pool) {
  const Eigen::Matrix3Xd points = data.points(Eigen::all, face.points);
  const ExactSurface local = PatchOf(face.shape, points, NoneOf(face.points.size()), pool);
  const ExactSurface patch = Placed(local, data.unit, data.middle + move);
  const Eigen::Matrix2Xd feet = FootPointsOn(local, points, pool);
  PartFace made{face.shape.Shape(data.unit, data.middle + move), patch, ToNurbs(patch)};
  PointTrim trim = TrimToPoints(
      made.surface, feet, PolesOf(patch), data.unit * data.spacing, face.numbers.scale, pool);
  made.surface = std::move(trim.surface);
  constexpr double kMany = 0.05;  // of the points: fewer stand out of a smooth outline by chance
  if (static_cast<double>(trim.outside.size()) > kMany * static_cast<double>(points.cols())) {
    for (std::string& warning : trim.warnings) warnings.push_back(std::move(warning));
  }
  return made;
}

}  // namespace batten::internal
