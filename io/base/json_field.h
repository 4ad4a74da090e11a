// SPDX-License-Identifier: MIT
// A value of a JSON document with its place in it. Not installed.
#pragma once

#include <charconv>
#include <cmath>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"
#include "io/base/json_document.h"

namespace batten::internal {

// A value with its place in the document, which every message names.
class JsonField {
 public:
  JsonField(const JsonValue& value, std::string place, const std::string& path)
      : value_(&value), place_(std::move(place)), path_(&path) {}

  [[noreturn]] void Fail(const std::string& reason) const {
    throw ReadError(*path_, place_ + ": " + reason);
  }

  const JsonValue& value() const { return *value_; }
  bool Has(std::string_view name) const { return value_->Find(name) != nullptr; }

  JsonField Member(std::string_view name) const {
    Expect(JsonValue::Kind::kObject);
    const std::string place = place_.empty() ? std::string(name) : place_ + '.' + std::string(name);
    const JsonValue* member = value_->Find(name);
    if (!member) throw ReadError(*path_, place + ": is missing");
    return JsonField(*member, place, *path_);
  }

  JsonField Item(size_t index) const {
    return JsonField(value_->items[index], place_ + '[' + std::to_string(index) + ']', *path_);
  }

  void Expect(JsonValue::Kind kind) const {
    if (value_->kind == kind) return;
    const std::string what = Name(value_->kind) + std::string(" instead of ") + Name(kind);
    if (place_.empty()) throw ReadError(*path_, what);
    Fail(what);
  }

  int Integer(int low, int high) const {
    Expect(JsonValue::Kind::kNumber);
    const double number = value_->number;
    if (!(number >= low && number <= high) || number != std::floor(number)) {
      Fail(Text(number) + " is not an integer from " + std::to_string(low) + " to " +
           std::to_string(high));
    }
    return static_cast<int>(number);
  }

  const std::vector<double>& Numbers() const {
    Expect(JsonValue::Kind::kNumbers);
    return value_->numbers;
  }

  static std::string Text(double number) {
    char text[40];
    return std::string(text, std::to_chars(text, text + sizeof text, number).ptr);
  }

 private:
  const JsonValue* value_;
  std::string place_;
  const std::string* path_;
};

}  // namespace batten::internal
