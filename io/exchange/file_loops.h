// SPDX-License-Identifier: MIT
// The loops of trimmed surfaces as files hold them: in pieces, not quite closed, turned either way.
// Not installed.
#pragma once

#include <Eigen/Core>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten::internal {

// What a set of loops does wrong.
class LoopError : public std::runtime_error {
 public:
  LoopError(size_t loop, const std::string& rule) : std::runtime_error(rule), loop_(loop) {}
  size_t loop() const { return loop_; }

 private:
  size_t loop_;
};

// How far, as a share of the domain, ends that are meant to meet may be apart in files: in JSON,
// and in those of CAD programs, which work to tolerances in space.
inline constexpr double kFileGap = 1e-6;
inline constexpr double kCadGap = 1e-3;

// The lengths of the domain in u and v.
Eigen::Array2d DomainSides(const NurbsSurface& surface);

// Pieces that follow one another, as one curve: degrees raised to the highest, parameters shifted
// to go on, a knot of multiplicity p at a joint, or as many as its smoothness leaves, to 1e-10 of
// `sides`. `either_way`: pieces that run against the others are turned round. The ends of two
// pieces become the middle of both. Throws std::invalid_argument naming the joint where they are
// farther apart than `largest_gap` of `sides`, or without a piece.
NurbsCurve<2> Chained(std::vector<NurbsCurve<2>> pieces,
                      const Eigen::Array2d& sides,
                      double largest_gap,
                      bool either_way);

// The loop with its end moved onto its beginning where they are within `largest_gap` of `sides`;
// loops that close to kLoopClosure stay as they are. Throws std::invalid_argument naming the gap
// where it is larger.
NurbsCurve<2> Shut(const NurbsCurve<2>& loop, const Eigen::Array2d& sides, double largest_gap);

// The boundary of the domain, counter-clockwise.
NurbsCurve<2> DomainBoundary(const NurbsSurface& surface);

// Whether the largest loop has all others inside.
bool OneHoldsAll(const std::vector<NurbsCurve<2>>& loops);

// What loops are besides the largest: holes in it, or what their nesting says: outer boundaries of
// regions of their own where an even number of loops lies round them, else holes.
enum class LoopRole { kHolesInTheLargest, kByNesting };

// The surface with these loops, each closed to kLoopClosure: the largest first; outer boundaries
// counter-clockwise, holes clockwise; loops that are so already stay bit by bit.
// Those that leave the domain by no more than `largest_gap` of it are moved onto it. Throws
// LoopError for one that leaves it by more or encloses nothing.
NurbsSurface WithTurnedLoops(const NurbsSurface& surface,
                             std::vector<NurbsCurve<2>> loops,
                             double largest_gap,
                             LoopRole role = LoopRole::kHolesInTheLargest);

}  // namespace batten::internal
