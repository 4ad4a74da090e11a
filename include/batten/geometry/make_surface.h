// SPDX-License-Identifier: MIT
// Planes, cylinders, cones, spheres, tori and surfaces of revolution as exact NURBS.
#pragma once

#include <Eigen/Core>
#include <numbers>

#include "batten/geometry/frame.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"

namespace batten {

// Domains are [0, 1]. Round shapes: u goes round the axis as MakeArc does, v along the profile, and
// S_u × S_v looks outward. All round, the edges u = 0 and u = 1 coincide bit by bit; so do v = 0
// and v = 1 of a whole torus. Poles and tips are collapsed edges: all their control points are one
// point of the axis. Functions throw std::invalid_argument naming the value that breaks a rule.
// [Piegl & Tiller 1997, §8.3–8.5]
//
// Rounding, as NurbsSurface gives points: within 4 units in the last place of the radius of spheres
// and cylinders, of the largest distance from the axis of cones and tori, and 2 more of the largest
// coordinate where the centre is not the origin or the axis not a coordinate axis; twice that as
// SurfaceEvaluator gives them.

// S(0,0), S(1,0), S(0,1), S(1,1) are the corners; the rest is bilinear between them.
NurbsSurface MakeBilinear(const Eigen::Vector3d& p00,
                          const Eigen::Vector3d& p10,
                          const Eigen::Vector3d& p01,
                          const Eigen::Vector3d& p11);

// The rectangle of the frame's x-y plane, u along x; its normal is the axis. Intervals increase.
NurbsSurface MakePlane(const Frame& frame, const Interval& x, const Interval& y);

// radius > 0; the heights are places on the axis, from the origin; they increase.
NurbsSurface MakeCylinder(const Frame& frame,
                          double radius,
                          const Interval& height,
                          const AngleRange& angles = {});

// A cone between two circles: radius_lower at height.lower, radius_upper at height.upper. Either
// may be 0, a tip, and not both; equal ones make a cylinder.
NurbsSurface MakeCone(const Frame& frame,
                      double radius_lower,
                      double radius_upper,
                      const Interval& height,
                      const AngleRange& angles = {});

inline constexpr Interval kAllLatitudes{-std::numbers::pi / 2, std::numbers::pi / 2};

// Latitudes in [−π/2, π/2], increasing; those within 1e-12 of ±π/2 are the poles.
NurbsSurface MakeSphere(const Frame& frame,
                        double radius,
                        const AngleRange& longitude = {},
                        const Interval& latitude = kAllLatitudes);

// The tube, a circle of radius `minor` > 0 about the circle of radius `major` > 0. Tube angles
// count from the outermost point towards the axis' direction. minor > major makes a spindle, which
// goes through itself where the tube angles reach the axis.
NurbsSurface MakeTorus(const Frame& frame,
                       double major,
                       double minor,
                       const AngleRange& round = {},
                       const AngleRange& tube = {});

// The curve turned about the frame's axis: S(u,v) is C(v) turned by angles.start + u·sweep; the
// frame's x does not matter. Basis and weights in v are the curve's, periodic ones too. Control
// points within 4 ε of the extent (and of the coordinates) of the axis are put on it. The normal
// looks outward where the curve leads along the axis' direction. Throws std::invalid_argument if
// the whole curve lies on the axis or on a circle about it, and for more than half a turn where a
// curve in a plane with the axis crosses it twice or more. [Piegl & Tiller 1997, A8.1]
NurbsSurface Revolve(const NurbsCurve<3>& profile,
                     const Frame& frame,
                     const AngleRange& angles = {});

}  // namespace batten
