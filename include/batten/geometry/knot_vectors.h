// SPDX-License-Identifier: MIT
// Knot vectors: made from nothing, from parameters, from a control polygon; compared and changed.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

#include "batten/geometry/spline_basis.h"

namespace batten {

// --- From nothing. n functions of degree p over [lower, upper]; all throw std::invalid_argument
// unless 1 ≤ p ≤ kMaxDegree, n > p and lower < upper.

// Equal spans everywhere, also the p spans outside each end of the domain (not clamped).
SplineBasis UniformKnots(int degree, int size, double lower, double upper);

// Equal spans inside, clamped at the ends.
SplineBasis QuasiUniformKnots(int degree, int size, double lower, double upper);

// Periodic, with simple knots at the increasing `breaks`, of which the last is the first one period
// later; breaks may repeat, up to p times. breaks.size() − 1 different functions.
SplineBasis PeriodicKnots(int degree, std::span<const double> breaks);

// Periodic with `distinct` ≥ 1 equal spans.
SplineBasis PeriodicUniformKnots(int degree, int distinct, double lower, double upper);

// --- From the parameters of data, in increasing order (equal ones allowed). Clamped over [first,
// last]. All throw std::invalid_argument if parameters decrease, are not finite or are all equal.

// For interpolation of as many points as there are parameters: each inner knot is the average of p
// consecutive inner parameters. Where parameters differ the interpolation matrix is regular and
// banded; where p or more are equal a knot may be repeated, and more than p times is refused.
// Throws if there are not more than p parameters. [Piegl & Tiller 1997, eq. 9.8; de Boor 1978]
SplineBasis AveragedKnots(int degree, std::span<const double> parameters);

// For least squares with p < size ≤ number of parameters: every span of the knots holds a parameter
// and the normal matrix is positive definite, if parameters differ. [Piegl & Tiller 1997, eq.
// 9.68, 9.69]
SplineBasis LeastSquaresKnots(int degree, int size, std::span<const double> parameters);

// By data density: the spans hold equally many parameters as nearly as can be, knots lie midway
// between two of them, no span is empty and the Schoenberg–Whitney condition holds, so that least
// squares has one solution, also where parameters repeat. Throws unless p < size ≤ number of
// different parameters.
SplineBasis DensityKnots(int degree, int size, std::span<const double> parameters);

// --- From a control polygon (Dim × n points).

// Riesenfeld's knots, clamped on [0, 1]: the polygon laid out straight and scaled to length one.
// Inner knots are, for odd p, the vertices without the first and last (p + 1)/2, and for even p the
// middles of the edges without the first and last p/2. Throws std::invalid_argument unless there
// are more than p points, not all the same, and if coincident vertices would make a knot of
// multiplicity above p or reach an end of the domain.
SplineBasis RiesenfeldKnots(int degree, const Eigen::Ref<const Eigen::MatrixXd>& control_points);

// --- Changing. What is periodic stays periodic.

// Knots moved linearly to the domain [lower, upper], whose ends are met exactly; elsewhere right to
// four roundings of the largest knot. Equal knots stay equal. Throws unless lower < upper.
SplineBasis Scaled(const SplineBasis& basis, double lower, double upper);

// Knots reflected on the same domain: N_i(u) becomes N_{n-1-i}(lower + upper − u), to one rounding
// of the largest knot. The ends are met exactly, and equal knots stay equal.
SplineBasis Reversed(const SplineBasis& basis);

// --- Asking.

struct KnotMultiplicity {
  double knot;
  int multiplicity;
  bool operator==(const KnotMultiplicity&) const = default;
};

// The different knots in increasing order and how often each is there. Knots that are at most
// `tolerance` (≥ 0, in parameter units) above the first of their group count as that one.
std::vector<KnotMultiplicity> DistinctKnots(std::span<const double> knots, double tolerance = 0);

// The same for the knots of the closed domain only.
std::vector<KnotMultiplicity> DomainKnots(const SplineBasis& basis);

// Whether degree, number of knots and kind (periodic or not) agree and no knot differs by more than
// `tolerance` (≥ 0, in parameter units).
bool SameKnots(const SplineBasis& a, const SplineBasis& b, double tolerance);

// The inner knots that `basis` lacks, each as often as it lacks them, so that refined by them it
// has every inner knot of `other` as often as that. Exact comparison; increasing.
std::vector<double> MissingKnots(const SplineBasis& basis, const SplineBasis& other);

}  // namespace batten
