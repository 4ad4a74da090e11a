// SPDX-License-Identifier: MIT
// Inflections, cusps and loops of cubic curves, and the torsion of those in space.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "batten/geometry/nurbs_curve.h"

namespace batten {

// What one cubic piece is.
//  kLine, kConic: a cubic in form only; kArch: a plane cubic piece without any of the following.
//  kInflected: with one to three inflections; kCusp; kLoop: it crosses itself (and may be inflected
//  too where it is rational). kSpace: in no plane, so without cusp or loop.
enum class CubicKind { kLine, kConic, kArch, kInflected, kCusp, kLoop, kSpace };
std::string NameOf(
    CubicKind kind);  // "line", "conic", "arch", "inflected", "cusp", "loop", "space"

struct CubicFeatures {
  double lower, upper;  // the piece, in the curve's parameter
  CubicKind kind = CubicKind::kArch;
  std::vector<double> inflections = {};  // where the curvature changes sign, inside the piece
  std::optional<double> cusp = {};       // where the speed vanishes
  std::optional<std::array<double, 2>> loop = {};  // the two parameters of the crossing
  // Of a piece in space: the least and greatest torsion, of one sign on a piece; infinite where the
  // curvature vanishes.
  std::optional<std::array<double, 2>> torsion = {};
};

// Of every polynomial piece of a curve of degree 3, rational or not, the parameters of the curve.
// In homogeneous coordinates inflections are the roots of the cubic det(C, C′, C″), the crossing
// those of its Hessian form, a cusp a double one of them: closed forms, no search. A piece counts
// as plane, as straight, and as at rest in a cusp to `tolerance` of its size. Crossings of
// different pieces are not looked for. Throws std::invalid_argument unless the degree is 3 and the
// tolerance positive. [Stone & DeRose 1989; Blinn & Loop 2005]
template <int Dim>
std::vector<CubicFeatures> FeaturesOfCubic(const NurbsCurve<Dim>& curve, double tolerance = 1e-9);

extern template std::vector<CubicFeatures> FeaturesOfCubic(const NurbsCurve<2>&, double);
extern template std::vector<CubicFeatures> FeaturesOfCubic(const NurbsCurve<3>&, double);

}  // namespace batten
