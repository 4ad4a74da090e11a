// SPDX-License-Identifier: MIT
// NURBS curves and surfaces as files have them, their Bézier pieces in intervals, and the proofs.
#pragma once

#include <array>
#include <nlohmann/json.hpp>
#include <stdexcept>
#include <string>
#include <vector>

#include "interval.h"

namespace verify {

using Json = nlohmann::json;
using Vector = std::array<Interval, 3>;
using Point4 = std::array<Interval, 4>;  // w·x, w·y, w·z, w

struct Basis {
  int degree = 0;
  std::vector<double> knots;
  int size() const { return static_cast<int>(knots.size()) - degree - 1; }
  double knot(int k) const { return knots.at(k); }
  double lower() const { return knot(degree); }
  double upper() const { return knot(size()); }
  bool Holds(double at) const { return at >= lower() && at <= upper(); }
  std::vector<int> Spans() const;  // of positive length, in the domain
};

// Bézier points of one cell between knots, second direction fastest.
struct Piece {
  int p = 0, q = 0, depth = 0;  // depth: how often it was halved
  double u0 = 0, u1 = 0, v0 = 0, v1 = 0;
  std::vector<Point4> net;
  const Point4& at(int i, int j) const { return net[i * (q + 1) + j]; }
  Point4& at(int i, int j) { return net[i * (q + 1) + j]; }
};

// A surface, or a curve with q = 0.
struct Shape {
  bool surface = false;
  Basis u, v;
  std::vector<std::array<double, 4>> points;  // x, y, z, w, second direction fastest
  std::vector<Shape> trims;                   // curves in the parameter plane
  std::array<double, 3> origin{};             // near to the points: pieces are less by it
  std::vector<Piece> pieces;                  // filled by Read

  Vector At(const Interval& u, const Interval& v) const;
};

// One entry of "data", or a trim loop of one, whose origin is zero. Throws std::runtime_error
// naming what is wrong.
Shape Read(const Json& entry, bool loop = false);

// The halves of a piece, across the two directions by turns. [de Casteljau]
std::array<Piece, 2> Halves(const Piece& piece);

using Point = std::array<double, 3>;
enum class Side { kInside, kOutside, kUnknown };

// The part of the parameter plane that loops enclose, by the even-odd rule; no loops: all of it.
class Region {
 public:
  explicit Region(const Shape& shape);
  Side Of(double u, double v) const;
  // Of a whole box.
  Side OfBox(double u0, double u1, double v0, double v1) const;

 private:
  // How often a ray from (u, v) along +x of turned axes crosses the loops: 0 even, 1 odd, −1
  // unknown.
  int Crossings(double u, double v, int turn) const;
  std::vector<Piece> arcs_;
};

// Whether no point of the shape inside the region is nearer to q than `lower`.
bool ProveLower(const Shape& shape, const Region& region, const Point& q, double lower);

// Whether the place is a point of the shape within `upper` of q: S(u, v) or, with loop ≥ 0, the
// point of that trim loop at u.
struct Place {
  double u, v;
  int loop;
};
bool ProveUpper(const Shape& shape, const Region& region, const Point& q, double upper, Place at);

// Parameter boxes [u0, u1, v0, v1] of the region on which S_u × S_v was not proved to keep the sign
// along a fixed direction, so not to vanish; without width, of lines of knots, not to turn over.
using Boxes = std::vector<std::array<double, 4>>;
Boxes UnprovedRegularity(const Shape& shape, const Region& region);

}  // namespace verify
