// SPDX-License-Identifier: MIT
// Options and result of taking a scan of a part to pieces: its faces and what they have in common.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/fit_report.h"
#include "batten/fitting/progress.h"
#include "batten/fitting/trimmed_solid.h"
#include "batten/geometry/classify_shape.h"
#include "batten/geometry/exact_shape.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

struct PartFitOptions {
  // Distance in the data's units, > 0, within which points are of one face; absent: what noise
  // explains, 3.5 standard deviations. Judged too.
  std::optional<double> tolerance = std::nullopt;
  // Fit the faces together under the relations that are found.
  bool regularise = false;
  // Fit free surfaces to smooth regions that no plane, sphere, cylinder, cone or torus explains.
  bool free_form = true;
  // Make a solid of the faces too.
  bool solid = false;
  // Of the area of a solid that is made, the greatest share without points near, in [0, 1].
  double most_invented = 0.15;
  // How far the points may be from the body besides their noise, such as those on the chords of a
  // mesh: at least this is taken for their standard deviation. >= 0
  double least_noise = 0;
  Eigen::Vector3d shift = Eigen::Vector3d::Zero();  // subtracted from the coordinates of the result
  std::uint64_t seed = 1;                           // of samples for spacing and noise
  int threads = 0;                                  // 0: all cores
  Progress progress = nullptr;
};

// Throws std::invalid_argument naming the field whose value breaks its rule.
void Check(const PartFitOptions& options);

// A face of a part: a region of its points that one shape explains.
struct FaceSummary {
  std::string kind;         // "plane", "sphere", "cylinder", "cone", "torus" or "free"
  Eigen::Index points = 0;  // of the face
  double rms = 0, max = 0;  // their distances from it
  std::optional<PrimitiveSummary> primitive = std::nullopt;  // absent where free
  std::vector<int> touching = {};                            // faces that have a border with it
};

// What two faces or more have in common as far as their standard deviations tell.
struct RelationSummary {
  std::string kind;        // "parallel", "perpendicular", "coaxial", "coplanar", "equal radius",
                           // "tangent"
  std::vector<int> faces;  // indices
  double deviation = 0;    // by which the faces, each by itself, miss it; radians or lengths
  double allowed = 0;      // the greatest that chance explains, in the same unit
  bool kept = false;       // the faces as returned have it exactly
};

// What is known of the faces of a part, in their order.
struct PartSummary {
  std::vector<FaceSummary> faces;
  std::vector<RelationSummary> relations;
};

// One face, in world coordinates less options.shift.
struct PartFace {
  SurfaceShape shape;                                // FreeForm where it is none
  std::optional<ExactSurface> patch = std::nullopt;  // the part of the shape that the points cover
  NurbsSurface surface;                              // the same, or a free surface, trimmed
};

struct PartsFit {
  std::vector<PartFace> faces;  // by falling number of points
  PartSummary summary;
  std::vector<int> labels;      // of every point, its face; −1: of none
  Eigen::VectorXd residuals;    // of every point, signed along the normal of its face; of points of
                                // no face the distance from the nearest
  Eigen::Matrix2Xd parameters;  // of its foot
  std::vector<int> owners;      // the face that this is on
  std::optional<TrimmedSolid> solid;  // of all faces, where it was asked for and they close
  int bodies = 0, genus = 0;          // of the solid; handles of all bodies together
  double invented = 0;                // of its area, the share without points near
  std::string no_solid;               // why not, a sentence without a full stop
  FitReport report;
};

}  // namespace batten
