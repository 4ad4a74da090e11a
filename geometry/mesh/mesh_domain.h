// SPDX-License-Identifier: MIT
// A surface's domain as a lattice of whole numbers, and its border. Internal to geometry.
#pragma once

#include <Eigen/Core>
#include <cstdint>
#include <vector>

#include "batten/geometry/closure.h"
#include "batten/geometry/nurbs_surface.h"
#include "geometry/numeric/constrained_delaunay.h"

namespace batten::internal {

// Parameters as whole numbers: [0, width] × [0, height] is the domain, the longer side in space
// ConstrainedDelaunay::kReach, the other about in proportion.
class MeshDomain {
 public:
  explicit MeshDomain(const NurbsSurface& surface);

  std::int64_t width() const { return width_; }
  std::int64_t height() const { return height_; }
  bool closed_u() const { return closed_u_; }
  bool closed_v() const { return closed_v_; }

  LatticePoint Snap(const Eigen::Vector2d& parameter) const;
  // Ends of the domain and lines exactly.
  Eigen::Vector2d ParameterOf(const LatticePoint& point) const;

  bool OnBorder(const LatticePoint& point) const;
  // The point on the border where it is that many steps from it or fewer, else as it is.
  LatticePoint OntoBorder(LatticePoint point, std::int64_t within) const;
  // The points of the other sides of the seams that are the same point of the surface.
  std::vector<LatticePoint> Mirrored(const LatticePoint& point) const;
  // One point for all that are the same point of the surface by seams and poles.
  LatticePoint Canonical(LatticePoint point) const;

  // Lines u = const and v = const through the first vertices: the knots, with more lines between
  // them for high degrees and closed directions. Increasing, from 0 to width or height.
  const std::vector<std::int64_t>& lines_u() const { return lines_u_; }
  const std::vector<std::int64_t>& lines_v() const { return lines_v_; }
  // Those inside the domain where the surface may have a crease.
  const std::vector<std::int64_t>& creases_u() const { return creases_u_; }
  const std::vector<std::int64_t>& creases_v() const { return creases_v_; }

 private:
  Eigen::Vector2d lower_, upper_;
  std::int64_t width_, height_;
  bool closed_u_, closed_v_;
  CollapsedEdgeSet poles_;
  std::vector<std::int64_t> lines_u_, lines_v_, creases_u_, creases_v_;
  std::vector<double> values_u_, values_v_;  // of the lines
};

}  // namespace batten::internal
