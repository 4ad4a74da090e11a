// SPDX-License-Identifier: MIT
#include "fitting/neighbours/local_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "batten/fitting/statistics.h"
#include "fitting/neighbours/point_cells.h"

namespace batten::internal {
namespace {

using Index = Eigen::Index;

constexpr double kWidth = 8;
constexpr double kSure = 0.85;   // borders of a part that is evenly dense look this much sparser
constexpr double kSparse = 1.2;  // area a point, from which on the points nearest to some are asked
constexpr double kSparsest = 16;   // where a map tears, points may be any distance apart in space
constexpr double kClearly = 1.25;  // spacings below are chance, or gaps among the points
constexpr size_t kAskedInCell = 8;
constexpr size_t kNearest = 12;        // of which the disc tells the spacing
constexpr double kFewest = 20;         // points around a cell; below, they tell nothing
constexpr std::int64_t kWidest = 4;    // cells, as a multiple of the narrowest
constexpr double kMostPlaces = 1e7;    // limit on the number of all parts
constexpr double kNarrow = 0.4;        // radius of a circle over the width of a cell; above, a hole
constexpr double kCircle = 1.2;        // radius of a circle between lines that are that far apart
constexpr double kMostCircles = 0.75;  // quantile of their radii, by area
constexpr double kDiscs = 6;           // so many of them have room in the area; one alone is a hole
constexpr size_t kAsked = 400;         // points asked for their line
constexpr std::array<size_t, 2> kOnLine = {12, 24};  // points nearest to one, of either number …
constexpr double kThin = 0.35;   // … are a line if less broad than this share of their length
constexpr double kMostly = 0.8;  // share of the points asked; 0.1 to 0.2 of even ones by chance

// Ratio of the points' breadth to their length, of the middle half of them.
double BreadthOf(const Eigen::Matrix2Xd& local) {
  const Eigen::Matrix2Xd centred = local.colwise() - Eigen::Vector2d(local.rowwise().mean());
  const Eigen::Matrix2d spread = centred * centred.transpose();
  const double angle = 0.5 * std::atan2(2 * spread(0, 1), spread(0, 0) - spread(1, 1));
  const Eigen::Vector2d way(std::cos(angle), std::sin(angle)), over(-way.y(), way.x());
  const auto deviation = [&](const Eigen::Vector2d& axis) {
    const Eigen::VectorXd places = centred.transpose() * axis;
    std::vector<double> from(places.begin(), places.end());
    const double middle = Median(from);
    for (double& one : from) one = std::abs(one - middle);
    return Median(std::move(from));
  };
  const double length = deviation(way);
  return length > 0 ? deviation(over) / length : 1;
}

// Values, and the areas of the plane that they stand for. Their medians are by area: by count the
// denser parts would tell, where there are more points.
using ByArea = std::vector<std::pair<double, double>>;

bool IsThinAbout(const PointCells& cells, const Eigen::Vector2d& place) {
  const auto nearest = cells.Nearest(place, kOnLine.back());
  if (nearest.empty()) return false;
  Eigen::Matrix2Xd local(2, static_cast<Index>(nearest.size()));
  for (size_t k = 0; k < nearest.size(); ++k)
    local.col(static_cast<Index>(k)) = cells.points().col(nearest[k].second) - place;
  return std::any_of(kOnLine.begin(), kOnLine.end(), [&](size_t count) {
    return BreadthOf(local.leftCols(static_cast<Index>(count))) <= kThin;
  });
}

// Whether nearly all points are on lines.
bool OnLines(const PointCells& cells) {
  const auto all = cells.All();
  const size_t asked = std::min(kAsked, all.size());
  size_t thin = 0;
  for (size_t k = 0; k < asked; ++k)
    if (IsThinAbout(cells, cells.points().col(all[k * all.size() / asked]))) ++thin;
  return static_cast<double>(thin) >= kMostly * static_cast<double>(asked);
}

// By the disc that holds half of the points nearest to one.
double SpacingInSpace(const Eigen::Matrix2Xd& points,
                      Index point,
                      const std::vector<std::pair<double, Index>>& nearest,
                      const PlaceInSpace& place) {
  const Eigen::Vector3d centre = place(points.col(point));
  std::vector<double> distances;
  for (const auto& [squared, near] : nearest)
    if (near != point) distances.push_back((place(points.col(near)) - centre).norm());
  const double spacing = Median(std::move(distances)) * std::sqrt(2 * std::numbers::pi / kNearest);
  return std::min(spacing, kSparsest);
}

// Spacing about some points of a cell, by the areas of the discs that hold those nearest to them.
ByArea SpacingsIn(const PointCells& cells, size_t cell, const PlaceInSpace& place) {
  ByArea spacings;
  const auto in = cells.In(cell);
  const size_t asked = std::min(kAskedInCell, in.size());
  for (size_t k = 0; k < asked; ++k) {
    const Index point = in[k * in.size() / asked];
    const auto nearest = cells.Nearest(cells.points().col(point), kNearest + 1);  // itself besides
    if (nearest.empty() || nearest.back().first > cells.width() * cells.width()) continue;
    const double area = std::numbers::pi * nearest.back().first / static_cast<double>(kNearest);
    const double spacing =
        place ? SpacingInSpace(cells.points(), point, nearest, place) : std::sqrt(area);
    spacings.emplace_back(spacing, area);
  }
  return spacings;
}

// What the points nearest to some points of each cell, and of those around it, tell about the
// points' spacing there; 0 where they are too few.
std::vector<float> SpacingsByNeighbours(const PointCells& cells, const PlaceInSpace& place) {
  const std::vector<float> areas = cells.OccupiedAreas();
  std::vector<std::optional<ByArea>> told(areas.size());
  std::vector<float> spacings(areas.size(), 0);
  for (size_t cell = 0; cell < areas.size(); ++cell) {
    double count = 0, area = 0;
    cells.Around(cell, [&](size_t at) {
      count += static_cast<double>(cells.In(at).size());
      area += areas[at];
    });
    if (count < kFewest) continue;
    spacings[cell] = 1;
    if (area < kSparse * count) continue;
    ByArea near;
    cells.Around(cell, [&](size_t at) {
      if (!told[at]) told[at] = SpacingsIn(cells, at, place);
      near.insert(near.end(), told[at]->begin(), told[at]->end());
    });
    const bool tell = static_cast<double>(near.size()) >= kFewest;
    const double spacing = tell ? kSure * WeightedMedian(std::move(near)) : 0;
    if (!tell || spacing > kClearly) spacings[cell] = static_cast<float>(spacing);
  }
  return spacings;
}

// What circles tell about each cell; nothing where they are no gaps between lines. `occupied` is
// the area that points occupy of each cell, by the narrowest parts.
std::vector<float> SpacingsByCircles(const PointCells& cells,
                                     const std::vector<EmptyCircle>& circles,
                                     const std::vector<float>& occupied) {
  std::vector<float> spacings(occupied.size(), 0);
  std::vector<std::vector<std::pair<float, float>>> radii(occupied.size());  // and areas
  for (const EmptyCircle& circle : circles)
    if (circle.radius <= kNarrow * cells.width())
      radii[cells.Of(circle.place)].emplace_back(static_cast<float>(circle.radius),
                                                 static_cast<float>(circle.area));
  for (size_t cell = 0; cell < occupied.size(); ++cell) {
    double empty = 0, covered = 0;
    ByArea near;
    cells.Around(cell, [&](size_t at) {
      covered += occupied[at];
      for (const auto& circle : radii[at]) empty += circle.second;
      near.insert(near.end(), radii[at].begin(), radii[at].end());
    });
    if (near.empty() || empty <= covered) continue;
    const double radius = WeightedQuantile(std::move(near), kMostCircles);
    if (empty > kDiscs * std::numbers::pi * radius * radius)
      spacings[cell] = static_cast<float>(radius / kCircle);
  }
  return spacings;
}

}  // namespace

LocalSpacing::LocalSpacing(const Eigen::Matrix2Xd& points,
                           const std::vector<EmptyCircle>& circles,
                           const PlaceInSpace& place) {
  corner_ = points.rowwise().minCoeff();
  const Eigen::Vector2d extent = points.rowwise().maxCoeff() - corner_;
  side_ = std::max(kWidth, PointCells::kParts * std::sqrt(extent.prod() / kMostPlaces));
  const PointCells narrow(points, corner_, side_, extent);
  nu_ = narrow.nu();
  nv_ = narrow.nv();
  const std::vector<float> areas = narrow.OccupiedAreas();
  spacing_.assign(areas.size(), 1);
  std::vector<char> told(areas.size(), 0);
  const bool lines = !circles.empty() && OnLines(narrow);
  for (std::int64_t times = 1; times <= kWidest; times *= 2) {
    const PointCells cells(points, corner_, static_cast<double>(times) * side_, extent);
    const auto in_cells = [&](size_t cell) {
      const auto at = static_cast<std::int64_t>(cell);
      return static_cast<size_t>(at / nu_ / times * cells.nu() + at % nu_ / times);
    };
    std::vector<float> occupied(static_cast<size_t>(cells.nu() * cells.nv()), 0);
    for (size_t cell = 0; cell < areas.size(); ++cell) occupied[in_cells(cell)] += areas[cell];
    const std::vector<float> counted = SpacingsByNeighbours(cells, place),
                             between = lines ? SpacingsByCircles(cells, circles, occupied)
                                             : std::vector<float>(occupied.size(), 0);
    for (size_t cell = 0; cell < areas.size(); ++cell) {
      const size_t at = in_cells(cell);
      float& here = spacing_[cell];
      if (told[cell] == 0) here = std::max(here, counted[at]);
      here = std::max(here, between[at]);
      if (counted[at] > 0) told[cell] = 1;
    }
  }
}

double LocalSpacing::At(const Eigen::Vector2d& place) const {
  const Eigen::Array2d cell = ((place - corner_) / side_).array().floor();
  const auto i = static_cast<std::int64_t>(std::clamp(cell[0], 0.0, static_cast<double>(nu_ - 1)));
  const auto j = static_cast<std::int64_t>(std::clamp(cell[1], 0.0, static_cast<double>(nv_ - 1)));
  return spacing_[static_cast<size_t>(j * nu_ + i)];
}

}  // namespace batten::internal
