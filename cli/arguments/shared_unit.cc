// SPDX-License-Identifier: MIT
#include "cli/arguments/shared_unit.h"

#include <utility>

#include "batten/io/geometry_file.h"

namespace batten::internal {
namespace {

const std::string kUsual = GeometryWriteOptions().unit;

}  // namespace

GeometryReadOptions ReadBeside(const std::string& asked,
                               const std::string& said,
                               const std::string& format) {
  if (!asked.empty()) return {format, asked};
  return {format, said.empty() ? kUsual : said, kUsual};
}

std::vector<Geometry> SharedUnit::Read(const std::string& path, const std::string& format) {
  if (!asked_.empty() || !first_.empty()) {
    return ReadGeometry(path, ReadBeside(asked_, first_, format));
  }
  GeometryContents contents = ReadGeometryContents(path, {.format = format, .strict = true});
  first_ = contents.unit.empty() ? kUsual : contents.unit;
  return std::move(contents.geometry);
}

std::string SharedUnit::name() const {
  return !asked_.empty() ? asked_ : !first_.empty() ? first_ : kUsual;
}

}  // namespace batten::internal
