// SPDX-License-Identifier: MIT
// The solid of a machined part: which road a solid takes, and the one over exact faces.
#pragma once

#include <optional>
#include <string>

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
  std::optional<double> volume = std::nullopt;  // of the mesh that it stands for
  double least_noise = 0;                       // of points on the chords of that mesh
};

// Why a solid of another genus is refused.
std::string GenusWords(int genus, int asked);

// Why a solid of this volume does not stand for the mesh; empty where it does, or there is none.
std::string VolumeWords(double volume, const SolidDemands& demands);

// Takes the road over planes, cylinders, cones, spheres and tori; kCad refuses where it ends before
// a solid that meets the demands.
CadOutcome RunCadSolid(const FitArguments& arguments,
                       SolidKind kind,
                       const SolidDemands& demands,
                       FitFiles& files,
                       const PointCloud& cloud);

}  // namespace batten::internal
