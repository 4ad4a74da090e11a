// SPDX-License-Identifier: MIT
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

#include "batten/fitting/uncertainty.h"
#include "batten/geometry/trim_region.h"
#include "fitting/core/rounding.h"

namespace batten {
namespace {

constexpr int kPerSpan = 3, kFewest = 24, kMostOfSurface = 160, kMostOfCurve = 2000;

// Middles of equal parts of the domain, some in every knot span.
std::vector<double> Middles(const SplineBasis& basis, int most) {
  const int count = std::clamp(kPerSpan * static_cast<int>(basis.Spans().size()), kFewest, most);
  std::vector<double> middles;
  for (int k = 0; k < count; ++k)
    middles.push_back(basis.lower() + (k + 0.5) / count * (basis.upper() - basis.lower()));
  return middles;
}

double Step(const SplineBasis& basis, const std::vector<double>& middles) {
  return (basis.upper() - basis.lower()) / static_cast<double>(middles.size());
}

}  // namespace

UncertaintyMap MapUncertainty(const Uncertainty& of, const NurbsSurface& surface) {
  UncertaintyMap map;
  map.u = Middles(surface.basis_u(), kMostOfSurface);
  map.v = Middles(surface.basis_v(), kMostOfSurface);
  const double cell = Step(surface.basis_u(), map.u) * Step(surface.basis_v(), map.v);
  std::optional<TrimRegion> region;
  if (surface.trimmed()) region.emplace(surface);
  const auto rows = static_cast<Eigen::Index>(map.v.size());
  Eigen::Matrix2Xd places(2, static_cast<Eigen::Index>(map.u.size()) * rows);
  map.areas = Eigen::VectorXd::Zero(places.cols());
  for (Eigen::Index k = 0; k < places.cols(); ++k) {
    places.col(k) << map.u[static_cast<size_t>(k / rows)], map.v[static_cast<size_t>(k % rows)];
    if (region && !region->Contains(places(0, k), places(1, k))) continue;
    const SurfaceJet jet = surface.JetAt(places(0, k), places(1, k));
    map.areas[k] = jet.du.cross(jet.dv).norm() * cell;
  }
  map.places = of.At(places);
  for (Eigen::Index k = 0; k < places.cols(); ++k) {
    if (!(map.areas[k] > 0))
      map.places[static_cast<size_t>(k)] = {internal::kNone, internal::kNone, internal::kNone};
  }
  return map;
}

template <int Dim>
UncertaintyMap MapUncertainty(const Uncertainty& of, const NurbsCurve<Dim>& curve) {
  UncertaintyMap map;
  map.u = Middles(curve.basis(), kMostOfCurve);
  map.v = {0};
  Eigen::Matrix2Xd places = Eigen::Matrix2Xd::Zero(2, static_cast<Eigen::Index>(map.u.size()));
  map.areas.resize(places.cols());
  for (Eigen::Index k = 0; k < places.cols(); ++k) {
    places(0, k) = map.u[static_cast<size_t>(k)];
    map.areas[k] = curve.Derivatives(places(0, k), 1).col(1).norm() * Step(curve.basis(), map.u);
  }
  map.places = of.At(places);
  return map;
}

template UncertaintyMap MapUncertainty(const Uncertainty&, const NurbsCurve<2>&);
template UncertaintyMap MapUncertainty(const Uncertainty&, const NurbsCurve<3>&);

UncertaintySummary UncertaintyMap::Summary(const Uncertainty& of) const {
  UncertaintySummary summary;
  summary.known = true;
  summary.noise = of.noise();
  summary.inflation = of.inflation();
  summary.freedom = of.freedom();
  std::vector<std::pair<double, double>> supported;  // deviation and area
  double area = 0;
  for (size_t k = 0; k < places.size(); ++k) {
    const double own = areas[static_cast<Eigen::Index>(k)];
    if (!(own > 0)) continue;
    area += own;
    if (places[k].support < kLeastSupport) {
      summary.unsupported_area += own;
      continue;
    }
    supported.emplace_back(places[k].deviation, own);
    summary.sigma_max = std::max(summary.sigma_max, places[k].deviation);
    summary.bias_max = std::max(summary.bias_max, std::abs(places[k].bias));
  }
  summary.unsupported_share = area > 0 ? summary.unsupported_area / area : 0;
  std::sort(supported.begin(), supported.end());
  double left = (area - summary.unsupported_area) / 2;
  for (const auto& [deviation, own] : supported) {
    summary.sigma_median = deviation;
    if ((left -= own) <= 0) break;
  }
  summary.note =
      "one standard deviation along the normal, by the noise of the points alone; not in it: bias "
      "by fairness (bias_max), shape the spline does not follow, and the choice of its freedom";
  if (summary.inflation > 1)
    summary.note += "; neighbouring points share noise, for which variances were raised";
  return summary;
}

}  // namespace batten
