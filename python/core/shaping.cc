// SPDX-License-Identifier: MIT
// Changes of a shape by hand.
#include <pybind11/stl.h>

#include "batten/geometry/bend.h"
#include "batten/geometry/flatten.h"
#include "batten/geometry/meet_targets.h"
#include "batten/geometry/modify_shape.h"
#include "batten/geometry/warp.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"

namespace batten::python {
namespace {

using Ranges =
    std::pair<std::optional<std::pair<double, double>>, std::optional<std::pair<double, double>>>;

// f(curve) or g(surface).
template <typename OfCurve, typename OfSurface>
BodyPtr ByKind(const Body& body, const OfCurve& of_curve, const OfSurface& of_surface) {
  const py::gil_scoped_release released;
  return MakeBody(std::visit(
      [&](const auto& shape) -> Geometry {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(shape)>, NurbsSurface>) {
          return of_surface(shape);
        } else {
          return of_curve(shape);
        }
      },
      body.geometry()));
}

ParameterRange RangeOf(const Ranges& region) { return {region.first->first, region.first->second}; }

ParameterRegion RegionOf(const Ranges& region) {
  ParameterRegion result;
  if (region.first) result.u = {region.first->first, region.first->second};
  if (region.second) result.v = {region.second->first, region.second->second};
  return result;
}

// `at` n × 1 or n × 2, `to` n × dimension, `order` as `at`, `fixed` m × 1 or m × 2.
BodyPtr MovePoints(const Body& body,
                   const Doubles& at,
                   const Doubles& to,
                   const std::vector<int>& order,
                   const std::vector<int>& fixed) {
  const std::vector<double> u = Numbers(at);
  const Eigen::VectorXd values = Vector(to);
  return ByKind(
      body,
      [&]<int Dim>(const NurbsCurve<Dim>& curve) {
        std::vector<CurveTarget<Dim>> targets;
        for (size_t k = 0; k < u.size(); ++k)
          targets.push_back(
              {u[k], values.segment<Dim>(static_cast<Eigen::Index>(Dim * k)), order[k]});
        return WithTargets<Dim>(curve, targets, fixed);
      },
      [&](const NurbsSurface& surface) {
        std::vector<SurfaceTarget> targets;
        for (size_t k = 0; 2 * k < u.size(); ++k) {
          targets.push_back({u[2 * k],
                             u[2 * k + 1],
                             values.segment<3>(static_cast<Eigen::Index>(3 * k)),
                             order[2 * k],
                             order[2 * k + 1]});
        }
        std::vector<NetPlace> places;
        for (size_t k = 0; 2 * k < fixed.size(); ++k)
          places.push_back({fixed[2 * k], fixed[2 * k + 1]});
        return WithTargets(surface, targets, places);
      });
}

BodyPtr Pull(const Body& body, double u, double v, const std::vector<int>& index, double by) {
  return ByKind(
      body,
      [&](const auto& curve) { return Pulled(curve, u, index, by); },
      [&](const NurbsSurface& surface) { return Pulled(surface, u, v, index[0], index[1], by); });
}

BodyPtr Warp(const Body& body,
             const Ranges& region,
             const Doubles& by,
             const std::string& shape,
             int spans) {
  const Eigen::VectorXd move = Vector(by);
  WarpOptions options;
  options.shape = shape == "tent"      ? WarpShape::kTent
                  : shape == "plateau" ? WarpShape::kPlateau
                                       : WarpShape::kBump;
  options.spans = spans;
  return ByKind(
      body,
      [&]<int Dim>(const NurbsCurve<Dim>& curve) {
        return Warped<Dim>(curve, RangeOf(region), move, options);
      },
      [&](const NurbsSurface& surface) {
        return Warped(surface, RegionOf(region), move, options);
      });
}

template <int Dim>
FlattenOptions<Dim> FlattenOf(const Eigen::VectorXd& normal,
                              double offset,
                              const std::optional<Eigen::VectorXd>& along,
                              double transition) {
  FlattenOptions<Dim> options{normal, offset, std::nullopt, transition};
  if (along) options.along = *along;
  return options;
}

BodyPtr Flatten(const Body& body,
                const Ranges& region,
                const Doubles& normal,
                double offset,
                const std::optional<Doubles>& along,
                double transition) {
  const Eigen::VectorXd n = Vector(normal);
  std::optional<Eigen::VectorXd> way;
  if (along) way = Vector(*along);
  return ByKind(
      body,
      [&]<int Dim>(const NurbsCurve<Dim>& curve) {
        return Flattened<Dim>(curve, RangeOf(region), FlattenOf<Dim>(n, offset, way, transition));
      },
      [&](const NurbsSurface& surface) {
        return Flattened(surface, RegionOf(region), FlattenOf<3>(n, offset, way, transition));
      });
}

py::tuple BendAbout(const Body& body,
                    const Doubles& from,
                    const Doubles& center,
                    const Doubles& axis,
                    double length,
                    double tolerance) {
  const CircleBend bend{Vector(from), Vector(center), Vector(axis), length};
  double error = 0;
  const auto bent = [&](const auto& shape) {
    auto result = Bent(shape, bend, tolerance);
    error = result.error;
    return std::move(result.shape);
  };
  const BodyPtr made = ByKind(body, bent, bent);
  return py::make_tuple(made, error);
}

}  // namespace

void BindShaping(py::module_& m) {
  m.def("move_points", &MovePoints);
  m.def("pull", &Pull);
  m.def("warp", &Warp);
  m.def("flatten", &Flatten);
  m.def("bend", &BendAbout);
}

}  // namespace batten::python
