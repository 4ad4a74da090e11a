// SPDX-License-Identifier: MIT
// Numbers of IGES entity types. Not installed. [IGES 5.3, §4]
#pragma once

namespace batten::internal {

// Those of single curves are in iges_shapes.h.
enum { kIgesComposite = 102, kIgesPoint = 116, kIgesMatrix = 124, kIgesSurface = 128 };
enum { kIgesPlane = 108 };
enum { kIgesRuled = 118, kIgesRevolution = 120, kIgesTabulated = 122 };
enum {
  kIgesInstance = 408,
  kIgesRectangularArray = 412,
  kIgesCircularArray = 414,
  kIgesExternal = 416,
  kIgesNetworkInstance = 420
};
enum {
  kIgesAssembly = 184,
  kIgesSolid = 186,
  kIgesSolidInstance = 430,
  kIgesVertices = 502,
  kIgesEdges = 504,
  kIgesEdgeLoop = 508,
  kIgesFace = 510,
  kIgesShell = 514
};
enum {
  kIgesBoundary = 141,
  kIgesCurveOnSurface = 142,
  kIgesBounded = 143,
  kIgesTrimmedSurface = 144
};

}  // namespace batten::internal
