// SPDX-License-Identifier: MIT
// A curve or surface as Python holds it: a value, with tables that are made when first asked for.
#pragma once

#include <pybind11/pybind11.h>

#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include "batten/geometry/curve_evaluator.h"
#include "batten/geometry/direction.h"
#include "batten/geometry/foot_point.h"
#include "batten/geometry/surface_evaluator.h"
#include "batten/io/geometry_types.h"

namespace batten::python {

namespace py = pybind11;

// Made once, by whichever thread comes first.
template <typename Table>
class Once {
 public:
  template <typename Make>
  const Table& Get(const Make& make) const {
    std::call_once(flag_, [&] { table_ = std::make_unique<Table>(make()); });
    return *table_;
  }

 private:
  mutable std::once_flag flag_;
  mutable std::unique_ptr<Table> table_;
};

class Body {
 public:
  explicit Body(Geometry geometry) : geometry_(std::move(geometry)) {}

  const Geometry& geometry() const { return geometry_; }
  bool is_surface() const { return std::holds_alternative<NurbsSurface>(geometry_); }
  int dimension() const { return std::holds_alternative<NurbsCurve<2>>(geometry_) ? 2 : 3; }

  // Throws ValueError for a curve.
  const NurbsSurface& surface() const;

  // To be called without the interpreter's lock.
  const SurfaceEvaluator& evaluator() const {
    return surface_.Get([&] { return SurfaceEvaluator(surface()); });
  }
  const SurfaceFootPoints& feet() const {
    return surface_feet_.Get([&] { return SurfaceFootPoints(surface()); });
  }
  template <int Dim>
  const CurveEvaluator<Dim>& curve_evaluator() const {
    return Pick<Dim>(plane_, space_).Get([&] {
      return CurveEvaluator<Dim>(std::get<NurbsCurve<Dim>>(geometry_));
    });
  }
  template <int Dim>
  const CurveFootPoints<Dim>& curve_feet() const {
    return Pick<Dim>(plane_feet_, space_feet_).Get([&] {
      return CurveFootPoints<Dim>(std::get<NurbsCurve<Dim>>(geometry_));
    });
  }

 private:
  template <int Dim, typename Two, typename Three>
  static const auto& Pick(const Two& two, const Three& three) {
    if constexpr (Dim == 2) {
      return two;
    } else {
      return three;
    }
  }

  Geometry geometry_;
  Once<SurfaceEvaluator> surface_;
  Once<SurfaceFootPoints> surface_feet_;
  Once<CurveEvaluator<2>> plane_;
  Once<CurveEvaluator<3>> space_;
  Once<CurveFootPoints<2>> plane_feet_;
  Once<CurveFootPoints<3>> space_feet_;
};

using BodyPtr = std::shared_ptr<Body>;

inline BodyPtr MakeBody(Geometry geometry) { return std::make_shared<Body>(std::move(geometry)); }

template <typename Shapes>
std::vector<BodyPtr> MakeBodies(Shapes&& shapes) {
  std::vector<BodyPtr> bodies;
  for (auto& one : shapes) bodies.push_back(MakeBody(std::move(one)));
  return bodies;
}

std::vector<Geometry> GeometriesOf(const std::vector<BodyPtr>& bodies);

// "u" or "v".
Direction DirectionOf(const std::string& name);

// f(curve) or f(surface, direction), the interpreter's lock given up.
template <typename F>
auto InDirection(const Body& body, const std::string& direction, F f) {
  using Result = decltype(f(body.surface(), Direction::kU));
  const Direction along = body.is_surface() ? DirectionOf(direction) : Direction::kU;
  const py::gil_scoped_release released;
  return std::visit(
      [&](const auto& shape) -> Result {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(shape)>, NurbsSurface>) {
          return f(shape, along);
        } else {
          return f(shape);
        }
      },
      body.geometry());
}

}  // namespace batten::python
