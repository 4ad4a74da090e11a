// SPDX-License-Identifier: MIT
#include "fitting/constraints/coons_parameterization.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "batten/fitting/fitting_problem.h"
#include "batten/fitting/solve_linear.h"
#include "batten/fitting/statistics.h"
#include "batten/geometry/reparameterize.h"
#include "batten/geometry/reverse.h"
#include "fitting/core/mask_indices.h"
#include "fitting/core/rounding.h"
#include "fitting/core/shared_constants.h"
#include "fitting/outline/four_sides.h"
#include "fitting/outline/outline_in_box.h"
#include "geometry/numeric/box_diagonal.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr double kNearlyMeets = 1e-6;  // of the size: closer than this they are drawn together
constexpr double kSmoothingOfSides = 1e-7;
constexpr double kSideKeeps = 0.5;  // spacings that a smoothed side may be off the outline
constexpr int kMostSpansOfSide = 24, kSamplesPerSpan = 4;
constexpr double kTooSparse = 1.8;         // spacings of the mean: sides drawn there mislead
constexpr double kNearlyRectangle = 0.75;  // of its area: an outline that is laid onto it
constexpr double kBeyondInSpacings = 0.1;

// Counter-clockwise.
constexpr std::array<SurfaceEdge, 4> kEdges = {SurfaceEdge{Direction::kV, false},
                                               SurfaceEdge{Direction::kU, true},
                                               SurfaceEdge{Direction::kV, true},
                                               SurfaceEdge{Direction::kU, false}};

// Four sides counter-clockwise, each from corner to corner, and those of them that are given.
struct Ring {
  std::vector<NurbsCurve<2>> sides;
  std::array<int, 4> given = {-1, -1, -1, -1};  // index among the given ones
  std::array<bool, 4> turned = {false, false, false, false};
};

NurbsCurve<2> Segment(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  Eigen::Matrix2Xd points(2, 2);
  points << a, b;
  return NurbsCurve<2>(SplineBasis::Uniform(1, 2, 0, 1), points);
}

Eigen::Vector2d StartOf(const NurbsCurve<2>& curve) { return curve.At(curve.basis().lower()); }
Eigen::Vector2d EndOf(const NurbsCurve<2>& curve) { return curve.At(curve.basis().upper()); }
Eigen::Vector2d MiddleOf(const NurbsCurve<2>& curve) {
  return curve.At((curve.basis().lower() + curve.basis().upper()) / 2);
}

// A smooth curve through the places of a side's samples, over its curve's parameter.
NurbsCurve<2> PlaneCurve(const PlacedSide& side, ThreadPool& pool) {
  const NurbsCurve<3>& curve = side.side.curve;
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, side.parameters.size());
  data->parameters.row(0) = side.parameters.transpose();
  data->values = side.places;
  const int spans =
      std::clamp(static_cast<int>(side.parameters.size()) / kSamplesPerSpan, 1, kMostSpansOfSide);
  const SplineBasis basis =
      SplineBasis::Uniform(3, spans + 3, curve.basis().lower(), curve.basis().upper());
  const FittingProblem problem(basis, std::move(data), kSmoothingOfSides);
  return NurbsCurve<2>(basis, SolveLinear(problem, pool).coefficients);
}

double SignedArea(const std::vector<NurbsCurve<2>>& ring) {
  double sum = 0;
  for (const NurbsCurve<2>& side : ring) {
    constexpr int kPlaces = 16;
    const double a = side.basis().lower(), step = (side.basis().upper() - a) / kPlaces;
    for (int k = 0; k < kPlaces; ++k) {
      const Eigen::Vector2d p = side.At(a + k * step), q = side.At(a + (k + 1) * step);
      sum += p[0] * q[1] - p[1] * q[0];
    }
  }
  return sum / 2;
}

// Four given sides in a ring: each next one begins nearest to where the last ended.
Ring TorusSectionOf(const std::vector<NurbsCurve<2>>& planes) {
  Ring ring;
  std::vector<bool> taken(4, false);
  ring.sides.push_back(planes[0]);
  ring.given[0] = 0;
  taken[0] = true;
  for (size_t place = 1; place < 4; ++place) {
    double least = std::numeric_limits<double>::infinity();
    for (int k = 1; k < 4; ++k) {
      for (const bool turn : {false, true}) {
        const NurbsCurve<2>& curve = planes[static_cast<size_t>(k)];
        const double gap =
            ((turn ? EndOf(curve) : StartOf(curve)) - EndOf(ring.sides.back())).norm();
        if (taken[static_cast<size_t>(k)] || gap >= least) continue;
        least = gap;
        ring.given[place] = k;
        ring.turned[place] = turn;
      }
    }
    const NurbsCurve<2>& next = planes[static_cast<size_t>(ring.given[place])];
    taken[static_cast<size_t>(ring.given[place])] = true;
    ring.sides.push_back(ring.turned[place] ? Reversed(next) : next);
  }
  if (SignedArea(ring.sides) < 0) {
    std::reverse(ring.sides.begin(), ring.sides.end());
    std::reverse(ring.given.begin(), ring.given.end());
    std::reverse(ring.turned.begin(), ring.turned.end());
    for (size_t k = 0; k < 4; ++k) {
      ring.sides[k] = Reversed(ring.sides[k]);
      ring.turned[k] = !ring.turned[k];
    }
  }
  return ring;
}

// The side that runs most along +u first.
void StartAlongU(Ring& ring) {
  std::ptrdiff_t first = 0;
  double most = -std::numeric_limits<double>::infinity();
  for (std::ptrdiff_t k = 0; k < 4; ++k) {
    const NurbsCurve<2>& side = ring.sides[static_cast<size_t>(k)];
    const double along = (EndOf(side) - StartOf(side)).normalized()[0];
    if (along <= most) continue;
    most = along;
    first = k;
  }
  std::rotate(ring.sides.begin(), ring.sides.begin() + first, ring.sides.end());
  std::rotate(ring.given.begin(), ring.given.begin() + first, ring.given.end());
  std::rotate(ring.turned.begin(), ring.turned.begin() + first, ring.turned.end());
}

// How badly a curve serves in place of a side: the distances of ends and middles.
double Misfit(const NurbsCurve<2>& curve, bool turned, const NurbsCurve<2>& side) {
  const Eigen::Vector2d start = turned ? EndOf(curve) : StartOf(curve),
                        end = turned ? StartOf(curve) : EndOf(curve);
  return (start - StartOf(side)).norm() + (end - EndOf(side)).norm() +
         (MiddleOf(curve) - MiddleOf(side)).norm();
}

// Fewer than four given sides take the places of those of the points' own ring that they serve
// best.
void TakePlaces(Ring& ring, const std::vector<NurbsCurve<2>>& planes) {
  const size_t count = planes.size();
  std::array<int, 4> places = {0, 1, 2, 3}, best = places;
  double least = std::numeric_limits<double>::infinity();
  const auto cost = [&](size_t k, bool turn) {
    return Misfit(planes[k], turn, ring.sides[static_cast<size_t>(places[k])]);
  };
  do {
    double sum = 0;
    for (size_t k = 0; k < count; ++k) sum += std::min(cost(k, false), cost(k, true));
    if (sum >= least) continue;
    least = sum;
    best = places;
  } while (std::next_permutation(places.begin(), places.end()));
  places = best;
  for (size_t k = 0; k < count; ++k) {
    const auto place = static_cast<size_t>(best[k]);
    const bool turn = cost(k, true) < cost(k, false);
    ring.given[place] = static_cast<int>(k);
    ring.turned[place] = turn;
    ring.sides[place] = turn ? Reversed(planes[k]) : planes[k];
  }
}

Outline OutlineOf(const Parameterization& base,
                  const PointMask& reached,
                  double spacing,
                  double noise,
                  ThreadPool& pool) {
  const std::vector<Eigen::Index> kept = IndicesOf(reached);
  OutlineOptions options;
  options.spacing = spacing;
  options.noise = noise;
  options.length_u = base.length_u;
  options.length_v = base.length_v;
  return FindOutlineInBox(base.parameters(Eigen::all, kept), options, pool);
}

// A side without the raggedness of the points beside it: the cubic of the fewest spans that keeps
// near it. `at` is the side over [0, 1].
NurbsCurve<2> Smoothed(const std::function<Eigen::Vector2d(double)>& at,
                       double spacing,
                       ThreadPool& pool) {
  constexpr int kSamples = 400, kMostSpans = 32;
  auto data = std::make_shared<FittingData>();
  data->parameters = Eigen::Matrix2Xd::Zero(2, kSamples + 1);
  data->parameters.row(0).setLinSpaced(kSamples + 1, 0, 1);
  data->values.resize(2, kSamples + 1);
  for (int k = 0; k <= kSamples; ++k) data->values.col(k) = at(data->parameters(0, k));
  for (int spans = 1;; spans *= 2) {
    const SplineBasis basis = SplineBasis::Uniform(3, spans + 3, 0, 1);
    const FittingProblem problem(basis, data, kSmoothingOfSides);
    const LinearSolution solution = SolveLinear(problem, pool);
    const double off = (EvaluateAt(problem, solution.coefficients, pool) - data->values)
                           .colwise()
                           .norm()
                           .maxCoeff();
    if (off > kSideKeeps * spacing && spans < kMostSpans) continue;
    return NurbsCurve<2>(basis, solution.coefficients);
  }
}

// The loop's places next to the corners of the rectangle, ascending: corners that were found near
// them, for one of the four any place. None where fewer were found, or others elsewhere.
std::optional<std::vector<double>> CornersOfRectangle(const OutlineCurve& outer,
                                                      const Eigen::Vector2d& lengths,
                                                      double spacing) {
  constexpr int kPlaces = 4000;
  constexpr double kNear = 10;  // spacings: corners of one ragged corner
  const double a = outer.loop.basis().lower(), step = (outer.loop.basis().upper() - a) / kPlaces;
  std::vector<double> cuts;
  int found = 0;
  for (int k = 0; k < 4; ++k) {
    const Eigen::Vector2d corner(k == 1 || k == 2 ? lengths[0] : 0.0, k >= 2 ? lengths[1] : 0.0);
    const auto off = [&](double at) { return (outer.loop.At(at) - corner).norm(); };
    double best = a;
    for (int i = 1; i < kPlaces; ++i)
      if (off(a + i * step) < off(best)) best = a + i * step;
    const Eigen::Vector2d nearest = outer.loop.At(best);
    std::optional<double> real;
    for (const double at : outer.corners) {
      if ((outer.loop.At(at) - nearest).norm() < kNear * spacing && (!real || off(at) < off(*real)))
        real = at;
    }
    found += real ? 1 : 0;
    cuts.push_back(real.value_or(best));
  }
  std::sort(cuts.begin(), cuts.end());
  if (found < 3 || std::adjacent_find(cuts.begin(), cuts.end()) != cuts.end()) return std::nullopt;
  for (const double at : outer.corners) {
    double least = std::numeric_limits<double>::infinity();
    for (const double cut : cuts)
      least = std::min(least, (outer.loop.At(at) - outer.loop.At(cut)).norm());
    if (least > kNear * spacing) return std::nullopt;
  }
  return cuts;
}

// Without the corners at which the loop hardly turns: those at the ends of a stretch on an edge.
OutlineCurve WithClearCorners(const OutlineCurve& outer) {
  constexpr double kClear = 0.64;  // cosine: 50°
  constexpr double kAside = 1e-6;  // of the domain
  const double a = outer.loop.basis().lower(), b = outer.loop.basis().upper();
  OutlineCurve clear{outer.loop, {}};
  for (const double corner : outer.corners) {
    const double before = corner > a ? corner - kAside * (b - a) : b - kAside * (b - a);
    const Eigen::Vector2d in = outer.loop.JetAt(before).first.normalized(),
                          out = outer.loop.JetAt(corner + kAside * (b - a)).first.normalized();
    if (in.dot(out) < kClear) clear.corners.push_back(corner);
  }
  return clear;
}

bool TakeFourSides(const Outline& outline,
                   const Eigen::Vector2d& lengths,
                   double spacing,
                   ThreadPool& pool,
                   Ring& ring) {
  if (outline.loops.empty()) return false;
  const OutlineCurve outer = WithClearCorners(outline.loops.front());
  if (const auto sides = FourSides(outer)) {
    for (const NurbsCurve<2>& side : *sides) {
      const double a = side.basis().lower(), b = side.basis().upper();
      ring.sides.push_back(
          Smoothed([&](double s) { return side.At(a + s * (b - a)); }, spacing, pool));
    }
    return true;
  }
  const auto places = CornersOfRectangle(outer, lengths, spacing);
  if (!places) return false;
  const std::vector<double>& cuts = *places;
  const double a = outer.loop.basis().lower(), b = outer.loop.basis().upper();
  for (size_t k = 0; k < 4; ++k) {
    const double from = cuts[k], to = k < 3 ? cuts[k + 1] : cuts[0] + (b - a);
    ring.sides.push_back(Smoothed(
        [&](double s) {
          const double at = from + s * (to - from);
          return outer.loop.At(at > b ? at - (b - a) : at);
        },
        spacing,
        pool));
  }
  StartAlongU(ring);
  return true;
}

// The ring the points themselves suggest: four sides of their outline, or the rectangle's.
Ring OwnRing(const Parameterization& base,
             const PointMask& reached,
             double spacing,
             double noise,
             ThreadPool& pool) {
  Ring ring;
  const Outline outline = OutlineOf(base, reached, spacing, noise, pool);
  if (TakeFourSides(outline, {base.length_u, base.length_v}, spacing, pool, ring)) return ring;
  const Eigen::Vector2d corners[4] = {
      {0, 0}, {base.length_u, 0}, {base.length_u, base.length_v}, {0, base.length_v}};
  for (int k = 0; k < 4; ++k) ring.sides.push_back(Segment(corners[k], corners[(k + 1) % 4]));
  return ring;
}

PlaneSides SidesOf(const Ring& ring) {
  return {ring.sides[0],
          Reversed(ring.sides[2]),
          Reversed(ring.sides[3]),
          ring.sides[1],
          {ring.given[0] >= 0, ring.given[2] >= 0, ring.given[3] >= 0, ring.given[1] >= 0}};
}

// Draws the ends of given sides that are neighbours in the ring together, where they nearly meet.
void CloseCorners(std::array<std::optional<BoundaryEdge>, 4>& around,
                  double size,
                  std::vector<std::string>& warnings) {
  for (size_t k = 0; k < 4; ++k) {
    auto &one = around[k], &next = around[(k + 1) % 4];
    if (!one || !next) continue;
    Eigen::Matrix3Xd a = one->curve.control_points(), b = next->curve.control_points();
    const Eigen::Vector3d from = a.col(a.cols() - 1), to = b.col(0);
    const double gap = (from - to).norm();
    if (gap == 0) continue;
    if (gap > kNearlyMeets * size) {
      throw std::invalid_argument("boundary " + one->name + " and " + next->name +
                                  " do not meet at a corner: their ends are " + RoundedText(gap) +
                                  " apart; make them end in one point");
    }
    if (gap > kRelativelyEqual * size) {
      warnings.push_back("boundary " + one->name + " and " + next->name +
                         " were drawn together: " + RoundedText(gap) + " at their corner");
    }
    a.col(a.cols() - 1) = b.col(0) = (from + to) / 2;
    one->curve = NurbsCurve<3>(one->curve.basis(), std::move(a), one->curve.weights());
    next->curve = NurbsCurve<3>(next->curve.basis(), std::move(b), next->curve.weights());
  }
}

// Takes (s,t) for the base's place of every point.
void TakePlacesOn(const FourSidedMap& map, Parameterization& base, ThreadPool& pool) {
  base.length_u = map.length_s();
  base.length_v = map.length_t();
  const Eigen::Vector2d lengths(base.length_u, base.length_v);
  base.parameters = lengths.asDiagonal() * map.Inverted(base.parameters, pool);
}

void KeepInside(Parameterization& base) {
  base.parameters.row(0) = base.parameters.row(0).cwiseMax(0.0).cwiseMin(base.length_u);
  base.parameters.row(1) = base.parameters.row(1).cwiseMax(0.0).cwiseMin(base.length_v);
}

// Moves edges of the rectangle that may be moved (in the ring's order) out to points that count
// beyond them, and by the margin; other points are drawn to its edge.
void EndAround(Parameterization& base,
               const PointMask& counted,
               const std::array<bool, 4>& movable,
               double margin) {
  Eigen::Vector2d low = Eigen::Vector2d::Zero(), high(base.length_u, base.length_v);
  for (Eigen::Index k = 0; k < counted.size(); ++k) {
    if (!counted[k]) continue;
    const auto place = base.parameters.col(k);
    if (movable[0]) low[1] = std::min(low[1], place[1]);
    if (movable[1]) high[0] = std::max(high[0], place[0]);
    if (movable[2]) high[1] = std::max(high[1], place[1]);
    if (movable[3]) low[0] = std::min(low[0], place[0]);
  }
  low -= margin * Eigen::Vector2d(movable[3], movable[0]);
  high += margin * Eigen::Vector2d(movable[1], movable[2]);
  base.parameters.colwise() -= low;
  base.length_u = high[0] - low[0];
  base.length_v = high[1] - low[1];
  KeepInside(base);
}

// How many times as far apart as the mean spacing points are where they are sparse: from the counts
// of tiles of 4 × 4 spacings that have all their neighbours; 1 where counts are those of chance.
// Infinite where the points are all but lost in the rectangle.
double Sparseness(const Parameterization& base, const PointMask& counted, double spacing) {
  constexpr double kTile = 4, kOfChance = 10;  // the lowest twentieth of Poisson's with mean 16
  constexpr double kMostTiles = 4;             // a point
  const double side = kTile * spacing;
  const double tiles = (base.length_u / side + 2) * (base.length_v / side + 2);
  if (tiles > kMostTiles * static_cast<double>(counted.size()) + 1e4)
    return std::numeric_limits<double>::infinity();
  const auto columns = static_cast<Eigen::Index>(base.length_u / side) + 2,
             rows = static_cast<Eigen::Index>(base.length_v / side) + 2;
  Eigen::MatrixXi counts = Eigen::MatrixXi::Zero(rows, columns);
  const auto place = [&](double length, Eigen::Index most) {
    return std::clamp<Eigen::Index>(std::lround(length / side), 0, most - 1);
  };
  for (Eigen::Index k = 0; k < counted.size(); ++k) {
    if (counted[k])
      ++counts(place(base.parameters(1, k), rows), place(base.parameters(0, k), columns));
  }
  std::vector<double> inner;
  for (Eigen::Index i = 1; i + 1 < columns; ++i) {
    for (Eigen::Index j = 1; j + 1 < rows; ++j) {
      if ((counts.block<3, 3>(j - 1, i - 1).array() > 0).all()) inner.push_back(counts(j, i));
    }
  }
  if (inner.empty()) return 1;
  return std::sqrt(std::max(1.0, kOfChance / Quantile(std::move(inner), 0.05)));
}

// Whether a place is on the far side of a given edge.
bool IsBeyond(const Parameterization& base,
              const Ring& ring,
              const Eigen::Vector2d& place,
              double allowed) {
  return (ring.given[0] >= 0 && place[1] < -allowed) ||
         (ring.given[1] >= 0 && place[0] > base.length_u + allowed) ||
         (ring.given[2] >= 0 && place[1] > base.length_v + allowed) ||
         (ring.given[3] >= 0 && place[0] < -allowed);
}

}  // namespace

PlacedBoundaries ParameterizeByCoons(Parameterization& base,
                                     PointMask& reached,
                                     const Eigen::Matrix3Xd& points,
                                     const std::vector<PlacedSide>& given,
                                     double spacing,
                                     double noise,
                                     ThreadPool& pool) {
  if (given.size() > 4) {
    throw std::invalid_argument(std::to_string(given.size()) +
                                " boundary curves: a surface has four edges");
  }
  std::vector<NurbsCurve<2>> planes;
  for (const PlacedSide& side : given) planes.push_back(PlaneCurve(side, pool));
  Ring ring;
  if (given.size() == 4) {
    ring = TorusSectionOf(planes);
    StartAlongU(ring);
  } else {
    ring = OwnRing(base, reached, spacing, noise, pool);
    TakePlaces(ring, planes);
  }
  PlacedBoundaries laid;
  std::array<std::optional<BoundaryEdge>, 4> around;
  for (size_t k = 0; k < 4; ++k) {
    if (ring.given[k] < 0) continue;
    const BoundaryEdge& side = given[static_cast<size_t>(ring.given[k])].side;
    around[k] = ring.turned[k] ? Turned(side) : side;
  }
  const double size = BoxDiagonal(points);
  CloseCorners(around, size, laid.warnings);
  const FourSidedMap map(SidesOf(ring));
  if (!map.one_to_one()) {
    throw std::invalid_argument(
        "the region between the boundary curves cannot be laid onto a rectangle: they cross, turn "
        "back or meet at a corner of nearly 0 or 180 degrees");
  }
  TakePlacesOn(map, base, pool);
  const double allowed = kThreeSigmas * noise + kBeyondInSpacings * spacing;
  for (Eigen::Index k = 0; k < reached.size(); ++k) {
    if (!reached[k] || !IsBeyond(base, ring, base.parameters.col(k), allowed)) continue;
    reached[k] = false;
    ++laid.beyond;
  }
  // An edge across a given one ends where that ends.
  const bool along_u = ring.given[0] < 0 && ring.given[2] < 0,
             along_v = ring.given[1] < 0 && ring.given[3] < 0;
  EndAround(base,
            reached,
            {along_v && ring.given[0] < 0,
             along_u && ring.given[1] < 0,
             along_v && ring.given[2] < 0,
             along_u && ring.given[3] < 0},
            spacing / 2);
  for (size_t k = 0; k < 4; ++k) {
    if (!around[k]) continue;
    // The upper and the left one of the ring run against the parameter.
    BoundaryEdge side = k >= 2 ? Turned(*around[k]) : *around[k];
    side.curve = Reparameterized(side.curve, 0, k % 2 == 0 ? base.length_u : base.length_v);
    laid.sides.push_back({kEdges[k], std::move(side)});
  }
  return laid;
}

bool ParameterizeByOutline(Parameterization& base,
                           const PointMask& reached,
                           double mean_spacing,
                           double noise,
                           ThreadPool& pool) {
  // Where points are sparse the outline is drawn as there, and is as much less certain.
  const double sparseness = Sparseness(base, reached, mean_spacing);
  if (sparseness > kTooSparse) return false;
  const double spacing = sparseness * mean_spacing;
  const Outline outline = OutlineOf(base, reached, spacing, noise, pool);
  // A loop of degree one is the rectangle itself.
  if (outline.fills || outline.parts != 1 || outline.loops.front().loop.basis().degree() == 1) {
    return false;
  }
  Ring ring;
  if (!TakeFourSides(outline, {base.length_u, base.length_v}, spacing, pool, ring)) return false;
  if (SignedArea(ring.sides) < kNearlyRectangle * base.length_u * base.length_v) return false;
  const FourSidedMap map(SidesOf(ring));
  if (!map.one_to_one()) return false;
  TakePlacesOn(map, base, pool);
  EndAround(base, reached, {true, true, true, true}, sparseness * spacing / 2);
  return true;
}

}  // namespace batten::internal
