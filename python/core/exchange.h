// SPDX-License-Identifier: MIT
// One reader or writer of CAD files at a time.
#pragma once

#include <mutex>

namespace batten::python {

// OpenCASCADE keeps its readers and writers in variables of the process.
inline std::mutex& ExchangeMutex() {
  static std::mutex mutex;
  return mutex;
}

}  // namespace batten::python
