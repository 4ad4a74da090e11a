// SPDX-License-Identifier: MIT
#include "fitting/neighbours/local_spacing.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>

#include "batten/fitting/statistics.h"

namespace batten::internal {
namespace {

using Index = Eigen::Index;

constexpr double kWidth = 8;
constexpr int kParts = 4;        // of a cell's width, each occupied or empty
constexpr double kSure = 0.85;   // borders of a part that is evenly dense look this much sparser
constexpr double kSparse = 1.2;  // area a point, from which on the points nearest to some are asked
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

// A spacing, and the area of the plane that the point which tells it stands for.
struct LocalTold {
  double spacing, area;
};

// The points in cells of one width.
class Cells {
 public:
  Cells(const Eigen::Matrix2Xd& points,
        const Eigen::Vector2d& corner,
        double width,
        const Eigen::Vector2d& extent)
      : points_(points),
        corner_(corner),
        width_(width),
        nu_(static_cast<std::int64_t>(extent[0] / width) + 1),
        nv_(static_cast<std::int64_t>(extent[1] / width) + 1),
        first_(static_cast<size_t>(nu_ * nv_) + 1, 0),
        order_(static_cast<size_t>(points.cols())) {
    for (const auto& point : points.colwise()) ++first_[Of(point) + 1];
    for (size_t cell = 1; cell < first_.size(); ++cell) first_[cell] += first_[cell - 1];
    std::vector<Index> next(first_.begin(), first_.end() - 1);
    for (Index k = 0; k < points.cols(); ++k)
      order_[static_cast<size_t>(next[Of(points.col(k))]++)] = k;
  }

  std::int64_t nu() const { return nu_; }
  std::int64_t nv() const { return nv_; }
  double width() const { return width_; }
  Index CountIn(size_t cell) const { return first_[cell + 1] - first_[cell]; }

  size_t Of(const Eigen::Vector2d& place) const {
    const Eigen::Vector2d from = (place - corner_) / width_;
    const auto i = std::min(static_cast<std::int64_t>(from[0]), nu_ - 1);
    const auto j = std::min(static_cast<std::int64_t>(from[1]), nv_ - 1);
    return static_cast<size_t>(j * nu_ + i);
  }

  // The parts of a cell, `kParts` in each direction, that hold a point; by their area.
  std::vector<float> OccupiedAreas() const {
    std::vector<float> areas(first_.size() - 1, 0);
    for (size_t cell = 0; cell < areas.size(); ++cell) {
      unsigned marks = 0;
      for (Index k = first_[cell]; k < first_[cell + 1]; ++k) marks |= 1U << PartOf(cell, k);
      areas[cell] =
          static_cast<float>(__builtin_popcount(marks) * width_ * width_ / (kParts * kParts));
    }
    return areas;
  }

  // What is around a cell: itself and its eight neighbours.
  template <typename Visit>
  void Around(size_t cell, const Visit& visit) const {
    const std::int64_t i = static_cast<std::int64_t>(cell) % nu_,
                       j = static_cast<std::int64_t>(cell) / nu_;
    for (std::int64_t y = std::max<std::int64_t>(0, j - 1); y <= std::min(nv_ - 1, j + 1); ++y)
      for (std::int64_t x = std::max<std::int64_t>(0, i - 1); x <= std::min(nu_ - 1, i + 1); ++x)
        visit(static_cast<size_t>(y * nu_ + x));
  }

  // Whether nearly all points are on lines.
  bool OnLines() const {
    const size_t asked = std::min(kAsked, order_.size());
    size_t thin = 0;
    for (size_t k = 0; k < asked; ++k)
      if (IsThinAbout(points_.col(order_[k * order_.size() / asked]))) ++thin;
    return static_cast<double>(thin) >= kMostly * static_cast<double>(asked);
  }

  // Spacing about some points of a cell, by the areas of the discs that hold those nearest to them.
  std::vector<LocalTold> SpacingsIn(size_t cell, const PlaceInSpace& place) const {
    std::vector<LocalTold> spacings;
    const auto count = static_cast<size_t>(CountIn(cell)), asked = std::min(kAskedInCell, count);
    for (size_t k = 0; k < asked; ++k) {
      const Index point = order_[static_cast<size_t>(first_[cell]) + k * count / asked];
      const auto nearest = Nearest(points_.col(point), kNearest + 1);  // itself besides
      if (nearest.empty() || nearest.back().first > width_ * width_) continue;
      const double area = std::numbers::pi * nearest.back().first / static_cast<double>(kNearest);
      spacings.push_back({place ? SpacingInSpace(point, nearest, place) : std::sqrt(area), area});
    }
    return spacings;
  }

 private:
  // By the disc that holds half of the points nearest to one.
  double SpacingInSpace(Index point,
                        const std::vector<std::pair<double, Index>>& nearest,
                        const PlaceInSpace& place) const {
    const Eigen::Vector3d centre = place(points_.col(point));
    std::vector<double> distances;
    for (const auto& [squared, near] : nearest)
      if (near != point) distances.push_back((place(points_.col(near)) - centre).norm());
    return Median(std::move(distances)) * std::sqrt(2 * std::numbers::pi / kNearest);
  }

  int PartOf(size_t cell, Index k) const {
    const Eigen::Vector2d from = (points_.col(order_[static_cast<size_t>(k)]) - corner_) / width_;
    const auto part = [&](double along, std::int64_t at) {
      return std::clamp(
          static_cast<int>((along - static_cast<double>(at)) * kParts), 0, kParts - 1);
    };
    const auto at = static_cast<std::int64_t>(cell);
    return part(from[1], at / nu_) * kParts + part(from[0], at % nu_);
  }

  // The points nearest to a place, with their squared distances; none where there are too few
  // around it.
  std::vector<std::pair<double, Index>> Nearest(const Eigen::Vector2d& place, size_t most) const {
    std::vector<std::pair<double, Index>> nearest;
    Around(Of(place), [&](size_t cell) {
      for (Index k = first_[cell]; k < first_[cell + 1]; ++k) {
        const Index near = order_[static_cast<size_t>(k)];
        nearest.emplace_back((points_.col(near) - place).squaredNorm(), near);
      }
    });
    if (nearest.size() < most) return {};
    std::partial_sort(nearest.begin(), nearest.begin() + static_cast<Index>(most), nearest.end());
    nearest.resize(most);
    return nearest;
  }

  bool IsThinAbout(const Eigen::Vector2d& place) const {
    const auto nearest = Nearest(place, kOnLine.back());
    if (nearest.empty()) return false;
    Eigen::Matrix2Xd local(2, static_cast<Index>(nearest.size()));
    for (size_t k = 0; k < nearest.size(); ++k)
      local.col(static_cast<Index>(k)) = points_.col(nearest[k].second) - place;
    return std::any_of(kOnLine.begin(), kOnLine.end(), [&](size_t count) {
      return BreadthOf(local.leftCols(static_cast<Index>(count))) <= kThin;
    });
  }

  const Eigen::Matrix2Xd& points_;
  Eigen::Vector2d corner_;
  double width_;
  std::int64_t nu_, nv_;
  std::vector<Index> first_;
  std::vector<Index> order_;
};

using Radii = std::vector<std::pair<float, float>>;  // and areas

float QuantileByArea(Radii radii, double share) {
  std::sort(radii.begin(), radii.end());
  double all = 0, sum = 0;
  for (const auto& [radius, area] : radii) all += area;
  for (const auto& [radius, area] : radii)
    if ((sum += area) >= share * all) return radius;
  return 0;
}

// The median by area: by count the denser parts would tell, where there are more points.
double MedianByArea(std::vector<LocalTold> told) {
  std::ranges::sort(told, {}, &LocalTold::spacing);
  double all = 0, sum = 0;
  for (const LocalTold& one : told) all += one.area;
  for (const LocalTold& one : told)
    if ((sum += one.area) >= all / 2) return one.spacing;
  return 0;
}

// What the points nearest to some points of each cell, and of those around it, tell about the
// points' spacing there; 0 where they are too few.
std::vector<float> SpacingsByNeighbours(const Cells& cells, const PlaceInSpace& place) {
  const std::vector<float> areas = cells.OccupiedAreas();
  std::vector<std::optional<std::vector<LocalTold>>> told(areas.size());
  std::vector<float> spacings(areas.size(), 0);
  for (size_t cell = 0; cell < areas.size(); ++cell) {
    double count = 0, area = 0;
    cells.Around(cell, [&](size_t at) {
      count += static_cast<double>(cells.CountIn(at));
      area += areas[at];
    });
    if (count < kFewest) continue;
    spacings[cell] = 1;
    if (area < kSparse * count) continue;
    std::vector<LocalTold> near;
    cells.Around(cell, [&](size_t at) {
      if (!told[at]) told[at] = cells.SpacingsIn(at, place);
      near.insert(near.end(), told[at]->begin(), told[at]->end());
    });
    const bool tell = static_cast<double>(near.size()) >= kFewest;
    const double spacing = tell ? kSure * MedianByArea(std::move(near)) : 0;
    if (!tell || spacing > kClearly) spacings[cell] = static_cast<float>(spacing);
  }
  return spacings;
}

// What circles tell about each cell; nothing where they are no gaps between lines. `occupied` is
// the area that points occupy of each cell, by the narrowest parts.
std::vector<float> SpacingsByCircles(const Cells& cells,
                                     const std::vector<EmptyCircle>& circles,
                                     const std::vector<float>& occupied) {
  std::vector<float> spacings(occupied.size(), 0);
  std::vector<Radii> radii(occupied.size());
  for (const EmptyCircle& circle : circles)
    if (circle.radius <= kNarrow * cells.width())
      radii[cells.Of(circle.place)].emplace_back(static_cast<float>(circle.radius),
                                                 static_cast<float>(circle.area));
  for (size_t cell = 0; cell < occupied.size(); ++cell) {
    double empty = 0, covered = 0;
    Radii near;
    cells.Around(cell, [&](size_t at) {
      covered += occupied[at];
      for (const auto& circle : radii[at]) empty += circle.second;
      near.insert(near.end(), radii[at].begin(), radii[at].end());
    });
    if (near.empty() || empty <= covered) continue;
    const double radius = QuantileByArea(std::move(near), kMostCircles);
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
  side_ = std::max(kWidth, kParts * std::sqrt(extent.prod() / kMostPlaces));
  const Cells narrow(points, corner_, side_, extent);
  nu_ = narrow.nu();
  nv_ = narrow.nv();
  const std::vector<float> areas = narrow.OccupiedAreas();
  spacing_.assign(areas.size(), 1);
  std::vector<char> told(areas.size(), 0);
  const bool lines = !circles.empty() && narrow.OnLines();
  for (std::int64_t times = 1; times <= kWidest; times *= 2) {
    const Cells cells(points, corner_, static_cast<double>(times) * side_, extent);
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
