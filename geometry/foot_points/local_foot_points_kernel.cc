// SPDX-License-Identifier: MIT
#include "geometry/foot_points/local_foot_points_kernel.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "geometry/foot_points/box_minimum.h"
#include "geometry/numeric/constants.h"
#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {
namespace {

constexpr int kAny = 0, kMostRounds = 40;
constexpr double kMostHalvings = 30;
// Of half a cell. Newton's error after a step so small is its square, and the cubic term of
// Taylor's formula less than rounding.
constexpr double kLastStep = 1e-6;
// The square of a sine, and of a tangent's length against the other's or the surface's extent,
// below which a normal is not trusted.
constexpr double kFlat = 0x1p-40;

typedef double Lanes __attribute__((vector_size(64)));

BATTEN_INLINE Lanes Same(double x) { return Lanes{x, x, x, x, x, x, x, x}; }
BATTEN_INLINE Lanes Load(const double* from) { return *reinterpret_cast<const Lanes*>(from); }
BATTEN_INLINE void Store(const Lanes& value, double* to) { *reinterpret_cast<Lanes*>(to) = value; }

// One coordinate with its derivatives in the cell's own parameters a, b ∈ [−1, 1].
struct Coordinate {
  Lanes h, a, b, aa, ab, bb;
};

// Horner's rule in b for every power of a, then in a; second derivatives come out halved.
template <int P, int Q>
BATTEN_INLINE Coordinate
Polynomial(const double* c, int any_p, int any_q, const Lanes& a, const Lanes& b) {
  const int p = P == kAny ? any_p : P, q = Q == kAny ? any_q : Q;
  Coordinate f{};
#pragma GCC unroll 4
  for (int r = p; r >= 0; --r) {
    Lanes h = Same(c[4 * (q * (p + 1) + r)]), hb{}, hbb{};
#pragma GCC unroll 4
    for (int s = q - 1; s >= 0; --s) {
      if (s < q - 2) {
        hbb = hbb * b + hb;
      } else if (s == q - 2) {
        hbb = hb;
      }
      hb = s == q - 1 ? h : hb * b + h;
      h = h * b + Same(c[4 * (s * (p + 1) + r)]);
    }
    if (r == p) {
      f.h = h, f.b = hb, f.bb = hbb;
      continue;
    }
    if (r < p - 2) {
      f.aa = f.aa * a + f.a;
    } else if (r == p - 2) {
      f.aa = f.a;
    }
    f.a = r == p - 1 ? f.h : f.a * a + f.h;
    f.ab = r == p - 1 ? f.b : f.ab * a + f.b;
    f.h = f.h * a + h;
    f.b = f.b * a + hb;
    f.bb = f.bb * a + hbb;
  }
  f.aa *= Same(2);
  f.bb *= Same(2);
  return f;
}

// [Piegl & Tiller 1997, eq. 4.20]
BATTEN_INLINE void Divide(const Coordinate& w, const Lanes& inverse, Coordinate& f) {
  f.h *= inverse;
  f.a = (f.a - w.a * f.h) * inverse;
  f.b = (f.b - w.b * f.h) * inverse;
  f.aa = (f.aa - 2 * w.a * f.a - w.aa * f.h) * inverse;
  f.ab = (f.ab - w.a * f.b - w.b * f.a - w.ab * f.h) * inverse;
  f.bb = (f.bb - 2 * w.b * f.b - w.bb * f.h) * inverse;
}

// Point and derivatives of eight places, coordinate by coordinate.
struct Jet {
  enum { kPoint = 0, kA = 3, kB = 6, kAA = 9, kAB = 12, kBB = 15, kRows = 18 };
  alignas(64) double rows[kRows][kFootPointLanes];

  BATTEN_INLINE void Keep(const Coordinate& f, int d) {
    Store(f.h, rows[kPoint + d]);
    Store(f.a, rows[kA + d]);
    Store(f.b, rows[kB + d]);
    Store(f.aa, rows[kAA + d]);
    Store(f.ab, rows[kAB + d]);
    Store(f.bb, rows[kBB + d]);
  }
};

template <int P, int Q, bool Rational>
BATTEN_INLINE void Evaluate(
    const double* c, int p, int q, const Lanes& a, const Lanes& b, Jet& jet) {
  if constexpr (Rational) {
    const Coordinate w = Polynomial<P, Q>(c + 3, p, q, a, b);
    const Lanes inverse = 1 / w.h;
    for (int d = 0; d < 3; ++d) {
      Coordinate f = Polynomial<P, Q>(c + d, p, q, a, b);
      Divide(w, inverse, f);
      jet.Keep(f, d);
    }
  } else {
    for (int d = 0; d < 3; ++d) jet.Keep(Polynomial<P, Q>(c + d, p, q, a, b), d);
  }
}

// What follows is for one lane, without branches where it is in the loops over all lanes.

BATTEN_INLINE double Greater(double x, double y) { return x > y ? x : y; }
BATTEN_INLINE double Size(double x) { return x < 0 ? -x : x; }

struct Vector {
  double x, y, z;

  BATTEN_INLINE Vector(double a, double b, double c) : x(a), y(b), z(c) {}
  BATTEN_INLINE Vector(const Jet& jet, int row, int lane)
      : x(jet.rows[row][lane]), y(jet.rows[row + 1][lane]), z(jet.rows[row + 2][lane]) {}
};
BATTEN_INLINE double Dot(const Vector& a, const Vector& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
BATTEN_INLINE Vector Cross(const Vector& a, const Vector& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
BATTEN_INLINE Vector Along(const Vector& a, double s, const Vector& b) {
  return {a.x + s * b.x, a.y + s * b.y, a.z + s * b.z};
}

// |S − q|²/2 to second order, with the squares of the first derivatives' lengths.
struct Model {
  double value, ga, gb, haa, hab, hbb, aa, bb;

  BATTEN_INLINE Model(const Jet& jet, int k, const Vector& off) {
    const Vector a(jet, Jet::kA, k), b(jet, Jet::kB, k);
    value = Dot(off, off);
    ga = Dot(off, a);
    gb = Dot(off, b);
    aa = Dot(a, a);
    bb = Dot(b, b);
    haa = aa + Dot(off, Vector(jet, Jet::kAA, k));
    hab = Dot(a, b) + Dot(off, Vector(jet, Jet::kAB, k));
    hbb = bb + Dot(off, Vector(jet, Jet::kBB, k));
  }
};

// Eight descents in one cell.
struct alignas(64) Group {
  double x[kFootPointLanes], y[kFootPointLanes], z[kFootPointLanes];
  double a[kFootPointLanes], b[kFootPointLanes];        // where they stand
  double da[kFootPointLanes], db[kFootPointLanes];      // their steps
  double at_a[kFootPointLanes], at_b[kFootPointLanes];  // the trials
  double squares[kFootPointLanes], side[kFootPointLanes], tries[kFootPointLanes];
  // Of the trial: its value, the step from there, and answers, 1 or 0.
  double trial[kFootPointLanes], step_a[kFootPointLanes], step_b[kFootPointLanes];
  double nearer[kFootPointLanes], plain[kFootPointLanes];
  double exact[kFootPointLanes];  // the step is Newton's own: the next error is its square
  double still[kFootPointLanes];  // descent would leave the domain in both parameters
  // If it is taken: where the descent stands then, with a last step or without.
  double ends[kFootPointLanes], done[kFootPointLanes], lost[kFootPointLanes],
      halvings[kFootPointLanes];
  double last_a[kFootPointLanes], last_b[kFootPointLanes];
  double last_squares[kFootPointLanes], last_side[kFootPointLanes], last_flat[kFootPointLanes];
  double active[kFootPointLanes], leaves[kFootPointLanes], flat[kFootPointLanes];
  LocalBox domain;
  double extent;  // the square of the surface's

  BATTEN_INLINE Vector Off(const Jet& jet, int k) const {
    return {jet.rows[0][k] - x[k], jet.rows[1][k] - y[k], jet.rows[2][k] - z[k]};
  }

  // Newton's step where nothing stands in its way. Returns whether any lane needs more thought.
  BATTEN_INLINE bool TakePlainSteps(const Jet& jet) {
    long long others = 0;
    for (int k = 0; k < kFootPointLanes; ++k) {
      const Model m(jet, k, Off(jet, k));
      // Both eigenvalues, in units of the first derivatives, more than 1e-9 of the greater or one.
      const double sum = m.haa * m.bb + m.hbb * m.aa, unit = m.aa * m.bb;
      const double det = m.haa * m.hbb - m.hab * m.hab;
      const double enough = det * unit - 1e-9 * sum * Greater(unit, sum);
      const double inverse = 1 / det;
      const double sa = (m.hab * m.gb - m.hbb * m.ga) * inverse;
      const double sb = (m.hab * m.ga - m.haa * m.gb) * inverse;
      // Not held and not led beyond a side.
      const double na = at_a[k] + sa, nb = at_b[k] + sb;
      const bool held =
          ((at_a[k] <= domain.x0) & (m.ga >= 0)) | ((at_a[k] >= domain.x1) & (m.ga <= 0)) |
          ((at_b[k] <= domain.y0) & (m.gb >= 0)) | ((at_b[k] >= domain.y1) & (m.gb <= 0));
      const bool inside =
          (na >= domain.x0) & (na <= domain.x1) & (nb >= domain.y0) & (nb <= domain.y1);
      const bool good = (sum > 0) & (enough >= 0) & inside & !held;
      const bool taken = (active[k] != 0) & (m.value < squares[k]);
      trial[k] = m.value;
      step_a[k] = sa;
      step_b[k] = sb;
      nearer[k] = taken ? 1 : 0;
      plain[k] = good ? 1 : 0;
      exact[k] = 1;
      still[k] = 0;
      others |= taken & !good ? 1LL : 0LL;
    }
    return others != 0;
  }

  // The trial is taken or its step halved; what is done comes to rest, and what leaves the cell
  // waits. Returns whether any lane goes on.
  BATTEN_INLINE bool Advance(const Jet& jet) {
    Decide();
    TakeLastSteps(jet);
    return Move();
  }

  // The next step, and whether the descent ends here, with that step or without.
  // (Sums stand outside of choices: where they might not be made, compilers use branches.)
  BATTEN_INLINE void Decide() {
    for (int k = 0; k < kFootPointLanes; ++k) {
      const bool took = nearer[k] != 0;
      // A halved step that gained next to nothing was the last.
      const bool small = (tries[k] > 0) & (squares[k] - trial[k] <= 4 * kEpsilon * squares[k]);
      const bool stays = (still[k] != 0) | small;
      const double next_a = step_a[k], next_b = step_b[k], old_a = da[k], old_b = db[k];
      const double scale = 0.5 + 0.5 * nearer[k];
      const double sa = (took ? next_a : old_a) * scale, sb = (took ? next_b : old_b) * scale;
      const double again = (1 - nearer[k]) * (tries[k] + 1);
      const bool tiny = Greater(Size(sa), Size(sb)) < kLastStep;
      const bool fails = tiny | (again >= kMostHalvings);
      const bool here = Greater(Size(at_a[k] + sa), Size(at_b[k] + sb)) <= 1;
      const bool last = took & tiny & here & (exact[k] != 0) & !stays;
      const bool gives_up = fails & (nearer[k] == 0);
      const bool over = last | (took & stays) | gives_up;
      step_a[k] = sa;
      step_b[k] = sb;
      halvings[k] = again;
      ends[k] = last ? 1.0 : 0.0;
      done[k] = over ? 1.0 : 0.0;
      lost[k] = gives_up & (active[k] != 0) ? 1.0 : 0.0;
    }
  }

  // The last step by Taylor's formula, and the side of the surface that the point is on.
  BATTEN_INLINE void TakeLastSteps(const Jet& jet) {
    for (int k = 0; k < kFootPointLanes; ++k) {
      const double s = ends[k] * step_a[k], t = ends[k] * step_b[k];
      const Vector ja(jet, Jet::kA, k), jb(jet, Jet::kB, k), jaa(jet, Jet::kAA, k),
          jab(jet, Jet::kAB, k), jbb(jet, Jet::kBB, k);
      const Vector last = Along(
          Along(Off(jet, k), s, Along(Along(ja, s / 2, jaa), t, jab)), t, Along(jb, t / 2, jbb));
      const Vector normal =
          Cross(Along(Along(ja, s, jaa), t, jab), Along(Along(jb, s, jab), t, jbb));
      const double aa = Dot(ja, ja), bb = Dot(jb, jb), least = aa < bb ? aa : bb;
      const bool good = (Dot(normal, normal) > kFlat * aa * bb) &
                        (least > kFlat * Greater(Greater(aa, bb), extent));
      last_a[k] = at_a[k] + s;
      last_b[k] = at_b[k] + t;
      last_squares[k] = Dot(last, last);
      last_side[k] = -Dot(normal, last);
      last_flat[k] = good ? 0.0 : 1.0;
    }
  }

  BATTEN_INLINE bool Move() {
    Choose(nearer, last_a, a);
    Choose(nearer, last_b, b);
    Choose(nearer, last_squares, squares);
    Choose(nearer, last_side, side);
    Choose(nearer, last_flat, flat);
    Choose(lost, lost, flat);  // a kink, or a distance that rounding decides
    Choose(active, step_a, da);
    Choose(active, step_b, db);
    Choose(active, halvings, tries);
    long long any = 0;
    for (int k = 0; k < kFootPointLanes; ++k) {
      const double to_a = ClampTo(a[k] + da[k], domain.x0, domain.x1);
      const double to_b = ClampTo(b[k] + db[k], domain.y0, domain.y1);
      const bool beyond = Greater(Size(to_a), Size(to_b)) > 1;
      // Where tangents vanish there is no telling on what ground the next step would be.
      const bool on = (active[k] != 0) & (done[k] == 0) & (flat[k] == 0);
      const double left = leaves[k];
      at_a[k] = to_a;
      at_b[k] = to_b;
      leaves[k] = on & beyond ? 1.0 : left;
      active[k] = on & !beyond ? 1.0 : 0.0;
      any |= on & !beyond ? 1LL : 0LL;
    }
    return any != 0;
  }

  static BATTEN_INLINE void Choose(const double* which, const double* from, double* to) {
    for (int k = 0; k < kFootPointLanes; ++k) {
      const double there = from[k], here = to[k];
      to[k] = which[k] != 0 ? there : here;
    }
  }

  void TakeHeldStep(const Jet& jet, int k);
};

// Newton's step in one parameter; where the curvature is not positive, downhill by a step that the
// first derivatives suggest.
double LineStep(double g, double h, double scale, double low, double high) {
  const double curvature = h > 1e-12 * scale ? h : std::max(scale, std::abs(h));
  return curvature > 0 ? ClampTo(-g / curvature, low, high) : 0;
}

// The step of one lane that is none of the plain ones: held at sides that descent would leave, or
// led to them, or from a Hessian that must be shifted by its lowest eigenvalue.
void Group::TakeHeldStep(const Jet& jet, int k) {
  Model m(jet, k, Off(jet, k));
  const LocalBox moves{
      domain.x0 - at_a[k], domain.x1 - at_a[k], domain.y0 - at_b[k], domain.y1 - at_b[k]};
  const bool held_a = (moves.x0 >= 0 && m.ga >= 0) || (moves.x1 <= 0 && m.ga <= 0);
  const bool held_b = (moves.y0 >= 0 && m.gb >= 0) || (moves.y1 <= 0 && m.gb <= 0);
  if (held_a || held_b) {
    step_a[k] = held_a ? 0 : LineStep(m.ga, m.haa, m.aa, moves.x0, moves.x1);
    step_b[k] = held_b ? 0 : LineStep(m.gb, m.hbb, m.bb, moves.y0, moves.y1);
    still[k] = held_a && held_b ? 1 : 0;
    exact[k] = (held_a || m.haa > 1e-12 * m.aa) && (held_b || m.hbb > 1e-12 * m.bb) ? 1 : 0;
    return;
  }
  // In units of the first derivatives, so that the shift means the same in both parameters.
  const double uu = m.aa > 0 ? m.aa : 1, vv = m.bb > 0 ? m.bb : 1;
  const double a_scaled = m.haa / uu, c_scaled = m.hbb / vv;
  const double mean = (a_scaled + c_scaled) / 2, half = (a_scaled - c_scaled) / 2;
  const double radius = std::sqrt(half * half + m.hab * m.hab / (uu * vv));
  const double lowest = mean - radius, size = std::max(1.0, std::abs(mean) + radius);
  constexpr double kIndefinite = 1e-9, kLeastCurvature = 1e-3;
  if (lowest < kIndefinite * size) {
    const double shift = kLeastCurvature * size - lowest + std::max(0.0, -lowest);
    m.haa += shift * uu;
    m.hbb += shift * vv;
    exact[k] = 0;
  }
  BoxMinimum(m.haa, m.hab, m.hbb, m.ga, m.gb, moves, step_a + k, step_b + k);
  if (std::isfinite(step_a[k]) && std::isfinite(step_b[k])) return;
  step_a[k] = step_b[k] = 0;
  still[k] = 1;
}

// One direction of a cell: its middle, half its length, and the domain in its parameter.
struct CellAxis {
  double middle, half, inverse, low, high;

  BATTEN_INLINE CellAxis(const AxisTable& axis, int span) {
    const TableSpan& ends = axis.spans[span];
    half = (ends.end - ends.start) / 2;
    middle = ends.start + half;
    inverse = 2 * ends.scale;
    low = span == 0 ? -1 : (axis.lower - middle) * inverse;
    high = span + 1 == axis.span_count ? 1 : (axis.upper - middle) * inverse;
  }
};

template <int P, int Q, bool Rational>
BATTEN_INLINE void DescendGroup(const double* c, int p, int q, Group& group) {
  Jet jet;
  for (int k = 0; k < kFootPointLanes; ++k) {
    group.at_a[k] = ClampTo(group.a[k] + group.da[k], group.domain.x0, group.domain.x1);
    group.at_b[k] = ClampTo(group.b[k] + group.db[k], group.domain.y0, group.domain.y1);
  }
  for (int round = 0; round < kMostRounds; ++round) {
    Evaluate<P, Q, Rational>(c, p, q, Load(group.at_a), Load(group.at_b), jet);
    if (group.TakePlainSteps(jet)) {
      for (int k = 0; k < kFootPointLanes; ++k) {
        if (group.nearer[k] != 0 && group.plain[k] == 0) group.TakeHeldStep(jet, k);
      }
    }
    if (!group.Advance(jet)) return;
  }
}

template <int P, int Q, bool Rational>
BATTEN_INLINE void DescendRun(const SurfaceTable& table,
                              const CorrectionRun& run,
                              const FootPointLanes& lanes) {
  const CellAxis u(table.u, run.span_u), v(table.v, run.span_v);
  const double* c = table.patches + (static_cast<std::size_t>(run.span_u) * table.v.span_count +
                                     static_cast<std::size_t>(run.span_v)) *
                                        table.patch_stride;
  Group group;
  group.extent = table.extent * table.extent;
  group.domain = {u.low, u.high, v.low, v.high};
  for (std::size_t at = run.begin; at < run.end; at += kFootPointLanes) {
    for (int k = 0; k < kFootPointLanes; ++k) {
      group.x[k] = lanes.x[at + k];
      group.y[k] = lanes.y[at + k];
      group.z[k] = lanes.z[at + k];
      group.a[k] = (lanes.u[at + k] - u.middle) * u.inverse;
      group.b[k] = (lanes.v[at + k] - v.middle) * v.inverse;
      group.da[k] = lanes.du[at + k] * u.inverse;
      group.db[k] = lanes.dv[at + k] * v.inverse;
      group.squares[k] = lanes.squares[at + k];
      group.side[k] = lanes.side[at + k];
      group.tries[k] = lanes.tries[at + k];
      group.active[k] = 1;
      group.leaves[k] = group.flat[k] = 0;
    }
    DescendGroup<P, Q, Rational>(c, table.u.degree, table.v.degree, group);
    for (int k = 0; k < kFootPointLanes; ++k) {
      lanes.u[at + k] = u.middle + u.half * group.a[k];
      lanes.v[at + k] = v.middle + v.half * group.b[k];
      lanes.du[at + k] = u.half * group.da[k];
      lanes.dv[at + k] = v.half * group.db[k];
      lanes.squares[at + k] = group.squares[k];
      lanes.side[at + k] = group.side[k];
      lanes.tries[at + k] = group.tries[k];
      const double settled = group.flat[k] != 0 ? kFootHard : kFootSettled;
      const double off = group.leaves[k] != 0 ? kFootLeaves : settled;
      lanes.state[at + k] = group.active[k] != 0 ? kFootHard : off;
    }
  }
}

template <int P, int Q>
BATTEN_INLINE void DescendRuns(const SurfaceTable& table,
                               const CorrectionRun* runs,
                               std::size_t run_count,
                               const FootPointLanes& lanes) {
  for (std::size_t k = 0; k < run_count; ++k) {
    if (table.rational) {
      DescendRun<P, Q, true>(table, runs[k], lanes);
    } else {
      DescendRun<P, Q, false>(table, runs[k], lanes);
    }
  }
}

}  // namespace

BATTEN_CLONES
void DescendInCells(const SurfaceTable& table,
                    const CorrectionRun* runs,
                    std::size_t run_count,
                    const FootPointLanes& lanes) {
  if (table.u.degree == 3 && table.v.degree == 3) {
    DescendRuns<3, 3>(table, runs, run_count, lanes);
  } else {
    DescendRuns<kAny, kAny>(table, runs, run_count, lanes);
  }
}

}  // namespace batten::internal
