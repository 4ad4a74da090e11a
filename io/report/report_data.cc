// SPDX-License-Identifier: MIT
#include "io/report/report_data.h"

#include <filesystem>
#include <nlohmann/json.hpp>
#include <string_view>

#include "io/base/base64.h"

namespace batten::internal {
namespace {

using Json = nlohmann::ordered_json;

// An object or array, written member by member so that large arrays pass through no tree.
class Writer {
 public:
  explicit Writer(std::string& text) : text_(text) {}

  Writer& Key(std::string_view name) {
    Comma();
    text_ += '"';
    text_ += name;
    text_ += "\":";
    fresh_ = true;
    return *this;
  }
  void Value(const Json& value) {
    Comma();
    text_ += value.dump(-1, ' ', false, Json::error_handler_t::replace);
  }
  void Raw(std::string_view json) {
    Comma();
    text_ += json;
  }
  void Floats(const Eigen::Ref<const Eigen::MatrixXd>& numbers) {
    Comma();
    AppendFloats(text_, numbers);
  }
  void Indices(const Eigen::Ref<const Eigen::MatrixXi>& numbers) {
    Comma();
    AppendIndices(text_, numbers);
  }
  void Flags(const PointMask& flags) {
    Comma();
    AppendFlags(text_, flags);
  }
  void Lines(const std::vector<Eigen::Matrix3Xd>& lines) {
    Open('[');
    for (const Eigen::Matrix3Xd& line : lines) Floats(line);
    Close(']');
  }
  void Open(char bracket) {
    Comma();
    text_ += bracket;
    fresh_ = true;
  }
  void Close(char bracket) {
    text_ += bracket;
    fresh_ = false;
  }

 private:
  void Comma() {
    if (!fresh_) text_ += ',';
    fresh_ = false;
  }

  std::string& text_;
  bool fresh_ = true;  // nothing stands before that a comma would part
};

Json Coordinates(const Eigen::Vector3d& v) { return {v.x(), v.y(), v.z()}; }

void WriteNet(Writer& json, const Json& size, const Eigen::Matrix3Xd& points) {
  json.Key("net").Open('{');
  json.Key("size").Value(size);
  json.Key("points").Floats(points);
  json.Close('}');
}

void WriteSurface(Writer& json, const ReportSurface& surface) {
  json.Open('{');
  json.Key("name").Value(surface.name);
  json.Key("positions").Floats(surface.mesh.vertices);
  json.Key("normals").Floats(surface.mesh.normals);
  json.Key("uv").Floats(surface.mesh.parameters);
  json.Key("triangles").Indices(surface.mesh.triangles);
  json.Key("deviation").Floats(surface.deviation);
  json.Key("gap").Floats(surface.gap);
  if (surface.sigma.size() > 0) json.Key("sigma").Floats(surface.sigma);
  json.Key("gaussian").Floats(surface.gaussian);
  json.Key("mean").Floats(surface.mean);
  json.Key("trims").Lines(surface.trims);
  json.Key("edges").Lines(surface.edges);
  json.Key("knot_lines").Lines(surface.knot_lines);
  WriteNet(json, {surface.net_u, surface.net_v}, surface.net);
  json.Close('}');
}

void WriteCurve(Writer& json, const ReportCurve& curve) {
  json.Open('{');
  json.Key("name").Value(curve.name);
  json.Key("closed").Value(curve.closed);
  json.Key("planar").Value(curve.planar);
  json.Key("points").Floats(curve.points);
  json.Key("parameters").Floats(curve.parameters);
  json.Key("curvature").Floats(curve.curvature);
  json.Key("normals").Floats(curve.normals);
  json.Key("knots").Floats(curve.knots);
  WriteNet(json, Json::array({curve.net.cols()}), curve.net);
  json.Close('}');
}

void WriteCloud(Writer& json, const ReportCloud& cloud) {
  json.Open('{');
  json.Key("points").Floats(cloud.points);
  json.Key("deviation").Floats(cloud.deviation);
  json.Key("outlier").Flags(cloud.outlier);
  if (cloud.feet.cols() > 0) {
    json.Key("foot").Floats(cloud.feet);
    json.Key("parameter").Floats(cloud.parameters);
  }
  json.Key("shown").Value(cloud.points.cols());
  json.Key("total").Value(cloud.total);
  json.Close('}');
}

}  // namespace

std::string ReportTitle(const FitReport& report, const ReportContext& context) {
  const bool named = !context.file.empty() && context.file != "-";
  const Json name = named ? std::filesystem::path(context.file).filename().string() : "";
  // There and back, so that what is not UTF-8 is replaced.
  const auto valid = Json::parse(name.dump(-1, ' ', false, Json::error_handler_t::replace));
  return valid == "" ? report.geometry.kind : valid.get<std::string>();
}

std::string ToReportData(const FitReport& report,
                         const ReportContext& context,
                         const ReportScene& scene) {
  std::string text;
  Writer json(text);
  json.Open('{');
  json.Key("schema").Value(kViewSchema);
  json.Key("title").Value(ReportTitle(report, context));
  if (!context.date.empty()) json.Key("date").Value(context.date);
  json.Key("kind").Value(scene.surfaces.empty() ? "curve" : "surface");
  json.Key("unit").Value(context.unit);
  json.Key("center").Value(Coordinates(scene.center));
  json.Key("size").Value(scene.size);
  json.Key("tolerance").Value(scene.tolerance ? Json(*scene.tolerance) : Json(nullptr));
  json.Key("limit").Value(scene.limit);
  json.Key("signed").Value(scene.signed_values);
  json.Key("report").Raw(ToReportJson(report, context));
  json.Key("surfaces").Open('[');
  for (const ReportSurface& surface : scene.surfaces) WriteSurface(json, surface);
  json.Close(']');
  json.Key("curves").Open('[');
  for (const ReportCurve& curve : scene.curves) WriteCurve(json, curve);
  json.Close(']');
  json.Key("plan").Value({{"u", Coordinates(scene.plan_u)}, {"v", Coordinates(scene.plan_v)}});
  json.Key("cloud");
  WriteCloud(json, scene.cloud);
  const ReportHistogram& histogram = scene.histogram;
  json.Key("histogram")
      .Value({{"low", histogram.low},
              {"high", histogram.high},
              {"counts", histogram.counts},
              {"below", histogram.below},
              {"above", histogram.above},
              {"mean", histogram.mean},
              {"deviation", histogram.deviation}});
  json.Close('}');
  return text;
}

}  // namespace batten::internal
