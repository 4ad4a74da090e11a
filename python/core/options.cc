// SPDX-License-Identifier: MIT
#include "python/core/options.h"

#include <pybind11/stl.h>

#include <limits>

#include "batten/geometry/spline_basis.h"
#include "python/core/body.h"
#include "python/core/cloud.h"

namespace batten::python {
namespace {

std::string Shown(const py::handle& value) {
  constexpr std::size_t kLongest = 60;
  std::string text = py::repr(value).cast<std::string>();
  if (text.size() > kLongest) text = text.substr(0, kLongest) + "…";
  return text;
}

std::optional<double> AsNumber(const py::handle& value) {
  if (PyBool_Check(value.ptr()) || PyUnicode_Check(value.ptr())) return std::nullopt;
  const double number = PyFloat_AsDouble(value.ptr());
  if (number == -1 && PyErr_Occurred()) {
    PyErr_Clear();
    return std::nullopt;
  }
  return number;
}

std::optional<std::int64_t> AsWhole(const py::handle& value) {
  if (PyBool_Check(value.ptr())) return std::nullopt;
  const auto index = py::reinterpret_steal<py::object>(PyNumber_Index(value.ptr()));
  if (!index) {
    PyErr_Clear();
    return std::nullopt;
  }
  const long long whole = PyLong_AsLongLong(index.ptr());
  if (whole == -1 && PyErr_Occurred()) {
    PyErr_Clear();
    return std::nullopt;
  }
  return whole;
}

template <typename T, typename Read>
std::vector<T> List(const char* name,
                    const py::object& value,
                    std::size_t count,
                    const char* what,
                    const Read& read) {
  const auto fail = [&]() {
    Keywords::Refuse(name, Shown(value) + " is not " + std::to_string(count) + " " + what);
  };
  if (PyUnicode_Check(value.ptr())) fail();
  const auto items =
      py::reinterpret_steal<py::object>(PySequence_Fast(value.ptr(), "not a sequence"));
  if (!items) {
    PyErr_Clear();
    fail();
  }
  const auto size = static_cast<std::size_t>(PySequence_Fast_GET_SIZE(items.ptr()));
  if (size != count) fail();
  std::vector<T> list;
  for (std::size_t k = 0; k < size; ++k) {
    const std::optional<T> one =
        read(PySequence_Fast_GET_ITEM(items.ptr(), static_cast<py::ssize_t>(k)));
    if (!one) fail();
    list.push_back(*one);
  }
  return list;
}

int Narrow(const char* name, std::int64_t whole) {
  if (whole < std::numeric_limits<int>::min() || whole > std::numeric_limits<int>::max())
    Keywords::Refuse(name, std::to_string(whole) + " is out of range");
  return static_cast<int>(whole);
}

void RequireDegree(int degree) {
  if (degree >= 1 && degree <= kMaxDegree) return;
  Keywords::Refuse("degree",
                   std::to_string(degree) + " is not in [1, " + std::to_string(kMaxDegree) + "]");
}

void TakeDegrees(const Keywords& k, int& u, int& v) {
  if (!k.Has("degree")) return;
  if (const auto both = AsWhole(k.Value("degree"))) {
    u = v = Narrow("degree", *both);
  } else {
    const auto pair = k.Wholes("degree", 2);
    u = Narrow("degree", pair[0]);
    v = Narrow("degree", pair[1]);
  }
  RequireDegree(u);
  RequireDegree(v);
}

void TakeParameterization(const Keywords& k, CurveParameterization& parameterization) {
  k.Choose<CurveParameterization>("parameterization",
                                  {{"chord", CurveParameterization::kChord},
                                   {"centripetal", CurveParameterization::kCentripetal},
                                   {"uniform", CurveParameterization::kUniform},
                                   {"foley", CurveParameterization::kFoley},
                                   {"universal", CurveParameterization::kUniversal},
                                   {"given", CurveParameterization::kGiven}},
                                  parameterization);
}

// None chooses; words are losses.
void TakeLoss(const Keywords& k, std::optional<Loss>& loss) {
  if (!k.Has("loss")) return;
  if (k.Word("loss") == "auto") return;
  Loss chosen = Loss::kNone;
  k.Choose<Loss>("loss",
                 {{"none", Loss::kNone},
                  {"huber", Loss::kHuber},
                  {"cauchy", Loss::kCauchy},
                  {"tukey", Loss::kTukey},
                  {"truncated", Loss::kTruncated},
                  {"auto", Loss::kNone}},
                 chosen);
  loss = chosen;
}

// A number, or the word of a rule.
void TakeSmoothing(const Keywords& k, std::optional<double>& smoothing, SmoothBy& by) {
  if (!k.Has("smoothing")) return;
  if (!PyUnicode_Check(k.Value("smoothing").ptr())) {
    smoothing = k.Number("smoothing");
    return;
  }
  if (k.Word("smoothing") == "auto") return;
  k.Choose<SmoothBy>("smoothing",
                     {{"cross-validation", SmoothBy::kCrossValidation},
                      {"noise", SmoothBy::kNoise},
                      {"auto", SmoothBy::kWeight}},
                     by);
}

FreeVariables Free(const char* name, const py::object& value) {
  FreeVariables free;
  py::object words = value;
  if (PyUnicode_Check(value.ptr())) words = value.attr("replace")(",", " ").attr("split")();
  if (!py::isinstance<py::iterable>(words))
    Keywords::Refuse(name, Shown(value) + " is no list of names");
  for (const py::handle& one : words) {
    const std::string word = py::str(one).cast<std::string>();
    if (word == "parameters" || word == "params") {
      free.parameters = true;
    } else if (word == "weights") {
      free.weights = true;
    } else if (word == "knots") {
      free.knots = true;
    } else if (word != "none" && word != "control_points") {
      Keywords::Refuse(
          name, "'" + word + "' is none of 'parameters', 'weights', 'knots', 'none', 'auto'");
    }
  }
  return free;
}

void TakeFree(const Keywords& k, std::optional<FreeVariables>& optimize) {
  if (!k.Has("optimize")) return;
  const py::object value = k.Value("optimize");
  if (PyUnicode_Check(value.ptr()) && k.Word("optimize") == "auto") return;
  optimize = Free("optimize", value);
}

void TakeClosing(const Keywords& k, Closing& closed) {
  k.Choose<Closing>("closed",
                    {{"auto", Closing::kAuto},
                     {"none", Closing::kNone},
                     {"u", Closing::kU},
                     {"v", Closing::kV},
                     {"uv", Closing::kBoth}},
                    closed);
}

void TakeConditions(const Keywords& k, SurfaceFitOptions& options) {
  if (k.Has("boundary")) {
    for (const py::handle& one : k.Value("boundary")) {
      const Geometry& geometry = one.cast<const Body&>().geometry();
      const std::string name = "boundary " + std::to_string(options.boundary.size());
      if (const auto* curve = std::get_if<NurbsCurve<3>>(&geometry)) {
        options.boundary.push_back({*curve, name});
      } else if (const auto* surface = std::get_if<NurbsSurface>(&geometry)) {
        options.boundary.push_back({*surface, name});
      } else {
        Keywords::Refuse("boundary", "a curve in space or a surface is needed");
      }
    }
  }
  k.Take("boundary_tolerance", options.boundary_tolerance);
  if (k.Has("meet")) options.meet = k.Value("meet").cast<const Points&>().cloud;
  if (k.Has("symmetric")) {
    const auto abcd = k.Numbers("symmetric", 4);
    const Eigen::Vector3d normal(abcd[0], abcd[1], abcd[2]);
    const double length = normal.norm();
    if (!(length > 0)) Keywords::Refuse("symmetric", "the plane needs a normal");
    options.symmetric = MirrorPlane{normal / length, -abcd[3] / length};
  }
  if (k.Has("domain")) {
    const auto box = k.Numbers("domain", 4);
    options.domain = DomainBox{box[0], box[1], box[2], box[3]};
  }
}

// Fields that every fit has.
template <typename Options>
void TakeWork(const Keywords& k, Options& options) {
  k.Take("shift", options.shift);
  options.threads = k.Threads();
}

}  // namespace

void Keywords::Refuse(const char* name, const std::string& rule) {
  throw py::value_error(std::string(name) + ": " + rule);
}

bool Keywords::Has(const char* name) const {
  return values_.contains(name) && !py::object(values_[name]).is_none();
}

py::object Keywords::Value(const char* name) const { return values_[name]; }

double Keywords::Number(const char* name) const {
  const py::object value = Value(name);
  const std::optional<double> number = AsNumber(value);
  if (!number) Refuse(name, Shown(value) + " is not a number");
  return *number;
}

std::int64_t Keywords::Whole(const char* name) const {
  const py::object value = Value(name);
  const std::optional<std::int64_t> whole = AsWhole(value);
  if (!whole) Refuse(name, Shown(value) + " is not a whole number");
  return *whole;
}

bool Keywords::Truth(const char* name) const {
  const py::object value = Value(name);
  const bool numpy = py::str(py::type::of(value).attr("__name__")).cast<std::string>() == "bool_";
  if (!PyBool_Check(value.ptr()) && !numpy)
    Refuse(name, Shown(value) + " is neither True nor False");
  return PyObject_IsTrue(value.ptr()) == 1;
}

std::string Keywords::Word(const char* name) const {
  const py::object value = Value(name);
  if (!PyUnicode_Check(value.ptr())) Refuse(name, Shown(value) + " is not a word");
  return value.cast<std::string>();
}

std::vector<double> Keywords::Numbers(const char* name, std::size_t count) const {
  return List<double>(name, Value(name), count, "numbers", AsNumber);
}

std::vector<std::int64_t> Keywords::Wholes(const char* name, std::size_t count) const {
  return List<std::int64_t>(name, Value(name), count, "whole numbers", AsWhole);
}

void Keywords::Take(const char* name, double& field) const {
  if (Has(name)) field = Number(name);
}
void Keywords::Take(const char* name, int& field) const {
  if (Has(name)) field = Narrow(name, Whole(name));
}
void Keywords::Take(const char* name, bool& field) const {
  if (Has(name)) field = Truth(name);
}
void Keywords::Take(const char* name, std::uint64_t& field) const {
  if (!Has(name)) return;
  const std::int64_t whole = Whole(name);
  if (whole < 0) Refuse(name, "must not be negative");
  field = static_cast<std::uint64_t>(whole);
}
void Keywords::Take(const char* name, std::optional<double>& field) const {
  if (Has(name)) field = Number(name);
}
void Keywords::Take(const char* name, std::optional<int>& field) const {
  if (Has(name)) field = Narrow(name, Whole(name));
}
void Keywords::Take(const char* name, Eigen::Vector3d& field) const {
  if (Has(name)) field = Eigen::Vector3d(Numbers(name, 3).data());
}
void Keywords::Take(const char* name, std::optional<Eigen::Vector3d>& field) const {
  if (Has(name)) field = Eigen::Vector3d(Numbers(name, 3).data());
}
void Keywords::Take(const char* name, std::optional<std::pair<int, int>>& field) const {
  if (!Has(name)) return;
  const auto pair = Wholes(name, 2);
  field = {Narrow(name, pair[0]), Narrow(name, pair[1])};
}

int Keywords::Threads() const {
  constexpr int kMost = 1024;
  int threads = 0;
  Take("threads", threads);
  if (threads < 0 || threads > kMost)
    Refuse("threads", "is " + std::to_string(threads) + ", not from 0 to 1024");
  return threads;
}

SurfaceFitOptions SurfaceOptionsOf(const Keywords& k) {
  SurfaceFitOptions options;
  TakeDegrees(k, options.degree_u, options.degree_v);
  k.Take("tolerance", options.tolerance);
  k.Take("control_points", options.control_points);
  k.Take("max_control_points", options.max_control_points);
  TakeSmoothing(k, options.smoothing, options.smooth_by);
  TakeLoss(k, options.loss);
  k.Take("loss_scale", options.loss_scale);
  TakeFree(k, options.optimize);
  k.Choose<BaseShape>("base",
                      {{"auto", BaseShape::kAuto},
                       {"plane", BaseShape::kPlane},
                       {"sheet", BaseShape::kSheet},
                       {"revolution", BaseShape::kRevolution},
                       {"sphere", BaseShape::kSphere},
                       {"torus", BaseShape::kTorus},
                       {"wing", BaseShape::kWing}},
                      options.base);
  TakeClosing(k, options.closed);
  k.Choose<Trimming>("trim", {{"auto", Trimming::kAuto}, {"none", Trimming::kNone}}, options.trim);
  TakeConditions(k, options);
  k.Take("thin", options.thin);
  k.Take("side_of_normals", options.side_of_normals);
  k.Take("given_parameters", options.given_parameters);
  k.Take("keep_outliers", options.keep_outliers);
  k.Take("snap", options.snap);
  k.Take("seed", options.seed);
  TakeWork(k, options);
  return options;
}

CurveFitOptions CurveOptionsOf(const Keywords& k) {
  CurveFitOptions options;
  k.Take("degree", options.degree);
  k.Take("tolerance", options.tolerance);
  k.Take("control_points", options.control_points);
  k.Take("max_control_points", options.max_control_points);
  TakeParameterization(k, options.parameterization);
  k.Choose<PointOrder>("order",
                       {{"auto", PointOrder::kAuto},
                        {"given", PointOrder::kGiven},
                        {"unordered", PointOrder::kUnordered}},
                       options.order);
  k.Choose<ClosedChoice>(
      "closed",
      {{"auto", ClosedChoice::kAuto}, {"yes", ClosedChoice::kYes}, {"no", ClosedChoice::kNo}},
      options.closed);
  k.Take("corners", options.corners);
  k.Choose<CurveDistance>("distance",
                          {{"auto", CurveDistance::kAuto},
                           {"parameter", CurveDistance::kParameter},
                           {"point", CurveDistance::kPoint},
                           {"tangent", CurveDistance::kTangent},
                           {"squared", CurveDistance::kSquared}},
                          options.distance);
  TakeSmoothing(k, options.smoothing, options.smooth_by);
  TakeLoss(k, options.loss);
  k.Take("loss_scale", options.loss_scale);
  TakeFree(k, options.optimize);
  k.Take("seed", options.seed);
  TakeWork(k, options);
  return options;
}

PrimitiveFitOptions PrimitiveOptionsOf(const Keywords& k) {
  PrimitiveFitOptions options;
  k.Choose<PrimitiveKind>("kind",
                          {{"auto", PrimitiveKind::kAuto},
                           {"line", PrimitiveKind::kLine},
                           {"circle", PrimitiveKind::kCircle},
                           {"plane", PrimitiveKind::kPlane},
                           {"sphere", PrimitiveKind::kSphere},
                           {"cylinder", PrimitiveKind::kCylinder},
                           {"cone", PrimitiveKind::kCone},
                           {"torus", PrimitiveKind::kTorus}},
                          options.kind);
  k.Take("tolerance", options.tolerance);
  TakeLoss(k, options.loss);
  k.Take("loss_scale", options.loss_scale);
  k.Take("seed", options.seed);
  TakeWork(k, options);
  return options;
}

GridFitOptions GridOptionsOf(const Keywords& k) {
  GridFitOptions options;
  k.Take("rows", options.rows);
  k.Take("columns", options.columns);
  TakeDegrees(k, options.degree_u, options.degree_v);
  k.Choose<GridMethod>("method",
                       {{"auto", GridMethod::kAuto},
                        {"interpolate", GridMethod::kInterpolate},
                        {"local", GridMethod::kInterpolateLocally},
                        {"least-squares", GridMethod::kLeastSquares}},
                       options.method);
  k.Take("tolerance", options.tolerance);
  k.Take("control_points", options.control_points);
  k.Choose<GridParameterization>("parameterization",
                                 {{"auto", GridParameterization::kAuto},
                                  {"given", GridParameterization::kGiven},
                                  {"uniform", GridParameterization::kUniform},
                                  {"chord", GridParameterization::kChord},
                                  {"centripetal", GridParameterization::kCentripetal}},
                                 options.parameterization);
  TakeClosing(k, options.closed);
  TakeWork(k, options);
  return options;
}

SolidFitOptions SolidOptionsOf(const Keywords& k) {
  SolidFitOptions options;
  k.Take("tolerance", options.tolerance);
  const bool automatic = k.Has("smoothing") && PyUnicode_Check(k.Value("smoothing").ptr());
  if (!automatic) {
    k.Take("smoothing", options.smoothing);
  } else if (k.Word("smoothing") != "auto") {
    Keywords::Refuse("smoothing", "'" + k.Word("smoothing") + "' is neither a number nor 'auto'");
  }
  constexpr double kMost = 1e12;  // beyond, the points drown in rounding
  if (options.smoothing && *options.smoothing > kMost)
    Keywords::Refuse("smoothing", "more than 1e12");
  k.Take("max_iterations", options.max_iterations);
  k.Take("keep_outliers", options.keep_outliers);
  k.Take("merge_faces", options.merge_faces);
  k.Take("seed", options.seed);
  TakeWork(k, options);
  return options;
}

LocalFitOptions LocalOptionsOf(const Keywords& k) {
  LocalFitOptions options;
  k.Choose<LocalPieces>("method",
                        {{"local-parabolic", LocalPieces::kParabolas},
                         {"local-conic", LocalPieces::kConics},
                         {"local-cubic", LocalPieces::kCubics}},
                        options.pieces);
  k.Take("tolerance", options.tolerance);
  k.Take("closed", options.closed);
  k.Take("corners", options.corners);
  k.Take("shift", options.shift);
  return options;
}

std::vector<MetPlace> PlacesOf(const Keywords& k) {
  std::vector<MetPlace> places;
  if (!k.Has("places")) return places;
  for (const auto& x : k.Value("places").cast<std::vector<std::vector<double>>>()) {
    places.push_back({Eigen::Vector3d(x[0], x[1], x[2])});
    if (x.size() == 6) places.back().direction = Eigen::Vector3d(x[3], x[4], x[5]);
  }
  return places;
}

CloudInterpolationOptions InterpolationOptionsOf(const Keywords& k) {
  CloudInterpolationOptions options;
  k.Take("degree", options.degree);
  RequireDegree(options.degree);
  TakeParameterization(k, options.parameterization);
  k.Take("closed", options.closed);
  k.Take("keep_order", options.keep_order);
  k.Take("function_of_x", options.function_of_x);
  if (k.Has("spline")) {
    SplineEnds ends = SplineEnds::kNatural;
    k.Choose<SplineEnds>("spline",
                         {{"natural", SplineEnds::kNatural},
                          {"clamped", SplineEnds::kClamped},
                          {"curvature", SplineEnds::kCurvature},
                          {"not-a-knot", SplineEnds::kNotAKnot},
                          {"periodic", SplineEnds::kPeriodic}},
                         ends);
    options.spline = ends;
  }
  const auto curvature = [&](const char* name, std::optional<Eigen::VectorXd>& field) {
    if (!k.Has(name)) return;
    const auto numbers = k.Value(name).cast<std::vector<double>>();
    field = Eigen::Map<const Eigen::VectorXd>(numbers.data(), std::ssize(numbers));
  };
  curvature("start_curvature", options.start_curvature);
  curvature("end_curvature", options.end_curvature);
  k.Take("start_tangent", options.start_tangent);
  k.Take("end_tangent", options.end_tangent);
  k.Take("tolerance", options.tolerance);
  if (options.tolerance && !(*options.tolerance > 0))
    Keywords::Refuse("tolerance", "must be positive");
  k.Take("shift", options.shift);
  return options;
}

OptimizeOptions OptimizeOptionsOf(const Keywords& k) {
  OptimizeOptions options;
  if (k.Has("free")) options.free = Free("free", k.Value("free"));
  k.Take("knots_u", options.knots_u);
  k.Take("knots_v", options.knots_v);
  k.Take("max_iterations", options.max_iterations);
  k.Take("noise", options.noise);
  k.Take("stop_at_noise", options.stop_at_noise);
  k.Take("least_gain", options.least_gain);
  std::optional<Loss> loss;
  TakeLoss(k, loss);
  options.loss = loss.value_or(Loss::kNone);
  k.Take("loss_scale", options.loss_scale);
  k.Take("fairness", options.fairness);
  if (k.Has("fixed_control_points"))
    for (const py::handle& one : k.Value("fixed_control_points")) {
      const auto index = AsWhole(one);
      if (!index) Keywords::Refuse("fixed_control_points", "whole numbers are needed");
      options.fixed_control_points.push_back(Narrow("fixed_control_points", *index));
    }
  k.Take("seconds", options.seconds);
  k.Take("seed", options.seed);
  return options;
}

}  // namespace batten::python
