// SPDX-License-Identifier: MIT
#include "batten/io/report_json.h"

#include <cmath>
#include <nlohmann/json.hpp>
#include <optional>

namespace batten {
namespace {

using Json = nlohmann::ordered_json;

Json Number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

template <typename T>
Json OrNull(const std::optional<T>& value) {
  return value ? Json(*value) : Json(nullptr);
}

Json Vector(const Eigen::Vector3d& value) {
  return Json::array({Number(value.x()), Number(value.y()), Number(value.z())});
}

Json Input(const InputSummary& input, const ReportContext& context) {
  Json json{{"files", input.files},
            {"points", input.points},
            {"used", input.used},
            {"non_finite", input.non_finite},
            {"duplicates", input.duplicates},
            {"outliers", input.outliers},
            {"spacing", Number(input.spacing)},
            {"noise", Number(input.noise)},
            {"bounding_box", Json::array({Vector(input.box_min), Vector(input.box_max)})},
            {"origin", Vector(input.origin)},
            {"shift", Vector(context.shift)},
            {"unit", context.unit}};
  if (input.mesh) {
    json["mesh"] = {{"triangles", input.mesh->triangles},
                    {"welded", input.mesh->welded},
                    {"open_edges", input.mesh->open_edges},
                    {"non_manifold", input.mesh->non_manifold},
                    {"sampled", input.mesh->sampled}};
  }
  if (input.thinned_to) json["thinned_to"] = *input.thinned_to;
  return json;
}

// By the names of the numbers; of vectors an array. Infinite ones are null.
Json Deviations(const PrimitiveAccuracy& accuracy) {
  Json json = Json::object();
  for (size_t i = 0; i < accuracy.names.size(); ++i) {
    const std::string& name = accuracy.names[i];
    const Json value = Number(accuracy.standard_deviations[static_cast<Eigen::Index>(i)]);
    const bool part = name.ends_with("_x") || name.ends_with("_y") || name.ends_with("_z");
    if (part) {
      json[name.substr(0, name.size() - 2)].push_back(value);
    } else {
      json[name] = value;
    }
  }
  return json;
}

Json Covariance(const PrimitiveAccuracy& accuracy) {
  Json rows = Json::array();
  for (const auto& row : accuracy.covariance.rowwise()) {
    Json numbers = Json::array();
    for (const double value : row) numbers.push_back(Number(value));
    rows.push_back(std::move(numbers));
  }
  return {{"of", accuracy.names},
          {"frame_x", Vector(accuracy.frame_x)},
          {"frame_y", Vector(accuracy.frame_y)},
          {"matrix", std::move(rows)}};
}

Json Primitive(const PrimitiveSummary& primitive) {
  Json json = {{"kind", primitive.kind}};
  if (primitive.point) json["point"] = Vector(*primitive.point);
  if (primitive.direction) json["direction"] = Vector(*primitive.direction);
  if (primitive.center) json["center"] = Vector(*primitive.center);
  if (primitive.axis) json["axis"] = Vector(*primitive.axis);
  if (primitive.normal) json["normal"] = Vector(*primitive.normal);
  if (primitive.apex) json["apex"] = Vector(*primitive.apex);
  if (primitive.radius) json["radius"] = Number(*primitive.radius);
  if (primitive.major_radius) json["major_radius"] = Number(*primitive.major_radius);
  if (primitive.minor_radius) json["minor_radius"] = Number(*primitive.minor_radius);
  if (primitive.half_angle) json["half_angle"] = Number(*primitive.half_angle);
  if (primitive.sweep) json["sweep"] = Number(*primitive.sweep);
  json["scale"] = Number(primitive.scale);
  json["why"] = primitive.why;
  if (primitive.accuracy) {
    json["standard_deviations"] = Deviations(*primitive.accuracy);
    json["covariance"] = Covariance(*primitive.accuracy);
    json["inflation"] = Number(primitive.accuracy->inflation);
  }
  return json;
}

Json Faces(const std::vector<FaceSummary>& faces) {
  Json result = Json::array();
  for (size_t k = 0; k < faces.size(); ++k) {
    const FaceSummary& face = faces[k];
    result.push_back({{"index", k},
                      {"kind", face.kind},
                      {"points", face.points},
                      {"rms", Number(face.rms)},
                      {"max", Number(face.max)},
                      {"primitive", face.primitive ? Primitive(*face.primitive) : Json(nullptr)},
                      {"touching", face.touching}});
  }
  return result;
}

Json Relations(const std::vector<RelationSummary>& relations) {
  Json result = Json::array();
  for (const RelationSummary& relation : relations) {
    result.push_back({{"kind", relation.kind},
                      {"faces", relation.faces},
                      {"deviation", Number(relation.deviation)},
                      {"allowed", Number(relation.allowed)},
                      {"kept", relation.kept}});
  }
  return result;
}

Json Shape(const GeometrySummary& geometry, const std::string& file) {
  Json json = {{"kind", geometry.kind},
               {"base", geometry.base},
               {"degree", geometry.degree},
               {"control_points", geometry.control_points},
               {"rational", geometry.rational},
               {"closed", geometry.closed},
               {"trims", geometry.trims},
               {"file", file}};
  if (!geometry.poles.empty()) json["poles"] = geometry.poles;
  if (geometry.creases) {
    const CreaseSummary& creases = *geometry.creases;
    json["creases"] = {{"edges", creases.edges},
                       {"length", Number(creases.length)},
                       {"least_angle", Number(creases.least_angle)},
                       {"greatest_angle", Number(creases.greatest_angle)}};
  }
  if (!geometry.base_why.empty()) {
    json["base_why"] = geometry.base_why;
    json["distortion"] = Number(geometry.distortion);
  }
  if (geometry.base_axes) {
    const Eigen::Matrix3d& axes = *geometry.base_axes;
    json["base_axes"] = {
        {"u", Vector(axes.col(0))}, {"v", Vector(axes.col(1))}, {"normal", Vector(axes.col(2))}};
  }
  if (geometry.primitive) json["primitive"] = Primitive(*geometry.primitive);
  return json;
}

Json Error(const ErrorSummary& error, const char* kind) {
  return {{"rms", Number(error.rms)},
          {"mean", Number(error.mean)},
          {"max", Number(error.max)},
          {"p50", Number(error.p50)},
          {"p95", Number(error.p95)},
          {"p99", Number(error.p99)},
          {"signed_p5", Number(error.signed_p5)},
          {"signed_p95", Number(error.signed_p95)},
          {"tolerance", error.tolerance ? Number(*error.tolerance) : Json(nullptr)},
          {"within_tolerance", Number(error.within_tolerance)},
          {"out_of_tolerance", error.out_of_tolerance},
          {"points", error.points},
          {"kind", kind}};
}

Json Optimize(const OptimizeSummary& optimize) {
  return {{"ran", optimize.ran},
          {"why", optimize.why},
          {"iterations", optimize.iterations},
          {"rms_before", Number(optimize.rms_before)},
          {"rms_after", Number(optimize.rms_after)}};
}

Json Rounds(const std::vector<RoundSummary>& rounds, bool curve) {
  Json result = Json::array();
  for (const RoundSummary& round : rounds) {
    Json control_points = Json::array({round.control_points_u});
    if (!curve) control_points.push_back(round.control_points_v);
    result.push_back({{"stage", round.stage},
                      {"control_points", std::move(control_points)},
                      {"rms", Number(round.rms)},
                      // Cross-validation measures no greatest distance.
                      {"max", round.max > 0 || round.rms == 0 ? Number(round.max) : Json(nullptr)},
                      {"score", Number(round.score)},
                      {"seconds", Number(round.seconds)}});
  }
  return result;
}

Json Candidates(const std::vector<BaseCandidate>& candidates) {
  Json result = Json::array();
  for (const BaseCandidate& one : candidates)
    result.push_back({{"name", one.name},
                      {"score", one.score ? Number(*one.score) : Json(nullptr)},
                      {"control_points", one.score ? Json(one.control_points) : Json(nullptr)},
                      {"refused", one.refused.empty() ? Json(nullptr) : Json(one.refused)}});
  return result;
}

Json Overshoot(const OvershootSummary& overshoot) {
  return {{"max", Number(overshoot.max)},
          {"in_spacings", Number(overshoot.in_spacings)},
          {"at", overshoot.max > 0 ? Vector(overshoot.at) : Json(nullptr)},
          {"area_without_points", Number(overshoot.area_without_points)},
          {"largest_gap", Number(overshoot.largest_gap)}};
}

// Null where nothing was fitted.
Json End(const FitEnd& end) {
  if (end.words.empty()) return nullptr;
  return {{"code", Name(end.code)},
          {"words", end.words},
          {"where", end.where ? Vector(*end.where) : Json(nullptr)}};
}

Json Seconds(const StageSeconds& seconds) {
  return {{"read", Number(seconds.read)},
          {"prepare", Number(seconds.prepare)},
          {"parameterize", Number(seconds.parameterize)},
          {"solve", Number(seconds.solve)},
          {"project", Number(seconds.project)},
          {"refine", Number(seconds.refine)},
          {"optimize", Number(seconds.optimize)},
          {"trim", Number(seconds.trim)},
          {"write", Number(seconds.write)},
          {"total", Number(seconds.total)}};
}

Json Uncertain(const UncertaintySummary& uncertainty) {
  Json json{{"sigma_max", nullptr}, {"sigma_median", nullptr}};
  if (uncertainty.known) {
    json = {{"sigma_max", Number(uncertainty.sigma_max)},
            {"sigma_median", Number(uncertainty.sigma_median)},
            {"bias_max", Number(uncertainty.bias_max)},
            {"point_noise", Number(uncertainty.noise)},
            {"inflation", Number(uncertainty.inflation)},
            {"freedom", Number(uncertainty.freedom)},
            {"unsupported_area", Number(uncertainty.unsupported_area)},
            {"unsupported_share", Number(uncertainty.unsupported_share)}};
  }
  json["coverage_note"] = uncertainty.note;
  return json;
}

Json Certified(const CertificateSummary& certified) {
  Json json{{"max_upper", Number(certified.max_upper)},
            {"max_lower", Number(certified.max_lower)},
            {"folds_proved_absent", certified.folds_proved_absent}};
  if (certified.tolerance) {
    json["proved_within"] = certified.proved_within;
    json["proved_out"] = certified.proved_out;
    json["undecided"] = certified.undecided;
  }
  if (certified.mesh_chord) json["mesh_chord"] = Number(*certified.mesh_chord);
  json["unproved"] = certified.unproved;
  return json;
}

Json Tile(const TileSummary& tile) {
  return {{"at", {tile.u, tile.v}},
          {"domain", {{tile.low[0], tile.high[0]}, {tile.low[1], tile.high[1]}}},
          {"points", tile.points},
          {"outliers", tile.outliers},
          {"out_of_tolerance", tile.out_of_tolerance},
          {"control_points", {tile.control_points_u, tile.control_points_v}},
          {"rms", Number(tile.rms)},
          {"max", Number(tile.max)}};
}

Json Form(const FormDeviation& form) {
  return {{"name", form.name},
          {"least_squares", Number(form.least_squares)},
          {"minimum_zone", Number(form.minimum_zone)},
          {"deviation", Number(form.deviation)},
          {"points", form.points}};
}

Json Alignment(const RigidAlignment& alignment) {
  Json rows = Json::array();
  for (const auto& row : alignment.rotation.rowwise())
    rows.push_back(Json::array({row[0], row[1], row[2]}));
  return {{"rotation", std::move(rows)},
          {"translation", Vector(alignment.translation)},
          {"determined", alignment.determined},
          {"iterations", alignment.iterations},
          {"rms_before", Number(alignment.rms_before)},
          {"rms_after", Number(alignment.rms_after)}};
}

Json Profile(const ProfileVerdict& profile) {
  return {{"zone", Json::array({profile.zone.low, profile.zone.high})},
          {"lowest", Number(profile.lowest)},
          {"highest", Number(profile.highest)},
          {"uncertainty", Number(profile.uncertainty)},
          {"out", profile.out},
          {"doubtful", profile.doubtful},
          {"decision", Name(profile.decision)}};
}

Json DoubtsOf(const FitReport& report) {
  Json doubts = Json::array();
  for (const Doubt& doubt : report.Doubts()) {
    doubts.push_back({{"code", doubt.code}, {"words", doubt.words}});
  }
  return doubts;
}

}  // namespace

std::string ToReportJson(const FitReport& report, const ReportContext& context) {
  Json json = {{"schema", "batten-report-2"},
               {"command", context.command},
               {"input", Input(report.input, context)},
               {"geometry", Shape(report.geometry, context.file)},
               {"error", Error(report.error, "orthogonal")},
               {"error_all", Error(report.error_all, "orthogonal")},
               {"optimize", Optimize(report.optimize)},
               {"termination", Name(report.termination)},
               {"end", End(report.end)},
               {"tolerance_reached", OrNull(report.tolerance_reached())},
               {"iterations", Rounds(report.iterations, report.geometry.kind == "curve")},
               {"seconds", Seconds(report.seconds)},
               {"peak_memory_bytes", context.peak_memory_bytes},
               {"threads", report.threads},
               {"warnings", report.warnings},
               {"doubt", DoubtsOf(report)},
               {"version", context.version}};
  if (!report.base_candidates.empty()) json["base_candidates"] = Candidates(report.base_candidates);
  if (report.overshoot) json["overshoot"] = Overshoot(*report.overshoot);
  if (report.uncertainty) json["uncertainty"] = Uncertain(*report.uncertainty);
  const ReportChecks& checks = context.checks;
  if (checks.certified) json["certified"] = Certified(*checks.certified);
  if (checks.form) json["form"] = Form(*checks.form);
  if (checks.alignment) json["alignment"] = Alignment(*checks.alignment);
  if (checks.profile) json["profile"] = Profile(*checks.profile);
  if (report.parameter_error) {
    const ErrorSummary& error = *report.parameter_error;
    Json& entry = json["parameter_error"] = Error(error, "parameter");
    entry["sum_of_squares"] = Number(error.rms * error.rms * static_cast<double>(error.points));
  }
  for (size_t i = 0; i < report.parts.size(); ++i) {
    const PartError& part = report.parts[i];
    Json entry = {{"index", i}, {"name", part.name}, {"geometry", part.kind}};
    entry.update(Error(part.error, "orthogonal"));
    json["parts"].push_back(std::move(entry));
  }
  for (const CloudPartSummary& part : report.cloud_parts) {
    Json entry{{"points", part.points},
               {"box", Json::array({Vector(part.box_min), Vector(part.box_max)})},
               {"share", Number(part.share)},
               {"used", part.used}};
    if (!part.refused.empty()) entry["refused"] = part.refused;
    json["parts"].push_back(std::move(entry));
  }
  for (const TileSummary& tile : report.tiles) json["tiles"].push_back(Tile(tile));
  if (context.part != nullptr) {
    json["faces"] = Faces(context.part->faces);
    json["relations"] = Relations(context.part->relations);
  }
  // File names need not be UTF-8; what is not becomes the replacement character.
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

}  // namespace batten
