// SPDX-License-Identifier: MIT
#include "batten/io/brep_reader.h"

#include "io/base/whole_file.h"
#include "io/exchange/brep_text.h"
#include "io/exchange/opencascade_functions.h"

namespace batten {
using namespace internal;

GeometryContents ReadBrepContents(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  return OpenCascade().import_brep(CheckedBrep(ReadWholeFile(path), name), name);
}

}  // namespace batten
