// SPDX-License-Identifier: MIT
// Fast evaluation of one curve at many parameters.
#pragma once

#include <Eigen/Core>
#include <memory>
#include <span>

#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/thread_pool.h"

namespace batten {

namespace internal {
struct CurveTable;
}  // namespace internal

// A NurbsCurve with tables made once: span by span the homogeneous Bernstein forms of the curve and
// its first three derivatives. The answers mean what those of NurbsCurve mean: parameters outside
// the domain are clamped or, over a periodic basis, wrapped; NaN, and ±∞ over a periodic basis,
// throw std::invalid_argument (SplineBasis::Clamp); at knots everything is right-continuous.
//
// Rounding, per coordinate: a point is right to 1e-13·E + 2^-52·|C|, with E half the longest side
// of the box of the control points, and a derivative to 1e-13 of what Leibniz' rule gives with the
// absolute value of every term added, control points taken less the middle of the box. (Measured:
// about 1e-15.)
//
// A value, cheap to copy; const methods may be called from several threads at once. Nothing is
// allocated in evaluation but results whose size does not fit. Answers do not depend, bit by bit,
// on how many parameters are given at once nor on the number of threads. Building takes
// O(p³) steps and 128·p bytes a span. [Piegl & Tiller 1997, §2.2, §4.2; Cox–de Boor in Bernstein
// form]
template <int Dim>
class CurveEvaluator {
 public:
  using Point = typename NurbsCurve<Dim>::Point;
  using PointColumns = typename NurbsCurve<Dim>::Points;
  static constexpr int kMaxOrder = 3;

  explicit CurveEvaluator(NurbsCurve<Dim> curve);

  const NurbsCurve<Dim>& curve() const;

  Point At(double u) const;

  // The point and its first three derivatives, as NurbsCurve::JetAt.
  CurveJet<Dim> JetAt(double u) const;

  // The points; `points` is resized if need be.
  void Points(std::span<const double> parameters, PointColumns& points) const;
  void Points(std::span<const double> parameters, PointColumns& points, ThreadPool& pool) const;

  // Columns k·(order+1) … k·(order+1) + order are the derivatives 0 … order at parameter k. Throws
  // std::invalid_argument unless 0 ≤ order ≤ kMaxOrder.
  void Derivatives(std::span<const double> parameters, int order, PointColumns& columns) const;
  void Derivatives(std::span<const double> parameters,
                   int order,
                   PointColumns& columns,
                   ThreadPool& pool) const;

  // The tables, for other kernels; they live as long as this evaluator or a copy of it.
  const internal::CurveTable& table() const;

 private:
  struct State;
  std::shared_ptr<const State> state_;
};

extern template class CurveEvaluator<2>;
extern template class CurveEvaluator<3>;

}  // namespace batten
