// SPDX-License-Identifier: MIT
// The operations of `batten edit` as they are typed: name:key=value,key=value.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <vector>

#include "batten/geometry/direction.h"
#include "batten/io/geometry_types.h"

namespace batten::internal {

// One operation, its name and keys known and its values in their ranges. Whether they suit a shape
// is told when it is applied.
struct EditOperation {
  std::string typed;  // for messages; long ones are cut
  std::string name;
  std::map<std::string, std::vector<double>> values;  // by key; "" for values without one
  std::map<std::string, std::string> words;           // of keys that take a word or a path
  std::optional<Direction> direction;
  GeometryReadOptions others;  // how other files are read: in the unit of what is edited

  bool Has(const std::string& key) const { return values.count(key) > 0; }
  const std::string& Word(const std::string& key) const { return words.at(key); }
  const std::vector<double>& Numbers(const std::string& key) const { return values.at(key); }
  double Number(const std::string& key) const { return values.at(key).front(); }
  int Whole(const std::string& key) const { return static_cast<int>(Number(key)); }

  // Throws UsageError: the operation as typed, and the reason.
  [[noreturn]] void Refuse(const std::string& reason) const;
};

// The operation of a text. Values are numbers, lists of them separated by ',' or ';', or words; `u`
// is another name of `at`, and what has a default is filled in. Throws UsageError naming the
// operation, the value and the rule, and the nearest name for one that is not known.
EditOperation ParseEditOperation(const std::string& text);

// What an operation could go on as where so much of it is typed: its name, a key, a word of a key.
std::vector<std::string> CompleteEditOperation(const std::string& typed);

// Every operation in a line of its own, for help.
std::string EditOperationsHelp();

}  // namespace batten::internal
