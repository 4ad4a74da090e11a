// SPDX-License-Identifier: MIT
// The readers of geometry that are batten's own from the first byte to the last.
#include <algorithm>
#include <charconv>
#include <vector>

#include "batten/io/geometry_json.h"
#include "batten/io/read_error.h"
#include "fuzz_targets.h"
#include "geometry_laws.h"
#include "io/exchange/iges_contents.h"
#include "io/exchange/step_syntax.h"
#include "memory_file.h"

namespace batten::internal {
namespace {

// The text in lines of the width, each with its section and number: columns 73 and 74 to 80.
void AppendSection(std::string& file, std::string_view text, char section) {
  constexpr std::size_t kWidth = 72;
  for (std::size_t begin = 0, number = 1; begin < text.size(); begin += kWidth, ++number) {
    std::string line(text.substr(begin, kWidth));
    line.resize(kWidth, ' ');
    std::string count = std::to_string(number % 10'000'000);
    count.insert(0, 7 - count.size(), ' ');
    file += line + section + count + '\n';
  }
}

std::string Field(std::string_view text) {
  std::string field(text.substr(0, 8));
  field.insert(0, 8 - field.size(), ' ');
  return field;
}

std::string Field(std::size_t number) { return Field(std::to_string(number)); }

// The parts of a text between separators, at least `count` of them.
std::vector<std::string_view> Parts(std::string_view text, char separator, std::size_t count) {
  std::vector<std::string_view> parts;
  for (std::size_t begin = 0; begin <= text.size();) {
    const std::size_t end = std::min(text.find(separator, begin), text.size());
    parts.push_back(text.substr(begin, end - begin));
    begin = end + 1;
  }
  if (parts.size() < count) parts.resize(count);
  return parts;
}

}  // namespace

std::string LaidOutIges(std::string_view entities) {
  constexpr std::size_t kWidth = 64;  // of the parameters on a line; the entity's number follows
  std::string directory, parameters;
  for (const std::string_view line : Parts(entities, '\n', 0)) {
    if (line.empty()) continue;
    const std::size_t end = std::min(line.find(';'), line.size());
    const auto heads = Parts(line.substr(0, end), ',', 4);
    std::string values(heads[0]);
    if (end < line.size()) values += ',' + std::string(line.substr(end + 1));
    values += ';';
    const std::size_t first = parameters.size() / 72 + 1;
    for (std::size_t begin = 0; begin < values.size(); begin += kWidth) {
      std::string piece = values.substr(begin, kWidth);
      piece.resize(72, ' ');
      parameters += piece;
    }
    const std::size_t lines = parameters.size() / 72 + 1 - first;
    const std::string blank = Field("");
    directory += Field(heads[0]) + Field(first) + blank + blank + blank + blank + Field(heads[2]) +
                 blank + Field(heads[3]);
    directory +=
        Field(heads[0]) + blank + blank + Field(lines) + Field(heads[1]) + std::string(32, ' ');
  }
  std::string file;
  AppendSection(file, "a file of entities", 'S');
  AppendSection(file, "1H,,1H;,1Hf,1Hf,1Hb,1Hb,32,38,6,308,15,1Hf,1.,2,2HMM,1,1.,;", 'G');
  AppendSection(file, directory, 'D');
  AppendSection(file, parameters, 'P');
  AppendSection(file, "S      1G      1D      1P      1", 'T');
  return file;
}

void FuzzJson(std::string_view bytes) {
  std::vector<Geometry> geometry;
  try {
    geometry = ParseGeometryJson(bytes, "fuzz.json");
  } catch (const ReadError&) {
    return;
  }
  RequireGeometryLaws(geometry);
}

void FuzzIges(std::string_view bytes) {
  std::vector<Geometry> geometry;
  try {
    geometry = ParseIgesContents(std::string(bytes), "fuzz.iges").contents.geometry;
  } catch (const ReadError&) {
    return;
  }
  if (!geometry.empty()) RequireGeometryLaws(geometry);  // else the reader of files refuses
}

void FuzzIgesEntities(std::string_view bytes) { FuzzIges(LaidOutIges(bytes)); }

void FuzzStepSyntax(std::string_view bytes) {
  try {
    CheckStepSyntax(bytes, "fuzz.step");
  } catch (const ReadError&) {
    return;
  }
}

}  // namespace batten::internal
