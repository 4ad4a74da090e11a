// SPDX-License-Identifier: MIT
// What the columns of a text are called. Not installed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "io/cloud/cloud_columns.h"

namespace batten::internal {

// A first line that is no row of points: names of columns, or a title. Empty: there is none.
struct TextHeader {
  std::string line;
  std::int64_t number = 0;
};

// The names that a header line gives, without quotes; they may hold blanks where it has delimiters.
std::vector<std::string> HeaderNames(std::string_view line);

// Where the name is, in any case; −1: nowhere.
int PlaceOf(const std::vector<std::string>& names, std::string_view sought);

// Where a name of the role is (IsRoleName); −1: nowhere.
int PlaceOfRole(const std::vector<std::string>& names, std::string_view role);

// Whether x and y are among the names, in any case, or what else they are called (IsRoleName).
bool NamesPlace(const std::vector<std::string>& names);

// A comment names the columns where its words are as many as they, or where as many in a row begin
// with x or u and hold x and y; else it is prose, and there are none.
std::vector<std::string> NamesInComment(const std::vector<std::string>& words, std::size_t width);

// The columns of a text whose first row has the fields `row`: by the names of its header, else by
// the words of a comment where they name them, else by its extension (.uvxyz, .xyzl, .xyzi, .xyzn,
// .xyzrgb; .pts with intensity, colours or both), filled up with numbers. A header of another
// number of names that do not say where x and y are is a title. Throws ReadError where there are
// fewer columns than the extension promises or, unless the places are `numbered` by the options,
// where a header that names x y z leaves open which columns they are, having more or fewer names
// than the row has fields.
std::vector<CloudField> TextFields(const std::string& file,
                                   const TextHeader& header,
                                   const std::vector<std::string>& comment,
                                   const std::vector<std::string_view>& row,
                                   bool numbered);

}  // namespace batten::internal
