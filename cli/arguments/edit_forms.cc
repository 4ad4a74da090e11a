// SPDX-License-Identifier: MIT
#include "cli/arguments/edit_forms.h"

#include <algorithm>
#include <iterator>
#include <utility>
#include <variant>

#include "batten/geometry/clamp.h"
#include "batten/geometry/continuation.h"
#include "batten/geometry/curve_chain.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/knot_vectors.h"
#include "batten/geometry/power_form.h"
#include "batten/geometry/remove_knots.h"
#include "batten/io/geometry_file.h"
#include "cli/arguments/edit_values.h"
#include "cli/arguments/plane_curves.h"

namespace batten::internal {
namespace {

// Inner knots, as often as each is short of the degree.
std::vector<double> MissingForBezier(const SplineBasis& basis) {
  std::vector<double> missing;
  for (const KnotMultiplicity& one : DomainKnots(basis)) {
    if (one.knot <= basis.lower() || one.knot >= basis.upper()) continue;
    missing.insert(missing.end(), basis.degree() - one.multiplicity, one.knot);
  }
  return missing;
}

template <int Dim>
NurbsCurve<Dim> InBezierForm(const NurbsCurve<Dim>& given) {
  const NurbsCurve<Dim> curve = Clamped(given);
  return RefineKnots(curve, MissingForBezier(curve.basis()));
}

NurbsSurface InBezierForm(const NurbsSurface& given) {
  NurbsSurface surface = Clamped(Clamped(given, Direction::kU), Direction::kV);
  surface = RefineKnots(surface, Direction::kU, MissingForBezier(surface.basis_u()));
  return RefineKnots(surface, Direction::kV, MissingForBezier(surface.basis_v()));
}

template <typename Shape>
double SizeOfShape(const Shape& shape) {
  const auto& points = shape.control_points();
  return (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).norm();
}

JoinFreedom FreedomOf(const EditOperation& op) {
  return {.alpha = op.Number("alpha"),
          .beta = op.Number("beta"),
          .eta = op.Number("eta"),
          .beta2 = op.Number("beta2"),
          .eta2 = op.Number("eta2")};
}

struct Continuer {
  const EditOperation& op;
  int order;

  template <int Dim>
  Geometry operator()(const NurbsCurve<Dim>& curve) const {
    const std::vector<double>& to = op.Numbers("to");
    if (op.direction) op.Refuse("a curve has one direction; leave dir out");
    if (static_cast<int>(to.size()) < Dim || (Dim == 2 && to.size() == 3 && to[2] != 0)) {
      op.Refuse(Dim == 2 ? "a plane curve needs two numbers x;y" : "it needs three numbers x;y;z");
    }
    return Continued(curve,
                     op.Word("end") == "upper",
                     order,
                     Eigen::Matrix<double, Dim, 1>(to.data()),
                     FreedomOf(op),
                     op.Number("weight"));
  }
  Geometry operator()(const NurbsSurface& surface) const {
    if (!op.direction) op.Refuse("a surface has two directions; say dir=u or dir=v");
    const std::vector<double>& to = op.Numbers("to");
    if (to.size() != 3) op.Refuse("of a surface `to` is the shift x;y;z of the far edge");
    return Continued(surface,
                     {*op.direction, op.Word("end") == "upper"},
                     order,
                     Eigen::Vector3d(to.data()),
                     FreedomOf(op));
  }
};

template <int Dim>
Geometry Chained(const EditOperation& op,
                 const std::vector<Geometry>& shapes,
                 const std::vector<std::string>& names) {
  std::vector<NurbsCurve<Dim>> curves;
  double size = 0;
  for (const Geometry& one : shapes) {
    curves.push_back(std::get<NurbsCurve<Dim>>(one));
    size += SizeOfShape(curves.back());
  }
  constexpr double kShare = 1e-6;
  return Unified(curves, op.Has("tolerance") ? op.Number("tolerance") : kShare * size, names);
}

// Paths separated by ';'.
std::vector<std::string> Paths(const std::string& text) {
  std::vector<std::string> paths;
  for (size_t begin = 0; begin < text.size();) {
    const size_t end = std::min(text.find(';', begin), text.size());
    if (end > begin) paths.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  return paths;
}

}  // namespace

Geometry BezierForm(const Geometry& shape) {
  return std::visit([](const auto& one) -> Geometry { return InBezierForm(one); }, shape);
}

Geometry BsplineForm(const EditOperation& operation, const Geometry& shape) {
  return std::visit(
      [&](const auto& one) -> Geometry {
        return RemoveKnots(
                   one,
                   operation.Has("tolerance") ? operation.Number("tolerance") : RoundingOf(one))
            .shape;
      },
      shape);
}

Geometry PowerForm(const Geometry& shape) {
  std::visit([](const auto& one) { ToPower(one); }, shape);
  return shape;
}

std::vector<Geometry> ContinuedPieces(const EditOperation& operation, const Geometry& shape) {
  const int order = operation.Word("order") == "1" ? 1 : 2;
  return {shape, std::visit(Continuer{operation, order}, shape)};
}

Geometry UnifiedCurve(const EditOperation& operation, const std::vector<Geometry>& shapes) {
  std::vector<Geometry> all = shapes;
  std::vector<std::string> names;
  const auto name = [&](const std::string& file, size_t count) {
    for (size_t k = 1; k <= count; ++k)
      names.push_back(count == 1 ? file : "curve " + std::to_string(k) + " of " + file);
  };
  name("the edited file", shapes.size());
  for (const std::string& path : Paths(operation.Word("with"))) {
    std::vector<Geometry> some = ReadGeometry(path, operation.others);
    name(path, some.size());
    std::move(some.begin(), some.end(), std::back_inserter(all));
  }
  MatchDimensions(all);
  for (const Geometry& one : all) {
    if (std::holds_alternative<NurbsSurface>(one)) {
      operation.Refuse("only curves make a chain; there is a surface among them");
    }
  }
  if (std::holds_alternative<NurbsCurve<2>>(all.front())) return Chained<2>(operation, all, names);
  return Chained<3>(operation, all, names);
}

}  // namespace batten::internal
