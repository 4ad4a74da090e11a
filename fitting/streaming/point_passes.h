// SPDX-License-Identifier: MIT
// The passes of a fit over its points: read ahead of what is done with them, and kept.
#pragma once

#include <functional>
#include <span>
#include <vector>

#include "batten/fitting/point_source.h"

namespace batten::internal {

class PointPasses {
 public:
  // Source and store (null: none) are referred to. With `ahead` the source passes in a thread of
  // its own, at most two pieces before they are taken.
  PointPasses(PointSource& source, PassStore* store, bool ahead)
      : source_(source), store_(store), ahead_(ahead) {}

  PointSource& source() const { return source_; }
  int done() const { return done_; }

  // The next pass: `run` goes over the points and leaves what they tell, of all processes, in
  // `numbers`. Of a pass that was kept these are filled without it. Throws std::runtime_error where
  // what was kept is not so many numbers.
  void Next(const std::vector<std::span<double>>& numbers, const std::function<void()>& run);

  // All points of this process, as PointSource::Pass has it; what the source throws passes through.
  void Over(const TakePoints& take);

 private:
  bool Restore(const std::vector<std::span<double>>& numbers);

  PointSource& source_;
  PassStore* store_;
  bool ahead_;
  int done_ = 0;
};

}  // namespace batten::internal
