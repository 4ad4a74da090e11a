// SPDX-License-Identifier: MIT
// Fits the line or circle of FitPrimitive and chooses between them. Used by FitPrimitive only.
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

#include "batten/fitting/primitive_options.h"
#include "fitting/primitives/circle_fit.h"
#include "fitting/primitives/line_fit.h"
#include "fitting/primitives/primitive_input.h"
#include "fitting/primitives/sample_consensus.h"

namespace batten::internal {

class CurvePrimitive {
 public:
  // Fits a line, a circle or both and chooses between them as FitPrimitive describes. `kind` is
  // kLine, kCircle or kAuto.
  CurvePrimitive(PrimitiveInput& input, PrimitiveKind kind);

  // Minus twice the log-likelihood of the points under normal noise about places spread evenly
  // along the curve, plus the penalty of Schwarz's criterion; outliers lie anywhere in a cube of
  // the size. Lengths in units of input.unit.
  double Surprise() const;

  // Standard deviation of a component of the inliers' distances, in units of input.unit, and the
  // degrees of freedom with which it is known.
  double Sigma() const;
  double FreedomsLeft() const;

  // The result; may be called once.
  PrimitiveFit Fit();

 private:
  template <typename Shape>
  Shape StartOf(std::optional<double> scale) const;
  template <typename Shape>
  SmoothedShape<Shape> Solved();
  template <typename Shape>
  int Freedoms() const;
  template <typename Shape>
  double FreedomsLeftOf() const;
  double Components() const;
  bool robust() const { return loss_ != Loss::kNone; }
  void SolveCircle();
  double CostOf(const auto& shape, double scale) const;
  void Choose();
  const std::vector<Eigen::Index>& Used() const;
  std::vector<double> Places() const;
  template <int Dim>
  NurbsCurve<Dim> LocalSegment();
  template <int Dim>
  NurbsCurve<Dim> LocalArc();
  bool Clockwise() const;
  template <int Dim>
  PrimitiveFit Measure();
  PointMask Forgotten() const;
  PrimitiveSummary Summary(double scale) const;

  PrimitiveInput& input_;
  PrimitiveKind kind_;
  Loss loss_;
  ShapeData data_;  // (points − middle) / unit
  std::optional<SmoothedShape<FittedLine>> line_;
  std::optional<SmoothedShape<FittedCircle>> circle_;
  std::string why_;
  double sweep_ = 0;
};

}  // namespace batten::internal
