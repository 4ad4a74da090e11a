// SPDX-License-Identifier: MIT
#include "batten/fitting/solid_layout.h"

#include <algorithm>
#include <string>

#include "batten/fitting/refused_data.h"
#include "fitting/solid/field_layout.h"
#include "fitting/solid/paired_layout.h"
#include "fitting/solid/surface_projector.h"

namespace batten {
using namespace internal;

QuadMesh LayoutOf(const TriangleSurface& surface, int faces, const Progress& progress) {
  if (faces < 6) throw RefusedData("a layout of fewer than six faces closes nothing");
  const SurfaceProjector projector(surface);
  // Another size of faces falls differently on the shape.
  for (const double finer : {1.0, 1.2, 0.85, 1.5}) {
    try {
      return FieldLayout(surface, projector, faces * finer, progress);
    } catch (const std::invalid_argument&) {
    }
  }
  try {
    return PairedLayout(surface, projector, faces, progress);
  } catch (const std::invalid_argument& fault) {
    throw RefusedData("no layout of quadrilaterals comes out (" + std::string(fault.what()) +
                      "): give one");
  }
}

int LayoutFaces(Eigen::Index points, bool measured) {
  // Vertices of a mesh stand where its shape asks for them, and have less noise than points.
  const Eigen::Index each = measured ? 4 : 6;
  constexpr Eigen::Index kLeast = 60, kMost = 2500;  // beyond, a fit takes more than a minute
  return int(std::clamp(points / each, kLeast, kMost));
}

}  // namespace batten
