// SPDX-License-Identifier: MIT
#include "fitting/surface/surface_folds.h"

#include <vector>

#include "batten/geometry/surface_evaluator.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten::internal {
namespace {

constexpr int kPlacesOfSpan = 8;

}  // namespace

int FoldedPairs(const NurbsSurface& surface) {
  const std::vector<double> us = BreaksIn(surface.basis_u(), kPlacesOfSpan),
                            vs = BreaksIn(surface.basis_v(), kPlacesOfSpan);
  SurfaceGrid grid;
  SurfaceEvaluator(surface).Grid(us, vs, grid);
  const auto normal = [&](size_t i, size_t j) {
    return grid.normals.col(static_cast<Eigen::Index>(i * vs.size() + j));
  };
  int folded = 0;
  for (size_t i = 0; i < us.size(); ++i) {
    for (size_t j = 0; j < vs.size(); ++j) {
      const auto here = normal(i, j);
      if (i + 1 < us.size() && here.dot(normal(i + 1, j)) < 0) ++folded;
      if (j + 1 < vs.size() && here.dot(normal(i, j + 1)) < 0) ++folded;
    }
  }
  return folded;
}

}  // namespace batten::internal
