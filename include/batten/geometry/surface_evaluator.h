// SPDX-License-Identifier: MIT
// Fast evaluation of one surface at many parameters.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "batten/geometry/nurbs_surface.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

namespace internal {
struct SurfaceTable;
}  // namespace internal

// What SurfaceEvaluator::Grid gives: column i·|vs| + j belongs to (us[i], vs[j]).
struct SurfaceGrid {
  Eigen::Matrix3Xd points, normals;
};

// A NurbsSurface with tables made once, so that a point or a jet costs some ten nanoseconds. The
// answers mean what those of NurbsSurface mean: parameters outside the domain are clamped or, in a
// periodic direction, wrapped; NaN, and ±∞ in a periodic direction, throw std::invalid_argument
// (SplineBasis::Clamp); at knots everything is right-continuous.
//
// Two forms are used. Span by span polynomials in local monomials about the middle of the span are
// the fastest; where the sum of their terms is so large against the extent of the surface and the
// smallest weight that digits would be lost (high degrees with wild control points, weights that
// differ much), or where they would take more than 32 MB, the basis functions are evaluated from
// their Bernstein forms (all terms positive) and summed over the control net.
//
// Rounding, per coordinate, with E half the longest side of the box of the control points: a point
// is right to 1e-13·E + 2^-52·|S|, and a derivative to 1e-13 of the largest, on its cell between
// knots, of what Leibniz' rule gives with all control points at distance E and the absolute value
// of every term added. (Points of smooth surfaces are right to about 1e-15·E.) So the distance
// from the origin costs derivatives nothing; but what NurbsSurface has exactly, like derivatives of
// zero along a collapsed edge, is here right to rounding only: ask NormalAt for normals.
//
// A value, cheap to copy. Const methods may be called from several threads at once. Nothing is
// allocated in evaluation but results whose size does not fit. Answers do not depend on how many
// parameters are given at once nor on the number of threads, bit by bit; different kinds of
// machine (instruction sets) may differ by rounding.
// Building takes O(p·q²) steps a cell between knots and O(p³) a span: 0.1 ms for 24 × 24 bicubic
// control points. [Piegl & Tiller 1997, §2.2, §4.4; Horner's rule; Cox–de Boor in Bernstein form]
class SurfaceEvaluator {
 public:
  explicit SurfaceEvaluator(NurbsSurface surface);

  const NurbsSurface& surface() const;

  Eigen::Vector3d At(double u, double v) const;

  // Point, first and second derivatives, as NurbsSurface::JetAt.
  SurfaceJet JetAt(double u, double v) const;

  // The unit normal S_u × S_v / |…|. Where the tangents are shorter or more parallel than 2^-20 of
  // what rounding is relative to, this is NurbsSurface::NormalAt, with its limits at collapsed
  // edges, and none where that has none.
  std::optional<Eigen::Vector3d> NormalAt(double u, double v) const;

  // The points at the columns (u, v) of `parameters`; `points` is resized if need be.
  void Points(const Eigen::Matrix2Xd& parameters, Eigen::Matrix3Xd& points) const;
  void Points(const Eigen::Matrix2Xd& parameters, Eigen::Matrix3Xd& points, ThreadPool& pool) const;

  // The jets there.
  void Jets(const Eigen::Matrix2Xd& parameters, std::vector<SurfaceJet>& jets) const;
  void Jets(const Eigen::Matrix2Xd& parameters,
            std::vector<SurfaceJet>& jets,
            ThreadPool& pool) const;

  // Points and unit normals at all pairs of `us` and `vs`; fastest where neighbours in `vs` share
  // a span. A normal that does not exist (see NormalAt) is the zero vector.
  void Grid(std::span<const double> us, std::span<const double> vs, SurfaceGrid& grid) const;
  void Grid(std::span<const double> us,
            std::span<const double> vs,
            SurfaceGrid& grid,
            ThreadPool& pool) const;

  // The tables, for other kernels; they live as long as this evaluator or a copy of it.
  const internal::SurfaceTable& table() const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

}  // namespace batten
