// SPDX-License-Identifier: MIT
// What curves and surfaces are: boxes, lengths, areas, curvature, continuity, class, joins.
#include <pybind11/stl.h>

#include "batten/geometry/arc_length.h"
#include "batten/geometry/bounding_box.h"
#include "batten/geometry/classify_shape.h"
#include "batten/geometry/closure.h"
#include "batten/geometry/curvature_range.h"
#include "batten/geometry/joins.h"
#include "batten/geometry/surface_area.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"

namespace batten::python {
namespace {

using Name = const std::string&;

py::tuple Box(const Body& body) {
  return std::visit(
      [](const auto& shape) {
        const auto box = [&] {
          const py::gil_scoped_release released;
          return BoundingBox(shape);
        }();
        const py::ssize_t size = box.min().size();
        return py::make_tuple(Owned(Eigen::VectorXd(box.min()), {size}),
                              Owned(Eigen::VectorXd(box.max()), {size}));
      },
      body.geometry());
}

// f(curve)
template <typename F>
auto OfCurve(const Body& body, const F& f) {
  using Result = decltype(f(std::declval<NurbsCurve<3>>()));
  return std::visit(
      [&](const auto& shape) -> Result {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(shape)>, NurbsSurface>) {
          throw py::value_error("a curve is needed, not a surface");
        } else {
          return f(shape);
        }
      },
      body.geometry());
}

double Length(const Body& body, const std::optional<std::pair<double, double>>& range) {
  return OfCurve(body, [&](const auto& curve) {
    return range ? ArcLength(curve, range->first, range->second) : ArcLength(curve);
  });
}

py::array AtLength(const Body& body, const Doubles& lengths) {
  return OfCurve(body, [&](const auto& curve) {
    const ArcLengthMap map(curve);
    Eigen::VectorXd parameters(lengths.size());
    for (py::ssize_t k = 0; k < lengths.size(); ++k)
      parameters[k] = map.ParameterAt(lengths.data()[k]);
    return Owned(std::move(parameters), {lengths.size()});
  });
}

double AreaOf(const Body& body, const std::optional<std::array<double, 4>>& box) {
  const NurbsSurface& surface = body.surface();
  const py::gil_scoped_release released;
  return box ? Area(surface, (*box)[0], (*box)[1], (*box)[2], (*box)[3]) : Area(surface);
}

py::object CurvatureRangeOf(const Body& body) {
  const auto range = std::visit(
      [](const auto& shape) {
        const py::gil_scoped_release released;
        return CurvatureRange(shape);
      },
      body.geometry());
  return range ? py::object(py::make_tuple(range->min, range->max)) : py::none();
}

py::list Continuity(const Body& body, Name direction, double tolerance) {
  const auto knots = InDirection(body, direction, [&](const auto& shape, auto... along) {
    return ContinuityAtKnots(shape, along..., tolerance);
  });
  py::list list;
  for (const KnotContinuity& one : knots)
    list.append(py::make_tuple(one.knot, one.multiplicity, one.guaranteed, one.actual));
  return list;
}

// The parameters of every class of shape by their names.
struct ShapeNumbers {
  static py::dict Of(const FreeForm&) { return {}; }
  static py::dict Of(const LineShape& s) {
    using namespace py::literals;
    return py::dict("point"_a = Triple(s.point), "direction"_a = Triple(s.direction));
  }
  static py::dict Of(const CircleShape& s) {
    using namespace py::literals;
    return py::dict(
        "center"_a = Triple(s.center), "normal"_a = Triple(s.normal), "radius"_a = s.radius);
  }
  static py::dict Of(const EllipseShape& s) {
    using namespace py::literals;
    return py::dict("center"_a = Triple(s.center),
                    "major_axis"_a = Triple(s.major_axis),
                    "minor_axis"_a = Triple(s.minor_axis),
                    "major_radius"_a = s.major_radius,
                    "minor_radius"_a = s.minor_radius);
  }
  static py::dict Of(const ParabolaShape& s) {
    using namespace py::literals;
    return py::dict("vertex"_a = Triple(s.vertex),
                    "axis"_a = Triple(s.axis),
                    "normal"_a = Triple(s.normal),
                    "focal_length"_a = s.focal_length);
  }
  static py::dict Of(const HyperbolaShape& s) {
    using namespace py::literals;
    return py::dict("center"_a = Triple(s.center),
                    "transverse_axis"_a = Triple(s.transverse_axis),
                    "conjugate_axis"_a = Triple(s.conjugate_axis),
                    "transverse_radius"_a = s.transverse_radius,
                    "conjugate_radius"_a = s.conjugate_radius);
  }
  static py::dict Of(const PlaneShape& s) {
    using namespace py::literals;
    return py::dict("point"_a = Triple(s.point), "normal"_a = Triple(s.normal));
  }
  static py::dict Of(const CylinderShape& s) {
    using namespace py::literals;
    return py::dict("point"_a = Triple(s.point), "axis"_a = Triple(s.axis), "radius"_a = s.radius);
  }
  static py::dict Of(const SphereShape& s) {
    using namespace py::literals;
    return py::dict("center"_a = Triple(s.center), "radius"_a = s.radius);
  }
  static py::dict Of(const ConeShape& s) {
    using namespace py::literals;
    return py::dict(
        "apex"_a = Triple(s.apex), "axis"_a = Triple(s.axis), "half_angle"_a = s.half_angle);
  }
  static py::dict Of(const TorusShape& s) {
    using namespace py::literals;
    return py::dict("center"_a = Triple(s.center),
                    "axis"_a = Triple(s.axis),
                    "major_radius"_a = s.major_radius,
                    "minor_radius"_a = s.minor_radius);
  }
  static py::dict Of(const RevolutionShape& s) {
    using namespace py::literals;
    return py::dict("point"_a = Triple(s.point), "axis"_a = Triple(s.axis));
  }
  static py::dict Of(const ExtrusionShape& s) {
    using namespace py::literals;
    return py::dict("direction"_a = Triple(s.direction));
  }
};

py::tuple Classify(const Body& body, double tolerance) {
  return std::visit(
      [&](const auto& shape) {
        const auto found = [&] {
          const py::gil_scoped_release released;
          return ClassifyShape(shape, {.tolerance = tolerance});
        }();
        return py::make_tuple(NameOf(found),
                              std::visit([](const auto& s) { return ShapeNumbers::Of(s); }, found));
      },
      body.geometry());
}

template <typename T>
py::object OrNone(const std::optional<T>& value) {
  return value ? py::cast(*value) : py::none();
}

py::dict Quality(const JoinQuality& join) {
  using namespace py::literals;
  return py::dict("C"_a = join.parametric,
                  "G"_a = join.geometric,
                  "position_gap"_a = join.position_gap,
                  "angle_gap"_a = OrNone(join.angle_gap),
                  "curvature_gap"_a = OrNone(join.curvature_gap));
}

py::dict Described(const CurveJoin& join) {
  py::dict all = Quality(join);
  all["at"] = py::make_tuple(join.at[0], join.at[1]);
  return all;
}

py::tuple EdgeName(const SurfaceEdge& edge) {
  return py::make_tuple(edge.direction == Direction::kU ? "u" : "v",
                        edge.upper ? "upper" : "lower");
}

py::dict Described(const SurfaceJoin& join) {
  py::dict all = Quality(join);
  all["at"] = py::make_tuple(py::make_tuple(join.at[0][0], join.at[0][1]),
                             py::make_tuple(join.at[1][0], join.at[1][1]));
  all["edges"] = py::make_tuple(EdgeName(join.edges[0]), EdgeName(join.edges[1]));
  all["reversed"] = join.reversed;
  all["shared_edges"] = join.shared_edges;
  return all;
}

py::dict Joint(const Body& first,
               const Body& second,
               const std::optional<double>& position,
               double angle,
               double curvature,
               double derivative) {
  const JoinOptions options{position, angle, curvature, derivative};
  return std::visit(
      [&](const auto& a, const auto& b) -> py::dict {
        if constexpr (std::is_same_v<decltype(a), decltype(b)>) {
          return Described(TestJoin(a, b, options));
        } else {
          throw py::value_error("other: two curves of one dimension or two surfaces are needed");
        }
      },
      first.geometry(),
      second.geometry());
}

}  // namespace

void BindMeasures(py::module_& m) {
  m.def("bounding_box", &Box);
  m.def("length", &Length);
  m.def("parameters_at_lengths", &AtLength);
  m.def("area", &AreaOf);
  m.def("curvature_range", &CurvatureRangeOf);
  m.def("closed", [](const Body& b, Name d, double tolerance) {
    return InDirection(
        b, d, [&](const auto& shape, auto... along) { return Closed(shape, along..., tolerance); });
  });
  m.def("continuity", &Continuity);
  m.def("seam_continuity", [](const Body& b, Name d, double tolerance) {
    return InDirection(b, d, [&](const auto& shape, auto... along) {
      return SeamContinuity(shape, along..., tolerance);
    });
  });
  m.def("collapsed_edges", [](const Body& b) {
    const CollapsedEdgeSet edges = CollapsedEdges(b.surface());
    return py::make_tuple(edges.u_lower, edges.u_upper, edges.v_lower, edges.v_upper);
  });
  m.def("classify", &Classify);
  m.def("joint", &Joint);
}

}  // namespace batten::python
