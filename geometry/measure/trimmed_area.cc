// SPDX-License-Identifier: MIT
#include "geometry/measure/trimmed_area.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>
#include <vector>

#include "batten/geometry/surface_evaluator.h"
#include "geometry/editing/monotone_arcs.h"
#include "geometry/measure/untrimmed_area.h"
#include "geometry/numeric/adaptive_sum.h"
#include "geometry/numeric/gauss_rule.h"

namespace batten::internal {
namespace {

constexpr double kTrimmedTolerance = 1e-10;
constexpr double kLeastTrimmedPart = 0x1p-30;  // of an arc: shorter parts are not cut
constexpr double kNoHeight = 1e-14;            // of the domain

// What an arc sweeps along u between t0 and t1: from the line x = near, the fractions [f0, f1] of
// the way to the arc. Where there is no arc its place is taken by the line x = far from y0 to y1.
struct Sweep {
  const MonotoneArc* arc;
  double near, far, y0, y1;
  double t0 = 0, t1 = 1, f0 = 0, f1 = 1;
  CellIntegral integral = {};

  MonotoneArc::Rise At(double t) const {
    if (arc != nullptr) return arc->RiseAt(t);
    return {far, y0 + t * (y1 - y0), y1 - y0};
  }
};

class SweepQuadrature {
 public:
  SweepQuadrature(const NurbsSurface& surface, const UnitDomain& domain)
      : surface_(surface), domain_(domain) {}

  Sweep Measured(Sweep sweep) const {
    const double fine = Integral(sweep, fine_);
    sweep.integral = {fine, std::abs(fine - Integral(sweep, coarse_))};
    return sweep;
  }

  std::vector<Sweep> Split(const Sweep& sweep) const {
    if (sweep.t1 - sweep.t0 <= kLeastTrimmedPart) return {};
    const double t = (sweep.t0 + sweep.t1) / 2, f = (sweep.f0 + sweep.f1) / 2;
    std::vector<Sweep> parts;
    for (const auto& [t0, t1] : {std::pair(sweep.t0, t), std::pair(t, sweep.t1)}) {
      for (const auto& [f0, f1] : {std::pair(sweep.f0, f), std::pair(f, sweep.f1)}) {
        Sweep part = sweep;
        part.t0 = t0;
        part.t1 = t1;
        part.f0 = f0;
        part.f1 = f1;
        parts.push_back(Measured(part));
      }
    }
    return parts;
  }

 private:
  double Integral(const Sweep& sweep, const GaussRule& rule) const {
    const Eigen::Index count = rule.nodes.size();
    double sum = 0;
    for (Eigen::Index i = 0; i < count; ++i) {
      const auto at = sweep.At(sweep.t0 + (sweep.t1 - sweep.t0) * rule.nodes[i]);
      const double width = at.x - sweep.near;
      double across = 0;
      for (Eigen::Index k = 0; k < count; ++k) {
        const double f = sweep.f0 + (sweep.f1 - sweep.f0) * rule.nodes[k];
        const Eigen::Vector2d uv = domain_.Back({sweep.near + f * width, at.y});
        const SurfaceJet jet = surface_.JetAt(uv[0], uv[1]);
        across += rule.weights[k] * jet.du.cross(jet.dv).norm();
      }
      sum += rule.weights[i] * across * width * at.slope_y;
    }
    return sum * (sweep.t1 - sweep.t0) * (sweep.f1 - sweep.f0) * domain_.length.prod();
  }

  SurfaceEvaluator surface_;
  const UnitDomain& domain_;
  GaussRule fine_ = GaussLegendre(12), coarse_ = GaussLegendre(8);
};

// The knots of a direction and the ends of [low, high], in order, and the same in the unit domain.
struct Lines {
  std::vector<double> parameters, places;

  Lines(const SplineBasis& basis, double low, double high) : parameters{low, high, basis.upper()} {
    for (const int span : basis.Spans()) parameters.push_back(basis.knots()[span]);
    std::sort(parameters.begin(), parameters.end());
    parameters.erase(std::unique(parameters.begin(), parameters.end()), parameters.end());
    for (const double u : parameters) {
      places.push_back((u - basis.lower()) / (basis.upper() - basis.lower()));
    }
  }
  int cells() const { return static_cast<int>(places.size()) - 1; }
};

// The cell of a place between lines; the outer ones reach on.
int CellOf(const Lines& lines, double x) {
  const auto beyond = std::upper_bound(lines.places.begin(), lines.places.end(), x);
  return std::clamp(static_cast<int>(beyond - lines.places.begin()) - 1, 0, lines.cells() - 1);
}

// A part of an arc in one cell of a row; it climbs from y0 to y1, or falls.
struct Piece {
  int column;
  const MonotoneArc* arc;
  double t0, t1, y0, y1;
};

// Heights, and by how much something changes there.
using Changes = std::vector<std::pair<double, int>>;

class TrimmedCells {
 public:
  TrimmedCells(const NurbsSurface& surface, const ParameterBox& box)
      : surface_(surface),
        domain_(surface),
        arcs_(MonotoneArcs(surface.trims(), domain_)),
        box_(box),
        in_u_(surface.basis_u(), box.u0, box.u1),
        in_v_(surface.basis_v(), box.v0, box.v1),
        rows_(in_v_.cells()),
        quadrature_(surface, domain_) {
    for (const MonotoneArc& arc : arcs_) CutArc(arc);
  }

  double Area() {
    for (int row = 0; row < in_v_.cells(); ++row) {
      const double v = in_v_.parameters[row];
      if (v >= box_.v0 && v < box_.v1) AddRow(row);
    }
    constexpr size_t kMostSplits = 10000, kMostSplitsPerSweep = 20;
    const size_t most = kMostSplits + kMostSplitsPerSweep * sweeps_.size();
    RefineUntilExact(sweeps_, kTrimmedTolerance, 0, most, [&](const Sweep& sweep) {
      return quadrature_.Split(sweep);
    });
    for (const Sweep& sweep : sweeps_) sum_.Add(sweep.integral.value);
    return sum_.value();
  }

 private:
  // At every line it crosses.
  void CutArc(const MonotoneArc& arc) {
    std::vector<double> cuts{0, 1};
    for (const int axis : {0, 1}) {
      for (const double line : (axis == 0 ? in_u_ : in_v_).places) {
        if (line > arc.Low(axis) && line < arc.High(axis)) cuts.push_back(arc.Where(axis, line));
      }
    }
    std::sort(cuts.begin(), cuts.end());
    for (size_t k = 0; k + 1 < cuts.size(); ++k) {
      if (cuts[k] == cuts[k + 1]) continue;
      const Eigen::Vector2d middle = arc.At((cuts[k] + cuts[k + 1]) / 2);
      rows_[CellOf(in_v_, middle[1])].push_back({CellOf(in_u_, middle[0]),
                                                 &arc,
                                                 cuts[k],
                                                 cuts[k + 1],
                                                 arc.At(cuts[k])[1],
                                                 arc.At(cuts[k + 1])[1]});
    }
  }

  // From the last column to the first. The heights at which the part reaches beyond a cell are
  // those which arcs farther on climb along more often than they fall.
  void AddRow(int row) {
    std::vector<Piece>& pieces = rows_[row];
    std::sort(pieces.begin(), pieces.end(), [](const Piece& a, const Piece& b) {
      return a.column > b.column;
    });
    Changes changes;
    int whole = 0;  // columns just passed that belong to the part as they are
    size_t next = 0;
    for (int column = in_u_.cells() - 1; column >= 0; --column) {
      const double near = in_u_.places[column], far = in_u_.places[column + 1];
      const double u = in_u_.parameters[column];
      const bool counts = u >= box_.u0 && u < box_.u1;
      const bool passed = next < pieces.size() && pieces[next].column == column;
      if (counts && !passed && Covers(changes, row)) {
        ++whole;
        continue;
      }
      AddWhole(row, column + 1, std::exchange(whole, 0));
      const Changes beyond = changes;
      const size_t first = next;
      double least = far;
      for (; next < pieces.size() && pieces[next].column == column; ++next) {
        const Piece& piece = pieces[next];
        const int climbs = piece.y1 > piece.y0 ? 1 : -1;
        changes.emplace_back(std::min(piece.y0, piece.y1), climbs);
        changes.emplace_back(std::max(piece.y0, piece.y1), -climbs);
        least = std::min({least, piece.arc->At(piece.t0)[0], piece.arc->At(piece.t1)[0]});
      }
      if (passed) Simplify(changes);
      if (!counts) continue;
      // What ends in this cell need not be measured from its side.
      if (!changes.empty()) least = near;
      AddBeyond(beyond, least, far);
      for (size_t k = first; k < next; ++k) {
        const Piece& piece = pieces[k];
        const Sweep sweep{piece.arc, least, far, piece.y0, piece.y1, piece.t0, piece.t1};
        sweeps_.push_back(quadrature_.Measured(sweep));
      }
    }
    AddWhole(row, 0, whole);
  }

  static void Simplify(Changes& changes) {
    std::sort(changes.begin(), changes.end());
    Changes merged;
    for (const auto& [y, by] : changes) {
      if (!merged.empty() && y - merged.back().first <= kNoHeight) {
        merged.back().second += by;
        if (merged.back().second == 0) merged.pop_back();
      } else {
        merged.emplace_back(y, by);
      }
    }
    changes = std::move(merged);
  }

  // Whether the part reaches beyond a cell at all heights of the row.
  bool Covers(const Changes& changes, int row) const {
    return changes.size() == 2 && changes[0].second == 1 &&
           changes[0].first <= in_v_.places[row] + kNoHeight &&
           changes[1].first >= in_v_.places[row + 1] - kNoHeight;
  }

  void AddBeyond(const Changes& changes, double near, double far) {
    int number = 0;
    for (size_t k = 0; k + 1 < changes.size(); ++k) {
      number += changes[k].second;
      const double y0 = changes[k].first, y1 = changes[k + 1].first;
      const Sweep sweep{nullptr, near, far, number > 0 ? y0 : y1, number > 0 ? y1 : y0};
      for (int i = 0; i < std::abs(number); ++i) sweeps_.push_back(quadrature_.Measured(sweep));
    }
  }

  // So many cells of a row from a column on.
  void AddWhole(int row, int column, int count) {
    if (count == 0) return;
    sum_.Add(UntrimmedArea(surface_,
                           in_u_.parameters[column],
                           in_u_.parameters[column + count],
                           in_v_.parameters[row],
                           in_v_.parameters[row + 1]));
  }

  const NurbsSurface& surface_;
  UnitDomain domain_;
  std::vector<MonotoneArc> arcs_;
  ParameterBox box_;
  Lines in_u_, in_v_;
  std::vector<std::vector<Piece>> rows_;
  SweepQuadrature quadrature_;
  std::vector<Sweep> sweeps_;
  CarriedSum sum_;
};

}  // namespace

double TrimmedArea(const NurbsSurface& surface, const ParameterBox& box) {
  return TrimmedCells(surface, box).Area();
}

}  // namespace batten::internal
