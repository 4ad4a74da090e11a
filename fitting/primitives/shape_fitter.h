// SPDX-License-Identifier: MIT
// Orthogonal-distance fit of a plane, sphere, cylinder, cone or torus to points.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "batten/fitting/point_mask.h"
#include "batten/geometry/thread_pool.h"
#include "fitting/primitives/fitted_surface.h"
#include "fitting/primitives/shape_data.h"
#include "fitting/primitives/surface_minimum.h"
#include "fitting/primitives/surface_starts.h"

namespace batten::internal {

struct ShapeFitOptions {
  // Absent: least squares over the inliers; outliers are points farther off than noise of the size
  // the others show can explain.
  std::optional<Loss> loss = std::nullopt;
  std::optional<double> scale = std::nullopt;  // of the loss, the data's units; found when absent
  double rounding = 1e-12;                     // of the size: distances below mean nothing
  std::uint64_t seed = 1;                      // seed of the random samples
};

// Another shape that fits the points almost as well.
struct AlternativeShape {
  FittedSurface shape;
  double excess = 0;  // of Σ w ρ(d), over σ²/2: the square of a number of standard deviations
};

struct ShapeFit {
  SurfaceKind kind = SurfaceKind::kPlane;
  FittedSurface local;        // in the fitter's unit about its middle
  SurfaceShape shape;         // in the points' coordinates
  Eigen::VectorXd distances;  // signed, one a point, in the data's units
  PointMask outliers;         // points that do not count in the fit
  Eigen::Index used = 0;      // the others' number
  double squares = 0;         // Σ w d² over those that count, weights of mean one
  int freedoms = 0;
  double sigma = 0;  // standard deviation of inliers from the shape
  ShapeLoss loss;    // minimised over those that count, in the fitter's unit
  // Other shapes that the points do not reject, in the fitter's unit: other local minima, and
  // simpler kinds that are limits of this one.
  std::vector<AlternativeShape> alternatives;
};

struct ShapeCandidate {
  FittedSurface shape;
  double scale = 0;                                       // of the points about it
  double cost = std::numeric_limits<double>::infinity();  // on the sample
};

// Fits shapes of several kinds to one cloud; the data they share are prepared once.
class ShapeFitter {
 public:
  // Points (3 × m) with positive weights (empty: ones), m ≥ 1, of extent > 0.
  ShapeFitter(const Eigen::Matrix3Xd& points,
              const Eigen::VectorXd& weights,
              const ShapeFitOptions& options,
              ThreadPool& pool);

  // The shape of this kind with the least Σ w ρ(d). Candidates from closed formulas and random
  // samples take a few steps on some hundreds of points; the best continue on some thousands, which
  // give noise and outliers too; two to four steps over all points finish the fit. Throws
  // std::invalid_argument with a sentence for the user where the points are fewer than the shape's
  // freedoms. O(m).
  ShapeFit Fit(SurfaceKind kind);

  // The data with weight zero for points that do not count in the fit; valid until the next call.
  const ShapeData& Counting(const ShapeFit& fit);

  double unit() const { return unit_; }
  const Eigen::Vector3d& middle() const { return middle_; }
  const StartData& starts() const { return start_; }

 private:
  // Minima on the sample, the lowest first.
  using Minima = std::vector<ShapeCandidate>;

  bool Robust(SurfaceKind kind) const;
  std::vector<FittedSurface> StartsOf(SurfaceKind kind);
  ShapeCandidate Settled(
      const FittedSurface& start, const ShapeData& points, int rounds, int steps, bool robust);
  const Minima& MinimaOf(SurfaceKind kind);
  void AddAlternatives(ShapeFit& fit);
  ShapeLoss Rejecting(double scale, SurfaceKind kind) const;
  void Minimise(const FittedSurface& start, const ShapeLoss& loss, ShapeFit& fit);

  ShapeFitOptions options_;
  ThreadPool& pool_;
  double unit_ = 1;
  Eigen::Vector3d middle_ = Eigen::Vector3d::Zero();
  ShapeData data_;           // (points − middle) / unit
  Eigen::VectorXd weights_;  // before any were set to zero
  StartData start_;
  std::array<Minima, kSurfaceKinds.size()> minima_;
};

}  // namespace batten::internal
