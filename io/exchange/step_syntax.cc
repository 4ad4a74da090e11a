// SPDX-License-Identifier: MIT
#include "io/exchange/step_syntax.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <system_error>
#include <utility>
#include <vector>

#include "batten/io/read_error.h"

namespace batten::internal {
namespace {

constexpr std::string_view kStart = "ISO-10303-21", kEnd = "END-ISO-10303-21";
constexpr int kDeepest = 64;                       // nested lists
constexpr std::int64_t kLargestName = 2147483647;  // OpenCASCADE counts in int

bool IsDigit(char c) { return c >= '0' && c <= '9'; }
bool IsLetter(char c) { return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z') || c == '_'; }

// One instance: "#name = …;", and where its references start in the list of all.
struct Instance {
  std::int64_t name;
  size_t first_reference, position;
};

struct Reference {
  std::int64_t name;
  size_t position;
};

class Scanner {
 public:
  Scanner(std::string_view text, const std::string& path) : text_(text), path_(path) {}

  void Check() {
    File();
    CheckReferences();
    CheckCycles();
  }

  // What another lexer may mistake: doubled quotes; comments, and blanks that hold a tab.
  struct Trap {
    size_t begin, end;
    bool blank;  // stands for a blank
  };
  const std::vector<Trap>& traps() const { return traps_; }

 private:
  // -- the grammar, one function for each rule [ISO 10303-21, §5 to §8] --

  void File() {
    if (text_.substr(0, 3) == "\xEF\xBB\xBF") at_ = 3;
    if (!Take(kStart)) Fail("is not a STEP file: it does not start with ISO-10303-21");
    // Whoever cuts a file cuts its end: this says more than where the last record breaks off.
    if (text_.rfind(kEnd) == text_.npos) Fail("is truncated: END-ISO-10303-21 is missing");
    Expect(';');
    if (!Take("HEADER")) FailHere("HEADER is missing");
    Expect(';');
    while (!Take("ENDSEC")) HeaderRecord();
    Expect(';');
    while (!Take(kEnd)) DataSection();
    Expect(';');
  }

  void HeaderRecord() {
    Keyword();
    Parameters();
    Expect(';');
  }

  void DataSection() {
    if (!Take("DATA")) FailHere("a DATA section or END-ISO-10303-21 must stand here");
    if (Peek() == '(') Parameters();
    Expect(';');
    while (!Take("ENDSEC")) InstanceRecord();
    Expect(';');
  }

  void InstanceRecord() {
    if (Peek() != '#') FailHere("an instance, as in #1 = …, must stand here");
    const size_t position = at_;
    instances_.push_back({Name(), references_.size(), position});
    Expect('=');
    if (Peek() == '(') {
      ++at_;
      while (Peek() != ')') {
        Keyword();
        Parameters();
      }
      Expect(')');
    } else {
      Keyword();
      Parameters();
    }
    Expect(';');
  }

  void Keyword() {
    Peek();
    if (at_ < text_.size() && text_[at_] == '!') ++at_;
    if (at_ >= text_.size() || !IsLetter(text_[at_])) FailHere("a keyword must stand here");
    while (at_ < text_.size() && (IsLetter(text_[at_]) || IsDigit(text_[at_]))) ++at_;
  }

  void Parameters() {
    if (++depth_ > kDeepest) FailHere("lists are nested deeper than 64 levels");
    Expect('(');
    if (Peek() != ')') {
      Parameter();
      while (Peek() == ',') {
        ++at_;
        Parameter();
      }
    }
    Expect(')');
    --depth_;
  }

  void Parameter() {
    const char c = Peek();
    if (c == '$' || c == '*') {
      ++at_;
    } else if (c == '#') {
      const size_t position = at_;
      references_.push_back({Name(), position});
    } else if (c == '\'') {
      String();
    } else if (c == '"') {
      Binary();
    } else if (c == '.') {
      Enumeration();
    } else if (c == '(') {
      Parameters();
    } else if (IsLetter(c) || c == '!') {
      Keyword();
      Parameters();
    } else if (IsDigit(c) || c == '-' || c == '+') {
      Number();
    } else {
      FailHere("a parameter must stand here");
    }
  }

  std::int64_t Name() {
    std::int64_t name = 0;
    const char* first = text_.data() + at_ + 1;
    const auto [end, error] = std::from_chars(first, text_.data() + text_.size(), name);
    if (error != std::errc() || name < 1 || name > kLargestName) {
      FailHere("'#' must be followed by a number from 1 to 2147483647");
    }
    at_ = static_cast<size_t>(end - text_.data());
    return name;
  }

  void Number() {
    const size_t start = at_;
    at_ = std::min(text_.find_first_not_of("0123456789+-.Ee", at_), text_.size());
    std::string_view token = text_.substr(start, at_ - start);
    if (token.front() == '+') token.remove_prefix(1);
    double value = 0;
    const auto [end, error] = std::from_chars(token.data(), token.data() + token.size(), value);
    // Underflow to zero is harmless, overflow is not; from_chars calls both out of range.
    const size_t exponent = token.find_first_of("eE");
    const bool tiny = error == std::errc::result_out_of_range && exponent != token.npos &&
                      token.substr(exponent + 1, 1) == "-";
    if (end != token.data() + token.size() || (error != std::errc() && !tiny)) {
      at_ = start;
      FailHere("'" + std::string(token.substr(0, 24)) + "' is not a number that fits a double");
    }
    const bool integer = token.find_first_of(".eE") == token.npos;
    if (integer && !(std::abs(value) <= kLargestName)) {
      at_ = start;
      FailHere("the integer " + std::string(token.substr(0, 24)) + " is above 2147483647");
    }
  }

  void String() {
    for (++at_;; at_ += 2) {  // a doubled quote stands for itself
      at_ = text_.find('\'', at_);
      if (at_ == text_.npos) Fail("is damaged: a string does not end");
      if (text_.substr(at_ + 1, 1) != "'") break;
      // OpenCASCADE's lexer takes it for the end unless a letter or digit follows.
      const size_t next = text_.find_first_not_of("\r\n", at_ + 2);
      if (next == text_.npos || !(IsLetter(text_[next]) || IsDigit(text_[next]))) {
        AddTrap({at_, at_ + 2, false});
      }
    }
    ++at_;
  }

  void Binary() {
    at_ = text_.find_first_not_of("0123456789ABCDEFabcdef", at_ + 1);
    if (at_ >= text_.size() || text_[at_] != '"') Fail("is damaged: a binary value does not end");
    ++at_;
  }

  void Enumeration() {
    ++at_;
    while (at_ < text_.size() && (IsLetter(text_[at_]) || IsDigit(text_[at_]))) ++at_;
    if (at_ >= text_.size() || text_[at_] != '.')
      FailHere("an enumeration, as in .T., must stand here");
    ++at_;
  }

  // -- characters --

  // The next character that is neither blank nor in a comment; zero at the end.
  char Peek() {
    for (;;) {
      const size_t blank = at_;
      at_ = std::min(text_.find_first_not_of(" \t\r\n", at_), text_.size());
      // Behind a string it knows spaces and new lines only.
      if (at_ > blank && text_.substr(blank, at_ - blank).find_first_of("\t\r") != text_.npos) {
        AddTrap({blank, at_, true});
      }
      if (text_.substr(at_, 2) != "/*") return at_ < text_.size() ? text_[at_] : '\0';
      const size_t begin = at_;
      at_ = text_.find("*/", at_ + 2);
      if (at_ == text_.npos) Fail("is damaged: a comment does not end");
      at_ += 2;
      AddTrap({begin, at_, true});
    }
  }

  // The same place may be looked at twice.
  void AddTrap(const Trap& trap) {
    if (traps_.empty() || traps_.back().begin < trap.begin) traps_.push_back(trap);
  }

  bool Take(std::string_view word) {
    Peek();
    if (text_.substr(at_, word.size()) != word) return false;
    at_ += word.size();
    return true;
  }

  void Expect(char c) {
    if (Peek() != c) FailHere(std::string("'") + c + "' must stand here");
    ++at_;
  }

  [[noreturn]] void Fail(const std::string& reason) const { throw ReadError(path_, reason); }
  [[noreturn]] void FailHere(const std::string& reason) const { FailAt(at_, reason); }
  [[noreturn]] void FailAt(size_t position, const std::string& reason) const {
    const auto end = text_.begin() + static_cast<std::ptrdiff_t>(std::min(position, text_.size()));
    throw ReadError::AtLine(
        path_, 1 + std::count(text_.begin(), end, '\n'), "is damaged: " + reason);
  }

  // -- the graph of references --

  // Sorts the instances and resolves every reference to the index of its instance.
  void CheckReferences() {
    size_t end = references_.size();
    last_reference_.resize(instances_.size());
    for (size_t i = instances_.size(); i-- > 0;) {
      last_reference_[i] = std::exchange(end, instances_[i].first_reference);
    }
    std::vector<std::pair<std::int64_t, size_t>> order(instances_.size());
    for (size_t i = 0; i < order.size(); ++i) order[i] = {instances_[i].name, i};
    std::sort(order.begin(), order.end());
    for (size_t i = 1; i < order.size(); ++i) {
      if (order[i].first == order[i - 1].first) {
        FailAt(instances_[order[i].second].position,
               "#" + std::to_string(order[i].first) + " is defined twice");
      }
    }
    for (const Reference& reference : references_) {
      const auto found =
          std::lower_bound(order.begin(), order.end(), std::pair(reference.name, size_t{0}));
      if (found == order.end() || found->first != reference.name) {
        FailAt(reference.position, "#" + std::to_string(reference.name) + " is not defined");
      }
      targets_.push_back(found->second);
    }
  }

  // Depth first, without recursion.
  void CheckCycles() const {
    enum Mark : char { kNew, kOpen, kDone };
    std::vector<Mark> marks(instances_.size(), kNew);
    std::vector<std::pair<size_t, size_t>> road;  // instance, its next reference
    for (size_t root = 0; root < instances_.size(); ++root) {
      if (marks[root] != kNew) continue;
      marks[root] = kOpen;
      road.emplace_back(root, instances_[root].first_reference);
      while (!road.empty()) {
        auto& [instance, next] = road.back();
        if (next == last_reference_[instance]) {
          marks[instance] = kDone;
          road.pop_back();
          continue;
        }
        const size_t target = targets_[next++];
        if (marks[target] == kOpen) {
          FailAt(instances_[target].position,
                 "#" + std::to_string(instances_[target].name) + " refers to itself");
        }
        if (marks[target] == kDone) continue;
        marks[target] = kOpen;
        road.emplace_back(target, instances_[target].first_reference);
      }
    }
  }

  std::string_view text_;
  const std::string& path_;
  size_t at_ = 0;
  int depth_ = 0;
  std::vector<Trap> traps_;
  std::vector<Instance> instances_;
  std::vector<size_t> last_reference_;  // of every instance, one past
  std::vector<Reference> references_;
  std::vector<size_t> targets_;  // of every reference: the index of its instance
};

}  // namespace

void CheckStepSyntax(std::string_view text, const std::string& path) {
  Scanner(text, path).Check();
}

void PrepareStepText(std::string& text, const std::string& path) {
  Scanner scanner(text, path);
  scanner.Check();
  if (scanner.traps().empty()) return;
  std::string safe;
  size_t done = 0;
  for (const Scanner::Trap& trap : scanner.traps()) {
    safe.append(text, done, trap.begin - done);
    const std::string_view place(text.data() + trap.begin, trap.end - trap.begin);
    const bool ends_line = place.find('\n') != place.npos;
    safe += !trap.blank ? "\\X\\27" : ends_line ? "\n" : " ";
    done = trap.end;
  }
  safe.append(text, done);
  text = std::move(safe);
}

}  // namespace batten::internal
