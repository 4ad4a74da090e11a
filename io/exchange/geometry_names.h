// SPDX-License-Identifier: MIT
// Names of curves and surfaces between encodings. Not installed.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace batten::internal {

// The name as UTF-8 on one line: bytes that are not UTF-8 are taken for Latin-1, control characters
// become spaces, spaces at either end go, and what is longer than 1000 bytes is cut at a character.
std::string CleanName(std::string_view text);

// The first `length` characters, others than ASCII as question marks. Expects UTF-8.
std::string AsciiPart(std::string_view name, std::size_t length);

// The name as ISO 10303-21 writes it between quotes: what is not ASCII as \X2\…\X0\ or \X4\…\X0\,
// quotes and backslashes untouched. Expects UTF-8.
std::string ToStepText(std::string_view text);

// The name as a JSON string with its quotes. Expects UTF-8.
std::string ToJsonText(std::string_view text);

}  // namespace batten::internal
