// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_locally.h"

#include <stdexcept>
#include <string>
#include <utility>

#include "batten/fitting/local_approximation.h"
#include "fitting/core/stage_clock.h"
#include "fitting/interpolation/met_points.h"
#include "fitting/ordering/curve_sequence.h"

namespace batten {
using namespace internal;
namespace {

const char* Name(LocalPieces pieces) {
  switch (pieces) {
    case LocalPieces::kParabolas:
      return "local parabolas";
    case LocalPieces::kConics:
      return "local conics";
    default:
      return "local cubics";
  }
}

template <int Dim>
InterpolatedCurve<Dim> Met(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                           const LocalFitOptions& options) {
  TangentOptions tangents;
  tangents.closed = options.closed;
  tangents.find_corners = options.corners;
  return InterpolateLocally<Dim>(points, options.pieces, tangents);
}

template <int Dim>
InterpolatedCurve<Dim> Approximated(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                                    const LocalFitOptions& options) {
  if (options.pieces == LocalPieces::kParabolas) {
    throw std::invalid_argument(
        "parabolas go through every point: conics or cubics keep a tolerance");
  }
  LocalApproximationOptions how;
  how.pieces = options.pieces == LocalPieces::kConics ? ApproximationPieces::kConics
                                                      : ApproximationPieces::kCubics;
  how.closed = options.closed;
  if (!options.corners) how.corner_angle.reset();
  LocalApproximation<Dim> found = ApproximateLocally<Dim>(points, *options.tolerance, how);
  return {std::move(found.curve), std::move(found.parameters)};
}

}  // namespace

template <int Dim>
CurveFit<Dim> FitLocally(const PointCloud& cloud, const LocalFitOptions& options) {
  StageClock clock;
  const MetPoints<Dim> met = MetPointsOf<Dim>(cloud, false, true, options.closed);
  clock.Enter(&StageSeconds::solve);
  const InterpolatedCurve<Dim> local =
      options.tolerance ? Approximated<Dim>(met.points, options) : Met<Dim>(met.points, options);
  clock.Enter(&StageSeconds::project);
  CurveFit<Dim> fit = FitThroughPoints<Dim>(cloud,
                                            met,
                                            local,
                                            {.base = Name(options.pieces),
                                             .why = "local methods leave nothing free",
                                             .closed = options.closed,
                                             .meets_all = !options.tolerance,
                                             .tolerance = options.tolerance,
                                             .shift = options.shift});
  if (!FollowsCurve(cloud.points())) {
    fit.report.warnings.push_back(
        "the points do not follow one another along a curve, and local methods take them in their "
        "order");
  }
  fit.report.seconds = clock.Seconds();
  return fit;
}

template CurveFit<2> FitLocally<2>(const PointCloud&, const LocalFitOptions&);
template CurveFit<3> FitLocally<3>(const PointCloud&, const LocalFitOptions&);

}  // namespace batten
