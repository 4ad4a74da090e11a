// SPDX-License-Identifier: MIT
#include "batten/fitting/fit_solid.h"

#include "fitting/solid/solid_fitter.h"

namespace batten {

SolidFit FitSolid(const PointCloud& cloud, const QuadMesh& layout, const SolidFitOptions& options) {
  return internal::SolidFitter(cloud, layout, options).Refined();
}

}  // namespace batten
