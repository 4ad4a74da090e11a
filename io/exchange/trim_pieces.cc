// SPDX-License-Identifier: MIT
#include "io/exchange/trim_pieces.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "batten/geometry/clamp.h"
#include "batten/geometry/split.h"
#include "io/exchange/file_loops.h"

namespace batten::internal {
namespace {

constexpr double kOnSide = 1e-9;     // of the domain
constexpr double kStraight = 1e-6;   // radians
constexpr double kSamePlace = 1e-9;  // of the interval

Side SideOf(const NurbsSurface& surface, const NurbsCurve<2>& piece) {
  const Eigen::Array2d slack = kOnSide * DomainSides(surface);
  const auto on = [&](int k, double value) {
    return ((piece.control_points().row(k).array() - value).abs() <= slack[k]).all();
  };
  if (on(0, surface.basis_u().lower())) return Side::kULower;
  if (on(0, surface.basis_u().upper())) return Side::kUUpper;
  if (on(1, surface.basis_v().lower())) return Side::kVLower;
  if (on(1, surface.basis_v().upper())) return Side::kVUpper;
  return Side::kNone;
}

// The direction at an end of a Bézier piece, by the nearest control point that differs.
Eigen::Vector2d Direction(const NurbsCurve<2>& bezier, bool at_end) {
  const auto& points = bezier.control_points();
  const Eigen::Index last = points.cols() - 1;
  const double rounding = 1e-13 * points.cwiseAbs().maxCoeff();
  for (Eigen::Index i = 1; i <= last; ++i) {
    const Eigen::Vector2d step =
        at_end ? points.col(last) - points.col(last - i) : points.col(i) - points.col(0);
    if (step.cwiseAbs().maxCoeff() > rounding) return step;
  }
  return Eigen::Vector2d::Zero();
}

bool Turns(const NurbsCurve<2>& before, const NurbsCurve<2>& after, const Eigen::Array2d& sides) {
  const Eigen::Vector2d a = (Direction(before, true).array() / sides).matrix().normalized();
  const Eigen::Vector2d b = (Direction(after, false).array() / sides).matrix().normalized();
  return !((a - b).norm() <= kStraight);
}

// The parameter at which a piece along a side reaches the place; its coordinate along the side
// goes one way.
double ParameterAt(const NurbsCurve<2>& curve, int along, double place) {
  double low = curve.basis().lower(), high = curve.basis().upper();
  const bool grows = curve.At(high)[along] > curve.At(low)[along];
  for (int i = 0; i < 100; ++i) {
    const double middle = low + (high - low) / 2;
    (((curve.At(middle)[along] < place) == grows) ? low : high) = middle;
  }
  return low + (high - low) / 2;
}

std::vector<TrimPiece> CutAt(const TrimPiece& piece, int along, const std::vector<double>& places) {
  const SplineBasis& basis = piece.curve.basis();
  const double a = piece.curve.At(basis.lower())[along], b = piece.curve.At(basis.upper())[along];
  const double slack = kSamePlace * std::abs(b - a);
  std::vector<double> cuts = {basis.lower(), basis.upper()};
  for (const double place : places) {
    if (place > std::min(a, b) + slack && place < std::max(a, b) - slack) {
      cuts.push_back(ParameterAt(piece.curve, along, place));
    }
  }
  std::sort(cuts.begin(), cuts.end());
  std::vector<TrimPiece> parts;
  for (size_t i = 1; i < cuts.size(); ++i) {
    if (!(cuts[i - 1] < cuts[i])) continue;
    parts.push_back({Segment(piece.curve, cuts[i - 1], cuts[i]), piece.side});
  }
  return parts;
}

}  // namespace

std::vector<TrimPiece> TrimPieces(const NurbsSurface& surface, const NurbsCurve<2>& loop) {
  const NurbsCurve<2> clamped = Clamped(loop);
  const int p = clamped.basis().degree();
  const Eigen::Array2d sides = DomainSides(surface);
  const std::vector<NurbsCurve<2>> spans = Decompose(clamped);
  std::vector<TrimPiece> pieces;
  double begin = clamped.basis().lower();
  for (size_t i = 0; i < spans.size(); ++i) {
    const Side side = SideOf(surface, spans[i]);
    const double end = spans[i].basis().upper();
    if (i + 1 < spans.size()) {
      const bool corner =
          clamped.basis().Multiplicity(end) >= p && Turns(spans[i], spans[i + 1], sides);
      if (!corner && side == SideOf(surface, spans[i + 1])) continue;
    }
    pieces.push_back({Segment(clamped, begin, end), side});
    begin = end;
  }
  return pieces;
}

void MatchSides(std::vector<std::vector<TrimPiece>>& loops, Side lower, Side upper) {
  const int along = lower == Side::kULower ? 1 : 0;
  std::vector<double> places;
  for (const auto& loop : loops) {
    for (const TrimPiece& piece : loop) {
      if (piece.side != lower && piece.side != upper) continue;
      places.push_back(piece.curve.At(piece.curve.basis().lower())[along]);
      places.push_back(piece.curve.At(piece.curve.basis().upper())[along]);
    }
  }
  std::sort(places.begin(), places.end());
  for (auto& loop : loops) {
    std::vector<TrimPiece> cut;
    for (const TrimPiece& piece : loop) {
      if (piece.side != lower && piece.side != upper) {
        cut.push_back(piece);
        continue;
      }
      for (TrimPiece& part : CutAt(piece, along, places)) cut.push_back(std::move(part));
    }
    loop = std::move(cut);
  }
}

}  // namespace batten::internal
