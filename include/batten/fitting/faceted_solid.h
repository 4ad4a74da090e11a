// SPDX-License-Identifier: MIT
// A closed mesh as it is: a solid of plane faces.
#pragma once

#include <optional>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/trimmed_solid.h"
#include "batten/geometry/triangle_surface.h"

namespace batten {

struct FacetedMesh {
  TrimmedSolid solid;
  std::vector<int> faces;  // that each triangle is of
};

// The solid whose faces are the planes of the mesh: triangles that hang together and whose corners
// lie within `flat` of one plane become a face, and collinear edges between the same two faces an
// edge. Vertices stay where they are, so its volume is that of the mesh to `flat` times its area.
// O(n log n). Precondition: the mesh is closed and turned outwards, as CloseSurface makes it;
// throws RefusedData where an edge does not belong to two triangles that run along it in opposite
// directions.
FacetedMesh FacetedSolid(const TriangleSurface& closed, double flat);

// What coordinates in single precision leave open, as most mesh files hold them: four units in the
// last place of the largest one.
double SinglePrecisionOf(const Eigen::Matrix3Xd& vertices);

// The volume that a closed mesh encloses, positive where it is turned outwards, and how far that of
// the body it stands for may be from it: two thousandths, or what its chords leave open, their
// height over all its area.
struct MeshVolume {
  double volume = 0, margin = 0;
};
MeshVolume VolumeOf(const TriangleSurface& closed);

// Why a solid of this volume does not stand for the mesh; none where it does.
std::optional<Doubt> VolumeDoubt(double volume, const MeshVolume& mesh);

}  // namespace batten
