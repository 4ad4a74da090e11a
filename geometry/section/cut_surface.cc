// SPDX-License-Identifier: MIT
#include "batten/geometry/cut_surface.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "batten/geometry/closure.h"
#include "geometry/numeric/construction_checks.h"
#include "batten/geometry/iso_curve.h"
#include "geometry/section/loop_cut.h"
#include "geometry/editing/monotone_arcs.h"
#include "batten/geometry/project_curve.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "batten/geometry/trim_loops.h"
#include "batten/geometry/trim_region.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kOne = 1e-11;  // of the domain: places nearer than 100 of it are one
constexpr double kIso = 1e-9;   // of the domain: how far an iso-line may be from one

// A map of all control points; ends of the unit square go to ends of the domain exactly.
template <typename Map>
NurbsCurve<2> Mapped(const NurbsCurve<2>& curve, const Map& map) {
  NurbsCurve<2>::Points points = curve.control_points();
  for (Eigen::Index k = 0; k < points.cols(); ++k) points.col(k) = map(points.col(k).eval());
  return NurbsCurve<2>(curve.basis(), std::move(points), curve.weights());
}

NurbsCurve<2> UnitSquare() {
  const double ends[] = {0, 1, 2, 3, 4};
  return NurbsCurve<2>(SplineBasis::Clamped(1, ends),
                       Eigen::Matrix2Xd{{0, 1, 1, 0, 0}, {0, 0, 1, 1, 0}});
}

// The surface with loops in the unit square in place of its own.
NurbsSurface Trimmed(const NurbsSurface& surface,
                     const UnitDomain& domain,
                     const std::vector<NurbsCurve<2>>& loops) {
  const auto back = [&](const Eigen::Vector2d& x) {
    constexpr double kEnd = 1e-13;
    Eigen::Vector2d at = domain.Back(x);
    const Eigen::Vector2d upper(surface.basis_u().upper(), surface.basis_v().upper());
    for (int d = 0; d < 2; ++d) {
      if (std::abs(x[d]) <= kEnd) at[d] = domain.lower[d];
      if (std::abs(x[d] - 1) <= kEnd) at[d] = upper[d];
    }
    return at;
  };
  std::vector<NurbsCurve<2>> mapped;
  for (const NurbsCurve<2>& loop : loops) mapped.push_back(Mapped(loop, back));
  return surface.WithTrims(std::move(mapped));
}

std::vector<RegionPart> PartsOf(const NurbsSurface& surface,
                                const std::vector<NurbsCurve<2>>& curves,
                                const char* function) {
  const UnitDomain domain(surface);
  const TrimRegion region(surface);
  const auto inside = [&](const Eigen::Vector2d& x) {
    if (x.minCoeff() < 0 || x.maxCoeff() > 1) return false;
    const Eigen::Vector2d at = domain.Back(x);
    return region.Contains(at[0], at[1]);
  };
  std::vector<NurbsCurve<2>> loops, cutting;
  for (const NurbsCurve<2>& loop : surface.trims()) loops.push_back(Mapped(loop, domain));
  if (loops.empty()) loops.push_back(UnitSquare());
  for (const NurbsCurve<2>& curve : curves) cutting.push_back(Mapped(curve, domain));
  return CutLoops(loops, cutting, inside, kOne, function);
}

SurfaceCut Sorted(const NurbsSurface& surface, const std::vector<RegionPart>& parts) {
  SurfaceCut cut;
  for (const RegionPart& part : parts) {
    NurbsSurface piece = Trimmed(surface, UnitDomain(surface), part.loops);
    CheckTrims(piece);
    (part.left ? cut.left : cut.right).push_back(std::move(piece));
  }
  return cut;
}

// Whether the place of the surface that is farthest from the plane, of a grid, is above it.
bool LiesAbove(const NurbsSurface& surface, const Plane& plane) {
  const TrimRegion region(surface);
  const UnitDomain domain(surface);
  constexpr int kGrid = 33;
  double farthest = 0;
  for (int i = 0; i < kGrid; ++i) {
    for (int j = 0; j < kGrid; ++j) {
      const Eigen::Vector2d at = domain.Back({(i + 0.5) / kGrid, (j + 0.5) / kGrid});
      if (!region.Contains(at[0], at[1])) continue;
      const double height = HeightAbove(plane, surface.At(at[0], at[1]));
      if (std::abs(height) > std::abs(farthest)) farthest = height;
    }
  }
  return farthest >= 0;
}

// Iso-lines that stand for all curves of a section.
struct IsoLines {
  Direction direction;
  std::vector<double> at;
};

std::optional<double> IsoParameter(const NurbsSurface& surface,
                                   const NurbsCurve<2>& curve,
                                   Direction direction) {
  const int fixed = direction == Direction::kU ? 0 : 1;
  const UnitDomain domain(surface);
  const Eigen::RowVectorXd x = curve.control_points().row(fixed);
  const double least = x.minCoeff(), most = x.maxCoeff();
  if (most - least > kIso * domain.length[fixed]) return std::nullopt;
  const Eigen::RowVectorXd y = curve.control_points().row(1 - fixed);
  const double gone = std::abs(y[y.size() - 1] - y[0]);
  if (gone < (1 - kIso) * domain.length[1 - fixed]) return std::nullopt;
  const SplineBasis& basis = direction == Direction::kU ? surface.basis_u() : surface.basis_v();
  for (const double knot : basis.knots()) {
    if (std::abs(knot - x[0]) <= kIso * domain.length[fixed]) return knot;
  }
  return (least + most) / 2;
}

std::optional<IsoLines> IsoLinesOf(const NurbsSurface& surface, const PlaneSection& section) {
  if (surface.trimmed()) return std::nullopt;
  for (const Direction direction : {Direction::kU, Direction::kV}) {
    IsoLines lines{direction, {}};
    for (const SectionCurve& curve : section.curves) {
      const auto at = IsoParameter(surface, curve.parameters, direction);
      if (at) lines.at.push_back(*at);
    }
    if (lines.at.size() != section.curves.size()) continue;
    std::sort(lines.at.begin(), lines.at.end());
    return lines;
  }
  return std::nullopt;
}

SurfaceCut SplitAt(NurbsSurface surface, const IsoLines& lines, const Plane& plane) {
  SurfaceCut cut;
  const auto take = [&](NurbsSurface piece) {
    (LiesAbove(piece, plane) ? cut.left : cut.right).push_back(std::move(piece));
  };
  for (const double at : lines.at) {
    auto [low, high] = Split(surface, lines.direction, at);
    take(std::move(low));
    surface = std::move(high);
  }
  take(std::move(surface));
  return cut;
}

}  // namespace

SurfaceCut CutByPlane(const NurbsSurface& surface,
                      const Plane& plane,
                      const SectionOptions& options) {
  const PlaneSection section = Section(surface, plane, options);
  if (const auto lines = IsoLinesOf(surface, section)) return SplitAt(surface, *lines, plane);
  std::vector<NurbsCurve<2>> curves;
  for (const SectionCurve& curve : section.curves) curves.push_back(curve.parameters);
  const std::vector<RegionPart> parts = PartsOf(surface, curves, "CutByPlane");
  if (!parts.empty()) return Sorted(surface, parts);
  SurfaceCut whole;
  (LiesAbove(surface, plane) ? whole.left : whole.right).push_back(surface);
  return whole;
}

namespace {

SurfaceCut CutAlongAll(const NurbsSurface& surface, std::vector<NurbsCurve<2>> curves) {
  for (NurbsCurve<2>& curve : curves) {
    if (Closed(curve) && SignedArea(curve) < 0) curve = Reversed(curve);
  }
  const std::vector<RegionPart> parts = PartsOf(surface, curves, "CutAlong");
  RequireThat(!parts.empty(), "CutAlong", "the curve does not pass through the surface's inside");
  return Sorted(surface, parts);
}

}  // namespace

SurfaceCut CutAlong(const NurbsSurface& surface, const NurbsCurve<2>& curve) {
  return CutAlongAll(surface, {curve});
}

SurfaceCut CutAlong(const NurbsSurface& surface, const NurbsCurve<3>& curve, double tolerance) {
  return CutAlongAll(surface, ProjectedCurve(surface, curve, tolerance));
}

}  // namespace batten
