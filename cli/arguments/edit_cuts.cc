// SPDX-License-Identifier: MIT
#include "cli/arguments/edit_cuts.h"

#include <iterator>
#include <utility>
#include <variant>

#include "batten/geometry/cut_surface.h"
#include "batten/geometry/plane_section.h"
#include "batten/geometry/split.h"
#include "batten/io/geometry_file.h"
#include "geometry/nurbs/placed_curve.h"

namespace batten::internal {
namespace {

// Of the size of the control points' box.
template <typename Shape>
double Share(const Shape& shape, double share) {
  const auto& points = shape.control_points();
  return share * (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

template <int Dim>
void CutCurve(const NurbsCurve<Dim>& curve,
              const Plane& plane,
              std::vector<Geometry>& above,
              std::vector<Geometry>& below) {
  constexpr double kTolerance = 1e-12;
  NurbsCurve<Dim> rest = curve;
  const NurbsCurve<3> in_space = [&] {
    if constexpr (Dim == 2) {
      return InSpace(curve);
    } else {
      return curve;
    }
  }();
  const auto take = [&](const NurbsCurve<Dim>& piece) {
    const double middle = (piece.basis().lower() + piece.basis().upper()) / 2;
    (HeightAbove(plane, in_space.At(middle)) > 0 ? above : below).emplace_back(piece);
  };
  for (const PlaneCrossing& one : Crossings(in_space, plane, Share(curve, kTolerance))) {
    if (one.touches || !(one.u > rest.basis().lower() && one.u < rest.basis().upper())) continue;
    auto [low, high] = Split(rest, one.u);
    take(low);
    rest = std::move(high);
  }
  take(rest);
}

template <typename From>
void Append(std::vector<Geometry>& to, From&& pieces) {
  to.insert(
      to.end(), std::make_move_iterator(pieces.begin()), std::make_move_iterator(pieces.end()));
}

// What the file of a trim holds: lengths in the unit of the surface, parameters as they are.
std::vector<Geometry> TrimmingCurves(const EditOperation& operation) {
  const std::string& path = operation.Word("curve");
  std::vector<Geometry> curves = ReadGeometry(path, operation.others);
  if (std::holds_alternative<NurbsCurve<2>>(curves.front())) return ReadGeometry(path);
  return curves;
}

// The curve that trims: in the parameter domain, or in space.
SurfaceCut CutAlongCurve(const EditOperation& operation,
                         const NurbsSurface& surface,
                         const Geometry& curve) {
  constexpr double kTolerance = 1e-8;
  if (const auto* plane = std::get_if<NurbsCurve<2>>(&curve)) return CutAlong(surface, *plane);
  const auto* space = std::get_if<NurbsCurve<3>>(&curve);
  if (!space) operation.Refuse("curve = '" + operation.Word("curve") + "' holds a surface");
  const double tolerance =
      operation.Has("tolerance") ? operation.Number("tolerance") : Share(surface, kTolerance);
  return CutAlong(surface, *space, tolerance);
}

}  // namespace

std::vector<Geometry> CutPieces(const EditOperation& operation, const Geometry& shape) {
  const std::vector<double>& x = operation.Numbers("plane");
  const Plane plane{{x[0], x[1], x[2]}, -x[3]};
  std::vector<Geometry> above, below;
  if (const auto* surface = std::get_if<NurbsSurface>(&shape)) {
    SurfaceCut cut = CutByPlane(*surface, plane);
    Append(above, std::move(cut.left));
    Append(below, std::move(cut.right));
  } else if (const auto* flat = std::get_if<NurbsCurve<2>>(&shape)) {
    CutCurve(*flat, plane, above, below);
  } else {
    CutCurve(std::get<NurbsCurve<3>>(shape), plane, above, below);
  }
  const std::string& keep = operation.Word("keep");
  std::vector<Geometry> kept;
  if (keep != "below") Append(kept, std::move(above));
  if (keep != "above") Append(kept, std::move(below));
  if (kept.empty()) operation.Refuse("nothing of it lies " + keep + " the plane");
  return kept;
}

std::vector<Geometry> TrimmedPieces(const EditOperation& operation, const NurbsSurface& surface) {
  const std::vector<Geometry> curves = TrimmingCurves(operation);
  if (curves.size() != 1) {
    operation.Refuse("curve = '" + operation.Word("curve") + "' holds " +
                     std::to_string(curves.size()) + " geometries; one curve is needed");
  }
  SurfaceCut cut = CutAlongCurve(operation, surface, curves.front());
  const bool inside = operation.Word("keep") == "inside";
  std::vector<Geometry> kept;
  Append(kept, std::move(inside ? cut.left : cut.right));
  if (kept.empty()) operation.Refuse("nothing of it lies " + operation.Word("keep"));
  return kept;
}

}  // namespace batten::internal
