// SPDX-License-Identifier: MIT
// The inner loops of the search for closest points, compiled for several instruction sets. Plain
// pointers only.
#pragma once

#include "geometry/foot_points/box_minimum.h"

namespace batten::internal {

// One polynomial piece as FootTable holds it: coefficients of x^r y^s on [−1, 1]² or, where not
// `monomial`, Bézier points; homogeneous, relative to the piece's centre.
struct FootPiece {
  const double* local;
  int degree_u, degree_v;
  bool rational, monomial;
};

// Where a descent stands, and what it saw there.
struct FootPlace {
  double x, y;
  double squared;   // |S − q|²
  unsigned leaves;  // sides across which descent would go on
  double gu, gv;    // of |S − q|²/2
};

// Sides of a box of local parameters.
inline constexpr unsigned kBelowX = 1, kAboveX = 2, kBelowY = 4, kAboveY = 8;

// The position relative to the centre.
void EvaluatePosition(const FootPiece& piece, double x, double y, double* position);

// What a descent would see at a place.
FootPlace LookAtPlace(const FootPiece& piece, const double* q, double x, double y);

// Newton steps for |S − q|², q relative to the centre, that never leave the box and never go
// uphill, until they are negligible or meet one of the `open` sides across which descent would go
// on. An indefinite Hessian is shifted by its lowest eigenvalue; a parameter at a side where
// descent leads out is held, and the other's own second derivative then decides.
FootPlace DescendInPiece(const FootPiece& piece,
                         const double* q,
                         double x,
                         double y,
                         const LocalBox& box,
                         unsigned open);

// f = A + q·B + shift·W for the rows of FootTable::squares; returns the least of them.
double FillSquares(
    const double* rows, int padded, bool rational, const double* q, double shift, double* f);

}  // namespace batten::internal
