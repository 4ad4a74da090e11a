// SPDX-License-Identifier: MIT
// The units of length that geometry files declare.
#pragma once

#include <string>
#include <vector>

namespace batten {

struct LengthUnit {
  const char* name;    // what users say, the first of its synonyms where a unit has several
  double millimetres;  // exactly
  const char* step;    // OpenCASCADE's word
  int iges_flag;       // [IGES 5.3, §2.2.4.3.14]
  const char* iges;    // the name that goes with the flag
};

// mm, cm, m, km, um, inch (in), ft, mi, mil, uin.
const std::vector<LengthUnit>& LengthUnits();

// The unit of that name. Throws UsageError naming those there are.
const LengthUnit& LengthUnitOf(const std::string& name);

// The name of the unit of so many millimetres, to 1e-9 of them; empty: none has it.
std::string LengthUnitName(double millimetres);

}  // namespace batten
