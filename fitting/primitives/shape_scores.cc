// SPDX-License-Identifier: MIT
#include "fitting/primitives/shape_scores.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "fitting/primitives/surface_distance.h"
#include "fitting/primitives/surface_minimum.h"
#include "geometry/numeric/dense_solvers.h"

namespace batten::internal {
namespace {

constexpr int kFinest = 16;  // cubes along a side

// A cube's part of Σ w ψ(d) ∇d and of Σ w |∇d|², in units in which Σ w ∇d ∇dᵀ is one.
struct Cell {
  double score[FreedomsOf(SurfaceKind::kTorus)] = {};  // of the freedoms there are
  double leverage = 0;
};

struct Sums {
  std::vector<Cell> cells = std::vector<Cell>(kFinest * kFinest * kFinest);
  double squares = 0;  // Σ w ψ²
  double slopes = 0;   // Σ ψ'
  Eigen::Index count = 0;
};

// ρ''(d): how much the pull of a point grows with its distance. Where the truncated square jumps
// its expectation for normal noise stands for it.
double LossSlope(const ShapeLoss& loss, double d) {
  if (loss.loss == Loss::kNone) return 1;
  if (loss.loss == Loss::kTruncated) return 0.95;
  const double step = 1e-4 * loss.scale;
  const auto pull = [&](double x) { return x * LossWeight(loss.loss, x, loss.scale); };
  return (pull(d + step) - pull(d - step)) / (2 * step);
}

class Scores {
 public:
  Scores(const FittedSurface& shape, const ShapeData& data, const ShapeLoss& loss, ThreadPool& pool)
      : shape_(shape), data_(data), loss_(loss), pool_(pool), freedoms_(FreedomsOf(shape.kind)) {
    low_ = data.points.rowwise().minCoeff();
    side_ = (data.points.rowwise().maxCoeff() - low_).maxCoeff();
  }

  // Scores are turned by `whiten`, the inverse root of Σ w ∇d ∇dᵀ.
  void Gather(const Eigen::MatrixXd& whiten) {
    constexpr Eigen::Index kParts = 16, kSmallest = 8192;
    const Eigen::Index count = data_.points.cols();
    const Eigen::Index block = std::max(kSmallest, (count + kParts - 1) / kParts);
    std::vector<Sums> parts(static_cast<size_t>((count + block - 1) / block));
    WithKind(shape_.kind, [&]<SurfaceKind kKind>() {
      const SurfaceDistance<kKind> distance_of(shape_);
      pool_.For(count, block, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
        GatherBlock<kKind>(
            distance_of, whiten, begin, end, parts[static_cast<size_t>(begin / block)]);
      });
    });
    for (const Sums& part : parts) Add(part);
  }

  const Sums& sums() const { return sums_; }

  // The scores' second moments with cubes joined to `across` along a side, over their variance
  // where errors are independent, that is one; `spread` is the standard deviation of the mean of
  // its diagonal then. Corrected for what the fit takes out of few cubes.
  struct Moments {
    Eigen::MatrixXd matrix;
    double mean = 1, spread = 0;
  };
  Moments MomentsAt(int across, double variance) const {
    std::vector<Cell> joined(static_cast<size_t>(across * across * across));
    const int ratio = kFinest / across;
    for (int i = 0; i < kFinest * kFinest * kFinest; ++i) {
      const int x = i % kFinest / ratio, y = i / kFinest % kFinest / ratio,
                z = i / (kFinest * kFinest) / ratio;
      Cell& cell = joined[static_cast<size_t>((z * across + y) * across + x)];
      const Cell& part = sums_.cells[static_cast<size_t>(i)];
      for (int j = 0; j < freedoms_; ++j) cell.score[j] += part.score[j];
      cell.leverage += part.leverage;
    }
    Moments moments{Eigen::MatrixXd::Zero(freedoms_, freedoms_)};
    double squares = 0;
    for (const Cell& cell : joined) {
      const Eigen::Map<const Eigen::VectorXd> score(cell.score, freedoms_);
      moments.matrix += score * score.transpose();
      squares += cell.leverage * cell.leverage;
    }
    const double effective = freedoms_ * freedoms_ / std::max(squares, 1e-300);
    const double few = std::max(0.1, 1 - freedoms_ / effective);
    moments.matrix /= variance * few;
    moments.mean = moments.matrix.trace() / freedoms_;
    moments.spread = std::sqrt(2 * squares) / (freedoms_ * few);
    return moments;
  }

 private:
  template <SurfaceKind kKind>
  void GatherBlock(const SurfaceDistance<kKind>& distance_of,
                   const Eigen::MatrixXd& whiten,
                   std::ptrdiff_t begin,
                   std::ptrdiff_t end,
                   Sums& sums) const {
    const Eigen::Matrix<double, FreedomsOf(kKind), FreedomsOf(kKind)> turn = whiten;
    const double cells = kFinest / side_;
    typename SurfaceDistance<kKind>::Row row;
    for (std::ptrdiff_t k = begin; k < end; ++k) {
      const Eigen::Vector3d p = data_.points.col(k);
      const double d = distance_of(p, row), w = data_.weights[k];
      const double of_loss = LossWeight(loss_.loss, d, loss_.scale);
      if (!(w > 0)) continue;
      const typename SurfaceDistance<kKind>::Row turned = turn * row;
      const Eigen::Vector3d at = (p - low_) * cells;
      int place = 0;
      for (int i = 2; i >= 0; --i) {
        place = place * kFinest + std::clamp(static_cast<int>(at[i]), 0, kFinest - 1);
      }
      Cell& cell = sums.cells[static_cast<size_t>(place)];
      const double pull = w * of_loss * d;
      for (int i = 0; i < FreedomsOf(kKind); ++i) cell.score[i] += pull * turned[i];
      cell.leverage += w * turned.squaredNorm();
      sums.squares += w * (of_loss * d) * (of_loss * d);
      sums.slopes += LossSlope(loss_, d);
      ++sums.count;
    }
  }

  void Add(const Sums& part) {
    for (size_t i = 0; i < part.cells.size(); ++i) {
      for (int j = 0; j < freedoms_; ++j) sums_.cells[i].score[j] += part.cells[i].score[j];
      sums_.cells[i].leverage += part.cells[i].leverage;
    }
    sums_.squares += part.squares;
    sums_.slopes += part.slopes;
    sums_.count += part.count;
  }

  const FittedSurface& shape_;
  const ShapeData& data_;
  const ShapeLoss& loss_;
  ThreadPool& pool_;
  int freedoms_;
  Eigen::Vector3d low_;
  double side_ = 1;
  Sums sums_;
};

}  // namespace

FreedomCovariance CovarianceOf(const FittedSurface& shape,
                               const ShapeData& data,
                               const ShapeLoss& loss,
                               double rounding,
                               ThreadPool& pool) {
  const int freedoms = FreedomsOf(shape.kind);
  const Eigen::MatrixXd a = FormOf(shape, data, {}, pool).matrix.topLeftCorner(freedoms, freedoms);
  FreedomCovariance result;
  Eigen::VectorXd unit = a.diagonal().cwiseSqrt();
  for (double& value : unit) value = value > 0 ? 1 / value : 1;
  const SymmetricEigen eigen = EigenOf(unit.asDiagonal() * a * unit.asDiagonal());
  constexpr double kFree = 1e-14;  // rounding of the sums
  const Eigen::VectorXd lambda = eigen.values.cwiseMax(kFree);
  result.determined = eigen.values.minCoeff() > kFree;
  const Eigen::MatrixXd whiten = lambda.cwiseSqrt().cwiseInverse().asDiagonal() *
                                 eigen.vectors.transpose() * unit.asDiagonal();
  Scores scores(shape, data, loss, pool);
  scores.Gather(whiten);
  const Sums& sums = scores.sums();
  const auto count = static_cast<double>(sums.count);
  const double left = std::max(1.0, count - freedoms);
  const double slope = std::max(0.1, sums.slopes / std::max(1.0, count));
  const double variance = std::max(sums.squares / left, rounding * rounding);
  Eigen::MatrixXd white = Eigen::MatrixXd::Identity(freedoms, freedoms);
  constexpr double kSignificant = 4, kMostGrowth = 4;
  double finer = 1;
  for (const int across : {16, 8, 4}) {
    Scores::Moments moments = scores.MomentsAt(across, variance);
    const double growth = std::clamp(moments.mean / finer, 1.0, kMostGrowth);
    finer = moments.mean;
    if (across == 4) {  // variance still growing at the widest blocks is extrapolated
      moments.mean *= growth;
      moments.matrix *= growth;
      moments.spread *= growth;
    }
    if (!(moments.mean > 1 + kSignificant * moments.spread)) continue;
    if (!(moments.mean > result.inflation)) continue;
    result.inflation = moments.mean;
    const SymmetricEigen spread = EigenOf(moments.matrix);
    white = spread.vectors * spread.values.cwiseMax(moments.mean).asDiagonal() *
            spread.vectors.transpose();
  }
  result.covariance = variance / (slope * slope) * whiten.transpose() * white * whiten;
  return result;
}

}  // namespace batten::internal
