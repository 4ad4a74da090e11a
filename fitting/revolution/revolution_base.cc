// SPDX-License-Identifier: MIT
#include "fitting/revolution/revolution_base.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "fitting/revolution/cylindrical_chart.h"
#include "fitting/revolution/revolution_shape.h"
#include "fitting/revolution/sphere_fit.h"
#include "fitting/revolution/torus_fit.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kMostMisfit = 0.09;  // a ripple of amplitude 0.1 has 0.07, a cube 0.11

RevolutionParameterization Refused(std::string failure_reason) {
  RevolutionParameterization base;
  base.failure_reason = std::move(failure_reason);
  return base;
}

// The clause for the report, once parameters are laid.
std::string WhyOf(const RevolutionParameterization& base,
                  const WayRound& way,
                  const std::string& shape) {
  std::string why = shape;
  if (base.periodic_u) {
    why += ", closed round its axis along " + Percent(way.share) + " of its profile";
  } else {
    why += ", open round its axis (" + std::to_string(std::lround(base.turn * 360 / kTurn)) +
           " degrees)";
  }
  if (base.periodic_v) why += ", its profile closed";
  if (base.pole_start && base.pole_end) {
    why += ", with a pole at either end";
  } else if (base.pole_start || base.pole_end) {
    why += ", with a pole at one end";
  }
  return why;
}

// Whether a sphere is plausible: slightly bent sheets and rods are near huge spheres.
bool IsBall(const RevolutionSamples& round, const FittedSphere& sphere) {
  constexpr double kLargest = 3;  // radii against the nodes' mean distance from their centre
  return sphere.radius > 0 && sphere.radius < kLargest * round.size;
}

std::string NoAxis(double misfit) {
  return "the points are off every surface of revolution by " + Percent(misfit) +
         " of its radius: there is no axis to wind round; fit a part of the cloud that is an open "
         "sheet";
}

constexpr const char* kSpiral =
    "the points go round the axis more than once without closing; lay them out flat as a sheet";

// Finds where the profile meets the axis near an end of the nodes, searching outwards.
std::optional<double> PoleOf(const BaseProfile& profile, double from, double to) {
  constexpr int kSteps = 64;
  double before = from;
  if (!(profile.At(before).place[0] > 0)) return std::nullopt;
  for (int i = 1; i <= kSteps; ++i) {
    const double s = from + (to - from) * i / kSteps;
    if (profile.At(s).place[0] > 0) {
      before = s;
      continue;
    }
    double inside = before, outside = s;
    for (int halving = 0; halving < 50; ++halving) {
      const double middle = (inside + outside) / 2;
      (profile.At(middle).place[0] > 0 ? inside : outside) = middle;
    }
    return inside;
  }
  return std::nullopt;
}

// Best axis of a sphere, if the nodes are nearly on one.
std::optional<AxisFrame> SphereAxis(const RevolutionSamples& round, ThreadPool& pool) {
  constexpr double kBallLike = 0.03;
  const FittedSphere sphere = FitSphere(round, pool);
  if (!IsBall(round, sphere) || sphere.misfit > kBallLike) return std::nullopt;
  return AxisOfSphere(round, sphere);
}

CylindricalChart ChartOf(const RevolutionEstimate& shape) {
  const BaseProfile& profile = *shape.profile;
  CylindricalChart chart;
  chart.frame = shape.frame;
  chart.mean_radius = shape.seen.mean_radius;
  chart.reach = shape.seen.reach;
  chart.along = [&profile](const Eigen::Vector2d& place) {
    return profile.Length(profile.Foot(place));
  };
  chart.low = profile.Length(shape.low);
  chart.high = profile.Length(shape.high);
  if (shape.closed_along) {
    chart.period = profile.Length(profile.range());
    return chart;
  }
  constexpr double kInside = 3;  // reaches
  const double inside = std::min(kInside * shape.seen.reach, (shape.high - shape.low) / 2);
  if (const auto pole = PoleOf(profile, shape.low + inside, 0)) {
    chart.low_pole = profile.Length(*pole);
  }
  if (const auto pole = PoleOf(profile, shape.high - inside, profile.range())) {
    chart.high_pole = profile.Length(*pole);
  }
  return chart;
}

// Angle of a place about the tube's centre, from the outside by the top.
double TubeAngle(const Ring& ring, const Eigen::Vector2d& place) {
  return std::atan2(place[1], place[0] - ring.radius);
}

// Finds the range of angles round its tube that a torus covers; an open one starts after the widest
// gap.
WayRound FindWayAlong(const RevolutionSamples& round,
                      const Ring& ring,
                      const SamplesAboutAxis& seen) {
  SamplesAboutAxis about = seen;  // with both angles exchanged
  for (Eigen::Index i = 0; i < seen.size(); ++i) {
    about.angles[i] = TubeAngle(ring, seen.places.col(i));
    about.clear[i] = true;
  }
  std::vector<double> across(static_cast<size_t>(seen.size()));
  for (Eigen::Index i = 0; i < seen.size(); ++i) across[i] = ring.radius * seen.angles[i];
  return FindWayRound(round, about, across, kTurn * ring.radius);
}

}  // namespace

RevolutionParameterization RevolutionBaseOf(const RoundCloud& cloud, ThreadPool& pool) {
  const std::optional<AxisFrame> preferred = SphereAxis(cloud.round, pool);
  const RevolutionEstimate shape = WithPreferredAxis(*cloud.shape, cloud.round, preferred, pool);
  if (!shape.profile || !(shape.misfit <= kMostMisfit)) {
    return Refused(NoAxis(std::min(shape.misfit, 1.0)));
  }
  CylindricalChart chart = ChartOf(shape);
  std::vector<double> lengths;
  for (const double foot : shape.feet) lengths.push_back(shape.profile->Length(foot));
  chart.way = FindWayRound(cloud.round, shape.seen, lengths, chart.period);
  if (chart.way.winds) return Refused(kSpiral);
  RevolutionParameterization base;
  base.name = "revolution";
  base.misfit = shape.misfit;
  AssignParameters(chart, cloud, pool, base);
  base.why = WhyOf(base, chart.way, "a surface of revolution");
  return base;
}

RevolutionParameterization SphereBaseOf(const RoundCloud& cloud, ThreadPool& pool) {
  const FittedSphere sphere = FitSphere(cloud.round, pool);
  if (!IsBall(cloud.round, sphere) || sphere.misfit > kMostMisfit) {
    const double misfit = IsBall(cloud.round, sphere) ? std::min(sphere.misfit, 1.0) : 1;
    return Refused("the points are off every sphere by " + Percent(misfit) +
                   " of its radius; choose another base");
  }
  CylindricalChart chart;
  chart.frame = AxisOfSphere(cloud.round, sphere);
  const SamplesAboutAxis seen = CylindricalCoordinates(cloud.round, chart.frame);
  chart.mean_radius = seen.mean_radius;
  chart.reach = seen.reach;
  const double radius = sphere.radius;
  chart.along = [radius](const Eigen::Vector2d& place) {
    return radius * std::atan2(place[0], -place[1]);
  };
  std::vector<double> lengths;
  for (const auto place : seen.places.colwise()) lengths.push_back(chart.along(place));
  chart.low = *std::min_element(lengths.begin(), lengths.end());
  chart.high = *std::max_element(lengths.begin(), lengths.end());
  chart.low_pole = 0;
  chart.high_pole = std::numbers::pi * radius;
  chart.way = FindWayRound(cloud.round, seen, lengths, 0);
  RevolutionParameterization base;
  base.name = "sphere";
  base.misfit = sphere.misfit;
  AssignParameters(chart, cloud, pool, base);
  base.why = WhyOf(base, chart.way, "a sphere");
  return base;
}

RevolutionParameterization TorusBaseOf(const RoundCloud& cloud, ThreadPool& pool) {
  const RevolutionEstimate& shape = *cloud.shape;
  const auto refused = [](const std::string& reason) {
    return Refused(reason + "; choose another base");
  };
  if (!shape.profile || !(shape.misfit <= kMostMisfit)) {
    return refused("the points are off every surface of revolution");
  }
  const Ring ring = FitTorus(cloud.round, shape.frame, pool);
  if (!(ring.misfit <= kMostMisfit)) {
    return refused("the points are off every torus by " + Percent(std::min(ring.misfit, 1.0)) +
                   " of its radius");
  }
  if (!(ring.radius > ring.tube) || !(ring.tube > 0)) {
    return refused("the tube of the torus would meet its axis");
  }
  const SamplesAboutAxis seen = CylindricalCoordinates(cloud.round, ring.frame);
  WayRound tube = FindWayAlong(cloud.round, ring, seen);
  tube.closed = tube.closed || shape.closed_along;
  if (!tube.closed && tube.turn < kTurn / 2) {
    return refused("less than half of a tube is there");
  }
  CylindricalChart chart;
  chart.frame = ring.frame;
  chart.mean_radius = ring.radius;
  chart.reach = seen.reach;
  chart.period = tube.closed ? kTurn * ring.tube : 0;
  const double start = tube.closed ? 0 : tube.start + tube.turn / 2 - kTurn / 2;
  chart.along = [ring, start](const Eigen::Vector2d& place) {
    double angle = TubeAngle(ring, place) - start;
    angle -= kTurn * std::floor(angle / kTurn);
    return ring.tube * (angle < kTurn ? angle : 0);
  };
  std::vector<double> lengths;
  for (const auto place : seen.places.colwise()) lengths.push_back(chart.along(place));
  chart.low = *std::min_element(lengths.begin(), lengths.end());
  chart.high = *std::max_element(lengths.begin(), lengths.end());
  chart.way = FindWayRound(cloud.round, seen, lengths, chart.period);
  if (chart.way.winds) return Refused(kSpiral);
  RevolutionParameterization base;
  base.name = "torus";
  base.misfit = ring.misfit;
  AssignParameters(chart, cloud, pool, base);
  base.why = WhyOf(base, chart.way, "a torus");
  return base;
}

}  // namespace batten::internal
