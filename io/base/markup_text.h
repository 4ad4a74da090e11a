// SPDX-License-Identifier: MIT
// Text in HTML. Not installed.
#pragma once

#include <string>
#include <string_view>

namespace batten::internal {

// Text that may stand between tags and in attributes.
std::string InMarkup(std::string_view text);

// A path as a relative reference: bytes that mean something in one are in per cent. [RFC 3986]
std::string AsReference(std::string_view path);

}  // namespace batten::internal
