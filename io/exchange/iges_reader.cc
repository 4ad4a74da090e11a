// SPDX-License-Identifier: MIT
#include "batten/io/iges_reader.h"

#include <utility>

#include "batten/io/read_error.h"
#include "io/base/whole_file.h"
#include "io/exchange/iges_contents.h"
#include "io/exchange/only_lines.h"
#include "io/exchange/opencascade_functions.h"

namespace batten {
using namespace internal;

GeometryContents ReadIgesContents(const std::string& path) {
  const std::string name = path == "-" ? "standard input" : path;
  const std::string text = ReadWholeFile(path);
  IgesContents found = ParseIgesContents(text, name);
  GeometryContents& contents = found.contents;
  if (!found.beyond.empty()) {
    GeometryContents all;
    if (found.fault.empty()) all = OpenCascade().import_iges(text, name);
    if (!all.geometry.empty()) {
      all.unit = contents.unit;
      all.remarks.insert(all.remarks.end(), contents.remarks.begin(), contents.remarks.end());
      contents = std::move(all);
    } else {
      contents.unread.push_back(found.fault.empty() ? found.beyond : found.fault);
    }
  }
  const std::string points = std::to_string(found.points) + " points";
  if (contents.geometry.empty()) {
    if (!contents.unread.empty()) throw ReadError(name, contents.unread[0]);
    throw ReadError(name,
                    "holds no curves or surfaces that can be read" +
                        (found.points > 0 ? ", " + points + " only" : ""));
  }
  if (found.points > 0) contents.remarks.push_back("its " + points + " are left out");
  if (OnlyLines(contents.geometry)) {
    contents.remarks.push_back("it holds only lines: they are curves of degree 1");
  }
  return contents;
}

std::vector<Geometry> ReadIges(const std::string& path) {
  GeometryContents contents = ReadIgesContents(path);
  if (!contents.unread.empty()) throw ReadError(path, contents.unread[0]);
  return std::move(contents.geometry);
}

}  // namespace batten
