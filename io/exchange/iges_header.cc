// SPDX-License-Identifier: MIT
#include "io/exchange/iges_header.h"

#include <algorithm>
#include <cctype>
#include <cstddef>

#include "batten/io/length_unit.h"
#include "geometry/numeric/number_text.h"
#include "io/exchange/geometry_names.h"
#include "io/exchange/iges_shapes.h"
#include "io/exchange/iges_types.h"

namespace batten::internal {
namespace {

// How many parameters an entity has by its type; all of them where that is not known.
size_t OwnParameters(const IgesEntity& entity) {
  const std::vector<double>& p = entity.parameters;
  const auto count = [&](size_t index) {
    const double value = index < p.size() ? p[index] : 0;
    return value >= 0 && value <= static_cast<double>(p.size()) ? static_cast<size_t>(value)
                                                                : p.size();
  };
  switch (entity.type) {
    case kIgesComposite:
      return 1 + count(0);
    case kIgesLine:
      return 6;
    case kIgesArc:
      return 7;
    case kIgesConic:
      return 11;
    case kIgesCurve:
      return 6 + (count(0) + count(1) + 2) + 4 * (count(0) + 1) + 5;
    case kIgesRuled:
    case kIgesRevolution:
    case kIgesTabulated:
      return 4;
    case kIgesSurface:
      return 9 + (count(0) + count(2) + 2) + (count(1) + count(3) + 2) +
             4 * (count(0) + 1) * (count(1) + 1) + 4;
    case kIgesCurveOnSurface:
      return 5;
    case kIgesTrimmedSurface:
      return 4 + count(2);
    case kIgesBounded:
      return 3 + count(2);
    default:
      return p.size();
  }
}

}  // namespace

void ReadIgesUnit(const IgesGlobal& global, GeometryContents& contents) {
  constexpr int kByName = 3;
  std::string name = global.unit_name;
  std::transform(name.begin(), name.end(), name.begin(), [](unsigned char c) {
    return static_cast<char>(std::toupper(c));
  });
  if (name == "INCH") name = "IN";
  std::string by_flag, by_name;
  for (const LengthUnit& unit : LengthUnits()) {
    if (unit.iges_flag == global.unit_flag && by_flag.empty()) by_flag = unit.name;
    if (name == unit.iges && by_name.empty()) by_name = unit.name;
  }
  contents.unit = global.unit_flag == kByName ? by_name : by_flag;
  auto& remarks = contents.remarks;
  if (contents.unit.empty()) {
    contents.unit = "inch";
    remarks.push_back("it declares no unit of length that is known: inches, which IGES means then");
  } else if (!by_flag.empty() && !by_name.empty() && by_flag != by_name) {
    remarks.push_back("its unit is " + by_flag + " by its flag and " + by_name +
                      " by its name: the flag counts");
  }
  if (global.scale > 0 && global.scale != 1) {
    remarks.push_back("its model space is scaled by " + NumberText(global.scale) +
                      ": coordinates are those of the model");
  }
}

std::string NameOfIges(const std::vector<IgesEntity>& entities, const IgesEntity& entity) {
  constexpr int kProperty = 406, kName = 15;
  const std::vector<double>& parameters = entity.parameters;
  size_t next = OwnParameters(entity);
  // Pointers to associativities, then to properties; each list begins with its length.
  for (int list = 0; list < 2 && next < parameters.size(); ++list) {
    const double count = parameters[next++];
    if (!(count >= 0 && count <= static_cast<double>(parameters.size() - next))) break;
    const size_t end = next + static_cast<size_t>(count);
    for (; next < end; ++next) {
      const int index = IgesIndex(parameters[next]);
      if (index < 0 || index >= static_cast<int>(entities.size())) continue;
      const IgesEntity& property = entities[static_cast<size_t>(index)];
      if (property.type != kProperty || property.form != kName) continue;
      if (std::string name = CleanName(property.text); !name.empty()) return name;
    }
  }
  if (std::string label = CleanName(entity.label); !label.empty()) return label;
  if (entity.type != kIgesTrimmedSurface || parameters.empty()) return "";
  const int base = IgesIndex(parameters[0]);
  if (base < 0 || base >= static_cast<int>(entities.size())) return "";
  const IgesEntity& surface = entities[static_cast<size_t>(base)];
  return surface.type == kIgesSurface ? NameOfIges(entities, surface) : "";
}

}  // namespace batten::internal
