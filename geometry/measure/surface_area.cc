// SPDX-License-Identifier: MIT
#include "batten/geometry/surface_area.h"

#include "geometry/measure/trimmed_area.h"
#include "geometry/measure/untrimmed_area.h"

namespace batten {
using namespace internal;

double Area(const NurbsSurface& surface) {
  const SplineBasis &u = surface.basis_u(), &v = surface.basis_v();
  return Area(surface, u.lower(), u.upper(), v.lower(), v.upper());
}

double Area(const NurbsSurface& surface, double u0, double u1, double v0, double v1) {
  if (!surface.trimmed()) return UntrimmedArea(surface, u0, u1, v0, v1);
  double sum = 0;
  for (const DomainStretch& u : StretchesInDomain(surface.basis_u(), u0, u1, "u")) {
    for (const DomainStretch& v : StretchesInDomain(surface.basis_v(), v0, v1, "v")) {
      sum += TrimmedArea(surface, {u.low, u.high, v.low, v.high});
    }
  }
  return sum;
}

}  // namespace batten
