// SPDX-License-Identifier: MIT
// Takes the scan of a machined part to pieces: planes, spheres, cylinders, cones, tori, free
// surfaces.
#pragma once

#include "batten/fitting/part_options.h"
#include "batten/fitting/point_cloud.h"

namespace batten {

// Finds the faces of a part. Regions grow from the points whose neighbours' normals agree best;
// each is of the first of plane, sphere, cylinder, cone and torus that its points do not reject:
// robust rms at most 1.15 times the noise, and no trend among neighbouring distances. Regions
// compete for the points at their borders, and those that touch and that one shape explains become
// one. Where the faces found are nearer to their points than the noise that was estimated, all is
// done again at that noise. Parameters and standard deviations are those of FitPrimitive over
// points that are for certain of the face: those at a border where two shapes cannot be told apart
// do not count. Smooth regions of no shape get free surfaces (FitSurface). Points of fewer than 30
// together, or off all that is near, are of no face. [Besl & Jain 1988; Cohen-Steiner, Alliez &
// Desbrun 2004]
//
// With `regularise` faces are fitted together under the relations that their standard deviations
// allow; see the relations of the summary.
//
// Normals are the cloud's where it has them. The result does not depend on the number of threads.
// Throws RefusedData, with a sentence for the user, where there are fewer than 30 points or no face
// is found; Cancelled when progress stops it. O(m log m).
PartsFit FitParts(const PointCloud& cloud, const PartFitOptions& options = {});

}  // namespace batten
