// SPDX-License-Identifier: MIT
#include "geometry/section/section_trace.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <unordered_map>
#include <utility>

#include "geometry/bezier/bernstein_polynomial.h"
#include "batten/geometry/iso_curve.h"
#include "geometry/bezier/spline_pieces.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/nurbs/span_breaks.h"

namespace batten::internal {
namespace {

constexpr int kBits = 20;  // a span is 2^20 steps of the grid
constexpr std::int64_t kSpan = std::int64_t{1} << kBits;
constexpr std::size_t kMostCells = 4'000'000;
constexpr double kInside = 0x1p-10;  // of a span: where an edge in the plane gets its signs

// A rectangle of the grid with the Bernstein coefficients of f times the weight.
struct Cell {
  std::int64_t u0, u1, v0, v1;
  std::vector<double> f;
};

struct GridVertex {
  std::int64_t u, v;
  bool operator==(const GridVertex&) const = default;
};

struct GridVertexHash {
  std::size_t operator()(const GridVertex& x) const {
    return static_cast<std::size_t>(x.u) * 0x9E3779B97F4A7C15u ^
           static_cast<std::size_t>(x.v) * 0xC2B2AE3D27D4EB4Fu;
  }
};

// The part of a cell between two neighbouring vertices of a grid line, by its lower end.
struct Side {
  GridVertex low, high;
  bool operator==(const Side&) const = default;
};

struct SideHash {
  std::size_t operator()(const Side& x) const {
    return GridVertexHash()(x.low) * 31 + GridVertexHash()(x.high);
  }
};

// Rows i0 … i1 and columns j0 … j1 of the coefficients: without those of an edge in the plane,
// which are zero; what is next to them has the sign and the zeros of the derivative inwards.
struct Inner {
  int i0, i1, j0, j1;
};

// Of coefficients, those above −zero taken as positive.
int SignChanges(const std::vector<double>& f, int first, int stride, int count, double zero) {
  int changes = 0;
  for (int k = 1; k < count; ++k) {
    const bool was = f[first + (k - 1) * stride] >= -zero, is = f[first + k * stride] >= -zero;
    if (was != is) ++changes;
  }
  return changes;
}

class Tracer {
 public:
  Tracer(const NurbsSurface& surface, const Eigen::Vector3d& normal, double offset, double tol)
      : surface_(surface),
        pieces_(surface),
        normal_(normal),
        offset_(offset),
        tolerance_(tol),
        p_(surface.basis_u().degree()),
        q_(surface.basis_v().degree()),
        breaks_u_(BreaksIn(surface.basis_u())),
        breaks_v_(BreaksIn(surface.basis_v())) {
    const auto& points = surface.control_points();
    const double units = 4 * std::numeric_limits<double>::epsilon();
    const double size = BoxDiagonal(points);
    rounding_ = units * ((7 * p_ + 7 * q_ + 4) * size + 3 * points.cwiseAbs().maxCoeff() +
                         std::abs(offset));
    const auto edges = BoundaryCurves(surface);
    for (int k = 0; k < 4; ++k) trace_.edges[k] = InPlane(edges[k].control_points());
  }

  SectionTrace Trace() {
    contained_.assign(breaks_u_.size() * breaks_v_.size(), false);
    std::vector<Cell> roots;
    for (int i = 0; i < pieces_.count_u(); ++i) {
      for (int j = 0; j < pieces_.count_v(); ++j) AddPatch(i, j, roots);
    }
    for (Cell& root : roots) Subdivide(std::move(root));
    for (auto* lines : {&on_u_, &on_v_}) {
      for (auto& [line, places] : *lines) {
        std::sort(places.begin(), places.end());
        places.erase(std::unique(places.begin(), places.end()), places.end());
      }
    }
    for (const Cell& leaf : leaves_) LinkLeaf(leaf);
    MakeChains();
    return std::move(trace_);
  }

 private:
  bool InPlane(const Eigen::Matrix3Xd& points) const {
    return ((normal_.transpose() * points).array() - offset_).abs().maxCoeff() <= rounding_;
  }

  // --- Parameters and signs

  static double ParameterAt(const std::vector<double>& breaks, std::int64_t place) {
    const auto i = static_cast<std::size_t>(place >> kBits);
    const std::int64_t part = place & (kSpan - 1);
    if (part == 0) return breaks[i];
    return breaks[i] + static_cast<double>(part) / kSpan * (breaks[i + 1] - breaks[i]);
  }
  Eigen::Vector2d ParametersOf(const GridVertex& x) const {
    return {ParameterAt(breaks_u_, x.u), ParameterAt(breaks_v_, x.v)};
  }

  std::int64_t end_u() const { return std::int64_t{pieces_.count_u()} << kBits; }
  std::int64_t end_v() const { return std::int64_t{pieces_.count_v()} << kBits; }

  // Whether a vertex lies on an edge in the plane; the edge's number, or −1.
  int EdgeInPlane(const GridVertex& x) const {
    if (trace_.edges[0] && x.u == 0) return 0;
    if (trace_.edges[1] && x.u == end_u()) return 1;
    if (trace_.edges[2] && x.v == 0) return 2;
    if (trace_.edges[3] && x.v == end_v()) return 3;
    return -1;
  }

  double Height(double u, double v) const { return normal_.dot(surface_.At(u, v)) - offset_; }

  // The place itself, a little inside where it is on an edge in the plane.
  double InwardHeight(double u, double v) const {
    const auto inside = [](const SplineBasis& basis, bool lower, bool upper, double x) {
      const std::vector<double>& U = basis.knots();
      const int span = basis.Span(x);
      const double step = kInside * (U[span + 1] - U[span]);
      if (lower && x == basis.lower()) return x + step;
      return upper && x == basis.upper() ? x - step : x;
    };
    return Height(inside(surface_.basis_u(), trace_.edges[0], trace_.edges[1], u),
                  inside(surface_.basis_v(), trace_.edges[2], trace_.edges[3], v));
  }

  bool InContainedPatch(const GridVertex& x) const {
    if (!trace_.contains_patch) return false;
    const auto touches = [&](std::int64_t i, std::int64_t j) {
      return i >= 0 && j >= 0 && i < pieces_.count_u() && j < pieces_.count_v() &&
             contained_[i * breaks_v_.size() + j];
    };
    const std::int64_t i = x.u >> kBits, j = x.v >> kBits;
    const bool on_u = x.u % kSpan == 0, on_v = x.v % kSpan == 0;
    return touches(i, j) || (on_u && touches(i - 1, j)) || (on_v && touches(i, j - 1)) ||
           (on_u && on_v && touches(i - 1, j - 1));
  }

  bool Positive(const GridVertex& x) {
    const auto [place, fresh] = positive_.try_emplace(x, true);
    if (!fresh || InContainedPatch(x)) return place->second;
    const Eigen::Vector2d at = ParametersOf(x);
    const double height = EdgeInPlane(x) >= 0 ? InwardHeight(at[0], at[1]) : Height(at[0], at[1]);
    return place->second = height + rounding_ >= 0;
  }

  // --- Cells

  void AddPatch(int i, int j, std::vector<Cell>& roots) {
    const SurfacePiece piece = pieces_.Piece(i, j);
    const double height = normal_.dot(piece.origin) - offset_;
    Cell cell{i * kSpan, (i + 1) * kSpan, j * kSpan, (j + 1) * kSpan, {}};
    const Eigen::RowVectorXd w = piece.points.row(3);
    const Eigen::RowVectorXd f = normal_.transpose() * piece.points.topRows<3>() + height * w;
    cell.f.assign(f.data(), f.data() + f.size());
    if ((f.array().abs() <= tolerance_ * w.array()).all()) {
      contained_[i * breaks_v_.size() + j] = true;
      trace_.contains_patch = true;
      return;
    }
    const double least = w.minCoeff(), most = w.maxCoeff();
    for (double& x : cell.f) x /= least;
    weight_ratio_ = std::max(weight_ratio_, most / least);
    cell.f.resize(cell.f.size() + kReadPast, 0);
    roots.push_back(std::move(cell));
  }

  Inner InnerOf(const Cell& c) const {
    return {trace_.edges[0] && c.u0 == 0 ? 1 : 0,
            trace_.edges[1] && c.u1 == end_u() ? p_ - 1 : p_,
            trace_.edges[2] && c.v0 == 0 ? 1 : 0,
            trace_.edges[3] && c.v1 == end_v() ? q_ - 1 : q_};
  }

  bool OneSign(const Cell& c, const Inner& in) const {
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (int i = in.i0; i <= in.i1; ++i) {
      for (int j = in.j0; j <= in.j1; ++j) {
        least = std::min(least, c.f[i * (q_ + 1) + j]);
        most = std::max(most, c.f[i * (q_ + 1) + j]);
      }
    }
    // Beyond what the sign of a vertex may be wrong by.
    const bool inner = in.i0 > 0 || in.j0 > 0 || in.i1 < p_ || in.j1 < q_;
    const double sure = 2 * rounding_ * weight_ratio_ * (inner ? 4 / kInside : 1);
    return least >= -rounding_ / 2 || most <= -sure;
  }

  // Whether f is monotone in one variable, by first differences.
  bool Monotone(const Cell& c, const Inner& in, bool along_u) const {
    bool rises = true, falls = true;
    const int step = along_u ? q_ + 1 : 1;
    for (int i = in.i0; i <= in.i1 - (along_u ? 1 : 0); ++i) {
      for (int j = in.j0; j <= in.j1 - (along_u ? 0 : 1); ++j) {
        const int k = i * (q_ + 1) + j;
        rises = rises && c.f[k + step] >= c.f[k];
        falls = falls && c.f[k + step] <= c.f[k];
      }
    }
    return rises || falls;
  }

  bool Simple(const Cell& c, const Inner& in) const {
    const bool edge_v = in.j0 > 0 || in.j1<q_, edge_u = in.i0> 0 || in.i1 < p_;
    if (!(!edge_u && Monotone(c, in, true)) && !(!edge_v && Monotone(c, in, false))) return false;
    const int n = q_ + 1, wide = in.j1 - in.j0 + 1, tall = in.i1 - in.i0 + 1;
    const auto once = [&](int i, int j, int stride, int count) {
      return SignChanges(c.f, i * n + j, stride, count, rounding_ * weight_ratio_) <= 1;
    };
    return once(in.i0, in.j0, 1, wide) && once(in.i1, in.j0, 1, wide) &&
           once(in.i0, in.j0, n, tall) && once(in.i0, in.j1, n, tall);
  }

  bool Flat(const Cell& c) const {
    const int count = (p_ + 1) * (q_ + 1);
    for (int k = 0; k < count; ++k) {
      if (std::abs(c.f[k]) > tolerance_) return false;
    }
    return true;
  }

  // Across which direction to cut: the one that bends more, else the longer one.
  bool CutsU(const Cell& c) const {
    if (c.u1 - c.u0 == 1 || c.v1 - c.v0 == 1) return c.v1 - c.v0 == 1;
    constexpr double kClearly = 2;
    const PolynomialBounds bounds = BoundsOf(c.f.data(), p_, q_);
    if (bounds.bend_x > kClearly * bounds.bend_y) return true;
    if (bounds.bend_y > kClearly * bounds.bend_x) return false;
    return c.u1 - c.u0 >= c.v1 - c.v0;
  }

  void Subdivide(Cell root) {
    std::vector<Cell> cells;
    cells.push_back(std::move(root));
    while (!cells.empty()) {
      Cell c = std::move(cells.back());
      cells.pop_back();
      ++cells_seen_;
      const Inner in = InnerOf(c);
      if (in.i0 <= in.i1 && in.j0 <= in.j1) {
        if (OneSign(c, in)) continue;
        const bool smallest = c.u1 - c.u0 == 1 && c.v1 - c.v0 == 1;
        if (!smallest && cells_seen_ < kMostCells && !Simple(c, in) && !Flat(c)) {
          Halve(c, cells);
          continue;
        }
      }
      Keep(std::move(c));
    }
  }

  void Halve(Cell& c, std::vector<Cell>& cells) const {
    Cell high = c;
    if (CutsU(c)) {
      HalveFirst(c.f.data(), p_, q_, 1, c.f.data(), high.f.data());
      c.u1 = high.u0 = (c.u0 + c.u1) / 2;
    } else {
      HalveSecond(c.f.data(), p_, q_, 1, c.f.data(), high.f.data());
      c.v1 = high.v0 = (c.v0 + c.v1) / 2;
    }
    cells.push_back(std::move(high));
    cells.push_back(std::move(c));
  }

  void Keep(Cell c) {
    for (const std::int64_t u : {c.u0, c.u1}) {
      for (const std::int64_t v : {c.v0, c.v1}) {
        on_u_[u].push_back(v);
        on_v_[v].push_back(u);
      }
    }
    leaves_.push_back(std::move(c));
  }

  // --- Links

  // Where f changes sign between two neighbouring vertices; a vertex whose f is zero to rounding
  // where that is next to it.
  int Crossing(const GridVertex& a, const GridVertex& b) {
    const bool along_u = a.v == b.v, turned = along_u ? a.u > b.u : a.v > b.v;
    const Side side = turned ? Side{b, a} : Side{a, b};
    const auto [place, fresh] = crossings_.try_emplace(side, static_cast<int>(trace_.nodes.size()));
    if (!fresh) return place->second;
    const GridVertex& plus = Positive(side.low) ? side.low : side.high;
    const GridVertex& minus = Positive(side.low) ? side.high : side.low;
    const Eigen::Vector2d from = ParametersOf(plus), to = ParametersOf(minus);
    const int edge = EdgeInPlane(plus);
    const bool on_edge = edge >= 0 && edge == EdgeInPlane(minus);
    const bool uneven = edge >= 0 || EdgeInPlane(minus) >= 0 || InContainedPatch(plus);
    const auto height = [&](const Eigen::Vector2d& at) {
      return (on_edge ? InwardHeight(at[0], at[1]) : Height(at[0], at[1])) + rounding_;
    };
    constexpr double kNext = 1e-9;
    const Eigen::Vector2d zero = Zero(height, from, to, uneven);
    const bool at_vertex = !uneven && height(from) <= 2 * rounding_ &&
                           (zero - from).norm() <= kNext * (to - from).norm();
    trace_.nodes.push_back(at_vertex ? from : zero);
    return place->second;
  }

  // Illinois' rule with halvings between; only halvings where f at the ends is not what their signs
  // come from.
  template <typename Function>
  static Eigen::Vector2d Zero(const Function& f,
                              Eigen::Vector2d plus,
                              Eigen::Vector2d minus,
                              bool uneven) {
    constexpr int kSteps = 80;
    double high = f(plus), low = f(minus);
    Eigen::Vector2d at = (plus + minus) / 2;
    for (int k = 0, side = 0; k < kSteps; ++k) {
      const bool halve = uneven || k % 3 == 2;
      at = halve ? Eigen::Vector2d((plus + minus) / 2)
                 : Eigen::Vector2d(plus + high / (high - low) * (minus - plus));
      if (at == plus || at == minus) break;
      const double value = f(at);
      if (value == 0) break;
      if (value > 0) {
        plus = at;
        high = value;
        if (std::exchange(side, 1) == 1) low /= 2;
      } else {
        minus = at;
        low = value;
        if (std::exchange(side, -1) == -1) high /= 2;
      }
    }
    return at;
  }

  // Vertices on the line between two corners of a leaf, from `from` on, without `to`.
  void Walk(std::vector<GridVertex>& ring, const GridVertex& from, const GridVertex& to) const {
    const bool along_u = from.v == to.v;
    const auto& places = along_u ? on_v_.at(from.v) : on_u_.at(from.u);
    const std::int64_t a = along_u ? from.u : from.v, b = along_u ? to.u : to.v;
    const auto vertex = [&](std::int64_t at) {
      return along_u ? GridVertex{at, from.v} : GridVertex{from.u, at};
    };
    const auto low = std::lower_bound(places.begin(), places.end(), std::min(a, b));
    const auto high = std::upper_bound(low, places.end(), std::max(a, b));
    if (a < b) {
      for (auto k = low; k + 1 != high; ++k) ring.push_back(vertex(*k));
    } else {
      for (auto k = high; --k != low;) ring.push_back(vertex(*k));
    }
  }

  struct Passage {
    int node;
    bool leaves;  // the ring goes from + to − here: a chain with + on its left begins
    double u, v;
  };

  void LinkLeaf(const Cell& c) {
    std::vector<GridVertex> ring;
    const GridVertex corners[] = {{c.u0, c.v0}, {c.u1, c.v0}, {c.u1, c.v1}, {c.u0, c.v1}};
    for (int k = 0; k < 4; ++k) Walk(ring, corners[k], corners[(k + 1) % 4]);
    std::vector<Passage> passages;
    for (std::size_t k = 0; k < ring.size(); ++k) {
      const GridVertex &a = ring[k], &b = ring[(k + 1) % ring.size()];
      if (Positive(a) == Positive(b)) continue;
      const int node = Crossing(a, b);
      passages.push_back({node, Positive(a), trace_.nodes[node][0], trace_.nodes[node][1]});
    }
    if (passages.empty()) return;
    if (passages.size() > 2 && PairInOrder(c, passages)) return;
    // Cut off what has the other sign than the middle.
    const bool middle = Height(ParameterAt(breaks_u_, (c.u0 + c.u1) / 2),
                               ParameterAt(breaks_v_, (c.v0 + c.v1) / 2)) >= 0;
    const std::size_t n = passages.size();
    for (std::size_t k = 0; k < n; ++k) {
      if (passages[k].leaves)
        Link(c, passages[k], passages[middle ? (k + 1) % n : (k + n - 1) % n]);
    }
  }

  // In a leaf where f is monotone in one variable the chains are graphs over the other, one after
  // the other.
  bool PairInOrder(const Cell& c, std::vector<Passage> passages) {
    const Inner in = InnerOf(c);
    const bool over_v = Monotone(c, in, true);
    if (!over_v && !Monotone(c, in, false)) return false;
    std::stable_sort(passages.begin(), passages.end(), [&](const Passage& a, const Passage& b) {
      return over_v ? a.v < b.v : a.u < b.u;
    });
    for (std::size_t k = 0; k < passages.size(); k += 2) {
      if (passages[k].leaves == passages[k + 1].leaves) return false;
    }
    for (std::size_t k = 0; k < passages.size(); k += 2) {
      const int first = passages[k].leaves ? 0 : 1;
      Link(c, passages[k + first], passages[k + 1 - first]);
    }
    return true;
  }

  void Link(const Cell& c, const Passage& from, const Passage& to) {
    const Inner in = InnerOf(c);
    links_.push_back({from.node,
                      to.node,
                      static_cast<int>(c.u0 >> kBits),
                      static_cast<int>(c.v0 >> kBits),
                      {ParameterAt(breaks_u_, c.u0),
                       ParameterAt(breaks_u_, c.u1),
                       ParameterAt(breaks_v_, c.v0),
                       ParameterAt(breaks_v_, c.v1)},
                      Monotone(c, in, true),
                      Monotone(c, in, false)});
  }

  void MakeChains() {
    std::vector<int> out(trace_.nodes.size(), -1);
    std::vector<bool> entered(trace_.nodes.size(), false);
    for (std::size_t k = 0; k < links_.size(); ++k) {
      out[links_[k].from] = static_cast<int>(k);
      entered[links_[k].to] = true;
    }
    const auto follow = [&](int node) {
      std::vector<SectionLink> chain;
      for (int k; (k = std::exchange(out[node], -1)) >= 0; node = links_[k].to) {
        chain.push_back(links_[k]);
      }
      if (!chain.empty()) trace_.chains.push_back(std::move(chain));
    };
    const auto count = static_cast<int>(trace_.nodes.size());
    for (int node = 0; node < count; ++node) {
      if (!entered[node]) follow(node);
    }
    for (int node = 0; node < count; ++node) follow(node);
  }

  const NurbsSurface& surface_;
  SurfacePieces pieces_;
  Eigen::Vector3d normal_;
  double offset_, tolerance_, rounding_ = 0, weight_ratio_ = 1;
  int p_, q_;
  std::vector<double> breaks_u_, breaks_v_;
  std::vector<bool> contained_;
  std::size_t cells_seen_ = 0;
  std::vector<Cell> leaves_;
  std::unordered_map<std::int64_t, std::vector<std::int64_t>> on_u_, on_v_;
  std::unordered_map<GridVertex, bool, GridVertexHash> positive_;
  std::unordered_map<Side, int, SideHash> crossings_;
  std::vector<SectionLink> links_;
  SectionTrace trace_;
};

}  // namespace

SectionTrace TraceSection(const NurbsSurface& surface,
                          const Eigen::Vector3d& normal,
                          double offset,
                          double tolerance) {
  return Tracer(surface, normal, offset, tolerance).Trace();
}

}  // namespace batten::internal
