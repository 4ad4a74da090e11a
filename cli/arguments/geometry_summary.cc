// SPDX-License-Identifier: MIT
#include "cli/arguments/geometry_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>
#include <variant>

#include "batten/geometry/classify_shape.h"
#include "batten/geometry/closure.h"
#include "batten/geometry/cubic_features.h"
#include "batten/geometry/curve_chain.h"
#include "batten/geometry/split.h"
#include "batten/io/geometry_file.h"
#include "cli/arguments/describe_geometry.h"
#include "cli/terminal/streams.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

// The first `dimension` coordinates.
Json ToJson(const Eigen::Vector3d& v, int dimension) {
  return std::vector<double>(v.data(), v.data() + dimension);
}

int Least(const std::vector<KnotContinuity>& knots, int degree) {
  int least = degree;
  for (const KnotContinuity& knot : knots) least = std::min(least, knot.actual);
  return least;
}

Json OrNull(const std::optional<int>& value) { return value ? Json(*value) : Json(nullptr); }

void AddBases(const std::vector<const SplineBasis*>& bases, Json& info) {
  for (const char* key : {"degree", "control_points", "knots", "domain", "periodic"}) {
    info[key] = Json::array();
  }
  for (const SplineBasis* basis : bases) {
    info["degree"].push_back(basis->degree());
    info["control_points"].push_back(basis->size());
    info["knots"].push_back(basis->knots());
    info["domain"].push_back({basis->lower(), basis->upper()});
    info["periodic"].push_back(basis->periodic());
  }
}

void AddMeasures(const ShapeMeasures& measures, int dimension, const char* size, Json& info) {
  info["bounding_box"] =
      Json::array({ToJson(measures.box.min(), dimension), ToJson(measures.box.max(), dimension)});
  info[size] = measures.size;
  info["curvature"] = nullptr;
  const auto finite = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  if (measures.curvature_min <= measures.curvature_max) {
    info["curvature"] = {{"min", finite(measures.curvature_min)},
                         {"max", finite(measures.curvature_max)}};
  }
}

// The parameters of every class of shape, in `dimension` coordinates.
class ShapeParameters {
 public:
  explicit ShapeParameters(int dimension) : dimension_(dimension) {}

  Json operator()(const FreeForm&) const { return nullptr; }
  Json operator()(const LineShape& s) const {
    return {{"point", Of(s.point)}, {"direction", Of(s.direction)}};
  }
  Json operator()(const CircleShape& s) const {
    return {{"center", Of(s.center)}, {"radius", s.radius}, {"normal", Normal(s.normal)}};
  }
  Json operator()(const EllipseShape& s) const {
    const double a = s.major_radius, b = s.minor_radius;
    const Eigen::Vector3d focus = std::sqrt(std::max(0.0, (a - b) * (a + b))) * s.major_axis;
    return {{"center", Of(s.center)},
            {"major_radius", a},
            {"minor_radius", b},
            {"major_axis", Of(s.major_axis)},
            {"minor_axis", Of(s.minor_axis)},
            {"foci", Json::array({Of(s.center + focus), Of(s.center - focus)})}};
  }
  Json operator()(const ParabolaShape& s) const {
    return {{"vertex", Of(s.vertex)},
            {"axis", Of(s.axis)},
            {"focal_length", s.focal_length},
            {"focus", Of(s.vertex + s.focal_length * s.axis)},
            {"normal", Normal(s.normal)}};
  }
  Json operator()(const HyperbolaShape& s) const {
    const double a = s.transverse_radius, b = s.conjugate_radius;
    const Eigen::Vector3d focus = std::hypot(a, b) * s.transverse_axis;
    return {{"center", Of(s.center)},
            {"transverse_radius", a},
            {"conjugate_radius", b},
            {"transverse_axis", Of(s.transverse_axis)},
            {"conjugate_axis", Of(s.conjugate_axis)},
            {"foci", Json::array({Of(s.center + focus), Of(s.center - focus)})}};
  }
  Json operator()(const PlaneShape& s) const {
    return {{"point", Of(s.point)}, {"normal", Of(s.normal)}};
  }
  Json operator()(const CylinderShape& s) const {
    return {{"point", Of(s.point)}, {"axis", Of(s.axis)}, {"radius", s.radius}};
  }
  Json operator()(const SphereShape& s) const {
    return {{"center", Of(s.center)}, {"radius", s.radius}};
  }
  Json operator()(const ConeShape& s) const {
    return {{"apex", Of(s.apex)}, {"axis", Of(s.axis)}, {"half_angle", s.half_angle}};
  }
  Json operator()(const TorusShape& s) const {
    return {{"center", Of(s.center)},
            {"axis", Of(s.axis)},
            {"major_radius", s.major_radius},
            {"minor_radius", s.minor_radius}};
  }
  Json operator()(const RevolutionShape& s) const {
    return {{"point", Of(s.point)}, {"axis", Of(s.axis)}};
  }
  Json operator()(const ExtrusionShape& s) const { return {{"direction", Of(s.direction)}}; }

 private:
  Json Of(const Eigen::Vector3d& v) const { return ToJson(v, dimension_); }
  // Of a plane curve: +z where it turns left.
  static Json Normal(const Eigen::Vector3d& v) { return ToJson(v, 3); }

  int dimension_;
};

template <typename Shape>
void AddShape(const Shape& shape, int dimension, double tolerance, Json& info) {
  const auto found = ClassifyShape(shape, {.tolerance = tolerance});
  info["shape"] = NameOf(found);
  Json parameters = std::visit(ShapeParameters(dimension), found);
  if (!parameters.is_null()) info["shape_parameters"] = std::move(parameters);
}

// What every piece is that a curve is made of; nothing for one of a single piece of higher degree.
template <int Dim>
void AddPieces(const NurbsCurve<Dim>& curve, double tolerance, Json& info) {
  const int degree = curve.basis().degree();
  if (degree == 1) return;
  const std::vector<CurvePieceShape> pieces = PieceShapes(curve, {.tolerance = tolerance});
  if (pieces.size() == 1 && degree != 2) return;
  for (const CurvePieceShape& piece : pieces) {
    Json one{{"domain", {piece.lower, piece.upper}}, {"shape", NameOf(piece.shape)}};
    Json parameters = std::visit(ShapeParameters(Dim), piece.shape);
    if (!parameters.is_null()) one["shape_parameters"] = std::move(parameters);
    if (degree == 2) {
      const Eigen::VectorXd w = Segment(curve, piece.lower, piece.upper).weights();
      one["shape_factor"] = ConicShapeFactor(w[0], w[1], w[2]);
    }
    info["pieces"].push_back(std::move(one));
  }
}

// Inflections, cusps, loops and torsion of cubic pieces.
template <int Dim>
void AddCubics(const NurbsCurve<Dim>& curve, double tolerance, Json& info) {
  if (curve.basis().degree() != 3) return;
  const auto number = [](double x) { return std::isfinite(x) ? Json(x) : Json(nullptr); };
  info["cubics"] = Json::array();
  for (const CubicFeatures& piece : FeaturesOfCubic(curve, tolerance)) {
    Json one{{"domain", {piece.lower, piece.upper}}, {"kind", NameOf(piece.kind)}};
    if (!piece.inflections.empty()) one["inflections"] = piece.inflections;
    if (piece.cusp) one["cusp"] = *piece.cusp;
    if (piece.loop) one["loop"] = *piece.loop;
    if (piece.torsion) {
      one["torsion"] = {{"min", number((*piece.torsion)[0])}, {"max", number((*piece.torsion)[1])}};
    }
    info["cubics"].push_back(std::move(one));
  }
}

template <int Dim>
Json Summary(const NurbsCurve<Dim>& curve, double tolerance) {
  Json info{{"kind", "curve"}};
  AddBases({&curve.basis()}, info);
  info["continuity"] = Json::array({Least(ContinuityAtKnots(curve), curve.basis().degree())});
  info["rational"] = curve.rational();
  info["closed"] = ClosedDirections(curve);
  info["seam"] = Json::array({OrNull(SeamContinuity(curve))});
  AddMeasures(Measure(curve), Dim, "length", info);
  AddShape(curve, Dim, tolerance, info);
  AddPieces(curve, tolerance, info);
  AddCubics(curve, tolerance, info);
  return info;
}

Json Summary(const NurbsSurface& surface, double tolerance) {
  constexpr Direction kU = Direction::kU, kV = Direction::kV;
  Json info{{"kind", "surface"}};
  AddBases({&surface.basis_u(), &surface.basis_v()}, info);
  info["continuity"] =
      Json::array({Least(ContinuityAtKnots(surface, kU), surface.basis_u().degree()),
                   Least(ContinuityAtKnots(surface, kV), surface.basis_v().degree())});
  info["rational"] = surface.rational();
  info["closed"] = ClosedDirections(surface);
  info["seam"] =
      Json::array({OrNull(SeamContinuity(surface, kU)), OrNull(SeamContinuity(surface, kV))});
  info["trims"] = surface.trims().size();
  AddMeasures(Measure(surface), 3, "area", info);
  AddShape(surface, 3, tolerance, info);
  return info;
}

Json BodyJson(const GeometryBody& body, const BodyMeasures& measures) {
  Json json;
  if (!body.name.empty()) json["name"] = body.name;
  json["kind"] = body.solid ? "solid" : "shell";
  json["surfaces"] = body.surfaces;
  json["shared_edges"] = body.shared_edges;
  json["watertight"] = body.watertight();
  json["area"] = measures.area;
  if (body.solid) {
    json["volume"] = measures.volume;
    json["center"] = ToJson(measures.center, 3);
    for (int i = 0; i < 3; ++i) json["inertia"].push_back(ToJson(measures.inertia.row(i), 3));
  }
  json["free_edges"] = Json::array();
  for (const FreeEdge& edge : body.free_edges) {
    json["free_edges"].push_back(
        {{"surface", edge.surface}, {"from", ToJson(edge.from, 3)}, {"to", ToJson(edge.to, 3)}});
  }
  return json;
}

void Print(const Json& object, const std::string& indent) {
  constexpr int kKeyWidth = 20;
  for (const auto& [key, value] : object.items()) {
    if (value.is_object()) {
      fmt::print("{}{}\n", indent, key);
      Print(value, indent + "  ");
    } else {
      fmt::print("{:<{}} {}\n",
                 indent + key,
                 kKeyWidth,
                 value.is_string() ? Printable(value.get<std::string>()) : JsonText(value));
    }
  }
}

}  // namespace

Json SummaryOf(const Geometry& geometry, double tolerance) {
  return std::visit([&](const auto& shape) { return Summary(shape, tolerance); }, geometry);
}

Json SummaryOf(const GeometryContents& contents, double tolerance) {
  Json all = Json::object();
  if (!contents.unit.empty()) all["unit"] = contents.unit;
  if (!contents.remarks.empty()) all["remarks"] = contents.remarks;
  const std::vector<BodyMeasures> measures = MeasureBodies(contents);
  double volume = 0;
  for (size_t k = 0; k < measures.size(); ++k) {
    all["bodies"].push_back(BodyJson(contents.bodies[k], measures[k]));
    if (!contents.bodies[k].solid) continue;
    volume += measures[k].volume;
    if (measures[k].inside_out)
      all["remarks"].push_back(fmt::format("solid {} is inside out: its faces look inwards", k));
  }
  if (volume != 0) all["volume"] = volume;
  const std::vector<Geometry>& geometry = contents.geometry;
  const auto named = [&](size_t k) {
    Json one;
    if (k < contents.names.size() && !contents.names[k].empty()) one["name"] = contents.names[k];
    one.update(SummaryOf(geometry[k], tolerance));
    return one;
  };
  if (!contents.unread.empty()) all["unread"] = contents.unread;
  const auto surfaces = std::count_if(geometry.begin(), geometry.end(), [](const Geometry& one) {
    return std::holds_alternative<NurbsSurface>(one);
  });
  all["surfaces"] = surfaces;
  all["curves"] = static_cast<std::ptrdiff_t>(geometry.size()) - surfaces;
  if (geometry.size() == 1) {
    Json one = named(0);
    one.update(all);
    return one;
  }
  for (size_t k = 0; k < geometry.size(); ++k) {
    Json one{{"index", k}};
    one.update(named(k));
    all["results"].push_back(std::move(one));
  }
  return all;
}

void PrintAligned(const Json& summary) {
  if (!summary.contains("results")) return Print(summary, "");
  Json head = summary;
  head.erase("results");
  Print(head, "");
  bool first = head.empty();
  for (const Json& one : summary["results"]) {
    if (!first) fmt::print("\n");
    first = false;
    Print(one, "");
  }
}

std::string JsonText(const Json& json, int indent) {
  return json.dump(indent, ' ', false, Json::error_handler_t::replace);
}

}  // namespace batten::internal
