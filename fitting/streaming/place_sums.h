// SPDX-License-Identifier: MIT
// Sums over small places of a parameter domain: what a fit has to know of points that pass by.
#pragma once

#include <Eigen/Core>
#include <span>
#include <vector>

namespace batten::internal {

// A rectangle of parameters cut into equal places, v fastest.
struct PlaceGrid {
  Eigen::Vector2d low, high;
  int count_u = 1, count_v = 1;

  // About `places` of them, as square as they can be.
  static PlaceGrid Of(const Eigen::Vector2d& low, const Eigen::Vector2d& high, double places);

  Eigen::Index size() const { return Eigen::Index{count_u} * count_v; }
  Eigen::Vector2d step() const {
    return {(high[0] - low[0]) / count_u, (high[1] - low[1]) / count_v};
  }
  // Of parameters; those outside belong to the nearest place.
  Eigen::Index PlaceOf(const Eigen::Vector2d& at) const;
  Eigen::Vector2d Middle(Eigen::Index place) const;
};

// What the points of a place have in common.
struct PlaceMeans {
  Eigen::Vector2d at;  // mean parameters
  double offset = 0;   // mean distance from a surface near the points
  double count = 0;
};

// Numbers of points, their parameters and their offsets, summed place by place; those beyond a
// limit apart. 72 bytes a place.
class PlaceSums {
 public:
  explicit PlaceSums(const PlaceGrid& grid);

  // A point at its parameters; `beyond`: as far off as outliers are.
  void Add(const Eigen::Vector2d& at, double offset, bool beyond);

  // All sums as numbers that are added up to merge.
  std::span<double> numbers() { return numbers_; }

  // The means of places that hold points, in the order of the places. Points beyond the limit
  // count where they are most of a place, or at least five of it, and nearly equally far off: shape
  // that the surface does not have.
  struct Means {
    std::vector<PlaceMeans> places;
    double used = 0, set_aside = 0;  // points
    double variance = 0;  // of offsets inside places, pooled; 0 where no place has two points
  };
  Means Collected() const;

  const PlaceGrid& grid() const { return grid_; }

 private:
  PlaceGrid grid_;
  std::vector<double> numbers_;
};

}  // namespace batten::internal
