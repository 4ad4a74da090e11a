// SPDX-License-Identifier: MIT
// The script that completes command lines in bash by asking `batten __complete WORD...`.
#pragma once

namespace batten::internal {

const char* BashCompletion();

}  // namespace batten::internal
