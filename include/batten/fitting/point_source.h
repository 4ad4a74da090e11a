// SPDX-License-Identifier: MIT
// Points that are passed over again and again, for clouds larger than memory.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <span>
#include <vector>

namespace batten {

// Gets some of the points: 3 × m, world coordinates, finite. They are valid during the call.
using TakePoints = std::function<void(const Eigen::Matrix3Xd& points)>;

// All points of a cloud, or this process's share of them, as often as they are asked for.
class PointSource {
 public:
  virtual ~PointSource() = default;

  // Hands every point to `take`, in pieces and in the same order each time. What `take` throws
  // passes through.
  virtual void Pass(const TakePoints& take) = 0;

  // Where processes have shares of the points: adds up their numbers, which are then the same for
  // all. In an order that depends on the number of processes only.
  virtual void Sum(std::span<double> /*numbers*/) {}

  // The numbers of all processes, one behind the other, for all.
  virtual std::vector<double> Gathered(std::vector<double> numbers) { return numbers; }

  // Whether Sum and Gathered do something: no process has all points.
  virtual bool shared() const { return false; }
};

// The points of a matrix, 3 × m, which it refers to.
class ArraySource : public PointSource {
 public:
  // Throws std::invalid_argument where a coordinate is not finite.
  explicit ArraySource(const Eigen::Matrix3Xd& points);
  void Pass(const TakePoints& take) override;

 private:
  const Eigen::Matrix3Xd& points_;
};

}  // namespace batten
