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
  // Faces of one size meet the points as well as any. Where that leaves too few of them on thin
  // parts, smaller ones there may do, or another size that falls differently on the shape.
  struct Attempt {
    double finer;
    bool by_curvature;
  };
  for (const auto& [finer, by_curvature] :
       {Attempt{1, false}, Attempt{1, true}, Attempt{1.2, false}, Attempt{1.5, true}}) {
    try {
      return FieldLayout(surface, projector, faces * finer, by_curvature, progress);
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

int LayoutFaces(Eigen::Index points) {
  constexpr Eigen::Index kEach = 5, kLeast = 60, kMost = 2500;
  return int(std::clamp(points / kEach, kLeast, kMost));
}

}  // namespace batten
