// SPDX-License-Identifier: MIT
#include "fitting/outline/outline_in_box.h"

#include <utility>

namespace batten::internal {
namespace {

// Spacings: an outline lies 0.43 outside the border of its points, but along a straight edge of the
// shape the outermost points lie on it.
constexpr double kWiden = 0.25;

struct InBox {
  Eigen::Matrix2Xd parameters;
  OutlineOptions options;
  Eigen::Vector2d low;
};

InBox MovedIntoBox(Eigen::Matrix2Xd parameters, OutlineOptions options) {
  const double widen = kWiden * options.spacing;
  Eigen::Vector2d low = (parameters.rowwise().minCoeff().array() - widen).max(0.0);
  Eigen::Vector2d high = parameters.rowwise().maxCoeff().array() + widen;
  high = high.cwiseMin(Eigen::Vector2d(options.length_u, options.length_v));
  high = high.cwiseMax((low.array() + options.spacing).matrix());
  if (options.periodic_u) {
    low[0] = 0;
    high[0] = options.length_u;
  }
  if (options.periodic_v || options.pole_start) low[1] = 0;
  if (options.periodic_v || options.pole_end) high[1] = options.length_v;
  parameters.colwise() -= low;
  options.length_u = high[0] - low[0];
  options.length_v = high[1] - low[1];
  if (options.stretch_u) {
    options.stretch_u = [whole = std::move(options.stretch_u), shift = low[1]](double v) {
      return whole(v + shift);
    };
  }
  if (options.place) {
    options.place = [whole = std::move(options.place), low](const Eigen::Vector2d& at) {
      return whole(at + low);
    };
  }
  return {std::move(parameters), std::move(options), low};
}

}  // namespace

Outline FindOutlineInBox(Eigen::Matrix2Xd parameters, OutlineOptions options, ThreadPool& pool) {
  const InBox box = MovedIntoBox(std::move(parameters), std::move(options));
  Outline outline = FindOutline(box.parameters, box.options, pool);
  for (OutlineCurve& curve : outline.loops) {
    Eigen::Matrix2Xd points = curve.loop.control_points().colwise() + box.low;
    curve.loop = NurbsCurve<2>(curve.loop.basis(), std::move(points), curve.loop.weights());
  }
  return outline;
}

bool FillTheirBox(Eigen::Matrix2Xd parameters, OutlineOptions options, ThreadPool& pool) {
  const InBox box = MovedIntoBox(std::move(parameters), std::move(options));
  return FillTheirRectangle(box.parameters, box.options, pool);
}

}  // namespace batten::internal
