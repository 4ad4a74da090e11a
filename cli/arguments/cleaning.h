// SPDX-License-Identifier: MIT
// The flag --clean: what becomes of stray points before and in a fit.
#pragma once

#include <optional>
#include <string>

#include "batten/fitting/clean_cloud.h"

namespace batten::internal {

struct Cleaning {
  bool keep_outliers = false;                     // none
  std::optional<StatisticalRemoval> statistical;  // before the fit, which then goes on as by auto
};

// auto, none, statistical or statistical:K,S. Throws UsageError for anything else.
Cleaning ToCleaning(const std::string& text);

}  // namespace batten::internal
