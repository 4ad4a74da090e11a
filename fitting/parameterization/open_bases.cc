// SPDX-License-Identifier: MIT
#include "fitting/parameterization/open_bases.h"

#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>

#include "fitting/core/rounding.h"
#include "fitting/core/rules.h"
#include "fitting/flattening/rectangle_base.h"
#include "fitting/parameterization/empty_area_fraction.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kOverlapToRefuse = 0.15;
constexpr double kGentle = std::numbers::pi / 4;  // lengths over the plane change by 41 % at most
constexpr double kManyLengths = 0.03;             // relative change of lengths over a sheet
// Change of lengths over a layout whose edges join turns that touch. Layouts of ramps that only lie
// over themselves have 0.01, of a roll four spacings apart 0.25: closer nodes tell its turns apart.
constexpr double kTorn = 0.1;
constexpr double kMuchEmpty = 0.2, kLittleEmpty = 0.02;  // shares of its rectangle

std::string InLayers(const PlaneBase& plane) {
  return "seen from any side, they lie over each other in " + Percent(plane.overlap) + " of places";
}

std::string Steepness(const PlaneBase& plane) {
  return std::to_string(std::lround(plane.steepness / kOneDegree)) + " degrees";
}

BaseAttempt OverPlane(const BaseInput& input, const PlaneBase& plane) {
  const bool asked = input.options.base == BaseShape::kPlane;
  if (plane.overlap > kOverlapToRefuse) {
    return Failure(InLayers(plane) +
                   (asked ? ": the points are not a height field over a plane" : ""));
  }
  const Eigen::Matrix3Xd local = plane.ToFrame(input.cloud.points());
  BaseAttempt made{{}, PointMask::Constant(input.cloud.size(), true)};
  Parameterization& base = made.base;
  base.name = "plane";
  base.why = asked ? "asked for"
             : plane.lattice
                 ? "the points are heights over a regular lattice, inclined " + Steepness(plane) +
                       " or less"
                 : "the points are a height field, inclined " + Steepness(plane) + " or less";
  base.shape = "a smooth height field";
  base.length_u = plane.length_u;
  base.length_v = plane.length_v;
  base.parameters.resize(2, local.cols());
  base.parameters.row(0) = local.row(0).cwiseMax(0.0).cwiseMin(plane.length_u);
  base.parameters.row(1) = local.row(1).cwiseMax(0.0).cwiseMin(plane.length_v);
  base.plane = plane;
  const bool layers = plane.overlap > kOverlapToWarn;
  if (layers)
    made.warnings.push_back(InLayers(plane) + ": a height field goes between the layers there");
  made.distorted = layers || (!plane.lattice && plane.steepness > kGentle);
  made.certain = !made.distorted && Acts(Rule::kCertainBase);
  return made;
}

BaseAttempt OverSheet(const BaseInput& input,
                      const PlaneBase& plane,
                      const SheetLayout& layout,
                      const InlierSubset& some) {
  if (!layout.found().ok()) {
    BaseAttempt failed = Failure(layout.found().failure_reason);
    failed.one_sided = !layout.found().orientation_consistent;
    return failed;
  }
  FlattenedBase sheet =
      layout.Over(some ? input.inliers()(Eigen::all, *some).eval() : input.inliers());
  Parameterization base;
  base.name = "sheet";
  base.shape = "a smooth sheet";
  base.why = input.options.base == BaseShape::kSheet ? "asked for"
             : plane.overlap > kOverlapToWarn
                 ? InLayers(plane)
                 : "seen from any side, the points are inclined up to " + Steepness(plane) +
                       ", and laid out flat they are predicted better";
  base.parameters = std::move(sheet.parameters);
  base.length_u = sheet.length_u;
  base.length_v = sheet.length_v;
  BaseAttempt made = Attempt(input, some, std::move(base), sheet.reached);
  const double empty =
      EmptyAreaFraction(made.base.parameters, made.reached, made.base.length_u, made.base.length_v);
  made.distorted = sheet.distortion > kManyLengths || empty > kMuchEmpty;
  made.certain = !made.distorted && Acts(Rule::kCertainBase);
  made.ragged = empty > kLittleEmpty;
  return made;
}

BaseAttempt OverRectangle(const BaseInput& input,
                          const RectangleLayout& layout,
                          const InlierSubset& some) {
  if (!layout.ok()) return Failure(layout.failure_reason());
  FlattenedBase rectangle =
      layout.Over(some ? input.inliers()(Eigen::all, *some).eval() : input.inliers());
  Parameterization base;
  base.name = "sheet";
  base.shape = "a smooth sheet with four sides";
  base.why =
      "the points are a sheet with four corners, mapped onto a rectangle without being laid "
      "flat";
  base.parameters = std::move(rectangle.parameters);
  base.length_u = rectangle.length_u;
  base.length_v = rectangle.length_v;
  return Attempt(input, some, std::move(base), rectangle.reached);
}

}  // namespace

bool SidesAreFree(const SurfaceFitOptions& options) {
  return options.boundary.empty() && !options.meet && !options.domain && !options.symmetric;
}

BaseMethod PlaneCandidate(const BaseInput& input, const PlaneBase& plane) {
  return {"plane", [&input, &plane](const InlierSubset&) { return OverPlane(input, plane); }};
}

SheetLayout& SheetFlattening::layout() {
  if (!layout_) {
    layout_.emplace(input_.inliers(),
                    input_.index(),
                    input_.statistics.spacing,
                    input_.statistics.noise,
                    input_.margin(),
                    input_.pool,
                    input_.options.progress);
  }
  return *layout_;
}

std::vector<BaseMethod> SheetCandidates(const BaseInput& input,
                                        const PlaneBase& plane,
                                        std::shared_ptr<SheetFlattening> flattening) {
  // Looks closer first where the first attempt changes lengths by more than `distortion`.
  const auto closer_beyond = [&](std::optional<double> distortion, bool last_resort) -> BaseMethod {
    return {.name = "sheet",
            .make =
                [&input, &plane, flattening, distortion](const InlierSubset& some) {
                  SheetLayout& layout = flattening->layout();
                  if (distortion && !(layout.found().distortion <= *distortion))
                    layout.LookCloser();
                  return OverSheet(input, plane, layout, some);
                },
            .smooth = true,
            .last_resort = last_resort};
  };
  return {closer_beyond(std::nullopt, false), closer_beyond(kTorn, true), closer_beyond(-1, true)};
}

BaseMethod RectangleCandidate(const BaseInput& input) {
  const auto layout = std::make_shared<std::optional<RectangleLayout>>();
  return {.name = "rectangle",
          .make =
              [&input, layout](const InlierSubset& some) {
                if (!*layout) {
                  layout->emplace(input.inliers(),
                                  input.index(),
                                  input.statistics.noise,
                                  input.margin(),
                                  input.pool);
                }
                return OverRectangle(input, **layout, some);
              },
          .smooth = true,
          .last_resort = true,
          .straightens = SidesAreFree(input.options)};
}

}  // namespace batten::internal
