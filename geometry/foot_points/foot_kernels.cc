// SPDX-License-Identifier: MIT
#include "geometry/foot_points/foot_kernels.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/numeric/constants.h"
#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {
namespace {

constexpr int kMaxSteps = 60, kMaxHalvings = 30;

// Steps below this (in local parameters) end a descent once taken: convergence being quadratic, the
// place is then right to its square.
constexpr double kLastStep = 2e-7;

// The squared distance with what a step needs of its derivatives in the local parameters.
struct FootJet {
  double squared;        // |S − q|²
  double gu, gv;         // (S − q)·S_u, (S − q)·S_v
  double huu, huv, hvv;  // second derivatives of |S − q|²/2
  double uu, vv;         // |S_u|², |S_v|²
};

// x, y, z, w of one place in the lanes of a register.
typedef double Quad __attribute__((vector_size(32), aligned(8)));

BATTEN_INLINE Quad Load(const double* from) { return *reinterpret_cast<const Quad*>(from); }
BATTEN_INLINE double Sum(const Quad& a) { return (a[0] + a[1]) + (a[2] + a[3]); }

// Homogeneous value and partial derivatives.
struct QuadJet {
  Quad a00, a10, a01, a20, a11, a02;
};

// Horner's rule in y for every power of x, then in x, with the derivatives carried along.
BATTEN_INLINE void Horner(const double* c, int p, int q, double x, double y, QuadJet& jet) {
  const Quad zero{0, 0, 0, 0};
  jet = {zero, zero, zero, zero, zero, zero};
  for (int r = p; r >= 0; --r) {
    const double* row = c + 4 * r * (q + 1);
    Quad b0 = Load(row + 4 * q), b1 = zero, b2 = zero;
    for (int s = q - 1; s >= 0; --s) {
      b2 = b2 * y + b1;
      b1 = b1 * y + b0;
      b0 = b0 * y + Load(row + 4 * s);
    }
    jet.a20 = jet.a20 * x + jet.a10;
    jet.a11 = jet.a11 * x + jet.a01;
    jet.a10 = jet.a10 * x + jet.a00;
    jet.a00 = jet.a00 * x + b0;
    jet.a01 = jet.a01 * x + b1;
    jet.a02 = jet.a02 * x + b2;
  }
  jet.a20 = jet.a20 * 2.0;
  jet.a02 = jet.a02 * 2.0;
}

// Bernstein polynomials on [−1, 1] with their derivatives, for degrees too high for powers.
struct Bernstein {
  static constexpr int kMost = 26;
  double b0[kMost], b1[kMost], b2[kMost];
};

BATTEN_INLINE void Difference(const double* from, int count, double scale, double* to) {
  double last = 0;
  for (int k = 0; k < count; ++k) {
    const double next = from[k];
    to[k] = scale * (last - next);
    last = next;
  }
  to[count] = scale * last;
}

BATTEN_INLINE void Fill(int n, double x, Bernstein& basis) {
  const double t = (1 + x) / 2;
  for (int k = 0; k <= n; ++k) basis.b1[k] = basis.b2[k] = 0;
  double* b = basis.b0;
  b[0] = 1;
  for (int level = 1; level <= n; ++level) {
    if (level == n - 1) {
      double once[Bernstein::kMost];
      Difference(b, level, (n - 1) / 2.0, once);
      Difference(once, level + 1, n / 2.0, basis.b2);
    }
    if (level == n) Difference(b, level, n / 2.0, basis.b1);
    double last = 0;
    for (int k = 0; k < level; ++k) {
      const double next = b[k];
      b[k] = (1 - t) * next + t * last;
      last = next;
    }
    b[level] = t * last;
  }
}

BATTEN_INLINE void SumBernstein(const double* c, int p, int q, double x, double y, QuadJet& jet) {
  const Quad zero{0, 0, 0, 0};
  jet = {zero, zero, zero, zero, zero, zero};
  Bernstein u, v;
  Fill(p, x, u);
  Fill(q, y, v);
  for (int r = 0; r <= p; ++r) {
    const double* row = c + 4 * r * (q + 1);
    Quad b0 = zero, b1 = zero, b2 = zero;
    for (int s = 0; s <= q; ++s) {
      const Quad point = Load(row + 4 * s);
      b0 += v.b0[s] * point;
      b1 += v.b1[s] * point;
      b2 += v.b2[s] * point;
    }
    jet.a00 += u.b0[r] * b0;
    jet.a10 += u.b1[r] * b0;
    jet.a20 += u.b2[r] * b0;
    jet.a01 += u.b0[r] * b1;
    jet.a11 += u.b1[r] * b1;
    jet.a02 += u.b0[r] * b2;
  }
}

BATTEN_INLINE void Homogeneous(const FootPiece& piece, double x, double y, QuadJet& jet) {
  if (!piece.monomial) {
    SumBernstein(piece.local, piece.degree_u, piece.degree_v, x, y, jet);
  } else if (piece.degree_u == 3 && piece.degree_v == 3) {
    Horner(piece.local, 3, 3, x, y, jet);  // unrolled
  } else if (piece.degree_u == 3 && piece.degree_v == 0) {
    Horner(piece.local, 3, 0, x, y, jet);
  } else {
    Horner(piece.local, piece.degree_u, piece.degree_v, x, y, jet);
  }
}

// With w = 1 in the last lane of S and q, that lane of every difference and derivative vanishes.
BATTEN_INLINE void Jet(const FootPiece& piece, const Quad& q, double x, double y, FootJet& jet) {
  QuadJet a;
  Homogeneous(piece, x, y, a);
  Quad s = a.a00, su = a.a10, sv = a.a01, suu = a.a20, suv = a.a11, svv = a.a02;
  if (piece.rational) {
    const double scale = 1 / a.a00[3], wu = a.a10[3], wv = a.a01[3];
    s = a.a00 * scale;
    su = (a.a10 - wu * s) * scale;
    sv = (a.a01 - wv * s) * scale;
    suu = (a.a20 - 2 * wu * su - a.a20[3] * s) * scale;
    svv = (a.a02 - 2 * wv * sv - a.a02[3] * s) * scale;
    suv = (a.a11 - wu * sv - wv * su - a.a11[3] * s) * scale;
  }
  const Quad off = s - q;
  jet.squared = Sum(off * off);
  jet.gu = Sum(off * su);
  jet.gv = Sum(off * sv);
  jet.uu = Sum(su * su);
  jet.vv = Sum(sv * sv);
  jet.huu = Sum(su * su + off * suu);
  jet.huv = Sum(su * sv + off * suv);
  jet.hvv = Sum(sv * sv + off * svv);
}

// Newton's step in one parameter; where the second derivative is not positive, downhill by a step
// that the first derivatives suggest.
BATTEN_INLINE double LineStep(double g, double h, double scale, double low, double high) {
  const double curvature = h > 1e-12 * scale ? h : std::max(scale, std::abs(h));
  return curvature > 0 ? ClampTo(-g / curvature, low, high) : 0;
}

BATTEN_INLINE void Step(
    const FootJet& jet, double x, double y, const LocalBox& box, double* dx, double* dy) {
  const bool held_x = (x <= box.x0 && jet.gu >= 0) || (x >= box.x1 && jet.gu <= 0) || jet.uu == 0;
  const bool held_y = (y <= box.y0 && jet.gv >= 0) || (y >= box.y1 && jet.gv <= 0) || jet.vv == 0;
  const LocalBox moves{box.x0 - x, box.x1 - x, box.y0 - y, box.y1 - y};
  *dx = *dy = 0;
  if (held_x || held_y) {
    if (!held_x) *dx = LineStep(jet.gu, jet.huu, jet.uu, moves.x0, moves.x1);
    if (!held_y) *dy = LineStep(jet.gv, jet.hvv, jet.vv, moves.y0, moves.y1);
    return;
  }
  // Scale to unit first derivatives, so that the shift means the same in both parameters.
  const double lx = std::sqrt(jet.uu), ly = std::sqrt(jet.vv);
  double a = jet.huu / jet.uu, c = jet.hvv / jet.vv;
  const double b = jet.huv / (lx * ly);
  const double mean = (a + c) / 2, half = (a - c) / 2, radius = std::sqrt(half * half + b * b);
  const double lowest = mean - radius, size = std::max(1.0, std::abs(mean) + radius);
  constexpr double kIndefinite = 1e-9, kLeastCurvature = 1e-3;
  if (lowest < kIndefinite * size) {
    const double shift = kLeastCurvature * size - lowest + std::max(0.0, -lowest);
    a += shift;
    c += shift;
  }
  BoxMinimum(a,
             b,
             c,
             jet.gu / lx,
             jet.gv / ly,
             {moves.x0 * lx, moves.x1 * lx, moves.y0 * ly, moves.y1 * ly},
             dx,
             dy);
  *dx /= lx;
  *dy /= ly;
}

// The sides the place lies on and descent leads across.
BATTEN_INLINE unsigned OpenSides(const FootJet& jet, double x, double y, const LocalBox& box) {
  return (x <= box.x0 && jet.gu > 0 ? kBelowX : 0u) | (x >= box.x1 && jet.gu < 0 ? kAboveX : 0u) |
         (y <= box.y0 && jet.gv > 0 ? kBelowY : 0u) | (y >= box.y1 && jet.gv < 0 ? kAboveY : 0u);
}

}  // namespace

BATTEN_CLONES
void EvaluatePosition(const FootPiece& piece, double x, double y, double* position) {
  QuadJet a;
  Homogeneous(piece, x, y, a);
  for (int d = 0; d < 3; ++d) position[d] = a.a00[d] / a.a00[3];
}

BATTEN_CLONES
FootPlace LookAtPlace(const FootPiece& piece, const double* point, double x, double y) {
  const Quad q{point[0], point[1], point[2], 1};
  FootJet jet;
  Jet(piece, q, x, y, jet);
  return {x, y, jet.squared, 0, jet.gu, jet.gv};
}

BATTEN_CLONES
FootPlace DescendInPiece(const FootPiece& piece,
                         const double* point,
                         double x,
                         double y,
                         const LocalBox& box,
                         unsigned open) {
  const Quad q{point[0], point[1], point[2], 1};
  x = ClampTo(x, box.x0, box.x1);
  y = ClampTo(y, box.y0, box.y1);
  FootJet jet;
  Jet(piece, q, x, y, jet);
  for (int step = 0; step < kMaxSteps; ++step) {
    double dx, dy;
    if (open != 0 && (OpenSides(jet, x, y, box) & open) != 0) break;
    Step(jet, x, y, box, &dx, &dy);
    bool moved = false, last = false;
    for (int halving = 0; halving < kMaxHalvings; ++halving, dx *= 0.5, dy *= 0.5) {
      const double nx = ClampTo(x + dx, box.x0, box.x1), ny = ClampTo(y + dy, box.y0, box.y1);
      const double far = std::max(std::abs(nx - x), std::abs(ny - y));
      if (far <= 2 * kEpsilon) break;
      FootJet trial;
      Jet(piece, q, nx, ny, trial);
      if (trial.squared < jet.squared) {
        last = far < kLastStep && halving == 0;
        moved = true;
        x = nx;
        y = ny;
        jet = trial;
        break;
      }
      if (far < kLastStep) break;  // the minimum to rounding
    }
    if (!moved || last) break;
  }
  return {x, y, jet.squared, OpenSides(jet, x, y, box) & open, jet.gu, jet.gv};
}

BATTEN_CLONES
double FillSquares(
    const double* rows, int padded, bool rational, const double* q, double shift, double* f) {
  const double *A = rows, *X = rows + padded, *Y = rows + 2 * padded, *Z = rows + 3 * padded;
  const double qx = q[0], qy = q[1], qz = q[2];
  if (rational) {
    const double* W = rows + 4 * padded;
    for (int k = 0; k < padded; ++k) {
      f[k] = A[k] + qx * X[k] + qy * Y[k] + qz * Z[k] + shift * W[k];
    }
  } else {
    for (int k = 0; k < padded; ++k) f[k] = A[k] + qx * X[k] + qy * Y[k] + qz * Z[k] + shift;
  }
  double least[8];
  for (int k = 0; k < 8; ++k) least[k] = f[k];
  for (int block = 8; block < padded; block += 8) {
    for (int k = 0; k < 8; ++k) least[k] = f[block + k] < least[k] ? f[block + k] : least[k];
  }
  double result = least[0];
  for (int k = 1; k < 8; ++k) result = least[k] < result ? least[k] : result;
  return result;
}

}  // namespace batten::internal
