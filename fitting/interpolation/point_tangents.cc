// SPDX-License-Identifier: MIT
#include "batten/fitting/point_tangents.h"

#include <Eigen/Geometry>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "fitting/core/rounding.h"

namespace batten {
using namespace internal;
namespace {

[[noreturn]] void RefuseTangents(const std::string& reason) { throw std::invalid_argument(reason); }

double CrossLength(const Eigen::Vector2d& a, const Eigen::Vector2d& b) {
  return std::abs(a.x() * b.y() - a.y() * b.x());
}
double CrossLength(const Eigen::Vector3d& a, const Eigen::Vector3d& b) { return a.cross(b).norm(); }

template <int Dim>
using Vector = Eigen::Matrix<double, Dim, 1>;

// The points of a stretch without corners inside, or of a whole closed curve, by their steps.
template <int Dim>
class Stretch {
 public:
  using Steps = Eigen::Matrix<double, Dim, Eigen::Dynamic>;

  // `rounding`: of a step, in the data's units.
  Stretch(Steps steps, bool closed, double rounding)
      : steps_(std::move(steps)), closed_(closed), rounding_(rounding) {}

  // The step before point k is Step(k − 1), the one after it Step(k). Beyond an end steps go on
  // changing as the last two do.
  Vector<Dim> Step(Eigen::Index k) const {
    const Eigen::Index count = steps_.cols();
    if (closed_) return steps_.col((k % count + count) % count);
    if (k >= 0 && k < count) return steps_.col(k);
    if (count == 1) return steps_.col(0);
    const auto beyond = static_cast<double>(k < 0 ? -k : k - count + 1);
    const Eigen::Index end = k < 0 ? 0 : count - 1, inner = k < 0 ? 1 : count - 2;
    return steps_.col(end) + beyond * (steps_.col(end) - steps_.col(inner));
  }

  // Zero where the difference of directions is not above rounding.
  double Turn(const Vector<Dim>& a, const Vector<Dim>& b) const {
    const double la = a.norm(), lb = b.norm(), cross = CrossLength(a, b);
    const bool straight = cross <= kRelativeRounding * la * lb + rounding_ * (la + lb);
    return straight ? 0 : cross;
  }

  // Directions differ or are opposite.
  bool Bends(Eigen::Index k) const {
    return Turn(Step(k - 1), Step(k)) > 0 || Step(k - 1).dot(Step(k)) < 0;
  }

  // Whether the neighbours on both sides leave the turn at k undetermined.
  bool Undecided(Eigen::Index k) const {
    return !(Turn(Step(k - 2), Step(k - 1)) + Turn(Step(k), Step(k + 1)) > 0);
  }

  Vector<Dim> Akima(Eigen::Index k) const {
    const double before = Turn(Step(k - 2), Step(k - 1)), behind = Turn(Step(k), Step(k + 1));
    const double part = before + behind > 0 ? before / (before + behind) : 0.5;
    return (1 - part) * Step(k - 1) + part * Step(k);
  }

  Vector<Dim> Bessel(Eigen::Index k) const {
    const Eigen::Index count = steps_.cols();
    if (count == 1) return steps_.col(0);
    if (closed_ || (k > 0 && k < count)) {
      const Vector<Dim> before = Step(k - 1), behind = Step(k);
      const double a = before.norm(), b = behind.norm();
      return (b / a) * before + (a / b) * behind;
    }
    // The circle's tangents at both ends of a chord are mirror images.
    const Vector<Dim> chord = Step(k == 0 ? 0 : count - 1).normalized();
    const Vector<Dim> inner = Bessel(k == 0 ? 1 : count - 1);
    return 2 * chord.dot(inner) * chord - inner;
  }

 private:
  Steps steps_;
  bool closed_;
  double rounding_;
};

// The unit vector of v, or of `otherwise` where the steps v is a mean of cancel.
template <int Dim>
Vector<Dim> Unit(const Vector<Dim>& v, const Vector<Dim>& otherwise) {
  return v.norm() > kRelativeRounding * otherwise.norm() ? Vector<Dim>(v.normalized())
                                                         : Vector<Dim>(otherwise.normalized());
}

template <int Dim>
void CheckPoints(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                 const TangentOptions& options) {
  const Eigen::Index m = points.cols(), least = options.closed ? 3 : 2;
  if (m < least) {
    RefuseTangents(std::string(options.closed ? "a closed curve" : "a curve") + " needs at least " +
                   std::to_string(least) + " different points; there are " + std::to_string(m));
  }
  if (!points.allFinite()) RefuseTangents("a point is not finite");
  for (Eigen::Index k = options.closed ? 0 : 1; k < m; ++k) {
    if (points.col(k) != points.col((k + m - 1) % m)) continue;
    RefuseTangents("points " + std::to_string(k == 0 ? m : k) + " and " + std::to_string(k + 1) +
                   " lie in one place: leave one of them out");
  }
  for (const Eigen::Index corner : options.corners) {
    if (corner < 0 || corner >= m) {
      RefuseTangents("corner " + std::to_string(corner + 1) + ": there is no such point");
    }
  }
}

// Finds the tangents of a sequence of points, stretch by stretch.
template <int Dim>
class TangentRow {
 public:
  TangentRow(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
             const TangentOptions& options)
      : options_(options),
        count_(points.cols()),
        whole_(options.closed && options.corners.empty()),
        steps_(Dim, options.closed ? count_ : count_ - 1),
        corner_(static_cast<size_t>(count_), false) {
    for (Eigen::Index k = 0; k < steps_.cols(); ++k) {
      steps_.col(k) = points.col((k + 1) % count_) - points.col(k);
    }
    // Steps in units of the largest, so that products neither vanish nor overflow.
    const double unit = steps_.cwiseAbs().maxCoeff();
    steps_ /= unit;
    rounding_ = 4 * std::numeric_limits<double>::epsilon() * (points.cwiseAbs().maxCoeff() / unit);
    result_.arriving.resize(Dim, count_);
    result_.leaving.resize(Dim, count_);
    for (const Eigen::Index k : options.corners) corner_[static_cast<size_t>(k)] = true;
  }

  PointTangents<Dim> Find() && {
    if (!options_.closed) corner_.front() = corner_.back() = true;  // stretches end there
    if (whole_) {
      Fill(0, count_);
    } else {
      FillStretches();
    }
    if (!options_.closed) {
      result_.arriving.col(0) = result_.leaving.col(0);
      result_.leaving.col(count_ - 1) = result_.arriving.col(count_ - 1);
      corner_.front() = corner_.back() = false;
    }
    for (Eigen::Index k = 0; k < count_; ++k) {
      if (corner_[static_cast<size_t>(k)]) result_.corners.push_back(k);
    }
    return std::move(result_);
  }

 private:
  // Stretches from corner to given corner.
  void FillStretches() {
    const std::vector<bool> ends = corner_;
    const auto is_end = [&](Eigen::Index k) { return ends[static_cast<size_t>(k % count_)]; };
    Eigen::Index first = 0;
    while (!is_end(first)) ++first;
    for (Eigen::Index done = 0; done < steps_.cols();) {
      Eigen::Index count = 1;
      while (!is_end(first + count)) ++count;
      Fill(first, count);
      done += count;
      first = (first + count) % count_;
    }
  }

  // The tangents inside a stretch of `count` steps, and the inner ones at its ends.
  void Fill(Eigen::Index first, Eigen::Index count) {
    Eigen::Matrix<double, Dim, Eigen::Dynamic> own(Dim, count);
    for (Eigen::Index k = 0; k < count; ++k) own.col(k) = steps_.col((first + k) % steps_.cols());
    const Stretch<Dim> stretch(std::move(own), whole_, rounding_);
    for (Eigen::Index k = 0; k < count + (whole_ ? 0 : 1); ++k) {
      const Eigen::Index at = (first + k) % count_;
      const Vector<Dim> tangent =
          options_.rule == TangentRule::kAkima ? stretch.Akima(k) : stretch.Bessel(k);
      const Vector<Dim> before = stretch.Step(k - 1), behind = stretch.Step(k);
      if ((whole_ || (k > 0 && k < count)) && IsCorner(stretch, k, tangent)) {
        corner_[static_cast<size_t>(at)] = true;
        result_.arriving.col(at) = before.normalized();
        result_.leaving.col(at) = behind.normalized();
        continue;
      }
      const Vector<Dim> direction = Unit<Dim>(tangent, k < count ? behind : before);
      if (k > 0 || whole_) result_.arriving.col(at) = direction;
      if (k < count) result_.leaving.col(at) = direction;
    }
  }

  // Between straight stretches where these are sought, and where the curve turns back.
  bool IsCorner(const Stretch<Dim>& stretch, Eigen::Index k, const Vector<Dim>& tangent) const {
    if (!stretch.Bends(k)) return false;
    if (options_.find_corners && stretch.Undecided(k)) return true;
    return tangent.norm() <=
           rounding_ + std::numeric_limits<double>::epsilon() * stretch.Step(k).norm();
  }

  const TangentOptions& options_;
  Eigen::Index count_;
  bool whole_;  // closed and without given corners
  Eigen::Matrix<double, Dim, Eigen::Dynamic> steps_;
  double rounding_ = 0;  // of a step
  std::vector<bool> corner_;
  PointTangents<Dim> result_;
};

}  // namespace

template <int Dim>
PointTangents<Dim> TangentsAt(const Eigen::Matrix<double, Dim, Eigen::Dynamic>& points,
                              const TangentOptions& options) {
  CheckPoints<Dim>(points, options);
  return TangentRow<Dim>(points, options).Find();
}

template PointTangents<2> TangentsAt<2>(const Eigen::Matrix2Xd&, const TangentOptions&);
template PointTangents<3> TangentsAt<3>(const Eigen::Matrix3Xd&, const TangentOptions&);

}  // namespace batten
