// SPDX-License-Identifier: MIT
#include "fitting/surface/base_borders.h"

#include "fitting/core/mask_indices.h"
#include "fitting/outline/outline_in_box.h"

namespace batten::internal {
namespace {

constexpr double kBeside = 1.5;  // spacings from the edge, which is one beyond the outermost points

}  // namespace

bool FillBase(const PreparedCloud& prepared, const PointMask& used, ThreadPool& pool) {
  const Parameterization& base = prepared.base;
  if (base.poles.any()) return false;
  const std::vector<Eigen::Index> kept = IndicesOf(used && prepared.reached);
  OutlineOptions options;
  options.spacing = prepared.statistics.spacing;
  options.noise = prepared.statistics.noise;
  options.periodic_u = base.periodic_u;
  options.periodic_v = base.periodic_v;
  options.length_u = base.length_u;
  options.length_v = base.length_v;
  return FillTheirBox(base.parameters(Eigen::all, kept), options, pool);
}

std::vector<std::uint8_t> BesideBorders(const PreparedCloud& prepared, const PointMask& used) {
  const Parameterization& base = prepared.base;
  const double near = kBeside * prepared.statistics.spacing;
  const auto beside = [near](double at, double length) { return at < near || at > length - near; };
  std::vector<std::uint8_t> sides;
  for (Eigen::Index k = 0; k < used.size(); ++k) {
    if (!used[k]) continue;
    const bool u = !base.periodic_u && beside(base.parameters(0, k), base.length_u);
    const bool v = !base.periodic_v && beside(base.parameters(1, k), base.length_v);
    sides.push_back(static_cast<std::uint8_t>((u ? 1 : 0) + (v ? 2 : 0)));
  }
  return sides;
}

}  // namespace batten::internal
