// SPDX-License-Identifier: MIT
// The records of an IGES file. Not installed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace batten::internal {

// An entity of the directory with its parameters. Numbers that are left out, or texts, are 0.
struct IgesEntity {
  int type = 0;
  int form = 0;
  int transform = -1;              // index of the entity of type 124 that places it, −1: none
  bool dependent = false;          // a part of another entity
  std::string label;               // at most 8 characters
  std::string text;                // the first text among the parameters, of properties (406) only
  bool geometry = false;           // not annotation, a definition, or a curve in parameters
  std::vector<double> parameters;  // after the type
};

// Parses fixed-format ASCII IGES: sections, directory, parameter data. Checks the lines' sections,
// pointers, and that the parameter lines of entities do not overlap in sum; memory stays within a
// few times the text. Throws ReadError naming `path` and the line.
std::vector<IgesEntity> ParseIges(std::string_view text, const std::string& path);

// What the global section says of lengths; what it leaves out is 0 or empty.
struct IgesGlobal {
  double scale = 0;  // of the model's space to the real one
  int unit_flag = 0;
  std::string unit_name;
};
IgesGlobal ParseIgesGlobal(std::string_view text, const std::string& path);

// The index of the entity with the odd sequence number that pointers use; −1 for 0.
inline int IgesIndex(double pointer) {
  return pointer >= 1 && pointer < 2e9 ? (static_cast<int>(pointer) - 1) / 2 : -1;
}

// "entity D7 (type 128)"
std::string IgesName(const std::vector<IgesEntity>& entities, int index);

}  // namespace batten::internal
