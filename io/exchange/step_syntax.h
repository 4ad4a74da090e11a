// SPDX-License-Identifier: MIT
// Whether a text is well-formed STEP. Not installed.
#pragma once

#include <string>
#include <string_view>

namespace batten::internal {

// Checks the exchange structure of ISO 10303-21 before OpenCASCADE sees it, whose parser hangs or
// reads freed memory on some damaged files: sections, records, parameters, numbers; every instance
// defined once; every reference to a defined one; no instance that refers to itself, however
// indirectly. Throws ReadError naming `path` and the line. Linear time up to the sort of the
// instances.
void CheckStepSyntax(std::string_view text, const std::string& path);

// Checks the text like that, and changes in it what OpenCASCADE's lexer mistakes and then may crash
// on: a doubled quote before anything but a letter or digit, which it may take for the end of the
// string, is written \X\27; comments, and blanks with tabs, become spaces.
void PrepareStepText(std::string& text, const std::string& path);

}  // namespace batten::internal
