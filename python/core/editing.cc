// SPDX-License-Identifier: MIT
// Operations that give a new curve or surface.
#include <pybind11/stl.h>

#include "batten/geometry/clamp.h"
#include "batten/geometry/composition.h"
#include "batten/geometry/degree_elevation.h"
#include "batten/geometry/degree_reduction.h"
#include "batten/geometry/extend.h"
#include "batten/geometry/insert_knots.h"
#include "batten/geometry/iso_curve.h"
#include "batten/geometry/join.h"
#include "batten/geometry/modify_shape.h"
#include "batten/geometry/remove_knots.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "batten/geometry/split.h"
#include "batten/geometry/transform.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"

namespace batten::python {
namespace {

using Name = const std::string&;

// A function f(shape, direction if any) of the library as a new body.
template <typename F>
BodyPtr New(const Body& body, Name direction, F f) {
  return MakeBody(InDirection(body, direction, [&](const auto& shape, auto... along) -> Geometry {
    return f(shape, along...);
  }));
}

py::tuple RemoveOne(const Body& body, Name direction, double at, int times, double tolerance) {
  int removed = 0;
  double error = 0;
  const BodyPtr made = New(body, direction, [&](const auto& shape, auto... along) {
    auto removal = RemoveKnot(shape, along..., at, times, tolerance);
    removed = removal.removed;
    error = removal.error;
    return std::move(removal.shape);
  });
  return py::make_tuple(made, removed, error);
}

py::tuple RemoveAll(const Body& body, double tolerance) {
  int removed = 0;
  double error = 0;
  const BodyPtr made = New(body, "u", [&](const auto& shape, auto...) {
    auto removal = RemoveKnots(shape, tolerance);
    removed = removal.removed;
    error = removal.error;
    return std::move(removal.shape);
  });
  return py::make_tuple(made, removed, error);
}

py::tuple Reduce(const Body& body, Name direction, int by, double tolerance) {
  int reduced = 0;
  double error = 0;
  const BodyPtr made = New(body, direction, [&](const auto& shape, auto... along) {
    auto reduction = Reduced(shape, along..., by, tolerance);
    reduced = reduction.reduced;
    error = reduction.error;
    return std::move(reduction.shape);
  });
  return py::make_tuple(made, reduced, error);
}

std::vector<BodyPtr> SplitAt(const Body& body, Name direction, double at) {
  auto pieces = InDirection(body, direction, [&](const auto& shape, auto... along) {
    auto [first, second] = Split(shape, along..., at);
    return std::vector<Geometry>{std::move(first), std::move(second)};
  });
  return MakeBodies(std::move(pieces));
}

std::vector<BodyPtr> DecomposeAll(const Body& body, Name direction) {
  const auto gather = [](auto pieces) {
    return std::vector<Geometry>(std::make_move_iterator(pieces.begin()),
                                 std::make_move_iterator(pieces.end()));
  };
  if (direction.empty()) {
    return MakeBodies(
        std::visit([&](const auto& shape) { return gather(Decompose(shape)); }, body.geometry()));
  }
  return MakeBodies(InDirection(body, direction, [&](const auto& shape, auto... along) {
    return gather(Decompose(shape, along...));
  }));
}

std::vector<BodyPtr> Parts(const Body& body, Name direction, double a, double b) {
  return MakeBodies(SegmentParts(body.surface(), DirectionOf(direction), a, b));
}

BodyPtr Transform(const Body& body, const Doubles& matrix) {
  if (matrix.ndim() != 2 || matrix.shape(0) != 4 || matrix.shape(1) != 4)
    throw py::value_error("matrix: an array of shape (4, 4) is needed");
  const Eigen::Matrix<double, 4, 4, Eigen::RowMajor> rows(matrix.data());
  return New(body, "u", [&](const auto& shape, auto...) {
    return Transformed(shape, Eigen::Matrix4d(rows));
  });
}

BodyPtr SetWeight(const Body& body, int i, int j, double weight) {
  return MakeBody(std::visit(
      [&](const auto& shape) -> Geometry {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(shape)>, NurbsSurface>) {
          return WithWeight(shape, i, j, weight);
        } else {
          return WithWeight(shape, i, weight);
        }
      },
      body.geometry()));
}

BodyPtr MovePoint(const Body& body, double u, double v, const Doubles& to) {
  if (to.size() != body.dimension())
    throw py::value_error("to: " + std::to_string(body.dimension()) + " numbers are needed");
  return MakeBody(std::visit(
      [&](const auto& shape) -> Geometry {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(shape)>, NurbsSurface>) {
          return MovedPoint(shape, u, v, Eigen::Vector3d(Vector(to)));
        } else {
          return MovedPoint(
              shape, u, typename std::remove_cvref_t<decltype(shape)>::Point(Vector(to)));
        }
      },
      body.geometry()));
}

BodyPtr Extend(const Body& body, Name direction, bool upper, double length, bool natural) {
  const Continuation how = natural ? Continuation::kNatural : Continuation::kFair;
  if (body.is_surface()) {
    const SurfaceEdge edge{DirectionOf(direction), upper};
    return MakeBody(Extended(body.surface(), edge, length, how));
  }
  return MakeBody(std::visit(
      [&](const auto& shape) -> Geometry {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(shape)>, NurbsSurface>) {
          return shape;
        } else {
          return Extended(shape, upper, length, how);
        }
      },
      body.geometry()));
}

BodyPtr JoinTwo(const Body& first, const Body& second, Name direction, double tolerance) {
  return MakeBody(std::visit(
      [&](const auto& a, const auto& b) -> Geometry {
        if constexpr (!std::is_same_v<decltype(a), decltype(b)>) {
          throw py::value_error("join: two curves of one dimension or two surfaces are needed");
        } else if constexpr (std::is_same_v<std::remove_cvref_t<decltype(a)>, NurbsSurface>) {
          return Join(a, b, DirectionOf(direction), tolerance);
        } else {
          return Join(a, b, tolerance);
        }
      },
      first.geometry(),
      second.geometry()));
}

BodyPtr Compose(
    const Body& body, Name direction, int degree, const Doubles& knots, const Doubles& values) {
  const ScalarSpline f{SplineBasis(degree, Numbers(knots)), Vector(values)};
  if (f.coefficients.size() != f.basis.size())
    throw py::value_error("coefficients: one for each function of the basis is needed");
  return New(body, direction, [&](const auto& shape, auto... along) {
    return Composed(shape, along..., f);
  });
}

}  // namespace

void BindEditing(py::module_& m) {
  m.def("insert_knot", [](const Body& b, Name d, double at, int times) {
    return New(
        b, d, [&](const auto& s, auto... along) { return InsertKnot(s, along..., at, times); });
  });
  m.def("refine", [](const Body& b, Name d, const std::vector<double>& knots) {
    return New(b, d, [&](const auto& s, auto... along) { return RefineKnots(s, along..., knots); });
  });
  m.def("remove_knot", &RemoveOne);
  m.def("remove_knots", &RemoveAll);
  m.def("elevate", [](const Body& b, Name d, int by) {
    return New(b, d, [&](const auto& s, auto... along) { return Elevated(s, along..., by); });
  });
  m.def("reduce", &Reduce);
  m.def("split", &SplitAt);
  m.def("segment", [](const Body& b, Name d, double from, double to) {
    return New(b, d, [&](const auto& s, auto... along) { return Segment(s, along..., from, to); });
  });
  m.def("segment_parts", &Parts);
  m.def("decompose", &DecomposeAll);
  m.def("reverse", [](const Body& b, Name d) {
    return New(b, d, [](const auto& s, auto... along) { return Reversed(s, along...); });
  });
  m.def("swap", [](const Body& b) { return MakeBody(Swapped(b.surface())); });
  m.def("transform", &Transform);
  m.def("clamp", [](const Body& b, Name d) {
    return New(b, d, [](const auto& s, auto... along) { return Clamped(s, along...); });
  });
  m.def("unclamp", [](const Body& b, Name d) {
    return New(b, d, [](const auto& s, auto... along) { return Unclamped(s, along...); });
  });
  m.def("make_periodic", [](const Body& b, Name d, double tolerance) {
    return New(
        b, d, [&](const auto& s, auto... along) { return Periodic(s, along..., tolerance); });
  });
  m.def("reparameterize", [](const Body& b, Name d, double from, double to) {
    return New(
        b, d, [&](const auto& s, auto... along) { return Reparameterized(s, along..., from, to); });
  });
  m.def("moebius", [](const Body& b, Name dir, double a, double be, double c, double d) {
    return New(b, dir, [&](const auto& s, auto... along) {
      return MobiusReparameterized(s, along..., a, be, c, d);
    });
  });
  m.def("iso", [](const Body& b, Name d, double at) {
    return MakeBody(IsoCurve(b.surface(), DirectionOf(d), at));
  });
  m.def("boundary", [](const Body& b) {
    std::vector<BodyPtr> edges;
    for (const NurbsCurve<3>& edge : BoundaryCurves(b.surface())) edges.push_back(MakeBody(edge));
    return edges;
  });
  m.def("set_weight", &SetWeight);
  m.def("move_point", &MovePoint);
  m.def("extend", &Extend);
  m.def("join", &JoinTwo);
  m.def("compose", &Compose);
  m.def("translation", [](const Doubles& shift) {
    const Eigen::Matrix4d matrix = Translation(Eigen::Vector3d(Vector(shift)));
    return Owned(Eigen::Matrix<double, 4, 4, Eigen::RowMajor>(matrix), {4, 4});
  });
  m.def("rotation", [](const Doubles& axis, double angle) {
    const Eigen::Matrix4d matrix = Rotation(Eigen::Vector3d(Vector(axis)), angle);
    return Owned(Eigen::Matrix<double, 4, 4, Eigen::RowMajor>(matrix), {4, 4});
  });
}

}  // namespace batten::python
