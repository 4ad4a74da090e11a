// SPDX-License-Identifier: MIT
#include "io/cloud/cloud_columns.h"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <span>
#include <string_view>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

// A role and the lower-case names under which files hold it.
struct Role {
  std::string_view role;
  std::array<std::string_view, 6> names;
};
constexpr std::size_t kFirstDegrees = 2;  // of the names of x and y
constexpr std::array kRoles{
    Role{"x", {"x", "easting", "longitude", "lon", "long", "lng"}},
    Role{"y", {"y", "northing", "latitude", "lat"}},
    Role{"z", {"z", "elevation", "height", "altitude", "alt"}},
    Role{"nx", {"nx", "normal_x", "normalx"}},
    Role{"ny", {"ny", "normal_y", "normaly"}},
    Role{"nz", {"nz", "normal_z", "normalz"}},
    Role{"u", {"u"}},
    Role{"v", {"v"}},
    Role{"w", {"w", "weight"}},
    Role{"red", {"red", "r", "diffuse_red"}},
    Role{"green", {"green", "g", "diffuse_green"}},
    Role{"blue", {"blue", "b", "diffuse_blue"}},
    Role{"rgb", {"rgb", "rgba"}},
};
constexpr std::array<std::string_view, 12> kColumnRoles{
    "x", "y", "z", "u", "v", "nx", "ny", "nz", "w", "red", "green", "blue"};

bool EqualIgnoringCase(std::string_view a, std::string_view b) {
  return std::equal(a.begin(), a.end(), b.begin(), b.end(), [](unsigned char s, unsigned char t) {
    return std::tolower(s) == std::tolower(t);
  });
}

std::string ListOf(const std::vector<CloudField>& fields) {
  constexpr std::size_t kShown = 20;
  std::string list;
  for (std::size_t k = 0; k < std::min(kShown, fields.size()); ++k) {
    list += (k > 0 ? ", " : "") + fields[k].name.substr(0, 40);
  }
  return fields.size() > kShown ? list + ", …" : list;
}

const Role& RoleOf(std::string_view role) {
  return *std::find_if(kRoles.begin(), kRoles.end(), [&](const Role& r) { return r.role == role; });
}

// Whether the name is one of the role's from `first` on.
bool IsNameOf(std::string_view role, std::string_view name, std::size_t first) {
  const auto& names = RoleOf(role).names;
  return !name.empty() &&
         std::any_of(names.begin() + static_cast<std::ptrdiff_t>(first),
                     names.end(),
                     [&](std::string_view known) { return EqualIgnoringCase(known, name); });
}

class ColumnChooser {
 public:
  ColumnChooser(const std::string& file,
                const std::vector<CloudField>& fields,
                FieldNaming naming,
                const CloudReadOptions& options)
      : file_(file), fields_(fields), naming_(naming), options_(options) {}

  CloudColumns Choose() {
    CheckRoles();
    CloudColumns chosen;
    chosen.point = Points();
    chosen.degrees = IsNameOf("x", fields_[chosen.point[0]].name, kFirstDegrees) &&
                     IsNameOf("y", fields_[chosen.point[1]].name, kFirstDegrees);
    chosen.normal = Triple({"nx", "ny", "nz"});
    for (const int column : chosen.normal) {
      if (column < 0 && (Asked("nx") || Asked("ny") || Asked("nz"))) {
        throw UsageError(file_ + ": normals need all of nx, ny and nz; columns are " +
                         ListOf(fields_));
      }
    }
    const bool by_name = naming_ == FieldNaming::kText;
    const bool parameters = by_name || options_.parameters;
    chosen.parameter = {Asked("u") || parameters ? Find("u") : -1,
                        Asked("v") || parameters ? Find("v") : -1};
    if (chosen.parameter[0] < 0) {
      if (Asked("v")) throw UsageError(file_ + ": the column v needs a column u beside it");
      chosen.parameter[1] = -1;
    }
    chosen.weight = Asked("w") || by_name ? Find("w") : -1;
    ChooseColours(chosen);
    for (const RowFilter& filter : options_.where) {
      const int column = Column(filter.column);
      chosen.where.push_back(
          {column,
           {fields_[column].single_precision ? static_cast<double>(static_cast<float>(filter.value))
                                             : filter.value}});
    }
    if (!options_.las_classes.empty()) {
      chosen.where.push_back(
          {Column("classification"), {options_.las_classes.begin(), options_.las_classes.end()}});
    }
    Compress(chosen);
    return chosen;
  }

 private:
  bool Asked(std::string_view role) const { return options_.columns.contains(std::string(role)); }

  void CheckRoles() const {
    for (const auto& [role, column] : options_.columns) {
      if (std::find(kColumnRoles.begin(), kColumnRoles.end(), role) == kColumnRoles.end()) {
        throw UsageError("columns: unknown role '" + role +
                         "'; known are x y z u v nx ny nz w red green blue");
      }
    }
  }

  // The column with the name, else with the 1-based number.
  int Column(const std::string& text) const {
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      if (fields_[k].name == text) return static_cast<int>(k);
    }
    for (std::size_t k = 0; k < fields_.size(); ++k) {
      if (EqualIgnoringCase(fields_[k].name, text)) return static_cast<int>(k);
    }
    int number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error == std::errc() && end == text.data() + text.size() && number >= 1 &&
        number <= static_cast<int>(fields_.size())) {
      return number - 1;
    }
    throw UsageError(file_ + ": no column '" + text + "'; columns are " + ListOf(fields_));
  }

  // The column asked for, else the first that has one of the role's names, else −1.
  int Find(std::string_view role) const {
    if (const auto asked = options_.columns.find(std::string(role));
        asked != options_.columns.end()) {
      return Column(asked->second);
    }
    for (const std::string_view name : RoleOf(role).names) {
      if (name.empty()) continue;
      for (std::size_t k = 0; k < fields_.size(); ++k) {
        if (EqualIgnoringCase(fields_[k].name, name)) return static_cast<int>(k);
      }
    }
    return -1;
  }

  // All three, or none.
  std::array<int, 3> Triple(const std::array<std::string_view, 3>& roles) const {
    const std::array<int, 3> found{Find(roles[0]), Find(roles[1]), Find(roles[2])};
    if (std::find(found.begin(), found.end(), -1) != found.end()) return {-1, -1, -1};
    return found;
  }

  std::array<int, 3> Points() const {
    const std::array<int, 3> found{Find("x"), Find("y"), Find("z")};
    if (found[0] >= 0 && found[1] >= 0) return found;
    if (Asked("x") || Asked("y") || Asked("z")) {
      throw UsageError(file_ + ": columns must give both x and y; columns are " + ListOf(fields_));
    }
    if (naming_ == FieldNaming::kProperties) {
      throw ReadError(file_, "has no x and y; its fields are " + ListOf(fields_));
    }
    const int count = static_cast<int>(fields_.size());
    if (count < 2) throw ReadError(file_, "has one column, where x y z or x y are needed");
    RequirePlacesOf(found);
    return {0, 1, count > 2 ? 2 : -1};
  }

  // Where not both x and y are named, the first columns are meant. Names that contradict that are
  // not to be passed over.
  void RequirePlacesOf(const std::array<int, 3>& found) const {
    constexpr std::array kAxes{"x", "y", "z"};
    std::string named, missing;
    bool elsewhere = false;
    for (int k = 0; k < 3; ++k) {
      std::string& list = found[k] >= 0 ? named : missing;
      if (found[k] >= 0 || k < 2) list += (list.empty() ? "" : " and ") + std::string(kAxes[k]);
      elsewhere = elsewhere || (found[k] >= 0 && found[k] != k);
    }
    if (!elsewhere) return;
    throw ReadError(file_,
                    "its columns name " + named + " but not " + missing +
                        "; say which to take, as in --columns x=1,y=2,z=3; columns are " +
                        ListOf(fields_));
  }

  void ChooseColours(CloudColumns& chosen) const {
    chosen.colour = Triple({"red", "green", "blue"});
    if (chosen.colour[0] >= 0) {
      const CloudField& red = fields_[chosen.colour[0]];
      chosen.colour_scale = red.colour_scale;
      chosen.colour_limit = red.colour_limit;
      chosen.wide_colour_scale = red.wide_colour_scale;
      chosen.wide_if_whole = red.wide_if_whole;
    } else if (Asked("red") || Asked("green") || Asked("blue")) {
      throw UsageError(file_ + ": colours need all of red, green and blue; columns are " +
                       ListOf(fields_));
    } else if (naming_ == FieldNaming::kProperties) {
      chosen.packed_colour = Find("rgb");
      chosen.packed_in_float =
          chosen.packed_colour >= 0 && fields_[chosen.packed_colour].packed_in_float;
    }
  }

  // From columns of the file to indices into the sorted list of those that are needed.
  void Compress(CloudColumns& chosen) const {
    std::vector<int*> used;
    for (const std::span<int> group : {std::span<int>(chosen.point),
                                       std::span<int>(chosen.normal),
                                       std::span<int>(chosen.parameter),
                                       std::span<int>(chosen.colour),
                                       std::span<int>(&chosen.weight, 1),
                                       std::span<int>(&chosen.packed_colour, 1)}) {
      for (int& column : group) used.push_back(&column);
    }
    for (CloudColumns::Match& match : chosen.where) used.push_back(&match.column);
    std::erase_if(used, [](const int* column) { return *column < 0; });
    for (const int* column : used) chosen.fields.push_back(*column);
    std::sort(chosen.fields.begin(), chosen.fields.end());
    chosen.fields.erase(std::unique(chosen.fields.begin(), chosen.fields.end()),
                        chosen.fields.end());
    for (int* column : used) {
      *column =
          static_cast<int>(std::lower_bound(chosen.fields.begin(), chosen.fields.end(), *column) -
                           chosen.fields.begin());
    }
  }

  const std::string& file_;
  const std::vector<CloudField>& fields_;
  FieldNaming naming_;
  const CloudReadOptions& options_;
};

}  // namespace

bool IsRoleName(std::string_view role, std::string_view name) { return IsNameOf(role, name, 0); }

CloudColumns ChooseColumns(const std::string& file,
                           const std::vector<CloudField>& fields,
                           FieldNaming naming,
                           const CloudReadOptions& options) {
  return ColumnChooser(file, fields, naming, options).Choose();
}

}  // namespace batten::internal
