// SPDX-License-Identifier: MIT
#include "fitting/wings/wing_layout.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "fitting/wings/dealt_sides.h"
#include "fitting/wings/density_end.h"
#include "fitting/wings/sheet_sides.h"
#include "fitting/wings/wing_edge.h"
#include "fitting/wings/wing_frame.h"
#include "fitting/wings/wing_places.h"
#include "geometry/numeric/number_text.h"

namespace batten::internal {
namespace {

constexpr int kEdgeRounds = 3;
constexpr double kNoiseOfExact = 1e-3;  // h: of exact points
constexpr double kTipWindow = 6;        // h
constexpr double kMostBlunt = 0.25;     // thickness at the edge over that amid its wedge
constexpr double kBeforeMiddle = 0.5;   // of the chord: sides told by normals are clear there

WingParameters Failed(std::string reason) {
  WingParameters failed;
  failed.failure_reason = std::move(reason);
  return failed;
}

// Functions of `around` that a tip's line is a sum of: equal at both sides of the edge.
Eigen::RowVector4d OfTip(double around) {
  const double square = around * around;
  return {1, square, around * (square - 1), square * (square - 1)};
}

// Shares of the way between the tips, which are where points end. False where no line was found.
bool CutTips(const WingPlaces& at,
             const WingFrame& frame,
             double spacing,
             double noise,
             WingCoordinates& coordinates) {
  const auto count = std::ssize(at.places);
  const auto around = [&](Eigen::Index k) { return std::clamp(coordinates.around[k], -1.0, 1.0); };
  std::array<Eigen::VectorXd, 2> ends;
  for (int tip = 0; tip < 2; ++tip) {
    EndingPoints ending{Eigen::MatrixXd(count, 4), Eigen::VectorXd(count), Eigen::VectorXd(count)};
    for (Eigen::Index k = 0; k < count; ++k) {
      ending.along.row(k) = OfTip(around(k));
      ending.reach[k] = (tip == 0 ? -at.At(k).v : at.At(k).v - 1) * frame.span;
      ending.place[k] = (around(k) + 1) / 2;
    }
    const std::optional<Eigen::VectorXd> end =
        EndOfPoints(ending, noise, std::max(kTipWindow * spacing, kEndWindowInNoises * noise));
    if (!end) return false;
    ends[static_cast<size_t>(tip)] = *end / frame.span;
  }
  coordinates.share.resize(count);
  for (Eigen::Index k = 0; k < count; ++k) {
    const Eigen::RowVector4d row = OfTip(around(k));
    const double low = -row.dot(ends[0]), high = 1 + row.dot(ends[1]);
    coordinates.share[k] = (at.At(k).v - low) / (high - low);
  }
  coordinates.edge_from = -OfTip(1).dot(ends[0]);
  coordinates.edge_to = 1 + OfTip(1).dot(ends[1]);
  return true;
}

WingParameters Result(const WingFrame& frame, const WingCoordinates& at) {
  WingParameters result;
  result.length_u = 2 * frame.chord;
  result.length_v = frame.span * (1 + 2 * at.beyond);
  result.parameters.resize(2, at.around.size());
  for (Eigen::Index k = 0; k < at.around.size(); ++k) {
    const Eigen::Vector2d place = at.Parameters(at.around[k], at.share[k]);
    result.parameters.col(k) << std::clamp(
        (place[0] + 1) / 2 * result.length_u, 0.0, result.length_u),
        std::clamp((place[1] + at.beyond) * frame.span, 0.0, result.length_v);
  }
  result.edge.emplace(SplineBasis::Uniform(3, 4, 0, result.length_v),
                      frame.edge.BezierPoints(at.EdgeAt(-at.beyond), at.EdgeAt(1 + at.beyond)));
  return result;
}

WingParameters Laid(const Eigen::Matrix3Xd& points,
                    const SheetSides& sides,
                    WingFrame frame,
                    double noise,
                    double margin,
                    ThreadPool& pool) {
  noise = std::max(noise, kNoiseOfExact * sides.spacing);
  for (int round = 0; round < kEdgeRounds; ++round) {
    const WingPlaces at = PlacesIn(frame, points, sides, pool);
    if (!MoveEdge(at, sides.spacing, noise, frame))
      return Failed("no line was found where its sides end");
  }
  const WingPlaces at = PlacesIn(frame, points, sides, pool);
  const EdgeWedge wedge = WedgeAtEdge(at, frame, noise);
  if (!(wedge.blunt < kMostBlunt))
    return Failed("its sides do not meet in a sharp edge: " + Percent(wedge.blunt) +
                  " of their distance is left there");
  WingCoordinates coordinates;
  coordinates.beyond = margin / frame.span;
  coordinates.around.resize(points.cols());
  std::vector<Eigen::Index> clear, unclear;
  for (Eigen::Index k = 0; k < points.cols(); ++k) {
    const WingPlace& place = at.At(k);
    coordinates.around[k] = frame.Around(place, at.SideOf(k));
    const double thickness = 2 * wedge.slope * (1 - place.along) * frame.chord;
    const bool told =
        at.SideOf(k) != 0 && (place.along < kBeforeMiddle || thickness > kClearThickness * noise);
    (told || frame.IsAtNose(place) ? clear : unclear).push_back(k);
  }
  if (!CutTips(at, frame, sides.spacing, noise, coordinates))
    return Failed("no lines were found where its tips end");
  DealOutSides(points, clear, unclear, frame.edge, noise, pool, coordinates);
  return Result(frame, coordinates);
}

}  // namespace

WingParameters LayWing(const Eigen::Matrix3Xd& points,
                       const NeighbourIndex& index,
                       double noise,
                       double margin,
                       ThreadPool& pool) {
  WingParameters result;
  const SheetSides sides = TellSidesApart(points, index, noise);
  if (!sides.ok()) {
    result.failure_reason = sides.failure_reason;
    return result;
  }
  const std::vector<std::vector<Eigen::Index>> ends = EndsOfSections(points, sides);
  result.failure_reason = "no sides of a thin section meet";
  for (size_t end = 0; end < ends.size(); ++end) {
    WingFrame frame = FrameOf(
        points, sides, ends[end], ends.size() > 1 ? ends[1 - end] : std::vector<Eigen::Index>{});
    if (!frame.ok()) {
      result.failure_reason = frame.failure_reason;
      continue;
    }
    result = Laid(points, sides, std::move(frame), noise, margin, pool);
    if (result.ok()) break;
  }
  return result;
}

}  // namespace batten::internal
