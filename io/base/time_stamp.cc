// SPDX-License-Identifier: MIT
#include "io/base/time_stamp.h"

#include <charconv>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <system_error>

namespace batten::internal {

std::string TimeStamp(const char* format) {
  std::int64_t seconds = 0;
  if (const char* epoch = std::getenv("SOURCE_DATE_EPOCH")) {
    std::int64_t given = 0;
    const char* end = epoch + std::strlen(epoch);
    const auto [stop, error] = std::from_chars(epoch, end, given);
    constexpr std::int64_t kYear10000 = 253402300800;
    if (error == std::errc() && stop == end && given >= 0 && given < kYear10000) seconds = given;
  }
  const std::time_t time = static_cast<std::time_t>(seconds);
  std::tm utc = {};
  ::gmtime_r(&time, &utc);
  char text[32];
  std::strftime(text, sizeof text, format, &utc);
  return text;
}

}  // namespace batten::internal
