// SPDX-License-Identifier: MIT
// The text of a STEP file as OpenCASCADE writes it is put into the shortest form.
#pragma once

#include <string>

namespace batten::internal {

// The text with every real number, which OpenCASCADE wrote with 17 digits and an exponent, in its
// shortest form that reads back exactly. Strings keep to ASCII and, as OpenCASCADE breaks long
// ones, to one line.
std::string WithShortestReals(const std::string& text);

}  // namespace batten::internal
