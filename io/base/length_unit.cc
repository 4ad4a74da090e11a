// SPDX-License-Identifier: MIT
#include "batten/io/length_unit.h"

#include <cmath>

#include "batten/io/read_error.h"

namespace batten {

const std::vector<LengthUnit>& LengthUnits() {
  static const std::vector<LengthUnit> units = {{"mm", 1, "MM", 2, "MM"},
                                                {"cm", 10, "CM", 10, "CM"},
                                                {"m", 1e3, "M", 6, "M"},
                                                {"km", 1e6, "KM", 7, "KM"},
                                                {"um", 1e-3, "UM", 9, "UM"},
                                                {"inch", 25.4, "INCH", 1, "IN"},
                                                {"in", 25.4, "INCH", 1, "IN"},
                                                {"ft", 304.8, "FT", 4, "FT"},
                                                {"mi", 1609344, "MI", 5, "MI"},
                                                {"mil", 0.0254, "MIL", 8, "MIL"},
                                                {"uin", 2.54e-5, "UIN", 11, "UIN"}};
  return units;
}

const LengthUnit& LengthUnitOf(const std::string& name) {
  std::string names;
  for (const LengthUnit& unit : LengthUnits()) {
    if (name == unit.name) return unit;
    names += (names.empty() ? "" : ", ") + std::string(unit.name);
  }
  throw UsageError("unit \"" + name + "\" is not one of " + names);
}

std::string LengthUnitName(double millimetres) {
  constexpr double kSame = 1e-9;
  for (const LengthUnit& unit : LengthUnits()) {
    if (std::abs(millimetres - unit.millimetres) <= kSame * unit.millimetres) return unit.name;
  }
  return "";
}

}  // namespace batten
