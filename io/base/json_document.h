// SPDX-License-Identifier: MIT
// JSON text as a compact tree, for files that are mostly numbers. Not installed.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace batten::internal {

// One value. Lists of numbers are kept as plain doubles, and lists of equally long lists of numbers
// as one table, so that a document takes less memory than its text.
struct JsonValue {
  enum class Kind { kNull, kBoolean, kNumber, kText, kNumbers, kTable, kList, kObject };

  Kind kind = Kind::kNull;
  bool boolean = false;
  double number = 0;
  std::int64_t columns = 0;  // of a table, which holds `numbers` row by row
  std::int64_t rows = 0;     // of a table
  std::string text;
  std::vector<double> numbers;     // kNumbers (the empty list included) and kTable
  std::vector<std::string> names;  // kObject: of its items, in the text's order
  std::vector<JsonValue> items;    // kObject, and kList: texts, booleans, objects and mixed lists

  // The member of that name; none when it is absent or this is not an object.
  const JsonValue* Find(std::string_view name) const;
};

// "a list of numbers", …: for messages.
const char* Name(JsonValue::Kind kind);

// Parses the whole text. Members whose names are not in `known` are skipped and take no memory.
// Throws ReadError, naming `path` with the line of a mistake in the syntax or else the place as in
// `shape.data[0].degree`: a number out of the range of double, a null among numbers, rows of
// different lengths, a name given twice, more than 64 levels, more than a million list items.
JsonValue ParseJson(std::string_view text,
                    const std::vector<std::string_view>& known,
                    const std::string& path);

}  // namespace batten::internal
