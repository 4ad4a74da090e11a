// SPDX-License-Identifier: MIT
#include "batten/io/step_reader.h"

#include <utility>

#include "batten/io/read_error.h"
#include "io/base/whole_file.h"
#include "io/exchange/opencascade_functions.h"
#include "io/exchange/step_syntax.h"

namespace batten {
using namespace internal;

GeometryContents ReadStepContents(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  std::string text = ReadWholeFile(path);
  PrepareStepText(text, name);
  return OpenCascade().import_step(std::move(text), name);
}

std::vector<Geometry> ReadStep(const std::string& path) {
  GeometryContents contents = ReadStepContents(path);
  if (!contents.unread.empty()) throw ReadError(path, contents.unread[0]);
  return std::move(contents.geometry);
}

}  // namespace batten
