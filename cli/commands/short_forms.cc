// SPDX-License-Identifier: MIT
#include "cli/commands/short_forms.h"

#include <algorithm>
#include <filesystem>
#include <initializer_list>
#include <optional>
#include <system_error>
#include <utility>

#include "batten/io/file_format.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
#include "cli/commands/file_kind.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/shell_words.h"

namespace batten::internal {
namespace {

using Words = std::vector<std::string>;

bool IsThere(const std::string& path) {
  std::error_code unknown;  // what can't be looked at is not there
  return std::filesystem::exists(std::filesystem::symlink_status(path, unknown));
}

// No command holds a dot or a slash, however mistyped.
bool NamesFile(const std::string& word) {
  if (word == "-") return true;  // standard input
  return !word.empty() && word[0] != '-' &&
         (word.find_first_of("./") != std::string::npos || IsThere(word));
}

bool HasCommand(const CLI::App& app, const std::string& name) {
  return !app.get_subcommands([&](const CLI::App* sub) { return sub->get_name() == name; }).empty();
}

bool StandsForCommand(const CLI::App& app, const Words& words, size_t place) {
  return place < words.size() && !HasCommand(app, words[place]) && NamesFile(words[place]);
}

// Whether the flag is among the words, its value apart or after '='.
bool Given(const Words& words, const std::string& flag) {
  return std::any_of(words.begin(), words.end(), [&](const std::string& word) {
    return word == flag || word.rfind(flag + "=", 0) == 0;
  });
}

// The flag's values, apart or after '='.
Words ValuesOf(const Words& words, const std::string& flag) {
  Words values;
  for (size_t k = 0; k < words.size(); ++k) {
    if (words[k] == flag && k + 1 < words.size()) values.push_back(words[++k]);
    if (words[k].rfind(flag + "=", 0) == 0) values.push_back(words[k].substr(flag.size() + 1));
  }
  return values;
}

// How the file is to be read, as the flags of its command will say.
CloudArguments ReadingOf(const Words& words) {
  const auto last = [&](const char* flag) {
    const Words values = ValuesOf(words, flag);
    return values.empty() ? std::string() : values.back();
  };
  CloudArguments reading;
  reading.columns = last("--columns");
  reading.box = last("--box");
  reading.where = ValuesOf(words, "--where");
  reading.las_class = last("--las-class");
  reading.projection = last("--projection");
  reading.format = last("--format");
  return reading;
}

bool HoldsGeometry(const Words& words, size_t place) {
  return IsGeometryFormat(InputFormat(words[place], ReadingOf(words).format));
}

bool GivesOutput(const Words& words) {
  return Given(words, "--output") ||
         std::any_of(words.begin(), words.end(), [](const std::string& word) {
           return word.rfind("-o", 0) == 0;  // -o OUT, -oOUT, -o=OUT
         });
}

// The words of a fit and the outputs that are not named.
Words WithOutputs(Words words, const std::string& cloud) {
  if (cloud == "-")
    throw UsageError("standard input has no name that the result could have: name it by -o OUT");
  std::string name = std::filesystem::path(cloud).stem().string();
  if (name.rfind('-', 0) == 0) name = "./" + name;  // no flag
  Words outputs = {name + ".step"};
  words.insert(words.end(), {"-o", outputs[0]});
  if (!Given(words, "--report")) {
    for (const char* const ending : {".report.html", ".report.json"}) {
      outputs.push_back(name + ending);
      words.insert(words.end(), {"--report", outputs.back()});
    }
  }
  const auto taken = std::find_if(outputs.begin(), outputs.end(), IsThere);
  if (taken == outputs.end()) return words;
  std::string line = "batten";
  for (const std::string& word : words) line += " " + ShellWord(word);
  throw UsageError(*taken + " is there already; this writes over it: " + line);
}

// The kind that --as asks for of a file that stands for its command; --as is then taken out. Of
// commands it is a flag of their own.
std::optional<FileUse> TakeUse(const CLI::App& app, Words& words) {
  Words rest;
  std::optional<std::string> word;
  for (size_t k = 0; k < words.size(); ++k) {
    if (words[k] == "--as") {
      word = k + 1 < words.size() ? words[++k] : "";
    } else if (words[k].rfind("--as=", 0) == 0) {
      word = words[k].substr(5);
    } else {
      rest.push_back(words[k]);
    }
  }
  const bool of_fit = !rest.empty() && rest[0] == "fit";
  const CLI::App& parent = of_fit ? *app.get_subcommand("fit") : app;
  if (!word || !StandsForCommand(parent, rest, of_fit ? 1 : 0)) return std::nullopt;
  words = std::move(rest);
  return UseNamed(*word);
}

// What the file was taken for, why, and what makes something else of it.
std::string Told(const std::string& path, const FileKind& kind) {
  if (kind.why.empty()) return "";
  std::string told = (path == "-" ? "standard input" : path) + ": " + kind.why + ": 'batten";
  for (const std::string& word : CommandOf(kind.use)) told += " " + word;
  told += "'";
  if (!kind.pick.empty()) told += ", " + kind.pick;
  for (const FileUse use : kind.others)
    told += (use == kind.others.front() ? "; --as " : "|") + std::string(NameOf(use));
  return told + (kind.others.empty() ? "" : " for another kind");
}

// Of words with a file at the place of the command, behind `fit` or first.
FullCommand OfFile(Words words, size_t place, std::optional<FileUse> use) {
  const std::string path = words[place];
  std::error_code error;
  if (std::filesystem::is_directory(path, error) && !FormatOfName(path))
    throw UsageError(path + " is a folder: name a file in it ('batten batch' fits many)");
  const bool geometry = HoldsGeometry(words, place);
  if (geometry && (place > 0 || use) && use != FileUse::kInfo) {
    throw UsageError(path +
                     " holds geometry: a fit is of points ('batten info' says what a file holds)");
  }
  const FileKind kind = use ? FileKind{*use, "", {}, "", {}} : KindOf(path, ReadingOf(words));
  words.erase(words.begin(), words.begin() + std::ptrdiff_t(place));
  const Words command = CommandOf(kind.use);
  words.insert(words.begin(), command.begin(), command.end());
  const auto behind = words.begin() + std::ptrdiff_t(command.size()) + 1;
  if (!kind.flags.empty() && !Given(words, kind.flags.front()))
    words.insert(behind, kind.flags.begin(), kind.flags.end());
  if (use) return {std::move(words), std::string("--as ") + NameOf(*use) + " asks for it"};
  return {std::move(words), Told(path, kind)};
}

// Whether the word at the place is used as a command: where it is a file's name too, another word
// that is no flag follows.
bool IsUsedAsCommand(const Words& words, size_t place) {
  const bool followed = place + 1 < words.size() && words[place + 1].rfind('-', 0) != 0;
  return followed || !IsThere(words[place]);
}

// Words with a first one that is no command though it says what is wanted; none where it does not.
std::optional<FullCommand> OfAlias(const CLI::App& app, const Words& words) {
  const size_t place = !words.empty() && words[0] == "fit" ? 1 : 0;
  if (words.size() <= place) return std::nullopt;
  const CLI::App& fit = *app.get_subcommand("fit");
  const std::string& alias = words[place];
  const bool of_file = words.size() > place + 1 && NamesFile(words[place + 1]);
  const auto is_among = [&](std::initializer_list<const char*> list) {
    return std::find(list.begin(), list.end(), alias) != list.end();
  };
  Words command, flags;
  if (place == 0 && HasCommand(fit, alias) && IsUsedAsCommand(words, 0)) {
    command = {"fit", alias};
  } else if (is_among({"line", "circle", "plane", "sphere", "cylinder", "cone", "torus"}) &&
             IsUsedAsCommand(words, place)) {
    if (!of_file) {
      throw UsageError("'" + alias + "' is no command: 'batten fit primitive FILE --kind " + alias +
                       "' fits one to points, 'batten make " + alias + "' makes one");
    }
    command = {"fit", "primitive"};
    if (!Given(words, "--kind")) flags = {"--kind", alias};
  } else if (place == 0 && of_file && is_among({"view", "open", "show"})) {
    command = {"info"};
  } else if (place == 0 && of_file && alias == "mesh" && HoldsGeometry(words, 1)) {
    command = {"tessellate"};
  } else {
    return std::nullopt;
  }
  std::string told = "'";
  for (size_t k = 0; k <= place; ++k) told += (k > 0 ? " " : "") + words[k];
  told += "' is taken for 'batten";
  for (const Words& some : {command, flags})
    for (const std::string& word : some) told += " " + word;
  Words full = command;
  const auto file = words.begin() + std::ptrdiff_t(place) + 1;
  const auto behind = flags.empty() ? file : file + 1;
  full.insert(full.end(), file, behind);
  full.insert(full.end(), flags.begin(), flags.end());
  full.insert(full.end(), behind, words.end());
  return FullCommand{std::move(full), told + "'"};
}

}  // namespace

FullCommand WithCommand(const CLI::App& app, Words words) {
  const bool help = !words.empty() && words[0] == "help";
  if (help && (words.size() == 1 || words[1].rfind('-', 0) != 0)) {
    words.erase(words.begin());
    words.emplace_back("--help");
    return {std::move(words), ""};
  }
  const std::optional<FileUse> use = TakeUse(app, words);
  if (std::optional<FullCommand> alias = use ? std::nullopt : OfAlias(app, words)) return *alias;
  if (StandsForCommand(app, words, 0)) return OfFile(std::move(words), 0, use);
  if (!words.empty() && words[0] == "fit" && StandsForCommand(*app.get_subcommand("fit"), words, 1))
    return OfFile(std::move(words), 1, use);
  return {std::move(words), ""};
}

FullCommand InFull(const CLI::App& app, const Words& words) {
  FullCommand full = WithCommand(app, words);
  const Words& all = full.words;
  const bool named = all == words || all[0] != "fit" || all.size() < 3 ||
                     (all[2] != "-" && all[2].rfind('-', 0) == 0) || GivesOutput(all) ||
                     Given(all, "--help") || Given(all, "-h");
  if (!named) full.words = WithOutputs(all, all[2]);
  return full;
}

bool WritesPageUnasked(const Words& typed, const Words& full) {
  return Given(full, "--report") && !Given(typed, "--report");
}

}  // namespace batten::internal
