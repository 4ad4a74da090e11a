// SPDX-License-Identifier: MIT
#include "fitting/primitives/surface_minimum.h"

#include <Eigen/Cholesky>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "fitting/primitives/surface_distance.h"
#include "geometry/numeric/constants.h"

namespace batten::internal {
namespace {

constexpr Eigen::Index kBlock = 8192;

using Vector7 = Eigen::Matrix<double, 7, 1>;

// The sums over a block, the lower triangle of the matrix only.
template <SurfaceKind kKind, bool kLossy>
SurfaceForm BlockForm(const SurfaceDistance<kKind>& distance_of,
                      const ShapeData& data,
                      const ShapeLoss& loss,
                      Eigen::Index begin,
                      Eigen::Index end) {
  constexpr int kFreedoms = FreedomsOf(kKind);
  double products[kFreedoms * (kFreedoms + 1) / 2] = {}, gradient[kFreedoms] = {}, cost = 0;
  for (Eigen::Index k = begin; k < end; ++k) {
    typename SurfaceDistance<kKind>::Row row;
    const double distance = distance_of(data.points.col(k), row);
    double weight = data.weights[k];
    if constexpr (kLossy) {
      cost += weight * LossValue(loss.loss, distance, loss.scale);
      weight *= LossWeight(loss.loss, distance, loss.scale);
      if (!(weight > 0)) continue;
    } else {
      cost += weight * distance * distance / 2;
    }
    int at = 0;
    for (int i = 0; i < kFreedoms; ++i) {
      const double weighted = weight * row[i];
      gradient[i] += weighted * distance;
      for (int j = 0; j <= i; ++j) products[at++] += weighted * row[j];
    }
  }
  SurfaceForm form;
  form.cost = cost;
  int at = 0;
  for (int i = 0; i < kFreedoms; ++i) {
    form.gradient[i] = gradient[i];
    for (int j = 0; j <= i; ++j) form.matrix(i, j) = form.matrix(j, i) = products[at++];
  }
  return form;
}

// The gradient's size in units in which the diagonal of the matrix is one: a length, as distances
// are, over the root of the number of points.
double Slope(const SurfaceForm& form) {
  double most = 0;
  for (int i = 0; i < 7; ++i) {
    if (form.matrix(i, i) > 0) {
      most = std::max(most, std::abs(form.gradient[i]) / std::sqrt(form.matrix(i, i)));
    }
  }
  return most;
}

// −(A + λ·diag A)⁻¹ g in the same units.
Vector7 StepOf(const SurfaceForm& form, int freedoms, double damping) {
  Eigen::VectorXd unit = form.matrix.diagonal().head(freedoms).cwiseSqrt();
  for (double& value : unit) value = value > 0 ? 1 / value : 0;
  Eigen::MatrixXd scaled =
      unit.asDiagonal() * form.matrix.topLeftCorner(freedoms, freedoms) * unit.asDiagonal();
  constexpr double kSymmetry = 1e-15;  // freedoms that move nothing are rounding
  scaled.diagonal().array() += damping + kSymmetry;
  for (int i = 0; i < freedoms; ++i) {
    if (unit[i] == 0) scaled(i, i) = 1;
  }
  Vector7 step = Vector7::Zero();
  step.head(freedoms) =
      unit.cwiseProduct(scaled.ldlt().solve(-unit.cwiseProduct(form.gradient.head(freedoms))));
  return step;
}

// Levenberg–Marquardt steps and final Gauss–Newton steps, one evaluation of the form each.
class Descent {
 public:
  Descent(const FittedSurface& start,
          const ShapeData& data,
          const ShapeLoss& loss,
          ThreadPool& pool)
      : data_(data), loss_(loss), pool_(pool), freedoms_(FreedomsOf(start.kind)) {
    best_.shape = start;
    best_.form = FormOf(start, data, loss, pool);
  }

  SurfaceMinimum Run(int most_steps) {
    while (best_.steps < most_steps && !best_.converged) Step();
    constexpr int kPolishingSteps = 20;
    const int last = std::min(most_steps, best_.steps + kPolishingSteps);
    const double rms = std::sqrt(2 * best_.form.cost / data_.weights.sum());
    if (rms > kNoise) return best_;
    while (best_.converged && best_.steps < last && Polish()) {
    }
    return best_;
  }

 private:
  static constexpr double kFirstDamping = 1e-4, kRaise = 8, kLower = 0.2, kMostDamping = 1e12;
  static constexpr double kSteady = 1e-12;  // of the sum
  static constexpr double kNoise = 1e-7;    // of the size: more than this hides the last digits
  static constexpr double kDone = 1e-3;     // of the rounding of distances about one

  bool Lowest() const { return !(best_.form.cost > 0) || Slope(best_.form) <= kDone * kEpsilon; }

  bool AtRounding() const {
    constexpr double kRoundings = 4;
    return 2 * best_.form.cost <= std::pow(kRoundings * kEpsilon, 2) * data_.weights.sum();
  }

  void Step() {
    if (Lowest() || AtRounding()) {
      best_.converged = true;
      return;
    }
    const Vector7 step = StepOf(best_.form, freedoms_, damping_);
    if (damping_ == 0 && -step.dot(best_.form.gradient) <= kSteady * best_.form.cost) {
      best_.converged = true;
      return;
    }
    const FittedSurface next = Moved(best_.shape, step);
    const SurfaceForm form = FormOf(next, data_, loss_, pool_);
    ++best_.steps;
    if (form.cost < best_.form.cost) {
      best_.shape = next;
      best_.form = form;
      damping_ = damping_ <= kFirstDamping ? 0 : damping_ * kLower;
    } else {
      damping_ = std::max(kFirstDamping, damping_ * kRaise);
      best_.converged = damping_ > kMostDamping;
    }
  }

  bool Polish() {
    if (Lowest()) return false;
    const FittedSurface next = Moved(best_.shape, StepOf(best_.form, freedoms_, 0));
    const SurfaceForm form = FormOf(next, data_, loss_, pool_);
    ++best_.steps;
    const bool better =
        Slope(form) < 0.5 * Slope(best_.form) && form.cost <= (1 + 16 * kEpsilon) * best_.form.cost;
    if (!better) return false;
    best_.shape = next;
    best_.form = form;
    return true;
  }

  const ShapeData& data_;
  const ShapeLoss& loss_;
  ThreadPool& pool_;
  int freedoms_;
  double damping_ = 0;
  SurfaceMinimum best_;
};

}  // namespace

SurfaceForm FormOf(const FittedSurface& shape,
                   const ShapeData& data,
                   const ShapeLoss& loss,
                   ThreadPool& pool) {
  const Eigen::Index count = data.points.cols();
  std::vector<SurfaceForm> parts(static_cast<size_t>((count + kBlock - 1) / kBlock));
  WithKind(shape.kind, [&]<SurfaceKind kKind>() {
    const SurfaceDistance<kKind> distance_of(shape);
    pool.For(count, kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      parts[static_cast<size_t>(begin / kBlock)] =
          loss.loss == Loss::kNone ? BlockForm<kKind, false>(distance_of, data, loss, begin, end)
                                   : BlockForm<kKind, true>(distance_of, data, loss, begin, end);
    });
  });
  SurfaceForm form;
  for (const SurfaceForm& part : parts) {
    form.matrix += part.matrix;
    form.gradient += part.gradient;
    form.cost += part.cost;
  }
  return form;
}

FittedSurface Moved(const FittedSurface& shape, const Eigen::Matrix<double, 7, 1>& step) {
  FittedSurface moved = shape;
  moved.point += step[0] * shape.normal;
  const Eigen::Vector3d turn =
      step[1] * shape.Across() + step[2] * shape.along + step[4] * shape.normal;
  const double angle = turn.norm();
  if (angle > 0) {
    const Eigen::AngleAxisd rotation(angle, turn / angle);
    moved.normal = (rotation * shape.normal).normalized();
    moved.along = rotation * shape.along;
    moved.along = (moved.along - moved.along.dot(moved.normal) * moved.normal).normalized();
  }
  (shape.kind == SurfaceKind::kSphere ? moved.curvature : moved.axis_curvature) += step[3];
  moved.slope += step[5];
  moved.curvature += step[6];
  return moved;
}

SurfaceMinimum Minimised(const FittedSurface& start,
                         const ShapeData& data,
                         const ShapeLoss& loss,
                         int most_steps,
                         ThreadPool& pool) {
  return Descent(start, data, loss, pool).Run(most_steps);
}

Eigen::VectorXd SurfaceDistances(const FittedSurface& shape,
                                 const Eigen::Matrix3Xd& points,
                                 ThreadPool& pool) {
  Eigen::VectorXd distances(points.cols());
  WithKind(shape.kind, [&]<SurfaceKind kKind>() {
    const SurfaceDistance<kKind> distance_of(shape);
    pool.For(points.cols(), kBlock, [&](std::ptrdiff_t begin, std::ptrdiff_t end) {
      typename SurfaceDistance<kKind>::Row row;
      for (std::ptrdiff_t k = begin; k < end; ++k) distances[k] = distance_of(points.col(k), row);
    });
  });
  return distances;
}

}  // namespace batten::internal
