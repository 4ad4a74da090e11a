// SPDX-License-Identifier: MIT
// What a fit holds: arrays that share its memory, the report as JSON and as a page, residuals as a
// file.
#include <pybind11/stl.h>
#include <sys/resource.h>

#include <ctime>
#include <optional>
#include <type_traits>
#include <vector>

#include "batten/fitting/uncertainty.h"
#include "batten/io/atomic_file.h"
#include "batten/io/certificate.h"
#include "batten/io/length_unit.h"
#include "batten/io/report_html.h"
#include "batten/io/report_json.h"
#include "batten/io/report_scene.h"
#include "batten/io/write_residuals.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/explained.h"
#include "python/core/fit.h"
#include "python/core/watch.h"

namespace batten::python {
namespace {

py::array Parameters(const py::object& self) {
  return std::visit(
      [&](const auto& parameters) {
        const bool flat = parameters.rows() == 1 || parameters.cols() == 1;
        constexpr bool kPairs = std::remove_cvref_t<decltype(parameters)>::RowsAtCompileTime == 2;
        const Shape form = flat && !kPairs ? Shape{parameters.size()}
                                           : Shape{parameters.cols(), parameters.rows()};
        return View(parameters.data(), form, self);
      },
      self.cast<const Fit&>().parameters);
}

Eigen::MatrixXd ParameterColumns(const Fit& fit) {
  return std::visit(
      [](const auto& parameters) -> Eigen::MatrixXd {
        if constexpr (std::remove_cvref_t<decltype(parameters)>::ColsAtCompileTime == 1) {
          return parameters.transpose();
        } else {
          return parameters;
        }
      },
      fit.parameters);
}

ReportContext ContextOf(const Fit& fit, const std::string& file) {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  ReportContext context;
  context.command = fit.command;
  context.file = file;
  context.unit = fit.unit;
  context.shift = fit.shift;
  context.peak_memory_bytes = std::int64_t{usage.ru_maxrss} * 1024;
  context.version = BATTEN_VERSION;
  context.checks = fit.checks;
  return context;
}

std::string Page(const FitPtr& fit,
                 Eigen::Index most_points,
                 Eigen::Index most_triangles,
                 const std::string& beside) {
  return Watched([=](Watch& watch) {
    const Eigen::MatrixXd parameters = ParameterColumns(*fit);
    const MeasuredPoints points{.cloud = fit->points->cloud,
                                .distances = fit->residuals,
                                .parameters = parameters,
                                .outliers = fit->outliers,
                                .owners = fit->owners,
                                .spacing = fit->report.input.spacing,
                                .noise = fit->report.input.noise};
    ReportSceneOptions options;
    options.tolerance = fit->report.error.tolerance;
    options.shift = fit->shift;
    options.max_points = most_points;
    options.max_triangles = most_triangles;
    options.names = fit->names;
    options.progress = [&](const char* stage, double fraction) {
      return watch.Go(stage, fraction);
    };
    ThreadPool pool(0);
    const ReportScene scene = MakeReportScene(GeometriesOf(fit->bodies), points, options, pool);
    ReportContext context = ContextOf(*fit, "");
    const std::time_t now = std::time(nullptr);
    std::tm utc{};
    char text[32] = "";
    if (gmtime_r(&now, &utc)) std::strftime(text, sizeof text, "%Y-%m-%d %H:%M UTC", &utc);
    context.date = text;
    return ToReportHtml(fit->report, context, scene, beside);
  });
}

void WriteText(const std::string& path, const std::string& text) {
  const py::gil_scoped_release released;
  AtomicFile file(path);
  file.Write(text);
  file.Commit();
}

Uncertainty UncertaintyOf(const Fit& fit) {
  const Eigen::MatrixXd feet = ParameterColumns(fit);
  return std::visit(
      [&](const auto& shape) {
        const PointCloud& cloud = fit.points->cloud;
        if constexpr (std::is_same_v<std::remove_cvref_t<decltype(shape)>, NurbsSurface>) {
          const SurfaceFit of{shape, feet, fit.residuals, fit.outliers, fit.report, fit.estimator};
          return Uncertainty(of, cloud);
        } else {
          using Found = CurveFit<std::remove_cvref_t<decltype(shape)>::Point::RowsAtCompileTime>;
          const Found of{shape,
                         feet.row(0).transpose(),
                         fit.residuals,
                         fit.outliers,
                         fit.report,
                         fit.estimator};
          return Uncertainty(of, cloud);
        }
      },
      GeometriesOf(fit.bodies).front());
}

// Places as 2 × k; of curves the first row. None: the points' feet.
Eigen::Matrix2Xd PlacesOf(const Fit& fit, const std::optional<Doubles>& places) {
  if (!places) {
    const Eigen::MatrixXd feet = ParameterColumns(fit);
    Eigen::Matrix2Xd at = Eigen::Matrix2Xd::Zero(2, feet.cols());
    at.topRows(feet.rows()) = feet;
    return at;
  }
  Eigen::Matrix2Xd at = Eigen::Matrix2Xd::Zero(2, places->shape(0));
  for (Eigen::Index k = 0; k < at.cols(); ++k)
    for (Eigen::Index c = 0; c < places->shape(1); ++c) at(c, k) = places->at(k, c);
  return at;
}

// Standard deviation, bias and support at places: k × 3.
py::array UncertaintyAt(const FitPtr& fit, const std::optional<Doubles>& places) {
  const Eigen::Matrix2Xd at = PlacesOf(*fit, places);
  const auto found =
      Watched([=](Watch&) { return Explained([&] { return UncertaintyOf(*fit).At(at); }); });
  py::array_t<double> rows({std::ssize(found), std::ptrdiff_t{3}});
  for (size_t k = 0; k < found.size(); ++k) {
    rows.mutable_at(k, 0) = found[k].deviation;
    rows.mutable_at(k, 1) = found[k].bias;
    rows.mutable_at(k, 2) = found[k].support;
  }
  return rows;
}

// Of displacements along the normal at places: k × k.
py::array CovarianceAt(const FitPtr& fit, const Doubles& places) {
  const Eigen::Matrix2Xd at = PlacesOf(*fit, places);
  std::vector<ShapeFunctional> functionals;
  for (const auto& place : at.colwise()) functionals.push_back({{place[0], place[1], 1}});
  const Eigen::MatrixXd found = Watched([=](Watch&) {
    return Explained([&] { return UncertaintyOf(*fit).Covariance(functionals); });
  });
  py::array_t<double> rows({found.rows(), found.cols()});
  for (Eigen::Index i = 0; i < found.rows(); ++i)
    for (Eigen::Index j = 0; j < found.cols(); ++j) rows.mutable_at(i, j) = found(i, j);
  return rows;
}

// Proved bounds of all distances, as batten-verify reads them.
void CertificateTo(const FitPtr& fit, const std::string& path) {
  WriteText(path, Watched([=](Watch&) {
              return Explained([&] {
                ThreadPool pool(0);
                const std::vector<Geometry> shapes = GeometriesOf(fit->bodies);
                const PointCloud& cloud = fit->points->cloud;
                const Certificate proved =
                    Certify(shapes, cloud, fit->shift, fit->report.error.tolerance, pool);
                return ToCertificateJson(proved, shapes, cloud, fit->shift);
              });
            }));
}

double LimitOf(const Fit& fit) {
  const PointCloud& cloud = fit.points->cloud;
  const double size =
      cloud.size() == 0
          ? 0
          : (cloud.points().rowwise().maxCoeff() - cloud.points().rowwise().minCoeff()).norm();
  return DeviationLimit(
      fit.residuals, fit.outliers, fit.report.error.tolerance, fit.report.input.noise, size);
}

void ResidualsTo(const FitPtr& fit, const std::string& path) {
  Watched([=](Watch&) {
    const Eigen::MatrixXd parameters = ParameterColumns(*fit);
    const auto file = WriteResiduals(path,
                                     {fit->points->cloud,
                                      fit->residuals,
                                      parameters,
                                      fit->outliers,
                                      LimitOf(*fit),
                                      fit->owners});
    file->Commit();
    return true;
  });
}

}  // namespace

void Complete(Fit& fit, const Keywords& keywords, bool keeps_origin) {
  if (keywords.Has("command")) fit.command = keywords.Word("command");
  if (keywords.Has("unit")) fit.unit = keywords.Word("unit");
  FitReport& report = fit.report;
  const Points& points = *fit.points;
  const double far = points.cloud.size() > 0 ? points.cloud.World(0).cwiseAbs().maxCoeff() : 0;
  const double metres = LengthUnitOf(fit.unit).millimetres / 1000;
  if (keeps_origin && far * metres > 500) {
    report.warnings.push_back(
        "coordinates are more than 500 m from zero, where CAD systems lose digits: shift='local' "
        "writes them near zero and reports the shift");
  }
  if (points.files.empty()) return;
  report.input.files = points.files;
  report.input.points = points.points_in_file - points.filtered;
  report.input.mesh = points.mesh;
  report.input.non_finite = points.non_finite;
  report.seconds.read = points.read_seconds;
  report.seconds.total += points.read_seconds;
}

void BindResults(py::module_& m) {
  py::class_<Fit, FitPtr>(m, "Fit")
      .def_readonly("bodies", &Fit::bodies)
      .def_readonly("names", &Fit::names)
      .def_readonly("points", &Fit::points)
      .def_readonly("unit", &Fit::unit)
      .def_property_readonly("shift", [](const Fit& f) { return Triple(f.shift); })
      .def_property_readonly("parameters", &Parameters)
      .def_property_readonly("residuals",
                             [](const py::object& self) {
                               const auto& values = self.cast<const Fit&>().residuals;
                               return View(values.data(), {values.size()}, self);
                             })
      .def_property_readonly("outliers",
                             [](const py::object& self) {
                               const auto& values = self.cast<const Fit&>().outliers;
                               return View(values.data(), {values.size()}, self);
                             })
      .def_property_readonly("owners",
                             [](const py::object& self) {
                               const auto& values = self.cast<const Fit&>().owners;
                               return View(values.data(), {std::ssize(values)}, self);
                             })
      .def_property_readonly(
          "ok",
          [](const Fit& f) {
            return f.report.tolerance_reached().value_or(!f.report.leaves_points()) &&
                   f.report.Doubts().empty();
          })
      .def_property_readonly("doubts",
                             [](const Fit& f) {
                               std::vector<std::string> words;
                               for (const Doubt& doubt : f.report.Doubts())
                                 words.push_back(doubt.words);
                               return words;
                             })
      .def_property_readonly("line", [](const Fit& f) { return f.report.OneLine(); })
      .def_property_readonly("warnings", [](const Fit& f) { return f.report.warnings; })
      .def_property_readonly("rms", [](const Fit& f) { return f.report.judged_error().rms; })
      .def_property_readonly("limit", &LimitOf)
      .def("report",
           [](const Fit& f, const std::string& file) {
             return ToReportJson(f.report, ContextOf(f, file));
           })
      .def("page", &Page)
      .def("uncertainty", &UncertaintyAt)
      .def("covariance", &CovarianceAt)
      .def("write_certificate", &CertificateTo)
      .def("write_residuals", &ResidualsTo);
  m.def("write_text", &WriteText);
}

}  // namespace batten::python
