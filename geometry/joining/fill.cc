// SPDX-License-Identifier: MIT
#include "batten/geometry/fill.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <utility>

#include "geometry/joining/hole_net.h"
#include "geometry/joining/hole_sides.h"
#include "geometry/joining/hole_system.h"
#include "geometry/numeric/construction_checks.h"
#include "geometry/numeric/polygon.h"

namespace batten {
using namespace internal;
namespace {

constexpr int kPlacesInSpan = 24;

double SizeOfSides(const std::vector<FillSide>& sides) {
  Eigen::AlignedBox3d box;
  for (const FillSide& side : sides) {
    const Eigen::Matrix3Xd& points = side.curve.control_points();
    box.extend(points.rowwise().minCoeff()).extend(points.rowwise().maxCoeff());
  }
  return box.diagonal().norm();
}

void CheckFill(const std::vector<FillSide>& sides, const FillOptions& options) {
  RequireThat(sides.size() >= 3 && sides.size() <= 6,
              "Fill",
              std::to_string(sides.size()) + " sides; a hole has three to six");
  RequirePositive("Fill", "angle_tolerance", options.angle_tolerance);
  if (options.tolerance) RequirePositive("Fill", "tolerance", *options.tolerance);
  RequireThat(options.max_spans >= 1 && options.max_spans <= 32,
              "Fill",
              "max_spans = " + std::to_string(options.max_spans) + " is not in [1, 32]");
  for (const FillSide& side : sides) {
    if (side.neighbour) RefuseTrims(side.neighbour->trimmed(), "Fill", "its edge may not count");
  }
}

// The direction into the patch across its edge, perpendicular to it.
Eigen::Vector3d Inwards(const Eigen::Vector3d& tangent, const Eigen::Vector3d& across) {
  return (across - across.dot(tangent) / tangent.squaredNorm() * tangent).normalized();
}

// Where side `k` is met by half of an edge of a patch at (u, v); `across` into the patch.
void MeasureSide(const HoleSide& side,
                 double s,
                 const SurfaceJet& jet,
                 const Eigen::Vector3d& along,
                 const Eigen::Vector3d& across,
                 FillQuality& fill) {
  fill.position_gap = std::max(fill.position_gap, (jet.point - side.At(s)).norm());
  const auto plane = side.PlaneAt(s);
  if (!plane || !(along.norm() > 0)) return;
  fill.outer_angle =
      std::max(fill.outer_angle, AngleBetween(plane->outwards, Inwards(along, across)));
}

FillQuality QualityOf(const std::vector<NurbsSurface>& patches,
                      const std::vector<HoleSide>& sides) {
  const auto n = static_cast<int>(sides.size());
  const auto spans = static_cast<int>(patches[0].basis_u().Spans().size());
  const int places = kPlacesInSpan * spans;
  FillQuality quality;
  for (int k = 0; k < n; ++k) {
    const NurbsSurface &patch = patches[k], &next = patches[(k + 1) % n];
    for (int i = 0; i <= places; ++i) {
      const double t = static_cast<double>(i) / places;
      const SurfaceJet inner = patch.JetAt(t, 0), other = next.JetAt(0, t);
      quality.inner_angle = std::max(
          quality.inner_angle, AngleBetween(inner.du.cross(inner.dv), other.du.cross(other.dv)));
      const SurfaceJet first = patch.JetAt(1, t), second = next.JetAt(t, 1);
      MeasureSide(sides[k], (1 - t) / 2, first, first.dv, -first.du, quality);
      MeasureSide(sides[k], (1 + t) / 2, second, second.du, -second.dv, quality);
    }
  }
  return quality;
}

HoleFill FilledWith(const std::vector<HoleSide>& sides, int spans) {
  const size_t n = sides.size();
  std::vector<Eigen::Vector3d> corners;
  for (size_t k = 0; k < n; ++k) {
    corners.push_back((sides[k].At(0) + sides[(k + n - 1) % n].At(1)) / 2);
  }
  std::vector<NurbsCurve<3>> splines;
  for (size_t k = 0; k < n; ++k) {
    splines.push_back(sides[k].Spline(spans, corners[k], corners[(k + 1) % n]));
  }
  const HoleNet net(splines, spans);
  HoleFill fill;
  fill.spans = spans;
  fill.patches = net.Patches(SolvedHole(net, sides));
  fill.quality = QualityOf(fill.patches, sides);
  return fill;
}

}  // namespace

double FillTolerance(const std::vector<FillSide>& sides, const FillOptions& options) {
  constexpr double kShare = 1e-6;
  return options.tolerance.value_or(kShare * SizeOfSides(sides));
}

HoleFill Fill(const std::vector<FillSide>& sides, const FillOptions& options) {
  CheckFill(sides, options);
  const double tolerance = FillTolerance(sides, options), angle = options.angle_tolerance;
  const std::vector<HoleSide> ordered = OrderedSides(sides, tolerance);
  // The sides come first: where neighbours disagree no number of spans mends the angle.
  const auto better = [&](const FillQuality& one, const FillQuality& other) {
    const bool kept = one.position_gap <= tolerance;
    if (kept != (other.position_gap <= tolerance)) return kept;
    if (!kept) return one.position_gap < other.position_gap;
    constexpr double kWorthSpans = 0.99;
    return std::max(one.inner_angle, one.outer_angle) <
           kWorthSpans * std::max(other.inner_angle, other.outer_angle);
  };
  HoleFill best;
  for (int spans = 1; spans <= options.max_spans && !best.reached; spans *= 2) {
    HoleFill fill = FilledWith(ordered, spans);
    fill.tolerance = tolerance;
    fill.reached = fill.quality.Within(tolerance, angle);
    if (best.patches.empty() || better(fill.quality, best.quality)) {
      best = std::move(fill);
    }
  }
  return best;
}

FillQuality MeasureFill(const std::vector<NurbsSurface>& patches,
                        const std::vector<FillSide>& sides,
                        const FillOptions& options) {
  CheckFill(sides, options);
  RequireThat(
      patches.size() == sides.size(), "MeasureFill", "there must be a patch for every side");
  return QualityOf(patches, OrderedSides(sides, FillTolerance(sides, options)));
}

}  // namespace batten
