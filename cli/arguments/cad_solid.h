// SPDX-License-Identifier: MIT
// The solid of a machined part: which road a solid takes, and the one over exact faces.
#pragma once

#include <optional>
#include <string>

#include "batten/fitting/faceted_solid.h"
#include "cli/arguments/fit_arguments.h"

namespace batten::internal {

enum class SolidKind { kAuto, kCad, kOrganic, kFaceted };

SolidKind ToSolidKind(const std::string& word);

struct CadOutcome {
  std::optional<int> code;  // the exit code; none: nothing is written
  std::string reason;       // why kAuto has to take the other road
};

// What a solid has to be, on either road.
struct SolidDemands {
  double most_invented = 0.15;  // of its area, the share without points near
  std::optional<int> genus = std::nullopt;
  std::optional<MeshVolume> volume = std::nullopt;  // of the mesh that it stands for
  double least_noise = 0;                           // of points on the chords of that mesh
};

// Why a solid of another genus is refused.
std::string GenusWords(int genus, int asked);

// "a watertight solid of 6 faces, 12 edges; volume …": what a written solid has.
std::string CensusWords(const SolidCensus& census, const char* faces);

// Takes the road over planes, cylinders, cones, spheres and tori; kCad refuses where it ends before
// a solid that meets the demands.
CadOutcome RunCadSolid(const FitArguments& arguments,
                       SolidKind kind,
                       const SolidDemands& demands,
                       FitFiles& files,
                       const PointCloud& cloud);

}  // namespace batten::internal
