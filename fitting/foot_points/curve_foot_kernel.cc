// SPDX-License-Identifier: MIT
#include "fitting/foot_points/curve_foot_kernel.h"

#include <algorithm>
#include <cmath>

#include "fitting/core/rounding.h"
#include "geometry/numeric/run_time_dispatch.h"

namespace batten::internal {
namespace {

constexpr int kLanes = 8;
constexpr int kMaxSteps = 8;
constexpr double kLastStep = 1e-6;  // of half a piece; squared by the step that is taken still
constexpr double kLeastBend = 0.1;  // second derivative over that of a straight line
constexpr double kFarthest = 4;     // step, of half a piece: farther might go all the way round

typedef double Lanes __attribute__((vector_size(kLanes * sizeof(double))));
typedef long long Mask __attribute__((vector_size(kLanes * sizeof(double))));

BATTEN_INLINE bool Any(const Mask& mask) {
  long long any = 0;
  for (int k = 0; k < kLanes; ++k) any |= mask[k];
  return any != 0;
}

// Places on the pieces, a lane each.
template <int Dim>
struct Group {
  Lanes powers[(kMaxFootDegree + 1) * Dim];
  Lanes x;
  int piece[kLanes];
};

BATTEN_INLINE double Middle(const CurvePieceTable& t, int i) {
  return 0.5 * (t.breaks[i] + t.breaks[i + 1]);
}
BATTEN_INLINE double Half(const CurvePieceTable& t, int i) {
  return 0.5 * (t.breaks[i + 1] - t.breaks[i]);
}

// The piece that holds u, searched from another piece on.
BATTEN_INLINE int PieceOf(const CurvePieceTable& t, double u, int near) {
  int i = near;
  if (u < t.breaks[i] || !(u < t.breaks[i + 1])) {
    const double* const above = std::upper_bound(t.breaks + 1, t.breaks + t.pieces, u);
    i = static_cast<int>(above - t.breaks) - 1;
  }
  return i;
}

template <int Dim>
BATTEN_INLINE void Load(const CurvePieceTable& t, Group<Dim>& g) {
  const int stride = (t.degree + 1) * Dim;
  bool same = true;
  for (int k = 1; k < kLanes; ++k) same = same && g.piece[k] == g.piece[0];
  if (same) {
    const double* const from = t.powers + static_cast<std::ptrdiff_t>(g.piece[0]) * stride;
    for (int i = 0; i < stride; ++i) g.powers[i] = from[i] - Lanes{};
    return;
  }
  for (int k = 0; k < kLanes; ++k) {
    const double* const from = t.powers + static_cast<std::ptrdiff_t>(g.piece[k]) * stride;
    for (int i = 0; i < stride; ++i) g.powers[i][k] = from[i];
  }
}

// A place beyond the ends of its piece moves to the piece it is on, around a periodic curve or as
// far as the end of an open one. True where that is another piece.
BATTEN_INLINE bool Enter(const CurvePieceTable& t, int& piece, double& x) {
  const double low = t.breaks[0], high = t.breaks[t.pieces];
  double u = Middle(t, piece) + x * Half(t, piece);
  if (t.periodic && !(u >= low && u < high))
    u -= (high - low) * std::floor((u - low) / (high - low));
  u = u < low ? low : u > high ? high : u;
  const int before = piece;
  piece = PieceOf(t, u, piece);
  x = (u - Middle(t, piece)) / Half(t, piece);
  x = x < -1 || u == low ? -1 : x > 1 || u == high ? 1 : x;  // ends to the last digit
  return piece != before;
}

// Horner's rule for the curve less the points, with half the second derivative.
template <int Dim>
BATTEN_INLINE void Jets(
    const Group<Dim>& g, int degree, const Lanes* q, Lanes* off, Lanes* first, Lanes* second) {
  for (int d = 0; d < Dim; ++d) {
    Lanes a = g.powers[degree * Dim + d], b{}, c{};
    for (int i = degree - 1; i >= 0; --i) {
      c = c * g.x + b;
      b = b * g.x + a;
      a = a * g.x + g.powers[i * Dim + d];
    }
    off[d] = a - q[d];
    first[d] = b;
    second[d] = c;
  }
}

template <int Dim>
BATTEN_INLINE Lanes Squares(const Group<Dim>& g, int degree, const Lanes* q) {
  Lanes sum{};
  for (int d = 0; d < Dim; ++d) {
    Lanes a = g.powers[degree * Dim + d];
    for (int i = degree - 1; i >= 0; --i) a = a * g.x + g.powers[i * Dim + d];
    sum += (a - q[d]) * (a - q[d]);
  }
  return sum;
}

// Newton steps for one group; returns which lanes have converged.
template <int Dim>
BATTEN_INLINE Mask
Descend(const CurvePieceTable& t, const Lanes* q, Group<Dim>& g, Lanes& squares) {
  const Lanes one = 1.0 - Lanes{};
  Mask done{}, lost{};
  Lanes at_start{};
  for (int step = 0; step < kMaxSteps; ++step) {
    Lanes off[Dim], first[Dim], second[Dim];
    Jets<Dim>(g, t.degree, q, off, first, second);
    Lanes slope{}, straight{}, bend{}, square{};
    for (int d = 0; d < Dim; ++d) {
      square += off[d] * off[d];
      slope += off[d] * first[d];
      straight += first[d] * first[d];
      bend += off[d] * second[d];
    }
    if (step == 0) at_start = square;
    bend = straight + 2.0 * bend;
    const Mask sound = bend > kLeastBend * straight;
    lost |= ~sound & ~done;
    const Lanes newton = -slope / (sound ? bend : one);
    lost |= ~((newton < kFarthest) & (newton > -kFarthest)) & ~done;
    const Lanes move = (done | lost) ? Lanes{} : newton;
    const Lanes from = g.x;
    g.x += move;
    const Mask outside = (g.x > one) | (g.x < -one);
    Mask changed{};
    if (Any(outside)) {
      bool reload = false;
      for (int k = 0; k < kLanes; ++k) {
        if (!outside[k]) continue;
        double x = g.x[k];
        if (Enter(t, g.piece[k], x)) {
          changed[k] = -1;
          reload = true;
        }
        g.x[k] = x;
      }
      if (reload) Load<Dim>(t, g);
    }
    const Lanes moved = g.x - from;
    done |= ~lost & ~changed & (moved < kLastStep) & (-moved < kLastStep);
    if (!Any(~(done | lost))) break;
  }
  squares = Squares<Dim>(g, t.degree, q);
  // Rounding may leave a foot farther than its start.
  return done & ~lost & (squares <= at_start * (1 + kRelativeRounding));
}

template <int Dim>
BATTEN_INLINE void FootPointSet(const CurvePieceTable& t,
                                const double* points,
                                const double* starts,
                                std::ptrdiff_t count,
                                const CurveFootPointsOut& out) {
  int near = 0;
  for (std::ptrdiff_t begin = 0; begin < count; begin += kLanes) {
    Group<Dim> g;
    Lanes q[Dim], squares;
    for (int k = 0; k < kLanes; ++k) {
      const std::ptrdiff_t i = std::min(begin + k, count - 1);
      for (int d = 0; d < Dim; ++d) q[d][k] = points[i * Dim + d];
      near = g.piece[k] = PieceOf(t, starts[i], near);
      g.x[k] = (starts[i] - Middle(t, near)) / Half(t, near);
    }
    Load<Dim>(t, g);
    const Mask found = Descend<Dim>(t, q, g, squares);
    const int used = static_cast<int>(std::min<std::ptrdiff_t>(kLanes, count - begin));
    for (int k = 0; k < used; ++k) {
      const int piece = g.piece[k];
      const double x = g.x[k], u = Middle(t, piece) + x * Half(t, piece);
      out.parameters[begin + k] = x <= -1  ? t.breaks[piece]
                                  : x >= 1 ? t.breaks[piece + 1]
                                           : std::clamp(u, t.breaks[piece], t.breaks[piece + 1]);
      out.squares[begin + k] = squares[k];
      // Between pieces there may be a corner, whose other side has not been looked at.
      const bool at_low = g.x[k] <= -1 + kRelativelyEqual && (t.periodic || piece > 0),
                 at_high = g.x[k] >= 1 - kRelativelyEqual && (t.periodic || piece + 1 < t.pieces);
      out.pieces[begin + k] = found[k] && !at_low && !at_high ? piece : -1;
    }
  }
}

BATTEN_CLONES
void FootPointsInPlane(const CurvePieceTable& t,
                       const double* points,
                       const double* starts,
                       std::ptrdiff_t count,
                       const CurveFootPointsOut& out) {
  FootPointSet<2>(t, points, starts, count, out);
}

BATTEN_CLONES
void FootPointsInSpace(const CurvePieceTable& t,
                       const double* points,
                       const double* starts,
                       std::ptrdiff_t count,
                       const CurveFootPointsOut& out) {
  FootPointSet<3>(t, points, starts, count, out);
}

}  // namespace

void LocalCurveFootPoints(const CurvePieceTable& table,
                          const double* points,
                          const double* starts,
                          std::ptrdiff_t count,
                          const CurveFootPointsOut& out) {
  if (table.dimension == 2) {
    FootPointsInPlane(table, points, starts, count, out);
  } else {
    FootPointsInSpace(table, points, starts, count, out);
  }
}

}  // namespace batten::internal
