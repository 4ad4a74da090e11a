// SPDX-License-Identifier: MIT
#include "fitting/tiles/tile_points.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "batten/fitting/refused_data.h"
#include "geometry/evaluation/evaluation_table.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

// Points that are dealt into cells together: enough that the cells of a large net are gone through
// seldom against the points.
constexpr Eigen::Index kAtOnce = Eigen::Index{1} << 20;

// Parameters and values of points until they are many.
class PointBuffer {
 public:
  PointBuffer(const SplineBasis& basis_u, const SplineBasis& basis_v, int dimension)
      : basis_u_(basis_u),
        basis_v_(basis_v),
        u_(basis_u_, 0),
        v_(basis_v_, 0),
        parameters_(2, kAtOnce),
        values_(dimension, kAtOnce),
        moments_({basis_u.degree(), basis_v.degree(), dimension},
                 static_cast<int>(basis_u.Spans().size()),
                 static_cast<int>(basis_v.Spans().size())) {}

  void Add(const Eigen::Vector2d& at,
           const Eigen::Ref<const Eigen::VectorXd>& value,
           ThreadPool& pool) {
    parameters_(0, size_) = std::clamp(at[0], basis_u_.lower(), basis_u_.upper());
    parameters_(1, size_) = std::clamp(at[1], basis_v_.lower(), basis_v_.upper());
    values_.col(size_++) = value;
    if (size_ == kAtOnce) Flush(pool);
  }

  void Flush(ThreadPool& pool) {
    const PointRows rows{size_,
                         parameters_.data(),
                         parameters_.data() + 1,
                         2,
                         values_.data(),
                         static_cast<int>(values_.rows()),
                         nullptr};
    moments_.Add(u_.table(), &v_.table(), rows, pool);
    size_ = 0;
  }

  CellMoments& moments() { return moments_; }

 private:
  const SplineBasis &basis_u_, &basis_v_;
  const AxisStorage u_, v_;
  Eigen::Matrix2Xd parameters_;
  Eigen::MatrixXd values_;
  Eigen::Index size_ = 0;
  CellMoments moments_;
};

}  // namespace

TileDomain FindDomain(StreamPipeline& pipeline,
                      const NearSurface& near,
                      const SurfaceFitOptions& options,
                      ThreadPool& pool) {
  const SampleFit& sample = pipeline.sample();
  const double limit = sample.LimitOf(near.Place(sample.cloud.points(), pool).distances, options);
  Eigen::Vector2d low = Eigen::Vector2d::Constant(kInfinity), high = -low;
  const auto extend = [&](const Eigen::Matrix3Xd& points) {
    const PlacedPoints placed = near.Place(pipeline.Local(points), pool);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      if (!(std::abs(placed.distances[k]) <= limit)) continue;
      low = low.cwiseMin(placed.parameters.col(k));
      high = high.cwiseMax(placed.parameters.col(k));
    }
  };
  const auto merge = [&] {
    const std::vector<double> all = pipeline.source().Gathered({low[0], low[1], high[0], high[1]});
    for (std::size_t k = 0; k < all.size(); k += 4) {
      low = low.cwiseMin(Eigen::Vector2d(all[k], all[k + 1]));
      high = high.cwiseMax(Eigen::Vector2d(all[k + 2], all[k + 3]));
    }
  };
  pipeline.Pass("parameterize", {{low.data(), 2}, {high.data(), 2}}, extend, merge);
  if (!(high - low).allFinite() || !((high - low).minCoeff() > 0))
    throw RefusedData("hardly any point is near the surface of the sample");
  const double margin = sample.SpacingOf(pipeline.look().different) / 2 + 2 * sample.noise;
  Parameterization base = near.BaseOf({{low, 0, 1}, {high, 0, 1}}, margin);
  const Eigen::Vector2d shift = low - base.parameters.col(0);
  return {std::move(base), shift, limit};
}

FoldedPoints FoldPoints(StreamPipeline& pipeline,
                        const NearSurface& near,
                        const TileDomain& domain,
                        const SplineBasis& basis_u,
                        const SplineBasis& basis_v,
                        ThreadPool& pool) {
  const std::optional<PlaneBase>& plane = domain.base.plane;
  PointBuffer buffer(basis_u, basis_v, plane ? 1 : 3);
  const auto fold = [&](const Eigen::Matrix3Xd& points) {
    const Eigen::Matrix3Xd local = pipeline.Local(points);
    const PlacedPoints placed = near.Place(local, pool);
    const Eigen::MatrixXd values =
        plane ? Eigen::MatrixXd(plane->axes.col(2).transpose() * (local.colwise() - plane->origin))
              : Eigen::MatrixXd(local);
    for (Eigen::Index k = 0; k < points.cols(); ++k) {
      if (std::abs(placed.distances[k]) <= domain.limit)
        buffer.Add(placed.parameters.col(k) - domain.shift, values.col(k), pool);
    }
  };
  pipeline.Pass("parameterize", {buffer.moments().numbers()}, fold, [&] {
    buffer.Flush(pool);
    pipeline.source().Sum(buffer.moments().numbers());
  });
  return {basis_u, basis_v, std::move(buffer.moments())};
}

}  // namespace batten::internal
