// SPDX-License-Identifier: MIT
// Points that are passed over again and again, for clouds larger than memory.
#pragma once

#include <Eigen/Core>
#include <functional>
#include <optional>
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
  // passes through. Fits on several threads call it from a thread of its own, so that reading goes
  // on while they work; one pass at a time.
  virtual void Pass(const TakePoints& take) = 0;

  // Where processes have shares of the points: adds up their numbers, which are then the same for
  // all. In an order that depends on the number of processes only.
  virtual void Sum(std::span<double> /*numbers*/) {}

  // The numbers of all processes, one behind the other, for all.
  virtual std::vector<double> Gathered(std::vector<double> numbers) { return numbers; }

  // Whether Sum and Gathered do something: no process has all points.
  virtual bool shared() const { return false; }
};

// Keeps the numbers of each pass of a streamed fit. The fit asks for those of a pass before it
// makes it; where it gets them it goes on as if it had made the pass, to the same result, as all
// else follows from the passes and the options. That both are those of the fit that kept them is
// the store's business. Of processes that share points the first one's store counts.
class PassStore {
 public:
  virtual ~PassStore() = default;

  // What was kept of pass 1, 2, …; none where it was not finished.
  virtual std::optional<std::vector<double>> Kept(int pass) = 0;

  virtual void Keep(int pass, std::span<const double> numbers) = 0;
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
