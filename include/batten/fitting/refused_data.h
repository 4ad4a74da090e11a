// SPDX-License-Identifier: MIT
// What a fit throws where the data, not the call, forbid it.
#pragma once

#include <stdexcept>
#include <string>

namespace batten {

// What a caller can change where data are refused.
enum class Remedy {
  kNone,
  kFitPart,        // fit a part of the points
  kFlatten,        // SurfaceFitOptions::base = BaseShape::kSheet
  kClosingByData,  // SurfaceFitOptions::closed = Closing::kAuto
  kLeaveOpen,      // an open shell: TriangleSurface::caps
};

// Data that a fit refuses: what() is one sentence for a user with the reason and its numbers; the
// remedy says what may help. Broken preconditions throw std::invalid_argument itself.
class RefusedData : public std::invalid_argument {
 public:
  explicit RefusedData(const std::string& reason, Remedy remedy = Remedy::kNone)
      : std::invalid_argument(reason), remedy_(remedy) {}

  Remedy remedy() const { return remedy_; }

 private:
  Remedy remedy_;
};

// Points on two sheets, one above the other, over a base that takes them for one.
class TwoSheets : public RefusedData {
 public:
  using RefusedData::RefusedData;
};

}  // namespace batten
