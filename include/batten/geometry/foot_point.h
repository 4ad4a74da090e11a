// SPDX-License-Identifier: MIT
// Foot points: where a curve or surface is nearest to a point.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <vector>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/parameter_box.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

// The nearest point found on a surface, with its parameters.
struct SurfaceFoot {
  double u = 0, v = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double distance = 0;
  double lower_bound = 0;  // no point of the surface, or of its part that counts, is nearer
  bool certified = false;  // the bound is the distance, but for what a search may miss
};

// The nearest point found on a curve.
struct CurveFoot {
  double u = 0;
  Eigen::Vector3d point = Eigen::Vector3d::Zero();
  double distance = 0;
  double lower_bound = 0;  // no point of the curve is nearer than this
  bool certified = false;  // the bound is the distance, but for what a search may miss
};

// The local minimum of |S(u,v) − q| reached from (u,v) by Newton steps that never leave the box and
// never go uphill. Boundary minima included. [Piegl & Tiller 1997, §6.1, with an active set at the
// box's sides and a shift of indefinite Hessians] Trims are not looked at.
SurfaceFoot LocalFootPoint(const NurbsSurface& surface,
                           const Eigen::Vector3d& q,
                           double u,
                           double v,
                           const ParameterBox& box);
SurfaceFoot LocalFootPoint(const NurbsSurface& surface,
                           const Eigen::Vector3d& q,
                           double u,
                           double v);

// Nearest points over the whole surface or, where it is trimmed, over the part inside its loops,
// which belong to it. Certified: the distance is within 1e-11 of the surface's size of the least,
// or to rounding where the point is far away, and `lower_bound` says within what. Nearest places
// that are equally near are all as good. Building is O(pieces); a query near the surface looks at a
// few of them. What the surface's bases call periodic is searched across the seam; degenerate edges
// and corners are ordinary. Points must be finite, or std::invalid_argument is thrown. Safe to ask
// from several threads. Trims cost a query some ten nanoseconds where the whole surface's nearest
// point is inside them, and elsewhere some microseconds; the distance is then within 1e-10 of the
// surface's size of the least. Building measures the loops: 1 to 100 ms. The bound is of the
// squared distance in Bernstein form, after the idea of [Chen, Yong, Paul & Sun 2008, "Computing
// the minimum distance between a point and a NURBS curve"].
class SurfaceFootPoints {
 public:
  explicit SurfaceFootPoints(NurbsSurface surface);
  ~SurfaceFootPoints();
  SurfaceFootPoints(SurfaceFootPoints&&) noexcept;
  SurfaceFootPoints& operator=(SurfaceFootPoints&&) noexcept;

  const NurbsSurface& surface() const;
  SurfaceFoot Nearest(const Eigen::Vector3d& q) const;

  // The same, certified alike, and faster where a place near the foot point is known.
  SurfaceFoot NearestFrom(const Eigen::Vector3d& q, double u, double v) const;

  // Whether a glance tells that nothing is nearer than the place (u, v), certified alike: so it is
  // for most points near a surface at their local foot points, right to rounding. False says
  // nothing: what needs a search, as at poles and creases, and rational surfaces.
  bool SurelyNearest(const Eigen::Vector3d& q, double u, double v) const;

  // One foot point for each column. Independent of the number of threads.
  std::vector<SurfaceFoot> Nearest(const Eigen::Matrix3Xd& points, ThreadPool& pool) const;

  // The local minimum below a start, found by Newton steps across pieces: several times as fast,
  // nothing certified (the lower bound is zero). Where that is outside the trims: the nearest point
  // of all, certified.
  SurfaceFoot Near(const Eigen::Vector3d& q, double u, double v) const;
  std::vector<SurfaceFoot> Near(const Eigen::Matrix3Xd& points,
                                const Eigen::Matrix2Xd& starts,
                                ThreadPool& pool) const;

 private:
  struct Search;
  std::unique_ptr<Search> search_;
};

// The same for curves in space or, with z = 0, in the plane.
template <int Dim>
class CurveFootPoints {
 public:
  explicit CurveFootPoints(NurbsCurve<Dim> curve);
  ~CurveFootPoints();
  CurveFootPoints(CurveFootPoints&&) noexcept;
  CurveFootPoints& operator=(CurveFootPoints&&) noexcept;

  const NurbsCurve<Dim>& curve() const;
  CurveFoot Nearest(const Eigen::Vector3d& q) const;
  std::vector<CurveFoot> Nearest(const Eigen::Matrix3Xd& points, ThreadPool& pool) const;
  CurveFoot Near(const Eigen::Vector3d& q, double u) const;

 private:
  struct Search;
  std::unique_ptr<Search> search_;
};

extern template class CurveFootPoints<2>;
extern template class CurveFootPoints<3>;

}  // namespace batten
