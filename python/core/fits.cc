// SPDX-License-Identifier: MIT
// Fits of surfaces, curves, primitives and grids.
#include <pybind11/stl.h>

#include "batten/fitting/fit_curve.h"
#include "batten/fitting/fit_grid.h"
#include "batten/fitting/fit_locally.h"
#include "batten/fitting/fit_primitive.h"
#include "batten/fitting/fit_surface.h"
#include "batten/fitting/fit_through.h"
#include "batten/fitting/form_deviation.h"
#include "batten/fitting/interpolate_cloud.h"
#include "python/core/arrays.h"
#include "python/core/bind.h"
#include "python/core/explained.h"
#include "python/core/fit.h"
#include "python/core/options.h"
#include "python/core/terms.h"
#include "python/core/watch.h"

namespace batten::python {
namespace {

// The terms that Python makes of where the joint stage begins.
ResidualTerms TermsMade(const Kept& make, const BodyPtr& start, Watch& watch) {
  ResidualTerms terms;
  InPython(watch, [&] { terms = TermsOf((*make)(start), watch); });
  return terms;
}

// Options that may be copied by the thread that works while Python goes on.
FitPtr SurfaceFitOf(const PointsPtr& points, const Keywords& keywords, SurfaceFit fit) {
  auto made = std::make_shared<Fit>();
  made->bodies = {MakeBody(std::move(fit.surface))};
  Take(fit, points, keywords, *made);
  return made;
}

FitPtr FitOneSurface(const PointsPtr& points, const py::dict& values, const py::object& progress) {
  const Keywords keywords(values);
  SurfaceFitOptions options = SurfaceOptionsOf(keywords);
  const Kept make_terms = keywords.Has("terms") ? Keep(keywords.Value("terms")) : nullptr;
  if (make_terms) options.terms = [](const NurbsSurface&) { return ResidualTerms(); };
  Check(options);
  if (points->cloud.dimension() == 2)
    throw py::value_error(
        "points: a surface needs x, y and z; fit_curve takes points of the plane");
  SurfaceFit fit = Watched(
      [=](Watch& watch) mutable {
        options.progress = watch.WholeFitProgress();
        if (make_terms) {
          options.terms = [&](const NurbsSurface& start) -> ResidualTerms {
            return TermsMade(make_terms, MakeBody(start), watch);
          };
        }
        return Explained([&] { return FitSurface(points->cloud, options); });
      },
      progress);
  return SurfaceFitOf(points, keywords, std::move(fit));
}

FitPtr FitOneGrid(const PointsPtr& points,
                  const py::dict& values,
                  const std::optional<py::array_t<bool, py::array::c_style>>& missing,
                  const std::optional<std::pair<Doubles, Doubles>>& lines,
                  const py::object& progress) {
  const Keywords keywords(values);
  GridFitOptions options = GridOptionsOf(keywords);
  if (missing) {
    options.missing = Eigen::Map<const PointMask>(missing->data(), missing->size());
  }
  if (lines) {
    options.parameterization = GridParameterization::kGiven;
    options.parameters = {Vector(lines->first), Vector(lines->second)};
  }
  Check(options);
  SurfaceFit fit = Watched(
      [=](Watch& watch) mutable {
        options.progress = watch.WholeFitProgress();
        return Explained([&] { return FitGrid(points->cloud, options); });
      },
      progress);
  return SurfaceFitOf(points, keywords, std::move(fit));
}

template <int Dim>
std::vector<FitPtr> CurveFitsOf(const PointsPtr& points,
                                const Keywords& keywords,
                                std::vector<CurveFit<Dim>> fits) {
  std::vector<FitPtr> list;
  for (CurveFit<Dim>& fit : fits) {
    auto made = std::make_shared<Fit>();
    made->bodies = {MakeBody(std::move(fit.curve))};
    Take(fit, points, keywords, *made);
    list.push_back(std::move(made));
  }
  return list;
}

template <int Dim>
std::vector<FitPtr> FitSomeCurves(const PointsPtr& points,
                                  const Keywords& keywords,
                                  CurveFitOptions options,
                                  const std::string& component,
                                  const py::object& progress) {
  const std::vector<MetPlace> places = PlacesOf(keywords);
  const Kept make_terms = keywords.Has("terms") ? Keep(keywords.Value("terms")) : nullptr;
  auto fits = Watched(
      [=](Watch& watch) mutable {
        options.progress = watch.WholeFitProgress();
        if (make_terms) {
          options.terms = [&](const SplineBasis& basis,
                              const Eigen::MatrixXd& control) -> ResidualTerms {
            return TermsMade(make_terms, MakeBody(NurbsCurve<Dim>(basis, control)), watch);
          };
        }
        return Explained([&]() -> std::vector<CurveFit<Dim>> {
          if (!places.empty()) {
            std::vector<CurveFit<Dim>> through;
            through.push_back(FitCurveThrough<Dim>(points->cloud, places, options));
            return through;
          }
          if (component == "all") return FitCurves<Dim>(points->cloud, options);
          std::vector<CurveFit<Dim>> one;
          one.push_back(component.empty()
                            ? FitCurve<Dim>(points->cloud, options)
                            : FitComponent<Dim>(points->cloud, std::stoi(component), options));
          return one;
        });
      },
      progress);
  return CurveFitsOf(points, keywords, std::move(fits));
}

// `component`: empty, "all" or a number.
std::vector<FitPtr> FitTheCurves(const PointsPtr& points,
                                 const py::dict& values,
                                 const std::string& component,
                                 const py::object& progress) {
  const Keywords keywords(values);
  CurveFitOptions options = CurveOptionsOf(keywords);
  Check(options);
  return points->cloud.dimension() == 2
             ? FitSomeCurves<2>(points, keywords, options, component, progress)
             : FitSomeCurves<3>(points, keywords, options, component, progress);
}

template <int Dim>
FitPtr InterpolateIn(const PointsPtr& points,
                     const Keywords& keywords,
                     const CloudInterpolationOptions& options) {
  std::vector<CurveFit<Dim>> one;
  one.push_back(Watched([=](Watch&) {
    return Explained([&] { return InterpolateCloud<Dim>(points->cloud, options); });
  }));
  return CurveFitsOf(points, keywords, std::move(one)).front();
}

FitPtr InterpolateOne(const PointsPtr& points, const py::dict& values) {
  const Keywords keywords(values);
  const CloudInterpolationOptions options = InterpolationOptionsOf(keywords);
  return points->cloud.dimension() == 2 ? InterpolateIn<2>(points, keywords, options)
                                        : InterpolateIn<3>(points, keywords, options);
}

template <int Dim>
FitPtr FitLocallyIn(const PointsPtr& points,
                    const Keywords& keywords,
                    const LocalFitOptions& options) {
  std::vector<CurveFit<Dim>> one;
  one.push_back(Watched(
      [=](Watch&) { return Explained([&] { return FitLocally<Dim>(points->cloud, options); }); }));
  return CurveFitsOf(points, keywords, std::move(one)).front();
}

FitPtr FitOneLocally(const PointsPtr& points, const py::dict& values) {
  const Keywords keywords(values);
  const LocalFitOptions options = LocalOptionsOf(keywords);
  return points->cloud.dimension() == 2 ? FitLocallyIn<2>(points, keywords, options)
                                        : FitLocallyIn<3>(points, keywords, options);
}

FitPtr FitOnePrimitive(const PointsPtr& points,
                       const py::dict& values,
                       const py::object& progress) {
  const Keywords keywords(values);
  PrimitiveFitOptions options = PrimitiveOptionsOf(keywords);
  Check(options);
  PrimitiveFit fit = Watched(
      [=](Watch& watch) mutable {
        options.progress = watch.WholeFitProgress();
        return Explained([&] { return FitPrimitive(points->cloud, options); });
      },
      progress);
  auto made = std::make_shared<Fit>();
  if (HasForm(fit)) made->checks.form = FormDeviationOf(fit, points->cloud, options.shift);
  made->bodies = {MakeBody(std::move(fit.geometry))};
  Take(fit, points, keywords, *made);
  return made;
}

}  // namespace

void BindFits(py::module_& m) {
  m.def("fit_surface", &FitOneSurface);
  m.def("fit_grid", &FitOneGrid);
  m.def("fit_curves", &FitTheCurves);
  m.def("interpolate_curve", &InterpolateOne);
  m.def("fit_locally", &FitOneLocally);
  m.def("fit_primitive", &FitOnePrimitive);
}

}  // namespace batten::python
