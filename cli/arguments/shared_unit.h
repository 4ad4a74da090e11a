// SPDX-License-Identifier: MIT
// Several files read together, in one unit.
#pragma once

#include <string>
#include <vector>

#include "batten/io/geometry_types.h"

namespace batten::internal {

// How to read a file beside others in the unit of the first, as it was `asked` for or `said` by
// that: what says none is mm then, as it is when it is read alone. In a unit that is asked for
// such coordinates stay as they are.
GeometryReadOptions ReadBeside(const std::string& asked,
                               const std::string& said,
                               const std::string& format = "");

// The unit of files that are read one after the other: the one asked for, else that of the first.
class SharedUnit {
 public:
  void Ask(const std::string& unit) { asked_ = unit; }

  // Throws as ReadGeometry.
  std::vector<Geometry> Read(const std::string& path, const std::string& format);

  // Of all that has been read and is written.
  std::string name() const;

 private:
  std::string asked_, first_;  // empty: nothing is asked for; no file has been read
};

}  // namespace batten::internal
