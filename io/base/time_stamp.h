// SPDX-License-Identifier: MIT
// The time in files. Not installed.
#pragma once

#include <string>

namespace batten::internal {

// SOURCE_DATE_EPOCH, where it holds seconds since 1970, else 1970, in UTC and std::strftime's
// `format` of at most 31 characters: the same geometry gives the same bytes.
std::string TimeStamp(const char* format);

}  // namespace batten::internal
