// SPDX-License-Identifier: MIT
// What the library throws of points, as that of a call from Python.
#pragma once

#include <stdexcept>

#include "batten/fitting/refused_data.h"
#include "python/core/errors.h"

namespace batten::python {

inline const char* KeywordThatHelps(Remedy remedy) {
  switch (remedy) {
    case Remedy::kNone:
      return "";
    case Remedy::kLeaveOpen:
      return "open=True";
    case Remedy::kFitPart:
      return "cloud_parts(points)";
    case Remedy::kFlatten:
      return "base='sheet'";
    case Remedy::kClosingByData:
      return "closed='auto'";
  }
  return "";
}

// Past the check of the options, what the library throws is said of the points.
template <typename Function>
auto Explained(const Function& fit) {
  try {
    return fit();
  } catch (const RefusedData& refusal) {
    throw Refused(refusal.what(), KeywordThatHelps(refusal.remedy()));
  } catch (const std::invalid_argument& error) {
    throw Refused(Reason(error.what()), "");
  }
}

}  // namespace batten::python
