// SPDX-License-Identifier: MIT
// The module of OpenCASCADE is found and loaded.
#pragma once

#include <string>
#include <vector>

#include "io/exchange/opencascade_functions.h"

namespace batten::internal {

// The folders in which the module is looked for, in this order: that of the environment variable
// BATTEN_MODULES; those that go with the program or library this code is part of, which are its
// own folder F, F/../lib/batten, F/batten and F/../lib/<architecture>/batten; the one batten is
// installed to; the one it was built in; and, as an empty name, those the loader looks in by
// itself: the run path, LD_LIBRARY_PATH, the system's.
std::vector<std::string> OpenCascadeFolders();

// The functions of `libbatten_opencascade.so` from the first of the folders that has one that
// loads. Throws std::runtime_error naming the file, the folders, what the loader says of one that
// is there, else of the first, and BATTEN_MODULES, where none does.
const OpenCascadeFunctions& LoadOpenCascade(const std::vector<std::string>& folders);

}  // namespace batten::internal
