// SPDX-License-Identifier: MIT
#include "cli/arguments/edit_syntax.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "batten/geometry/flatten.h"
#include "batten/geometry/spline_basis.h"
#include "batten/geometry/warp.h"
#include "batten/io/read_error.h"
#include "cli/terminal/help_format.h"
#include "cli/terminal/nearest_name.h"
#include "cli/terminal/parse_values.h"

namespace batten::internal {
namespace {

constexpr size_t kAnyNumber = 1'000'000;

// What the numbers of a key must be, and what is said where one is not: "… is not positive".
struct Range {
  bool (*holds)(double);
  std::string broken;
};

const Range kAny{[](double) { return true; }, ""};
const Range kNotZero{[](double x) { return x != 0; }, "is zero"};
const Range kPositive{[](double x) { return x > 0; }, "is not positive"};
const Range kNotNegative{[](double x) { return x >= 0; }, "is not 0 or more"};
const Range kIndex{[](double x) { return x >= 0 && x <= 1e9 && x == std::floor(x); },
                   "is not a whole number of 0 or more"};
const Range kTimes{[](double x) { return x >= 1 && x <= kMaxDegree && x == std::floor(x); },
                   fmt::format("is not a whole number from 1 to {}", kMaxDegree)};
const Range kBy{[](double x) { return x >= 1 && x < kMaxDegree && x == std::floor(x); },
                fmt::format("is not a whole number from 1 to {}", kMaxDegree - 1)};

struct Key {
  std::string name;  // "" for values without a key
  size_t least, most;
  Range range;
  enum class Need { kYes, kNo, kDefault } need = Need::kYes;
  double fallback = 0;
};

enum class Dir { kNone, kMeant };

// A key whose value is one of some words, or with none of them a path. Its first word is taken
// where it is not given and optional.
struct WordKey {
  std::string name;
  std::vector<std::string> words;
  bool needed = false;
};

struct Operation {
  std::string name;
  std::vector<Key> keys;
  Dir dir;
  std::string form, help;
  std::vector<WordKey> words = {};
};

const Key kAt{"at", 1, 1, kAny};
const Key kTimesKey{"times", 1, 1, kTimes, Key::Need::kDefault, 1};
const Key kByKey{"by", 1, 1, kBy, Key::Need::kDefault, 1};
const Key kPlane{"plane", 4, 4, kAny};
const Key kLength{"by", 1, 1, kPositive};
const Key kCurveTolerance{"tolerance", 1, 1, kPositive, Key::Need::kNo};
const Key kTolerance{"tolerance", 1, 1, kNotNegative, Key::Need::kNo};

const std::vector<Operation>& Operations() {
  static const std::vector<Operation> operations = {
      {"insert-knot", {kAt, kTimesKey}, Dir::kMeant, "at=0.3,times=1", "a knot; same shape"},
      {"refine",
       {{"at", 1, kAnyNumber, kAny}},
       Dir::kMeant,
       "at=0.1;0.2",
       "knots, as often as each is named; same shape"},
      {"remove-knot",
       {kAt, kTimesKey, kTolerance},
       Dir::kMeant,
       "at=0.3,times=1,tolerance=T",
       "a knot; the shape moves no more than T [1e-10 of its size]"},
      {"elevate", {kByKey}, Dir::kMeant, "by=1", "the degree; same shape"},
      {"reduce",
       {kByKey, kTolerance},
       Dir::kMeant,
       "by=1,tolerance=T",
       "the degree; the shape moves no more than T [1e-10 of its size]; of a Bezier curve by "
       "rule=forward, backward, least-squares or fixed-ends",
       {{"rule", {"best", "forward", "backward", "least-squares", "fixed-ends"}}}},
      {"split", {kAt}, Dir::kMeant, "at=0.5", "into two, NAME-1 and NAME-2"},
      {"decompose", {}, Dir::kMeant, "", "into Bezier pieces, NAME-1, ... [both directions]"},
      {"reverse", {}, Dir::kMeant, "", "run the other way"},
      {"swap", {}, Dir::kNone, "", "exchange u and v of a surface"},
      {"transform",
       {{"matrix", 16, 16, kAny}},
       Dir::kNone,
       "matrix=16 numbers row by row",
       "an affine or perspective map"},
      {"translate", {{"", 2, 3, kAny}}, Dir::kNone, "x,y,z", "move"},
      {"rotate",
       {{"axis", 3, 3, kAny}, {"angle", 1, 1, kAny}},
       Dir::kNone,
       "axis=0,0,1,angle=A",
       "turn about an axis through the origin, A in degrees"},
      {"scale",
       {{"", 1, 3, kNotZero}},
       Dir::kNone,
       "s|x,y,z",
       "by a factor, or one along each axis, about the origin"},
      {"clamp", {}, Dir::kMeant, "", "ends at control points [both directions]"},
      {"unclamp", {}, Dir::kMeant, "", "knots that go on past the ends [both directions]"},
      {"reparameterize",
       {{"to", 2, 2, kAny, Key::Need::kNo}, {"mobius", 4, 4, kAny, Key::Need::kNo}},
       Dir::kMeant,
       "to=a;b",
       "to the domain [a, b]; or mobius=A;B;C;D: u becomes (A u + B) / (C u + D)"},
      {"compose",
       {{"degree", 1, 1, kTimes}, {"knots", 4, kAnyNumber, kAny}, {"values", 2, kAnyNumber, kAny}},
       Dir::kMeant,
       "degree=2,knots=0;0;0;1;1;1,values=0;0.2;1",
       "traced by s, where u is that increasing spline of s; same shape"},
      {"iso", {kAt}, Dir::kMeant, "at=0.5", "the curve of a surface on which u (or v) is fixed"},
      {"set-weight",
       {{"index", 1, 2, kIndex}, {"value", 1, 1, kPositive}},
       Dir::kNone,
       "index=i[;j],value=w",
       "of the control point i (curves) or i,j (surfaces), from 0"},
      {"move-point",
       {{"at", 1, 2, kAny}, {"to", 2, 3, kAny}},
       Dir::kNone,
       "at=u[;v],to=x;y;z",
       "make the shape pass there, with the least change"},
      {"move",
       {{"at", 1, kAnyNumber, kAny},
        {"to", 2, kAnyNumber, kAny},
        {"order", 1, kAnyNumber, kIndex, Key::Need::kNo},
        {"keep", 1, kAnyNumber, kAny, Key::Need::kNo},
        {"fix", 1, kAnyNumber, kIndex, Key::Need::kNo}},
       Dir::kNone,
       "at=u1;u2,to=x1;y1;z1;x2;y2;z2",
       "several points at once, with the least change; order=0;1: derivatives; keep=u3;u4: points "
       "that stay; fix=0;1: control points that do (u;v, k;l, i;j on surfaces)"},
      {"pull",
       {{"at", 1, 2, kAny}, {"index", 1, 2, kIndex}, {"by", 1, 1, kAny}},
       Dir::kNone,
       "at=u[;v],index=i,by=L",
       "the point towards the control point i (two neighbours i;j of a curve: their leg; i;j on "
       "surfaces) by the length L, by weights"},
      {"warp",
       {{"region", 2, 4, kAny},
        {"by", 2, 3, kAny},
        {"spans", 1, 1, kIndex, Key::Need::kDefault, WarpOptions().spans}},
       Dir::kMeant,
       "region=a;b[;c;d],by=x;y;z",
       "the middle of the region of u (and v, or dir) by a vector, the rest less; shape=tent or "
       "plateau; spans=16: as many there",
       {{"shape", {"bump", "tent", "plateau"}}}},
      {"flatten",
       {{"region", 2, 4, kAny},
        {"plane", 4, 4, kAny},
        {"along", 2, 3, kAny, Key::Need::kNo},
        {"transition", 1, 1, kPositive, Key::Need::kDefault, FlattenOptions<3>().transition}},
       Dir::kMeant,
       "region=a;b[;c;d],plane=a;b;c;d",
       "the region of u (and v, or dir) to the plane a x + b y + c z + d = 0, along its normal or "
       "along=x;y;z; beyond it changes over 0.1 of the region"},
      {"bend",
       {{"from", 2, 3, kAny},
        {"center", 2, 3, kAny},
        {"axis", 3, 3, kAny, Key::Need::kNo},
        {"length", 1, 1, kPositive},
        {"tolerance", 1, 1, kPositive, Key::Need::kNo}},
       Dir::kNone,
       "from=x;y;z,center=x;y;z,length=L",
       "about the circle through `from`, right-handed about axis=0;0;1; what is behind turns along "
       "[tolerance=1e-6 of the size]"},
      {"extend",
       {kLength},
       Dir::kMeant,
       "end=upper,by=L,how=calm",
       "past an end or edge by a length, curvature going on; how=natural: the same polynomial",
       {{"end", {"upper", "lower"}, true}, {"how", {"calm", "natural"}}}},
      {"to-bezier",
       {},
       Dir::kNone,
       "",
       "knots of full multiplicity: the control points of all pieces"},
      {"to-bspline",
       {kTolerance},
       Dir::kNone,
       "tolerance=T",
       "without knots that move the shape no more than T [1e-10 of its size]"},
      {"to-power",
       {},
       Dir::kNone,
       "",
       "powers of the parameter, in JSON; the last operation; refused where they lose the shape"},
      {"continue",
       {{"to", 2, 3, kAny},
        {"alpha", 1, 1, kPositive, Key::Need::kDefault, 1},
        {"beta", 1, 1, kPositive, Key::Need::kDefault, 1},
        {"eta", 1, 1, kAny, Key::Need::kDefault, 0},
        {"beta2", 1, 1, kAny, Key::Need::kDefault, 0},
        {"eta2", 1, 1, kAny, Key::Need::kDefault, 0},
        {"weight", 1, 1, kPositive, Key::Need::kDefault, 1}},
       Dir::kMeant,
       "end=upper,to=x;y;z,order=2,beta=1",
       "a second shape that goes on with G1 or G2 to a point (a surface: its far edge shifted by "
       "it); alpha, beta, eta, beta2, eta2, weight: its freedom",
       {{"end", {"upper", "lower"}, true}, {"order", {"2", "1"}}}},
      {"unify",
       {kTolerance},
       Dir::kNone,
       "with=B.json;C.json,tolerance=T",
       "all curves, of other files too, end to end as one cubic; gaps up to T [1e-6 of the size]",
       {{"with", {}}}},
      {"cut",
       {kPlane},
       Dir::kNone,
       "plane=a;b;c;d,keep=both",
       "by the plane a x + b y + c z + d = 0 into NAME-1, ...; keep=above (where it is > 0) or "
       "below",
       {{"keep", {"both", "above", "below"}}}},
      {"trim",
       {kCurveTolerance},
       Dir::kNone,
       "curve=FILE,keep=inside",
       "by a curve: in u,v if plane, else projected [tolerance=1e-8 of the size]; keep=outside",
       {{"curve", {}, true}, {"keep", {"inside", "outside"}}}},
  };
  return operations;
}

const Operation& Find(const std::string& name) {
  std::vector<std::string> names;
  for (const Operation& operation : Operations()) {
    if (operation.name == name) return operation;
    names.push_back(operation.name);
  }
  std::string known;
  for (const std::string& one : names) known += (known.empty() ? "" : ", ") + one;
  throw UsageError("edit: unknown operation '" + name + "'; " +
                   DidYouMean(name, names, "known are " + known));
}

std::string Shown(const std::string& typed) {
  constexpr size_t kMost = 80;
  return typed.size() <= kMost ? typed : typed.substr(0, kMost) + "...";
}

// The text of every key; values without one have the key "".
std::map<std::string, std::string> Texts(const EditOperation& operation,
                                         const Operation& known,
                                         const std::string& text) {
  const bool has_at = !known.keys.empty() && known.keys[0].name == "at";
  std::map<std::string, std::string> texts;
  std::string key;
  for (size_t begin = 0; begin <= text.size();) {
    const size_t end = std::min(text.find(',', begin), text.size());
    const std::string token = text.substr(begin, end - begin);
    const size_t sign = token.find('=');
    if (sign != std::string::npos) {
      key = token.substr(0, sign);
      if (has_at && key == "u") key = "at";
      if (!texts.emplace(key, token.substr(sign + 1)).second) {
        operation.Refuse("'" + key + "' is given twice" +
                         (key == "at" ? " (u is another name of it)" : ""));
      }
    } else if (const auto [place, fresh] = texts.emplace(key, token); !fresh) {
      place->second += ',' + token;
    }
    begin = end + 1;
  }
  return texts;
}

Direction ParseDirection(const EditOperation& operation, const std::string& text) {
  if (text == "u") return Direction::kU;
  if (text == "v") return Direction::kV;
  operation.Refuse("dir = '" + text + "' is neither u nor v");
}

std::vector<double> ParseKey(const EditOperation& operation,
                             const Key& key,
                             const std::string& text) {
  const std::string name = key.name.empty() ? "" : key.name + " = ";
  std::vector<double> numbers;
  try {
    numbers = ParseNumbers(key.name, text);
  } catch (const UsageError&) {
    operation.Refuse(name + "'" + text + "' is not " +
                     (key.most == 1 ? "a finite number" : "a list of finite numbers"));
  }
  if (numbers.size() < key.least || numbers.size() > key.most) {
    const std::string wanted = key.least == key.most ? std::to_string(key.least)
                                                     : fmt::format("{} to {}", key.least, key.most);
    operation.Refuse(fmt::format("{}'{}' holds {} numbers; {} {} needed",
                                 name,
                                 text,
                                 numbers.size(),
                                 wanted,
                                 wanted == "1" ? "is" : "are"));
  }
  for (const double number : numbers) {
    if (!key.range.holds(number)) {
      operation.Refuse(fmt::format("{}{} {}", name, number, key.range.broken));
    }
  }
  return numbers;
}

[[noreturn]] void RefuseKey(const EditOperation& operation,
                            const Operation& known,
                            const std::string& key,
                            const std::string& text) {
  std::vector<std::string> names;
  for (const Key& one : known.keys) {
    if (!one.name.empty()) names.push_back(one.name);
  }
  for (const WordKey& one : known.words) names.push_back(one.name);
  if (known.dir == Dir::kMeant) names.push_back("dir");
  std::string list;
  for (const std::string& name : names) list += (list.empty() ? "" : ", ") + name;
  const std::string takes =
      known.keys.size() == 1 && known.keys[0].name.empty() ? known.form : list;
  const std::string rule =
      takes.empty() ? "it takes no values" : "'" + known.name + "' takes " + takes;
  if (key.empty()) operation.Refuse("'" + text + "' has no key; " + rule);
  operation.Refuse("unknown key '" + key + "'; " + DidYouMean(key, names, rule));
}

// Takes a key whose value is a word; whether it is one.
bool TakesWord(EditOperation& operation,
               const Operation& known,
               const std::string& key,
               const std::string& text) {
  const auto found = std::find_if(
      known.words.begin(), known.words.end(), [&](const WordKey& one) { return one.name == key; });
  if (found == known.words.end()) return false;
  const std::vector<std::string>& words = found->words;
  if (text.empty()) operation.Refuse(key + " is empty");
  if (!words.empty() && std::find(words.begin(), words.end(), text) == words.end()) {
    std::string list;
    for (const std::string& word : words) list += (list.empty() ? "" : ", ") + word;
    operation.Refuse(key + " = '" + text + "' is not among " + list);
  }
  operation.words[key] = text;
  return true;
}

void FillWords(EditOperation& operation, const Operation& known) {
  for (const WordKey& key : known.words) {
    if (operation.words.count(key.name) > 0) continue;
    if (key.needed) {
      operation.Refuse("'" + key.name + "' is missing; the form is " + known.name + ':' +
                       known.form);
    }
    operation.words[key.name] = key.words.empty() ? "" : key.words.front();
  }
}

}  // namespace

void EditOperation::Refuse(const std::string& reason) const {
  throw UsageError("edit " + typed + ": " + reason);
}

EditOperation ParseEditOperation(const std::string& text) {
  const size_t colon = std::min(text.find(':'), text.size());
  EditOperation operation;
  operation.typed = Shown(text);
  operation.name = text.substr(0, colon);
  const Operation& known = Find(operation.name);
  std::map<std::string, std::string> texts;
  if (colon + 1 < text.size()) texts = Texts(operation, known, text.substr(colon + 1));
  for (const auto& [key, value] : texts) {
    if (key == "dir" && known.dir == Dir::kMeant) {
      operation.direction = ParseDirection(operation, value);
      continue;
    }
    if (TakesWord(operation, known, key, value)) continue;
    const auto found = std::find_if(known.keys.begin(),
                                    known.keys.end(),
                                    [&, k = &key](const Key& one) { return one.name == *k; });
    if (found == known.keys.end()) RefuseKey(operation, known, key, value);
    operation.values[key] = ParseKey(operation, *found, value);
  }
  for (const Key& key : known.keys) {
    if (operation.Has(key.name) || key.need == Key::Need::kNo) continue;
    if (key.need == Key::Need::kYes) {
      operation.Refuse((key.name.empty() ? "its numbers are" : "'" + key.name + "' is") +
                       std::string(" missing; the form is ") + known.name + ':' + known.form);
    }
    operation.values[key.name] = {key.fallback};
  }
  FillWords(operation, known);
  return operation;
}

std::vector<std::string> CompleteEditOperation(const std::string& typed) {
  std::vector<std::string> words;
  const size_t colon = typed.find(':');
  if (colon == std::string::npos) {
    for (const Operation& one : Operations())
      words.push_back(one.name + (one.form.empty() && one.dir == Dir::kNone ? "" : ":"));
    return words;
  }
  const auto known = std::find_if(
      Operations().begin(), Operations().end(), [name = typed.substr(0, colon)](const auto& one) {
        return one.name == name;
      });
  if (known == Operations().end()) return words;
  const size_t begin = typed.find_last_of(":,") + 1;
  const std::string before = typed.substr(0, begin), last = typed.substr(begin);
  const auto given = [&](const std::string& key) {
    return before.find(':' + key + '=') != std::string::npos ||
           before.find(',' + key + '=') != std::string::npos;
  };
  const auto offer = [&](const std::string& key, const std::vector<std::string>& values) {
    if (key.empty() || given(key)) return;
    const std::string start = before + key + '=';
    if (last.find('=') == std::string::npos) words.push_back(start);
    for (const std::string& value : values) {
      if (last.rfind(key + '=', 0) == 0) words.push_back(start + value);
    }
  };
  if (known->dir == Dir::kMeant) offer("dir", {"u", "v"});
  for (const Key& key : known->keys) offer(key.name, {});
  for (const WordKey& key : known->words) offer(key.name, key.words);
  return words;
}

std::string EditOperationsHelp() {
  std::string help;
  for (const Operation& one : Operations()) {
    const std::string form = one.name + (one.form.empty() ? "" : ":" + one.form);
    help += HelpLines(form, one.help, 43);
  }
  return help;
}

}  // namespace batten::internal
