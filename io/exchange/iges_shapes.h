// SPDX-License-Identifier: MIT
// Single curves and surfaces of IGES from the parameters of their entities. Not installed.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <stdexcept>
#include <string>
#include <vector>

#include "batten/geometry/frame.h"
#include "batten/geometry/nurbs_curve.h"
#include "batten/geometry/nurbs_surface.h"
#include "io/exchange/iges_text.h"

namespace batten::internal {

// Entity types of curves that are one piece.
enum IgesCurveType {
  kIgesArc = 100,
  kIgesConic = 104,
  kIgesPolyline = 106,
  kIgesLine = 110,
  kIgesParametric = 112,
  kIgesCurve = 126
};

// Throws where a number, called `what`, is not finite or too large to be calculated with.
template <class Numbers>
void RequireWithinLimits(const Numbers& numbers, const char* what) {
  constexpr double kLargest = 1e150;
  for (const double number : numbers) {
    if (!(std::abs(number) <= kLargest)) {
      throw std::invalid_argument(std::string("has a ") + what + " above 1e150 in magnitude");
    }
  }
}

// The parameters of an entity, in order.
class IgesNumbers {
 public:
  explicit IgesNumbers(const std::vector<double>& numbers) : numbers_(numbers) {}

  double Real() { return next_ < numbers_.size() ? numbers_[next_++] : 0; }

  // A count or degree; the numbers it promises must be there, so it is below their number.
  int Integer() {
    const double value = Real();
    if (!(value >= 0 && value <= static_cast<double>(numbers_.size()))) {
      throw std::invalid_argument("promises more numbers than it has");
    }
    return static_cast<int>(value);
  }

  int Entity() { return IgesIndex(Real()); }

  // So many numbers within the limits; `what` they are called.
  std::vector<double> Reals(size_t count, const char* what = "coordinate") {
    if (count > numbers_.size() - std::min(next_, numbers_.size())) {
      throw std::invalid_argument("promises more numbers than it has");
    }
    const auto begin = numbers_.begin() + static_cast<std::ptrdiff_t>(next_);
    next_ += count;
    std::vector<double> reals(begin, begin + static_cast<std::ptrdiff_t>(count));
    RequireWithinLimits(reals, what);
    return reals;
  }

 private:
  const std::vector<double>& numbers_;
  size_t next_ = 0;
};

// Whether the entity is such a curve; point sets and annotation of type 106 are not.
bool IsIgesCurve(const IgesEntity& entity);

// The curve: B-splines (126), lines (110) and polylines (106) as they stand, circles (100) and
// ellipses (104, form 1) as batten makes them, parametric splines (112) as cubics over their own
// breaks. Throws std::invalid_argument for numbers that make none, parabolas and hyperbolas.
NurbsCurve<3> ReadIgesCurve(const IgesEntity& entity);

// The angles of a circle (100), which are its parameters in the file.
AngleRange IgesArcAngles(const IgesEntity& entity);

// A B-spline surface (128), or the part of it that counts.
NurbsSurface ReadIgesSurface(const IgesEntity& entity);

// The lines between places of equal parameters of two curves, both brought to [0, 1], which is u;
// v = 0 on the first.
NurbsSurface Ruled(const NurbsCurve<3>& first, const NurbsCurve<3>& second);

}  // namespace batten::internal
