// SPDX-License-Identifier: MIT
// Bases of surfaces with four edges: a plane, a flattened sheet, one mapped onto a rectangle.
#pragma once

#include <memory>
#include <vector>

#include "fitting/flattening/sheet_base.h"
#include "fitting/parameterization/base_attempt.h"
#include "fitting/parameterization/plane_base.h"

namespace batten::internal {

// Over more of a plane than this, a surface with several layers is no height field.
constexpr double kOverlapToWarn = 0.02;

// The plane below the points. It serves where they are a height field, but for a few places with
// several layers; it is certain where the height field is nowhere steep.
BaseMethod PlaneCandidate(const BaseInput& input, const PlaneBase& plane);

// A sheet's flattening, made when first asked for.
class SheetFlattening {
 public:
  explicit SheetFlattening(const BaseInput& input) : input_(input) {}
  SheetLayout& layout();
  // Poisson-disk samples of the inliers; null unless the flattening was made.
  const PoissonDiskSamples* nodes() const { return layout_ ? &layout_->nodes() : nullptr; }

 private:
  const BaseInput& input_;
  std::optional<SheetLayout> layout_;
};

// The flattened sheet: a first attempt, those at finer resolution where the first one changes
// lengths much, and, as a last resort, those in any case. It is certain where lengths hardly change
// and little of its rectangle is empty: then nothing closes.
std::vector<BaseMethod> SheetCandidates(const BaseInput& input,
                                        const PlaneBase& plane,
                                        std::shared_ptr<SheetFlattening> flattening);

// Whether a map onto a rectangle, or round a wing, may make sides of the sheet's own.
bool SidesAreFree(const SurfaceFitOptions& options);

// The sheet mapped onto a rectangle where it runs in space, if it has four corners: where the plane
// is steep or lengths change over the flattened sheet, or neither predicts points to the noise.
BaseMethod RectangleCandidate(const BaseInput& input);

}  // namespace batten::internal
