// SPDX-License-Identifier: MIT
// Curves and surfaces: made from numbers, their numbers as arrays, equality and hash.
#include "python/core/body.h"

#include <pybind11/stl.h>

#include <functional>
#include <optional>
#include <string_view>

#include "batten/io/geometry_json.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/errors.h"

namespace batten::python {
namespace {

SplineBasis BasisOf(int degree, const Doubles& knots, bool periodic, const char* name) {
  try {
    return periodic ? SplineBasis::Periodic(degree, Numbers(knots))
                    : SplineBasis(degree, Numbers(knots));
  } catch (const std::invalid_argument& error) {
    throw py::value_error(std::string(name) + ": " + Reason(error.what()));
  }
}

template <int Dim>
Geometry CurveOf(SplineBasis basis, const Doubles& points, Eigen::VectorXd weights) {
  return NurbsCurve<Dim>(
      std::move(basis), Columns<Dim>(points, "control_points"), std::move(weights));
}

BodyPtr MakeCurve(int degree,
                  const Doubles& knots,
                  const Doubles& points,
                  const std::optional<Doubles>& weights,
                  bool periodic) {
  SplineBasis basis = BasisOf(degree, knots, periodic, "knots");
  Eigen::VectorXd w = weights ? Vector(*weights) : Eigen::VectorXd();
  if (points.ndim() == 2 && points.shape(1) == 2)
    return MakeBody(CurveOf<2>(std::move(basis), points, std::move(w)));
  if (points.ndim() != 2 || points.shape(1) != 3)
    throw py::value_error("control_points: an array of shape (n, 2) or (n, 3) is needed");
  return MakeBody(CurveOf<3>(std::move(basis), points, std::move(w)));
}

std::vector<NurbsCurve<2>> LoopsOf(const std::vector<BodyPtr>& trims) {
  std::vector<NurbsCurve<2>> loops;
  for (const BodyPtr& trim : trims) {
    const auto* loop = std::get_if<NurbsCurve<2>>(&trim->geometry());
    if (!loop) throw py::value_error("trims: curves of two dimensions are needed");
    loops.push_back(*loop);
  }
  return loops;
}

BodyPtr MakeSurface(const std::pair<int, int>& degree,
                    const Doubles& knots_u,
                    const Doubles& knots_v,
                    const Doubles& points,
                    const std::optional<Doubles>& weights,
                    const std::pair<bool, bool>& periodic,
                    const std::vector<BodyPtr>& trims) {
  SplineBasis u = BasisOf(degree.first, knots_u, periodic.first, "knots_u");
  SplineBasis v = BasisOf(degree.second, knots_v, periodic.second, "knots_v");
  if (points.ndim() != 3 || points.shape(2) != 3)
    throw py::value_error("control_points: an array of shape (n, m, 3) is needed");
  if (points.shape(0) != u.size() || points.shape(1) != v.size()) {
    throw py::value_error("control_points: the knots and degrees are those of " +
                          std::to_string(u.size()) + " x " + std::to_string(v.size()) +
                          " control points, not " + std::to_string(points.shape(0)) + " x " +
                          std::to_string(points.shape(1)));
  }
  Eigen::Matrix3Xd columns =
      Eigen::Map<const Eigen::Matrix3Xd>(points.data(), 3, points.shape(0) * points.shape(1));
  NurbsSurface surface(std::move(u),
                       std::move(v),
                       std::move(columns),
                       weights ? Vector(*weights) : Eigen::VectorXd());
  if (!trims.empty()) surface = surface.WithTrims(LoopsOf(trims));
  return MakeBody(std::move(surface));
}

const SplineBasis& BasisOf(const Body& body, const std::string& direction) {
  if (body.is_surface()) {
    const NurbsSurface& surface = body.surface();
    return DirectionOf(direction) == Direction::kU ? surface.basis_u() : surface.basis_v();
  }
  return std::visit(
      [](const auto& shape) -> const SplineBasis& {
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(shape)>, NurbsSurface>) {
          return shape.basis_u();
        } else {
          return shape.basis();
        }
      },
      body.geometry());
}

py::array Knots(const py::object& self, const std::string& direction) {
  const std::vector<double>& knots = BasisOf(self.cast<const Body&>(), direction).knots();
  return View(knots.data(), {std::ssize(knots)}, self);
}

py::array ControlPoints(const py::object& self) {
  const Body& body = self.cast<const Body&>();
  return std::visit(
      [&](const auto& shape) {
        const auto& points = shape.control_points();
        Shape form{points.cols(), points.rows()};
        if (body.is_surface())
          form = {body.surface().size_u(), body.surface().size_v(), points.rows()};
        return View(points.data(), form, self);
      },
      body.geometry());
}

py::array Weights(const py::object& self) {
  const Body& body = self.cast<const Body&>();
  return std::visit(
      [&](const auto& shape) {
        Shape form{shape.weights().size()};
        if (body.is_surface()) form = {body.surface().size_u(), body.surface().size_v()};
        return View(shape.weights().data(), form, self);
      },
      body.geometry());
}

// Equal values have equal bytes, but for zeros of either sign.
void Mix(const double* numbers, Eigen::Index count, std::size_t& hash) {
  for (Eigen::Index k = 0; k < count; ++k)
    hash = hash * 1099511628211U ^ std::hash<double>()(numbers[k]);
}
void Mix(const SplineBasis& basis, std::size_t& hash) {
  hash = hash * 31 + static_cast<std::size_t>(basis.degree());
  Mix(basis.knots().data(), std::ssize(basis.knots()), hash);
}
template <int Dim>
void Mix(const NurbsCurve<Dim>& curve, std::size_t& hash) {
  Mix(curve.basis(), hash);
  Mix(curve.control_points().data(), curve.control_points().size(), hash);
  Mix(curve.weights().data(), curve.weights().size(), hash);
}
void Mix(const NurbsSurface& surface, std::size_t& hash) {
  Mix(surface.basis_u(), hash);
  Mix(surface.basis_v(), hash);
  Mix(surface.control_points().data(), surface.control_points().size(), hash);
  Mix(surface.weights().data(), surface.weights().size(), hash);
  for (const NurbsCurve<2>& loop : surface.trims()) Mix(loop, hash);
}

std::size_t Hash(const Body& body) {
  std::size_t hash = body.geometry().index() + 1469598103934665603U;
  std::visit([&](const auto& shape) { Mix(shape, hash); }, body.geometry());
  return hash >> 1;
}

}  // namespace

const NurbsSurface& Body::surface() const {
  if (const auto* surface = std::get_if<NurbsSurface>(&geometry_)) return *surface;
  throw py::value_error("a surface is needed, not a curve");
}

std::vector<Geometry> GeometriesOf(const std::vector<BodyPtr>& bodies) {
  std::vector<Geometry> geometries;
  for (const BodyPtr& body : bodies) geometries.push_back(body->geometry());
  return geometries;
}

Direction DirectionOf(const std::string& name) {
  if (name == "u") return Direction::kU;
  if (name == "v") return Direction::kV;
  throw py::value_error("direction: '" + name + "' is neither 'u' nor 'v'");
}

void BindBodies(py::module_& m) {
  py::class_<Body, BodyPtr>(m, "Body")
      .def_property_readonly("is_surface", &Body::is_surface)
      .def_property_readonly("dimension", &Body::dimension)
      .def("degree", [](const Body& b, const std::string& d) { return BasisOf(b, d).degree(); })
      .def("knots", &Knots)
      .def("domain",
           [](const Body& b, const std::string& d) {
             return py::make_tuple(BasisOf(b, d).lower(), BasisOf(b, d).upper());
           })
      .def("periodic", [](const Body& b, const std::string& d) { return BasisOf(b, d).periodic(); })
      .def("clamped", [](const Body& b, const std::string& d) { return BasisOf(b, d).clamped(); })
      .def("greville",
           [](const Body& b, const std::string& d) {
             const SplineBasis& basis = BasisOf(b, d);
             Eigen::VectorXd values(basis.size());
             for (int i = 0; i < basis.size(); ++i) values[i] = basis.Greville(i);
             return Owned(std::move(values), {basis.size()});
           })
      .def("control_points", &ControlPoints)
      .def("weights", &Weights)
      .def("rational",
           [](const Body& b) {
             return std::visit([](const auto& s) { return s.rational(); }, b.geometry());
           })
      .def(
          "trims",
          [](const Body& b) { return MakeBodies(std::vector<NurbsCurve<2>>(b.surface().trims())); })
      .def("with_trims",
           [](const Body& b, const std::vector<BodyPtr>& trims) {
             return MakeBody(b.surface().WithTrims(LoopsOf(trims)));
           })
      .def("json",
           [](const Body& b) { return ToGeometryJson(std::vector<Geometry>{b.geometry()}); })
      .def("__eq__", [](const Body& a, const Body& b) { return a.geometry() == b.geometry(); })
      .def("__hash__", &Hash);
  m.def("make_curve", &MakeCurve);
  m.def("make_surface", &MakeSurface);
}

}  // namespace batten::python
