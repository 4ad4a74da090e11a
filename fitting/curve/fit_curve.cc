// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_curve.h"

#include <cstdio>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "batten/fitting/curve_components.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/core/stage_clock.h"
#include "fitting/curve/curve_fitter.h"

namespace batten {
using namespace internal;
namespace {

constexpr double kLeftOver = 0.05;  // of the points: so few beside the longest component are told

template <int Dim>
class Components {
 public:
  Components(const PointCloud& cloud, const CurveFitOptions& options)
      : cloud_(cloud), options_(options), pool_(options.threads) {
    StageClock clock;
    Check(options);
    if (cloud.dimension() > Dim) {
      throw std::invalid_argument("the points are in space: a plane curve can't follow them");
    }
    Report(options.progress, "prepare", 0);
    ArrangeOptions arrange;
    arrange.parameterization = options.parameterization;
    arrange.degree = options.degree;
    arrange.order = options.order;
    arrange.closed = options.closed;
    arrange.find_outliers = !options.loss || *options.loss != Loss::kNone;
    arranged_ = ArrangeCurves(cloud, arrange, pool_, options.progress);
    seconds_ = clock.Seconds();
  }

  size_t size() const { return arranged_.curves.size(); }

  // Whether the longest component holds all but a few of the points.
  bool Alone() const {
    Eigen::Index all = 0;
    for (const OrderedPoints& curve : arranged_.curves) all += curve.cloud.size() + curve.repeats;
    const OrderedPoints& first = arranged_.curves.front();
    return static_cast<double>(first.cloud.size() + first.repeats) >=
           (1 - kLeftOver) * static_cast<double>(all);
  }

  // One line each.
  std::string List() const {
    std::string list;
    for (size_t k = 0; k < size(); ++k) {
      const OrderedPoints& curve = arranged_.curves[k];
      char text[120];
      std::snprintf(text,
                    sizeof text,
                    "\n  %zu: %td points, length %.4g, %s",
                    k + 1,
                    curve.cloud.size() + curve.repeats,
                    arranged_.lengths[k],
                    curve.closed ? "closed" : "open");
      list += text;
    }
    return list;
  }

  // `alone`: the others are not fitted. What is to be said of the whole cloud is said with the
  // first that is asked for.
  CurveFit<Dim> Fit(size_t component, bool alone) {
    StageClock clock;
    CurveFit<Dim> fit = FitOrdered<Dim>(
        cloud_, arranged_.curves[component], arranged_.sequence_outliers, options_, pool_, clock);
    fit.report.seconds = clock.Seconds();
    fit.report.seconds += std::exchange(seconds_, {});
    std::vector<std::string>& warnings = fit.report.warnings;
    if (component < arranged_.of_ends.size() && !arranged_.of_ends[component].empty())
      warnings.insert(warnings.begin(), arranged_.of_ends[component]);
    if (!alone && size() > 1) {
      for (std::string& warning : warnings)
        warning.insert(0, "curve " + std::to_string(component + 1) + ": ");
    }
    const std::vector<std::string> of_cloud = std::exchange(arranged_.warnings, {});
    warnings.insert(warnings.begin(), of_cloud.begin(), of_cloud.end());
    if (alone && size() > 1) {
      const auto& place = arranged_.curves[component].place;
      for (Eigen::Index k = 0; k < fit.outliers.size(); ++k)
        if (place[static_cast<size_t>(k)] < 0) fit.outliers[k] = true;
      warnings.insert(warnings.begin(),
                      "the points are " + std::to_string(size()) +
                          " separate curves; this is number " + std::to_string(component + 1) +
                          " of" + List());
    }
    return fit;
  }

 private:
  const PointCloud& cloud_;
  const CurveFitOptions& options_;
  ThreadPool pool_;
  CurveComponents arranged_;
  StageSeconds seconds_;  // of the arrangement, until a fit takes them
};

}  // namespace

template <int Dim>
CurveFit<Dim> FitCurve(const PointCloud& cloud, const CurveFitOptions& options) {
  Components<Dim> components(cloud, options);
  if (components.size() > 1 && !components.Alone()) {
    throw std::invalid_argument(
        "the points are " + std::to_string(components.size()) +
        " separate curves; choose a component, or all:" + components.List());
  }
  return components.Fit(0, true);
}

template <int Dim>
std::vector<CurveFit<Dim>> FitCurves(const PointCloud& cloud, const CurveFitOptions& options) {
  Components<Dim> components(cloud, options);
  std::vector<CurveFit<Dim>> fits;
  for (size_t k = 0; k < components.size(); ++k) {
    try {
      fits.push_back(components.Fit(k, false));
    } catch (const std::invalid_argument& error) {
      throw std::invalid_argument("component " + std::to_string(k + 1) + ": " + error.what());
    }
  }
  return fits;
}

template <int Dim>
CurveFit<Dim> FitComponent(const PointCloud& cloud, int component, const CurveFitOptions& options) {
  Components<Dim> components(cloud, options);
  if (component < 1 || static_cast<size_t>(component) > components.size()) {
    throw std::invalid_argument("there is no component " + std::to_string(component) +
                                (components.size() == 1
                                     ? ": the points are one curve"
                                     : "; the components are:" + components.List()));
  }
  return components.Fit(static_cast<size_t>(component) - 1, true);
}

template CurveFit<2> FitCurve<2>(const PointCloud&, const CurveFitOptions&);
template CurveFit<3> FitCurve<3>(const PointCloud&, const CurveFitOptions&);
template std::vector<CurveFit<2>> FitCurves<2>(const PointCloud&, const CurveFitOptions&);
template std::vector<CurveFit<3>> FitCurves<3>(const PointCloud&, const CurveFitOptions&);
template CurveFit<2> FitComponent<2>(const PointCloud&, int, const CurveFitOptions&);
template CurveFit<3> FitComponent<3>(const PointCloud&, int, const CurveFitOptions&);

}  // namespace batten
