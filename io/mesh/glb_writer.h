// SPDX-License-Identifier: MIT
// Triangle meshes as glTF 2.0 in one binary file, what viewers and browsers read. Internal to io.
#pragma once

#include <string>
#include <vector>

#include "batten/io/atomic_file.h"
#include "batten/io/deviation_colours.h"
#include "batten/io/surface_mesh.h"

namespace batten::internal {

// One surface of a scene: its mesh, its name, and a colour for each vertex or none at all.
struct GlbSurface {
  const SurfaceMesh& surface;
  std::string name;
  RgbColumns colours;
};

// A node for each surface under one that turns z up into glTF's y up and units into metres. The
// node of a surface moves it to the middle of its box, about which positions are floats: they are
// right to 1e-7 of its size wherever the origin is. NORMAL, TEXCOORD_0 (parameters, the domain as
// [0, 1]²), COLOR_0 where there are colours (linear, 16 bits, as glTF wants them), indices of 16 or
// 32 bits. Vertices on a seam or a crease stand once for each side. One material, seen from both
// sides. Throws UsageError beyond 4 GB, which is all a GLB can hold.
// [Khronos: glTF 2.0 specification, §3.6–3.9, §4.4]
void WriteGlb(const std::vector<GlbSurface>& surfaces, double metres, AtomicFile& file);

}  // namespace batten::internal
