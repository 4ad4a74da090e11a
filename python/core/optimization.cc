// SPDX-License-Identifier: MIT
// Control points, parameters, weights and knots of a shape and its data together.
#include <pybind11/stl.h>

#include <optional>

#include "batten/fitting/optimize.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/body.h"
#include "python/core/options.h"
#include "python/core/terms.h"
#include "python/core/watch.h"

namespace batten::python {
namespace {

struct Start {
  FittingProblem problem;
  Eigen::MatrixXd control_points;
  Eigen::VectorXd weights;
};

Start StartOf(const NurbsSurface& surface, std::shared_ptr<const FittingData> data, double fair) {
  return {FittingProblem(surface.basis_u(), surface.basis_v(), std::move(data), fair),
          surface.control_points(),
          surface.weights()};
}
template <int Dim>
Start StartOf(const NurbsCurve<Dim>& curve, std::shared_ptr<const FittingData> data, double fair) {
  return {FittingProblem(curve.basis(), std::move(data), fair),
          curve.control_points(),
          curve.weights()};
}

Geometry ShapeOf(const OptimizeResult& result) {
  const FittingProblem& problem = result.problem;
  const Eigen::MatrixXd& points = result.control_points;
  if (!problem.is_curve()) {
    return NurbsSurface(
        problem.basis_u(), problem.basis_v(), Eigen::Matrix3Xd(points), result.weights);
  }
  if (points.rows() == 2)
    return NurbsCurve<2>(problem.basis_u(), Eigen::Matrix2Xd(points), result.weights);
  return NurbsCurve<3>(problem.basis_u(), Eigen::Matrix3Xd(points), result.weights);
}

// (body, parameters, dict)
py::tuple OptimizeAll(const Body& body,
                      const Doubles& points,
                      const Doubles& parameters,
                      const std::optional<Doubles>& weights,
                      const py::dict& values,
                      const py::object& terms,
                      const py::object& progress) {
  const Keywords keywords(values);
  OptimizeOptions options = OptimizeOptionsOf(keywords);
  Check(options);
  const int threads = keywords.Threads();
  auto data = std::make_shared<FittingData>();
  if (body.dimension() == 2) {
    data->values = Columns<2>(points, "points");
  } else {
    data->values = Columns<3>(points, "points");
  }
  if (body.is_surface()) {
    data->parameters = Columns<2>(parameters, "parameters");
  } else {
    data->parameters = Eigen::Matrix2Xd::Zero(2, parameters.size());
    data->parameters.row(0) = Vector(parameters);
  }
  if (weights) data->weights = Vector(*weights);
  const Start start = std::visit(
      [&](const auto& shape) { return StartOf(shape, data, options.fairness); }, body.geometry());
  const int size = start.problem.net_size();
  for (const int index : options.fixed_control_points) {
    if (index < 0 || index >= size) {
      Keywords::Refuse("fixed_control_points",
                       std::to_string(index) + " is not in [0, " + std::to_string(size) + ")");
    }
  }
  const Kept list = Keep(terms);
  OptimizeResult result = Watched(
      [=](Watch& watch) mutable {
        InPython(watch, [&] { options.terms = TermsOf(*list, watch); });
        options.progress = [&](const char* stage, double fraction) {
          return watch.Go(stage, fraction);
        };
        ThreadPool pool(threads);
        return Optimize(start.problem, start.control_points, start.weights, options, pool);
      },
      progress);
  using namespace py::literals;
  const py::dict report("iterations"_a = result.iterations,
                        "rms_before"_a = result.rms_before,
                        "rms_after"_a = result.rms_after,
                        "ran"_a = result.ran,
                        "cancelled"_a = result.cancelled,
                        "note"_a = result.note);
  const Eigen::Matrix2Xd& found = result.problem.data().parameters;
  const py::ssize_t count = found.cols();
  py::array places = body.is_surface() ? Owned(Eigen::Matrix2Xd(found), {count, 2})
                                       : Owned(Eigen::VectorXd(found.row(0)), {count});
  return py::make_tuple(MakeBody(ShapeOf(result)), places, report);
}

}  // namespace

void BindOptimize(py::module_& m) { m.def("optimize", &OptimizeAll); }

}  // namespace batten::python
