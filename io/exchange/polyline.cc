// SPDX-License-Identifier: MIT
#include "io/exchange/polyline.h"

#include <Eigen/Geometry>

#include "geometry/numeric/polygon.h"

namespace batten::internal {
namespace {

struct Place {
  double parameter;
  Eigen::Vector3d point;
};

class SpatialSort {
 public:
  SpatialSort(const std::function<Eigen::Vector3d(double)>& map, double tolerance)
      : map_(map), tolerance_(tolerance) {}

  Place At(double parameter) const { return {parameter, map_(parameter)}; }

  // Everything after `a`, up to `b` and with it.
  void Append(const Place& a, const Place& b, int depth, std::vector<double>& result) const {
    constexpr int kDeepest = 12;
    constexpr double kHalf = 0.5;
    constexpr double kBeside[] = {0.23, 0.77};  // not where waves have their zeros
    const Place middle = At(a.parameter + kHalf * (b.parameter - a.parameter));
    const bool ends =
        depth >= kDeepest || !(a.parameter < middle.parameter) || !(middle.parameter < b.parameter);
    bool near = DistanceFromSegment(middle.point, a.point, b.point) <= tolerance_;
    for (const double share : kBeside) {
      if (!near || ends) break;
      near = DistanceFromSegment(map_(a.parameter + share * (b.parameter - a.parameter)),
                                 a.point,
                                 b.point) <= tolerance_;
    }
    if (near || ends) {
      result.push_back(b.parameter);
      return;
    }
    Append(a, middle, depth + 1, result);
    Append(middle, b, depth + 1, result);
  }

 private:
  const std::function<Eigen::Vector3d(double)>& map_;
  double tolerance_;
};

}  // namespace

std::vector<double> PolylineParameters(const std::function<Eigen::Vector3d(double)>& map,
                                       std::span<const double> breaks,
                                       double chord_tolerance,
                                       int pieces) {
  const SpatialSort halving(map, chord_tolerance);
  std::vector<double> result{breaks.front()};
  Place last = halving.At(breaks.front());
  for (std::size_t k = 1; k < breaks.size(); ++k) {
    const double from = breaks[k - 1], to = breaks[k];
    for (int piece = 1; piece <= pieces; ++piece) {
      const Place next =
          halving.At(piece == pieces ? to : from + (to - from) * (double(piece) / pieces));
      if (!(last.parameter < next.parameter)) continue;
      halving.Append(last, next, 0, result);
      last = next;
    }
  }
  return result;
}

std::vector<double> KnotBreaks(const SplineBasis& basis) {
  std::vector<double> breaks{basis.lower()};
  for (const double knot : basis.knots()) {
    if (knot > breaks.back() && knot < basis.upper()) breaks.push_back(knot);
  }
  breaks.push_back(basis.upper());
  return breaks;
}

}  // namespace batten::internal
