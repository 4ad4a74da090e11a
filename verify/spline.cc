// SPDX-License-Identifier: MIT
#include "claims.h"

#include <algorithm>
#include <cstdint>

namespace verify {
namespace {

// The polar form of one span of a spline at p arguments, by de Boor's scheme: values holds the
// p + 1 coefficients that act on the span. [Ramshaw 1989]
Point4 Blossom(const Basis& basis,
               int span,
               std::vector<Point4> values,
               const std::vector<Interval>& arguments) {
  const int p = basis.degree;
  for (int r = 1; r <= p; ++r) {
    for (int k = p; k >= r; --k) {
      const int i = span - p + k;
      const Interval low = basis.knot(i), high = basis.knot(i + p + 1 - r);
      const Interval& at = arguments[r - 1];
      const Interval a = (at - low) / (high - low), b = (high - at) / (high - low);
      Point4 &value = values[k], &before = values[k - 1];
      for (size_t c = 0; c < 4; ++c) value[c] = a * value[c] + b * before[c];
    }
  }
  return values[p];
}

// Bézier points of a span: the blossom at k times the upper and p − k times the lower end.
std::vector<Point4> BezierPoints(const Basis& basis, int span, const std::vector<Point4>& values) {
  const Interval low = basis.knot(span), high = basis.knot(span + 1);
  std::vector<Point4> result;
  for (int k = 0; k <= basis.degree; ++k) {
    std::vector<Interval> arguments(basis.degree, low);
    std::fill_n(arguments.begin(), k, high);
    result.push_back(Blossom(basis, span, values, arguments));
  }
  return result;
}

Basis ReadBasis(const Json& degree, const Json& knots, int size) {
  Basis basis{degree.get<int>(), knots.get<std::vector<double>>()};
  if (basis.degree < 1 || basis.degree > 25 || std::ssize(basis.knots) != size + basis.degree + 1 ||
      size <= basis.degree)
    throw std::runtime_error("a knot vector does not fit its degree and control points");
  if (!std::is_sorted(basis.knots.begin(), basis.knots.end()) || basis.Spans().empty())
    throw std::runtime_error("a knot vector decreases, or has no domain");
  return basis;
}

void ReadPoints(const Json& entry, Shape& shape) {
  const Json& points = entry.at("control_points").at("points");
  const Json& all = entry.at("control_points");
  for (size_t k = 0; k < points.size(); ++k) {
    std::array<double, 4> point{0, 0, 0, 1};
    if (points[k].size() < 2 || points[k].size() > 3)
      throw std::runtime_error("a control point has neither two nor three coordinates");
    for (size_t c = 0; c < points[k].size(); ++c) point[c] = points[k][c].get<double>();
    if (all.contains("weights")) point[3] = all.at("weights").at(k).get<double>();
    if (!(point[3] > 0)) throw std::runtime_error("a weight is not positive");
    shape.points.push_back(point);
  }
}

void MakePieces(Shape& shape) {
  const int p = shape.u.degree, q = shape.surface ? shape.v.degree : 0;
  const int columns = shape.surface ? shape.v.size() : 1;
  for (const int su : shape.u.Spans()) {
    for (const int sv : shape.surface ? shape.v.Spans() : std::vector<int>{0}) {
      Piece piece;
      piece.p = p, piece.q = q;
      piece.net.resize((p + 1) * (q + 1));
      for (int i = 0; i <= p; ++i) {
        std::vector<Point4> row;
        for (int j = 0; j <= q; ++j) {
          const auto& [x, y, z, weight] = shape.points[(su - p + i) * columns + sv - q + j];
          const Interval w = weight;
          const auto& [a, b, c] = shape.origin;  // differences first: they lose least
          row.push_back({w * (Interval(x) - a), w * (Interval(y) - b), w * (Interval(z) - c), w});
        }
        if (shape.surface) row = BezierPoints(shape.v, sv, row);
        std::copy(row.begin(), row.end(), piece.net.begin() + i * (q + 1));
      }
      for (int j = 0; j <= q; ++j) {
        std::vector<Point4> column;
        for (int i = 0; i <= p; ++i) column.push_back(piece.at(i, j));
        column = BezierPoints(shape.u, su, column);
        for (int i = 0; i <= p; ++i) piece.at(i, j) = column[i];
      }
      piece.u0 = shape.u.knot(su), piece.u1 = shape.u.knot(su + 1);
      if (shape.surface) piece.v0 = shape.v.knot(sv), piece.v1 = shape.v.knot(sv + 1);
      shape.pieces.push_back(std::move(piece));
    }
  }
}

}  // namespace

std::vector<int> Basis::Spans() const {
  std::vector<int> spans;
  for (int k = degree; k < size(); ++k)
    if (knot(k) < knot(k + 1)) spans.push_back(k);
  return spans;
}

// The hull over all pieces that the parameters meet. [de Casteljau]
Vector Shape::At(const Interval& at_u, const Interval& at_v) const {
  const auto value = [](std::vector<Point4> points, const Interval& at, double low, double high) {
    const Interval t = (at - low) / (Interval(high) - low);
    for (size_t r = points.size() - 1; r > 0; --r)
      for (size_t k = 0; k < r; ++k)
        for (size_t c = 0; c < 4; ++c)
          points[k][c] = (Interval(1) - t) * points[k][c] + t * points[k + 1][c];
    return points.front();
  };
  Vector hull;
  bool first = true;
  for (const Piece& piece : pieces) {
    if (at_u.hi < piece.u0 || at_u.lo > piece.u1) continue;
    if (surface && (at_v.hi < piece.v0 || at_v.lo > piece.v1)) continue;
    std::vector<Point4> column;
    for (int i = 0; i <= piece.p; ++i) {
      const auto row = piece.net.begin() + i * (piece.q + 1);
      column.push_back(surface ? value({row, row + piece.q + 1}, at_v, piece.v0, piece.v1) : *row);
    }
    const Point4 point = value(std::move(column), at_u, piece.u0, piece.u1);
    for (size_t c = 0; c < 3; ++c) {
      const Interval x = point[c] / point[3];
      hull[c] = first ? x : Hull(hull[c], x);
    }
    first = false;
  }
  return hull;
}

Shape Read(const Json& entry, bool loop) {
  Shape shape;
  shape.surface = entry.contains("degree_u");
  ReadPoints(entry, shape);
  if (!loop && !shape.points.empty()) std::copy_n(shape.points[0].begin(), 3, shape.origin.begin());
  if (shape.surface) {
    const int size_u = entry.at("size_u"), size_v = entry.at("size_v");
    if (std::int64_t{size_u} * size_v != std::ssize(shape.points))
      throw std::runtime_error("size_u times size_v is not the number of control points");
    shape.u = ReadBasis(entry.at("degree_u"), entry.at("knotvector_u"), size_u);
    shape.v = ReadBasis(entry.at("degree_v"), entry.at("knotvector_v"), size_v);
    if (entry.contains("trims"))
      for (const Json& trim : entry.at("trims").at("data")) shape.trims.push_back(Read(trim, true));
  } else {
    shape.u = ReadBasis(
        entry.at("degree"), entry.at("knotvector"), static_cast<int>(shape.points.size()));
  }
  MakePieces(shape);
  return shape;
}

std::array<Piece, 2> Halves(const Piece& piece) {
  const bool across_u = piece.q == 0 || piece.depth % 2 == 0;
  std::array<Piece, 2> halves{piece, piece};
  Piece &low = halves[0], &high = halves[1];
  ++low.depth, ++high.depth;
  const double middle =
      across_u ? piece.u0 + (piece.u1 - piece.u0) / 2 : piece.v0 + (piece.v1 - piece.v0) / 2;
  (across_u ? low.u1 : low.v1) = middle;
  (across_u ? high.u0 : high.v0) = middle;
  const int n = across_u ? piece.p : piece.q, lines = across_u ? piece.q : piece.p;
  for (int line = 0; line <= lines; ++line) {
    const auto of = [&](Piece& in, int k) -> Point4& {
      return across_u ? in.at(k, line) : in.at(line, k);
    };
    for (int r = 1; r <= n; ++r) {
      for (int k = 0; k <= n - r; ++k)
        for (size_t c = 0; c < 4; ++c) of(high, k)[c] = Half(of(high, k)[c], of(high, k + 1)[c]);
      of(low, r) = of(high, 0);
    }
  }
  return halves;
}

}  // namespace verify
