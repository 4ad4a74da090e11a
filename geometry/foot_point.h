// SPDX-License-Identifier: MIT
// Foot points: where a curve or surface is nearest to a point.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

// The nearest point found on a surface, with its parameters.
struct SurfaceFoot {
  double u = 0, v = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double distance = 0;
};

// The nearest point found on a curve.
struct CurveFoot {
  double u = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double distance = 0;
};

// A rectangle of parameters.
struct ParameterBox {
  double u0, u1, v0, v1;
};

// The local minimum of |S(u,v) − q| reached from (u,v) by Newton steps that never leave the box and
// never go uphill. Boundary minima included. [Piegl & Tiller 1997, §6.1, with an active set at the
// box's sides and a shift of indefinite Hessians]
SurfaceFoot LocalFootPoint(const NurbsSurface& surface,
                           const Eigen::Vector3d& q,
                           double u,
                           double v,
                           const ParameterBox& box);
SurfaceFoot LocalFootPoint(const NurbsSurface& surface,
                           const Eigen::Vector3d& q,
                           double u,
                           double v);

// Nearest points over the whole surface. Its Bézier pieces are halved until they are nearly flat
// and evenly parameterized, or small; every piece whose bounding box is nearer than the best foot
// point so far is searched by Newton steps from each local minimum of a grid of samples, so a
// minimum is missed only where one piece hides it between samples. Building is O(pieces).
class SurfaceFootPoints {
 public:
  explicit SurfaceFootPoints(NurbsSurface surface);
  ~SurfaceFootPoints();
  SurfaceFootPoints(SurfaceFootPoints&&) noexcept;
  SurfaceFootPoints& operator=(SurfaceFootPoints&&) noexcept;

  const NurbsSurface& surface() const;
  SurfaceFoot Nearest(const Eigen::Vector3d& q) const;

  // One foot point for each column. Independent of the number of threads.
  std::vector<SurfaceFoot> Nearest(const Eigen::Matrix3Xd& points, ThreadPool& pool) const;

 private:
  struct Tree;
  std::unique_ptr<Tree> tree_;
};

// Nearest point over a whole curve in space or, with z = 0, in the plane. The curve is cut into
// nearly straight arcs; those whose chords allow a nearer point are searched by Newton steps.
// O(arcs) a query.
template <int Dim>
class CurveFootPoints {
 public:
  explicit CurveFootPoints(NurbsCurve<Dim> curve);
  const NurbsCurve<Dim>& curve() const { return curve_; }
  CurveFoot Nearest(const Eigen::Vector3d& q) const;
  std::vector<CurveFoot> Nearest(const Eigen::Matrix3Xd& points, ThreadPool& pool) const;

 private:
  NurbsCurve<Dim> curve_;
  // Nearly straight arcs: arc k runs from parameter and sample k to k + 1, at most bulge k off its
  // chord.
  std::vector<double> parameters_;
  Eigen::Matrix3Xd samples_;
  std::vector<double> bulges_;
};

extern template class CurveFootPoints<2>;
extern template class CurveFootPoints<3>;

}  // namespace batten
