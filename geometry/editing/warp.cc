// SPDX-License-Identifier: MIT
#include "batten/geometry/warp.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <vector>

#include "batten/geometry/insert_knots.h"
#include "geometry/editing/control_forms.h"
#include "geometry/editing/region_knots.h"
#include "geometry/numeric/reject.h"

namespace batten {
using namespace internal;
namespace {

double Height(WarpShape shape, double share) {
  if (share < 0) return 0;
  const double x = 1 - std::abs(2 * share - 1);  // 0 at the ends, 1 in the middle
  if (shape == WarpShape::kTent) return x;
  if (shape == WarpShape::kBump) return x < 0.5 ? 2 * x * x * x : 1 - 6 * (1 - x) * (1 - x) * x;
  const double t = std::min(1.0, 1.5 * x);
  return t * t * t * (10 + t * (6 * t - 15));
}

void CheckWarp(const WarpOptions& options, bool finite) {
  constexpr int kFewest = 4, kMost = 1000;
  if (!finite) Reject("Warped", "by is not finite");
  if (options.spans < kFewest || options.spans > kMost) {
    Reject("Warped",
           "spans = " + std::to_string(options.spans) + " is not between " +
               std::to_string(kFewest) + " and " + std::to_string(kMost));
  }
}

// Heights at every distinct control point; ones where no range is given.
std::vector<double> Heights(const SplineBasis& basis,
                            const std::optional<ParameterRange>& range,
                            WarpShape shape) {
  if (!range) return std::vector<double>(static_cast<size_t>(DistinctPoints(basis)), 1);
  std::vector<double> heights = SharesInside(basis, *range);
  for (double& height : heights) height = Height(shape, height);
  return heights;
}

double Middle(const SplineBasis& basis, const std::optional<ParameterRange>& range) {
  return range ? range->from + (range->to - range->from) / 2
               : basis.lower() + (basis.upper() - basis.lower()) / 2;
}

std::vector<double> WarpKnots(const SplineBasis& basis,
                              const ParameterRange& range,
                              const std::string& name,
                              int spans) {
  CheckRange(basis, range, "Warped", name);
  // Fewer would leave no function inside, or one only.
  return LackingKnots(basis,
                      EvenPlaces(range, std::max(spans, 2 * (basis.degree() + 1))),
                      range.to - range.from,
                      basis.periodic());
}

// heights · by, scaled so that the form, that of the region's middle, gives `by`.
Eigen::MatrixXd Moves(const Eigen::VectorXd& heights,
                      const ControlForm& middle,
                      const Eigen::VectorXd& by) {
  double there = 0;
  for (size_t k = 0; k < middle.index.size(); ++k)
    there += middle.values[static_cast<Eigen::Index>(k)] * heights[middle.index[k]];
  return by * (heights / there).transpose();
}

}  // namespace

template <int Dim>
NurbsCurve<Dim> Warped(const NurbsCurve<Dim>& curve,
                       const ParameterRange& range,
                       const Eigen::Matrix<double, Dim, 1>& by,
                       const WarpOptions& options) {
  CheckWarp(options, by.allFinite());
  const NurbsCurve<Dim> finer =
      RefineKnots(curve, WarpKnots(curve.basis(), range, "u", options.spans));
  const std::vector<double> heights = Heights(finer.basis(), range, options.shape);
  return WithMoves(finer,
                   Moves(Eigen::Map<const Eigen::VectorXd>(heights.data(), std::ssize(heights)),
                         DerivativeForm(finer, Middle(finer.basis(), range)),
                         by));
}

NurbsSurface Warped(const NurbsSurface& surface,
                    const ParameterRegion& region,
                    const Eigen::Vector3d& by,
                    const WarpOptions& options) {
  CheckWarp(options, by.allFinite());
  if (!region.u && !region.v) Reject("Warped", "no range of the region is given");
  NurbsSurface finer = surface;
  if (region.u) {
    finer = RefineKnots(
        finer, Direction::kU, WarpKnots(surface.basis_u(), *region.u, "u", options.spans));
  }
  if (region.v) {
    finer = RefineKnots(
        finer, Direction::kV, WarpKnots(surface.basis_v(), *region.v, "v", options.spans));
  }
  const std::vector<double> along_u = Heights(finer.basis_u(), region.u, options.shape);
  const std::vector<double> along_v = Heights(finer.basis_v(), region.v, options.shape);
  Eigen::VectorXd heights(DistinctPoints(finer));
  Eigen::Index k = 0;
  for (const double a : along_u) {
    for (const double b : along_v) heights[k++] = a * b;
  }
  return WithMoves(
      finer,
      Moves(heights,
            DerivativeForm(
                finer, Middle(finer.basis_u(), region.u), Middle(finer.basis_v(), region.v)),
            by));
}

template NurbsCurve<2> Warped(const NurbsCurve<2>&,
                              const ParameterRange&,
                              const Eigen::Vector2d&,
                              const WarpOptions&);
template NurbsCurve<3> Warped(const NurbsCurve<3>&,
                              const ParameterRange&,
                              const Eigen::Vector3d&,
                              const WarpOptions&);

}  // namespace batten
