// SPDX-License-Identifier: MIT
#include "claims.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace verify {
namespace {

constexpr int kHalvings = 4, kDeepestArc = 48;  // of loops: to begin with, and at most
constexpr int kMostBoxes = 20000;               // for one point
constexpr int kDeepestRegular = 14;

Interval Coordinate(const Point4& point, size_t c) { return point[c] / point[3]; }
// The box of a piece's Bézier points, which holds the piece: weights are positive.
Vector BoxOf(const Piece& piece) {
  Vector box;
  for (size_t c = 0; c < 3; ++c) {
    box[c] = Coordinate(piece.net.front(), c);
    for (const Point4& point : piece.net) box[c] = Hull(box[c], Coordinate(point, c));
  }
  return box;
}

// Of a point from the origin of a shape.
Vector Relative(const Shape& shape, const Point& q) {
  Vector p;
  for (size_t c = 0; c < 3; ++c) p[c] = Interval(q[c]) - Interval(shape.origin[c]);
  return p;
}

// The squared distance of a point of a box from p.
Interval SquaredDistance(const Vector& box, const Vector& p) {
  Interval sum;
  for (size_t c = 0; c < 3; ++c) sum += Square(box[c] - p[c]);
  return sum;
}

Interval Binomial(int n, int k) {
  Interval value = 1;
  for (int i = 1; i <= k; ++i) value = value * Interval(n - k + i) / Interval(i);
  return value;
}

// A polynomial in Bernstein form, second direction fastest.
struct Polynomial {
  int p, q;
  std::vector<Interval> c;
  Polynomial(int p, int q) : p(p), q(q), c((p + 1) * (q + 1)) {}
  Interval& at(int i, int j) { return c[i * (q + 1) + j]; }
  const Interval& at(int i, int j) const { return c[i * (q + 1) + j]; }
};

// C(m,i) C(n,j) / C(m+n,i+j) for all i and j.
const std::vector<Interval>& Shares(int m, int n) {
  static std::map<std::pair<int, int>, std::vector<Interval>> known;
  std::vector<Interval>& shares = known[{m, n}];
  if (!shares.empty()) return shares;
  for (int i = 0; i <= m; ++i)
    for (int j = 0; j <= n; ++j)
      shares.push_back(Binomial(m, i) * Binomial(n, j) / Binomial(m + n, i + j));
  return shares;
}

// [Farin 2002, §6.10, in two variables]
Polynomial operator*(const Polynomial& a, const Polynomial& b) {
  Polynomial product(a.p + b.p, a.q + b.q);
  const std::vector<Interval>&of_p = Shares(a.p, b.p), &of_q = Shares(a.q, b.q);
  for (int i = 0; i <= a.p; ++i)
    for (int k = 0; k <= b.p; ++k) {
      const Interval share_u = of_p[i * (b.p + 1) + k];
      for (int j = 0; j <= a.q; ++j) {
        const Interval left = share_u * a.at(i, j);
        for (int l = 0; l <= b.q; ++l)
          product.at(i + k, j + l) += left * of_q[j * (b.q + 1) + l] * b.at(k, l);
      }
    }
  return product;
}

Polynomial Plus(Polynomial a, const Polynomial& b, bool minus = false) {
  for (size_t k = 0; k < a.c.size(); ++k) a.c[k] = minus ? a.c[k] - b.c[k] : a.c[k] + b.c[k];
  return a;
}

// Coordinate c of the net, less q times the weights.
Polynomial Component(const Piece& piece, size_t c, const Interval& q) {
  Polynomial result(piece.p, piece.q);
  for (size_t k = 0; k < piece.net.size(); ++k)
    result.c[k] = c == 3 ? piece.net[k][3] : piece.net[k][c] - q * piece.net[k][3];
  return result;
}

// Whether |P − qw|² − lower²w² has no negative Bernstein coefficient.
bool NoNearer(const Piece& piece, const Vector& q, double lower) {
  Polynomial sum(2 * piece.p, 2 * piece.q);
  for (size_t c = 0; c < 4; ++c) {
    const Polynomial part = Component(piece, c, c < 3 ? q[c] : Interval(0));
    Polynomial square = part * part;
    for (Interval& value : square.c)
      if (c == 3) value = -(Square(Interval(lower)) * value);
    sum = Plus(std::move(sum), square);
  }
  return std::all_of(sum.c.begin(), sum.c.end(), [](const Interval& x) { return x.lo >= 0; });
}

Polynomial Derivative(const Polynomial& f, bool by_u) {
  Polynomial d(by_u ? f.p - 1 : f.p, by_u ? f.q : f.q - 1);
  for (int i = 0; i <= d.p; ++i)
    for (int j = 0; j <= d.q; ++j)
      d.at(i, j) =
          Interval(by_u ? f.p : f.q) * ((by_u ? f.at(i + 1, j) : f.at(i, j + 1)) - f.at(i, j));
  return d;
}

// d · (w P_u × P_v + w_u P_v × P + w_v P × P_u), which is w³ d · (S_u × S_v), about a point of the
// piece.
bool KeepsSign(const Piece& piece, const Point& direction) {
  const Point4& corner = piece.net.front();
  std::vector<Polynomial> f, fu, fv;
  for (size_t c = 0; c < 4; ++c) {
    f.push_back(Component(piece, c, Coordinate(corner, c).lo));
    fu.push_back(Derivative(f[c], true));
    fv.push_back(Derivative(f[c], false));
  }
  const auto along = [&](const std::vector<Polynomial>& a, const std::vector<Polynomial>& b) {
    Polynomial sum(a[0].p + b[0].p, a[0].q + b[0].q);
    for (size_t c = 0; c < 3; ++c) {
      const size_t x = (c + 1) % 3, y = (c + 2) % 3;
      Polynomial part = Plus(a[x] * b[y], a[y] * b[x], true);
      for (Interval& value : part.c) value = Interval(direction[c]) * value;
      sum = Plus(std::move(sum), part);
    }
    return sum;
  };
  const Polynomial value =
      Plus(Plus(f[3] * along(fu, fv), fu[3] * along(fv, f)), fv[3] * along(f, fu));
  return std::all_of(value.c.begin(), value.c.end(), [](const Interval& x) { return x.lo > 0; });
}

// Any direction will do.
Point DirectionOf(const Piece& piece) {
  const auto at = [&](int i, int j, size_t c) { return Coordinate(piece.at(i, j), c).lo; };
  std::array<double, 3> a, b;
  for (size_t c = 0; c < 3; ++c) {
    a[c] = at(piece.p, piece.q, c) - at(0, 0, c);
    b[c] = at(0, piece.q, c) - at(piece.p, 0, c);
  }
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

}  // namespace

Region::Region(const Shape& shape) {
  for (const Shape& loop : shape.trims)
    arcs_.insert(arcs_.end(), loop.pieces.begin(), loop.pieces.end());
  for (int halving = 0; halving < kHalvings; ++halving) {
    std::vector<Piece> finer;
    for (const Piece& arc : arcs_)
      for (Piece& half : Halves(arc)) finer.push_back(std::move(half));
    arcs_ = std::move(finer);
  }
}

int Region::Crossings(double u, double v, int turn) const {
  // x and y of a turned frame: (u, v), (v, u), (−u, v), (−v, u).
  const size_t along = turn % 2 == 0 ? 0 : 1;
  const double sign = turn < 2 ? 1 : -1, x = sign * (along == 0 ? u : v), y = along == 0 ? v : u;
  int crossings = 0;
  std::vector<Piece> waiting = arcs_;
  while (!waiting.empty()) {
    const Piece piece = std::move(waiting.back());
    waiting.pop_back();
    const Vector box = BoxOf(piece);
    const Interval far = sign > 0 ? box[along] : -box[along], level = box[1 - along];
    if (far.hi < x || level.hi < y || level.lo > y) continue;
    const Interval first = Coordinate(piece.net.front(), 1 - along);
    const Interval last = Coordinate(piece.net.back(), 1 - along);
    const bool known = (first.hi < y || first.lo > y) && (last.hi < y || last.lo > y);
    if (known && far.lo > x) {
      crossings += (first.lo > y) != (last.lo > y);
      continue;
    }
    if (piece.depth == kDeepestArc || (!known && far.lo > x && piece.depth > 2 * kHalvings))
      return -1;  // next to (u, v), or an end on the ray
    for (Piece& half : Halves(piece)) waiting.push_back(std::move(half));
  }
  return crossings % 2;
}

Side Region::Of(double u, double v) const {
  if (arcs_.empty()) return Side::kInside;
  for (int turn = 0; turn < 4; ++turn) {
    const int crossings = Crossings(u, v, turn);
    if (crossings >= 0) return crossings == 1 ? Side::kInside : Side::kOutside;
  }
  return Side::kUnknown;
}

Side Region::OfBox(double u0, double u1, double v0, double v1) const {
  if (arcs_.empty()) return Side::kInside;
  u0 = Down(u0), v0 = Down(v0), u1 = Up(u1), v1 = Up(v1);  // ends of halves are rounded
  std::vector<Piece> waiting = arcs_;
  while (!waiting.empty()) {
    const Piece piece = std::move(waiting.back());
    waiting.pop_back();
    const Vector box = BoxOf(piece);
    if (box[0].hi < u0 || box[0].lo > u1 || box[1].hi < v0 || box[1].lo > v1) continue;
    const double size = std::max(box[0].hi - box[0].lo, box[1].hi - box[1].lo);
    if (piece.depth == kDeepestArc || !(size >= std::max(u1 - u0, v1 - v0) / 4))
      return Side::kUnknown;
    for (Piece& half : Halves(piece)) waiting.push_back(std::move(half));
  }
  return Of(u0 + (u1 - u0) / 2, v0 + (v1 - v0) / 2);
}

bool ProveLower(const Shape& shape, const Region& region, const Point& q, double lower) {
  if (!(lower > 0)) return lower == 0;
  const double square = Square(Interval(lower)).hi;
  const Vector p = Relative(shape, q);
  int boxes = 0;
  for (const Piece& piece : shape.pieces) {
    if (SquaredDistance(BoxOf(piece), p).lo >= square) continue;
    std::vector<Piece> waiting{piece};
    while (!waiting.empty()) {
      const Piece box = std::move(waiting.back());
      waiting.pop_back();
      if (++boxes > kMostBoxes) return false;
      if (SquaredDistance(BoxOf(box), p).lo >= square || NoNearer(box, p, lower)) continue;
      if (shape.surface && region.OfBox(box.u0, box.u1, box.v0, box.v1) == Side::kOutside) continue;
      for (Piece& half : Halves(box)) waiting.push_back(std::move(half));
      if (waiting.back().u1 <= waiting.back().u0) return false;
    }
  }
  return true;
}

bool ProveUpper(const Shape& shape, const Region& region, const Point& q, double upper, Place at) {
  const auto [u, v, loop] = at;
  Interval at_u = u, at_v = v;
  if (loop >= 0) {
    const Shape& curve = shape.trims.at(loop);
    if (!curve.u.Holds(u)) return false;
    const Vector on = curve.At(u, 0);
    // Loops may run along the domain's edge, where rounding is outside of it.
    const auto inside = [](const Interval& at, const Basis& basis) {
      return Interval(std::clamp(at.lo, basis.lower(), basis.upper()),
                      std::clamp(at.hi, basis.lower(), basis.upper()));
    };
    at_u = inside(on[0], shape.u);
    at_v = inside(on[1], shape.v);
  } else if (!shape.u.Holds(u) ||
             (shape.surface && !(shape.v.Holds(v) && region.Of(u, v) == Side::kInside))) {
    return false;
  }
  return Root(SquaredDistance(shape.At(at_u, at_v), Relative(shape, q))).hi <= upper;
}

namespace {

// Adds the boxes of a piece on which no direction was found that normals keep to.
void Regular(const Piece& piece, const Region& region, Boxes& unproved) {
  if (KeepsSign(piece, DirectionOf(piece))) return;
  if (region.OfBox(piece.u0, piece.u1, piece.v0, piece.v1) == Side::kOutside) return;
  if (piece.depth == kDeepestRegular) {
    unproved.push_back({piece.u0, piece.u1, piece.v0, piece.v1});
    return;
  }
  for (const Piece& half : Halves(piece)) Regular(half, region, unproved);
}

// The same of both sides together of a line of knots between two pieces. `v`: it runs along u.
void Creased(const Piece& low, const Piece& high, bool v, const Region& region, Boxes& unproved) {
  const Point a = DirectionOf(low), b = DirectionOf(high);
  const double of_a = std::hypot(a[0], a[1], a[2]), of_b = std::hypot(b[0], b[1], b[2]);
  const Point d{a[0] / of_a + b[0] / of_b, a[1] / of_a + b[1] / of_b, a[2] / of_a + b[2] / of_b};
  if (of_a > 0 && of_b > 0 && KeepsSign(low, d) && KeepsSign(high, d)) return;
  if (region.OfBox(low.u0, low.u1, low.v0, low.v1) == Side::kOutside) return;
  if (low.depth == kDeepestRegular) {
    unproved.push_back({v ? low.u0 : low.u1, low.u1, v ? low.v1 : low.v0, low.v1});
    return;
  }
  const std::array<Piece, 2> lows = Halves(low), highs = Halves(high);
  if ((low.depth % 2 == 1) == v) return Creased(lows[1], highs[0], v, region, unproved);
  for (size_t k = 0; k < 2; ++k) Creased(lows[k], highs[k], v, region, unproved);
}

}  // namespace

Boxes UnprovedRegularity(const Shape& shape, const Region& region) {
  Boxes unproved;
  const auto creased = [](const Basis& basis, double knot) {
    return knot > basis.lower() &&
           std::count(basis.knots.begin(), basis.knots.end(), knot) >= basis.degree;
  };
  const size_t columns = shape.v.Spans().size();
  for (size_t k = 0; k < shape.pieces.size(); ++k) {
    const Piece& piece = shape.pieces[k];
    Regular(piece, region, unproved);
    if (creased(shape.u, piece.u0))
      Creased(shape.pieces[k - columns], piece, false, region, unproved);
    if (creased(shape.v, piece.v0)) Creased(shape.pieces[k - 1], piece, true, region, unproved);
  }
  return unproved;
}

}  // namespace verify
