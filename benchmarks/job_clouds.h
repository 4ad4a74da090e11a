// SPDX-License-Identifier: MIT
// The clouds of `compare` by name, and how far fits of them are from the truth.
#pragma once

#include <Eigen/Core>
#include <cmath>
#include <stdexcept>
#include <string>

#include "batten/fitting/distances.h"
#include "closed_shapes.h"
#include "known_clouds.h"
#include "known_curves.h"
#include "known_sheets.h"

namespace batten::internal {

// S1: heights of Franke's function, σ = 1e-3; S2: the shell bent by 200°, σ = 1e-3; V: the vase
// with ripples, closed, σ = 1e-3 of its size; C1: the ordered helix, σ = 1e-4; C2: the unordered
// closed flower in the plane, σ = 5e-3.
inline Eigen::Matrix3Xd CloudOfKind(const std::string& kind, Eigen::Index count) {
  constexpr std::uint64_t kSeed = 1;
  if (kind == "S1") return Scatter(Franke, count, 1e-3, 0, kSeed);
  if (kind == "S2") return CloudOn(WavyShell(), {count, 1e-3}, kSeed).points;
  if (kind == "V") {
    const TurnedShape vase = RippledVase();
    return PointsOn(vase, count, 1e-3 * vase.Size(), kSeed).points;
  }
  if (kind == "C1") return CloudAlong(WavyHelix(), {count, 1e-4}, kSeed);
  if (kind == "C2") return CloudAlong(ClosedFlower(), {count, 5e-3, 0, false}, kSeed);
  throw std::invalid_argument("no kind of cloud " + kind + ": S1, S2, V, C1 or C2");
}

// Places of the noise-free surface of a kind.
inline Eigen::Matrix3Xd TruthOfKind(const std::string& kind, Eigen::Index count) {
  if (kind == "S1") return TruthGrid(Franke, 201);
  if (kind == "S2") return PlacesOf(WavyShell(), 141);
  if (kind == "V") {
    const TurnedShape vase = RippledVase();
    return TruthOn(vase, 20000, vase.SpacingOf(count)).points;
  }
  throw std::invalid_argument("no kind of surface " + kind + ": S1, S2 or V");
}

inline KnownCurve CurveOfKind(const std::string& kind) {
  if (kind == "C1") return WavyHelix();
  if (kind == "C2") return ClosedFlower();
  throw std::invalid_argument("no kind of curve " + kind + ": C1 or C2");
}

}  // namespace batten::internal
