// SPDX-License-Identifier: MIT
// What the columns of a file of points mean.
#pragma once

#include <array>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

#include "batten/io/cloud_options.h"

namespace batten::internal {

// One column of a file: a name in a header, or the number of a column of text.
struct CloudField {
  std::string name;
  bool single_precision = false;  // stored as float32
  double colour_scale = 1;        // from a red, green or blue of this type to 0 … 255
  // A value above the limit shows that all colours of the file count to a higher end.
  double colour_limit = std::numeric_limits<double>::infinity();
  double wide_colour_scale = 1;  // to 0 … 255 then
  bool wide_if_whole = false;    // and so does a file whose colours are all whole numbers
  bool packed_in_float = false;  // a packed colour comes as the float32 with its bits
};

// Which conventions say what an unnamed or named column means.
enum class FieldNaming {
  kText,        // x y z are the first three columns unless named; u v w are taken by their names
  kProperties,  // x y z must be named; u v w are taken only when asked for
};

// The columns of a file that are needed, by role. Indices count `fields`; −1: not there.
struct CloudColumns {
  std::vector<int> fields;  // needed columns of the file (0-based), increasing
  std::array<int, 3> point{-1, -1, -1};
  bool degrees = false;  // x and y are named longitude and latitude
  std::array<int, 3> normal{-1, -1, -1};
  std::array<int, 2> parameter{-1, -1};
  int weight = -1;
  std::array<int, 3> colour{-1, -1, -1};
  int packed_colour = -1;  // 0xRRGGBB
  bool packed_in_float = false;
  double colour_scale = 1;
  double colour_limit = std::numeric_limits<double>::infinity();
  double wide_colour_scale = 1;
  bool wide_if_whole = false;
  struct Match {
    int column;
    std::vector<double> values;  // any of them
  };
  std::vector<Match> where;  // all of them

  int dimension() const { return point[2] < 0 ? 2 : 3; }
};

// Whether files hold the role (x y z …) under that name, in any case: easting is x, latitude y.
bool IsRoleName(std::string_view role, std::string_view name);

// Resolves names and options for one file. Throws UsageError naming the columns there are where the
// options ask for another, ReadError where the file has no x and y, or, of a text, names only some
// of x y z, and elsewhere than in the first columns.
CloudColumns ChooseColumns(const std::string& file,
                           const std::vector<CloudField>& fields,
                           FieldNaming naming,
                           const CloudReadOptions& options);

}  // namespace batten::internal
