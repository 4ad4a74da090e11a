// SPDX-License-Identifier: MIT
#include "io/base/json_document.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <nlohmann/json.hpp>
#include <utility>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

using Kind = JsonValue::Kind;

constexpr size_t kDeepest = 64;
constexpr std::int64_t kMostItems = 1'000'000;

// Receives the parser's events and builds the tree. Exceptions pass through the parser.
class TreeBuilder : public nlohmann::json_sax<nlohmann::json> {
 public:
  TreeBuilder(std::string_view text,
              const std::vector<std::string_view>& known,
              const std::string& path)
      : text_(text), known_(known), path_(path) {}

  JsonValue TakeRoot() { return std::move(root_); }

  bool null() override { return Add({}); }
  bool boolean(bool value) override {
    JsonValue added;
    added.kind = Kind::kBoolean;
    added.boolean = value;
    return Add(std::move(added));
  }
  bool number_integer(number_integer_t value) override {
    return Number(static_cast<double>(value));
  }
  bool number_unsigned(number_unsigned_t value) override {
    return Number(static_cast<double>(value));
  }
  bool number_float(number_float_t value, const string_t&) override { return Number(value); }
  bool string(string_t& value) override {
    JsonValue added;
    added.kind = Kind::kText;
    if (!skipping()) added.text = std::move(value);
    return Add(std::move(added));
  }
  bool binary(binary_t&) override { return false; }  // JSON text has none

  bool start_object(size_t) override { return Open(Kind::kObject); }
  bool end_object() override { return Close(); }
  bool start_array(size_t) override { return Open(Kind::kNumbers); }
  bool end_array() override { return Close(); }

  bool key(string_t& name) override {
    if (skipping()) return true;
    JsonValue& object = open_.back();
    skip_next_ = std::find(known_.begin(), known_.end(), name) == known_.end();
    if (skip_next_) return true;
    if (object.Find(name)) Fail(Place() + ": the name \"" + name + "\" is given twice");
    object.names.push_back(std::move(name));
    object.items.emplace_back();
    return true;
  }

  bool parse_error(size_t position,
                   const std::string& token,
                   const nlohmann::detail::exception& error) override {
    const size_t end = std::min(position, text_.size());
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<long>(end), '\n');
    const std::string place = open_.empty() ? "" : " (in " + Place() + ")";
    if (dynamic_cast<const nlohmann::detail::out_of_range*>(&error)) {
      throw ReadError::AtLine(path_, line, token + " is out of the range of a double" + place);
    }
    if (position >= text_.size()) {
      throw ReadError::AtLine(path_, line, "the text ends too early" + place);
    }
    const std::string word = NotANumber(end);
    throw ReadError::AtLine(path_,
                            line,
                            (word.empty() ? "not JSON at '" + Printable(token) + "'"
                                          : word + " is not a finite number") +
                                place);
  }

 private:
  // Inside a member that nobody asked for.
  bool skipping() const { return skipped_levels_ > 0; }

  [[noreturn]] void Fail(const std::string& reason) const { throw ReadError(path_, reason); }

  // NaN or Infinity, which some programs write though JSON has no word for them, where the parser
  // stopped inside it; else empty.
  std::string NotANumber(size_t stop) const {
    constexpr std::string_view kLetters = "-NaInfity";
    size_t begin = stop;
    while (begin > 0 && kLetters.find(text_[begin - 1]) != std::string_view::npos) --begin;
    const size_t end = std::min(text_.find_first_not_of(kLetters, begin), text_.size());
    const std::string_view word = text_.substr(begin, end - begin);
    const bool is_one =
        word == "NaN" || word == "-NaN" || word == "Infinity" || word == "-Infinity";
    return std::string(is_one ? word : "");
  }

  // The end of what the parser had read, safe for a terminal.
  static std::string Printable(const std::string& token) {
    std::string result;
    for (const char c : token.substr(token.size() > 24 ? token.size() - 24 : 0)) {
      result += c >= 32 && c < 127 ? c : '?';
    }
    return result;
  }

  // Where the open values stand, as in `shape.data[0].points[7]`.
  std::string Place() const {
    std::string place;
    for (const JsonValue& value : open_) {
      if (value.kind == Kind::kObject) {
        if (!value.names.empty()) place += (place.empty() ? "" : ".") + value.names.back();
      } else {
        place += '[' + std::to_string(Count(value)) + ']';
      }
    }
    return place.empty() ? "the document" : place;
  }

  static std::int64_t Count(const JsonValue& list) {
    if (list.kind == Kind::kTable) return list.rows;
    if (list.kind == Kind::kNumbers) return static_cast<std::int64_t>(list.numbers.size());
    return static_cast<std::int64_t>(list.items.size());
  }

  bool Open(Kind kind) {
    if (skipping() || skip_next_) {
      skip_next_ = false;
      if (++skipped_levels_ + open_.size() > kDeepest) TooDeep();
      return true;
    }
    if (open_.size() >= kDeepest) TooDeep();
    open_.emplace_back().kind = kind;
    return true;
  }

  [[noreturn]] void TooDeep() const {
    Fail("lists and objects are nested deeper than " + std::to_string(kDeepest) + " levels");
  }

  bool Close() {
    if (skipping()) {
      --skipped_levels_;
      return true;
    }
    JsonValue done = std::move(open_.back());
    open_.pop_back();
    return Add(std::move(done));
  }

  bool Number(double value) {
    if (!skipping() && !skip_next_ && !open_.empty() && open_.back().kind == Kind::kNumbers) {
      open_.back().numbers.push_back(value);
      return true;
    }
    JsonValue added;
    added.kind = Kind::kNumber;
    added.number = value;
    return Add(std::move(added));
  }

  // Puts a finished value where it belongs: the root, a member, or a list.
  bool Add(JsonValue value) {
    if (skipping()) return true;
    if (skip_next_) {
      skip_next_ = false;
    } else if (open_.empty()) {
      root_ = std::move(value);
    } else if (open_.back().kind == Kind::kObject) {
      open_.back().items.back() = std::move(value);
    } else {
      AddToList(open_.back(), std::move(value));
    }
    return true;
  }

  void AddToList(JsonValue& list, JsonValue value) {
    const bool fresh = list.kind == Kind::kNumbers && list.numbers.empty();
    if (value.kind == Kind::kNumbers && (fresh || list.kind == Kind::kTable)) {
      return AddRow(list, value);
    }
    if (!fresh && list.kind != Kind::kList) {
      Fail(Place() + ": " + Name(value.kind) + " among " +
           (list.kind == Kind::kTable ? "lists of numbers" : "numbers"));
    }
    if (++items_ > kMostItems) {
      Fail("more than " + std::to_string(kMostItems) + " values in lists of other than numbers");
    }
    list.kind = Kind::kList;
    list.items.push_back(std::move(value));
  }

  void AddRow(JsonValue& table, const JsonValue& row) {
    const auto columns = static_cast<std::int64_t>(row.numbers.size());
    if (table.kind == Kind::kTable && columns != table.columns) {
      Fail(Place() + ": " + std::to_string(columns) + " numbers, but " +
           std::to_string(table.columns) + " in the rows before");
    }
    table.kind = Kind::kTable;
    table.columns = columns;
    ++table.rows;
    table.numbers.insert(table.numbers.end(), row.numbers.begin(), row.numbers.end());
  }

  std::string_view text_;
  const std::vector<std::string_view>& known_;
  const std::string& path_;
  JsonValue root_;
  std::vector<JsonValue> open_;  // the lists and objects not yet closed, outermost first
  bool skip_next_ = false;       // the value that follows belongs to an unknown name
  size_t skipped_levels_ = 0;
  std::int64_t items_ = 0;
};

}  // namespace

const JsonValue* JsonValue::Find(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? nullptr : &items[static_cast<size_t>(found - names.begin())];
}

const char* Name(JsonValue::Kind kind) {
  switch (kind) {
    case Kind::kNull:
      return "null";
    case Kind::kBoolean:
      return "true or false";
    case Kind::kNumber:
      return "a number";
    case Kind::kText:
      return "a text";
    case Kind::kNumbers:
      return "a list of numbers";
    case Kind::kTable:
      return "a list of lists of numbers";
    case Kind::kList:
      return "a list";
    case Kind::kObject:
      return "an object";
  }
  return "";
}

JsonValue ParseJson(std::string_view text,
                    const std::vector<std::string_view>& known,
                    const std::string& path) {
  if (text.find_first_not_of(" \t\r\n") == std::string_view::npos) {
    throw ReadError(path, "is empty");
  }
  TreeBuilder builder(text, known, path);
  nlohmann::json::sax_parse(text.begin(), text.end(), &builder);
  return builder.TakeRoot();
}

}  // namespace batten::internal
