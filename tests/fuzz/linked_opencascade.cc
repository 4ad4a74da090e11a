// SPDX-License-Identifier: MIT
// OpenCASCADE's functions linked into a fuzzer, in place of the module: its code is instrumented.
#include "io/exchange/opencascade_functions.h"

extern "C" const batten::internal::OpenCascadeFunctions* batten_opencascade_functions();

namespace batten::internal {

const OpenCascadeFunctions& OpenCascade() { return *batten_opencascade_functions(); }

}  // namespace batten::internal
