// SPDX-License-Identifier: MIT
#include "cli/commands/completion.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <exception>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <system_error>
#include <utility>

#include "batten/io/file_format.h"
#include "batten/io/read_error.h"
#include "cli/arguments/mesh_output.h"
#include "cli/commands/commands.h"
#include "cli/commands/short_forms.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/completion_scripts.h"
#include "cli/terminal/exit_codes.h"
#include "cli/terminal/offered_words.h"

namespace batten::internal {
namespace {

bool Begins(const std::string& text, const std::string& with) {
  return text.compare(0, with.size(), with) == 0;
}

using Accepts = std::function<bool(const std::string& path)>;

// Whether the format that a name says is of a kind. No list of extensions: the readers' own answer.
Accepts OfFormat(bool (*kind)(FileFormat)) {
  return [kind](const std::string& path) {
    try {
      return kind(FormatOf(path));
    } catch (const UsageError&) {
      return false;
    }
  };
}

Accepts EndingIn(const std::vector<std::string>& extensions) {
  return [extensions](const std::string& path) {
    const std::string extension = std::filesystem::path(path).extension().string();
    return std::find(extensions.begin(), extensions.end(), extension) != extensions.end();
  };
}

// Which files an option takes, by the name it shows in help; nothing where it takes none.
const Accepts* FilesOf(const CLI::Option& option) {
  static const Accepts geometry = OfFormat(IsGeometryFormat), cloud = OfFormat(IsCloudFormat),
                       readable = OfFormat(IsReadable);
  static const Accepts mesh = [](const std::string& path) { return NamesMesh(path, ""); };
  static const Accepts written = [](const std::string& path) {
    return readable(path) || mesh(path);
  };
  static const std::map<std::string, const Accepts*> kOfName = {{"GEOMETRY", &geometry},
                                                                {"GEOMETRY2", &geometry},
                                                                {"CURVE", &geometry},
                                                                {"CURVE.json", &geometry},
                                                                {"C.json", &geometry},
                                                                {"CLOUD", &cloud},
                                                                {"POINTS", &cloud},
                                                                {"FILE", &readable},
                                                                {"IN", &readable},
                                                                {"FILES", &written},
                                                                {"MESH", &mesh}};
  static const Accepts report = EndingIn({".json", ".html"}),
                       residuals = EndingIn({".ply", ".csv"});
  static const Accepts any = [](const std::string&) { return true; };
  const std::string name = option.get_single_name();
  if (name == "report") return &report;
  if (name == "residuals") return &residuals;
  if (name == "at-file") return &cloud;
  if (name == "boundary") return &geometry;
  if (name == "OUT") return &written;
  const std::string shown = option.get_positional() ? name : option.get_type_name();
  if (shown == "OUT") return &geometry;
  const auto found = kOfName.find(shown);
  return found == kOfName.end() ? nullptr : found->second;
}

// What bash would make of a word: quotes and backslashes gone.
std::string Unquoted(const std::string& word) {
  std::string plain;
  char quote = '\0';
  for (size_t k = 0; k < word.size(); ++k) {
    const char letter = word[k];
    if (quote == '\0' && (letter == '"' || letter == '\'')) {
      quote = letter;
    } else if (letter == quote) {
      quote = '\0';
    } else if (letter == '\\' && quote != '\'' && k + 1 < word.size()) {
      plain += word[++k];
    } else {
      plain += letter;
    }
  }
  return plain;
}

// Folders, and files that are accepted, whose names begin with what is typed.
std::vector<std::string> Files(const std::string& typed, const Accepts& accepts) {
  const size_t slash = typed.rfind('/');
  const std::string folder = slash == std::string::npos ? "" : typed.substr(0, slash + 1);
  const std::string begun = typed.substr(folder.size());
  std::string place = folder.empty() ? "." : folder;
  const char* const home = std::getenv("HOME");
  if (Begins(place, "~/") && home != nullptr) place = home + place.substr(1);
  std::vector<std::string> names;
  std::error_code error;  // what can't be looked into holds nothing to offer
  for (std::filesystem::directory_iterator entry(place, error), end; !error && entry != end;
       entry.increment(error)) {
    const std::string name = entry->path().filename().string();
    if (!Begins(name, begun) || (name[0] == '.' && begun.empty())) continue;
    std::error_code unknown;
    if (entry->is_directory(unknown) || accepts(name)) names.push_back(folder + name);
  }
  return names;
}

bool TakesValue(const CLI::Option& option) { return option.get_items_expected_max() > 0; }

bool Repeats(const CLI::Option& option) { return option.get_items_expected_max() > 1; }

// The option of the command that a word such as --loss or -o names.
const CLI::Option* Named(const CLI::App& command, const std::string& word) {
  const std::string name = word.substr(0, word.find('='));
  for (const CLI::Option* option : command.get_options()) {
    if (!option->get_positional() && option->check_name(name)) return option;
  }
  return nullptr;
}

std::vector<const CLI::Option*> Positionals(const CLI::App& command) {
  std::vector<const CLI::Option*> positionals;
  for (const CLI::Option* option : command.get_options()) {
    if (option->get_positional()) positionals.push_back(option);
  }
  return positionals;
}

std::vector<const CLI::App*> Commands(const CLI::App& command) {
  return command.get_subcommands([](const CLI::App*) { return true; });
}

// The command line as far as it is typed.
struct Typed {
  const CLI::App* command;
  const CLI::Option* wants = nullptr;  // the flag whose value comes next
  size_t positionals = 0;
  bool only_positionals = false;  // after --
  std::vector<const CLI::Option*> given;
};

Typed Walk(const CLI::App& app, const std::vector<std::string>& words) {
  Typed typed{&app, nullptr, 0, false, {}};
  for (const std::string& word : words) {
    if (std::exchange(typed.wants, nullptr) != nullptr) continue;
    if (typed.only_positionals) {
      ++typed.positionals;
    } else if (word == "--") {
      typed.only_positionals = true;
    } else if (word.size() > 1 && word[0] == '-') {
      const CLI::Option* const option = Named(*typed.command, word);
      if (option == nullptr) continue;
      typed.given.push_back(option);
      if (TakesValue(*option) && word.find('=') == std::string::npos) typed.wants = option;
    } else {
      const std::vector<const CLI::App*> commands = Commands(*typed.command);
      const auto named = std::find_if(commands.begin(), commands.end(), [&](const CLI::App* c) {
        return c->get_name() == word;
      });
      if (named != commands.end()) {
        typed = {*named, nullptr, 0, false, {}};
      } else {
        ++typed.positionals;
      }
    }
  }
  return typed;
}

// Of the usual format words those that are understood now.
std::vector<std::string> FormatWords() {
  std::vector<std::string> words;
  for (const char* const word : {"pcd",
                                 "ply",
                                 "las",
                                 "text",
                                 "xyz",
                                 "csv",
                                 "json",
                                 "step",
                                 "iges",
                                 "brep",
                                 "obj",
                                 "stl",
                                 "off",
                                 "glb"}) {
    try {
      if (NamesMesh("-", word) || IsReadable(FormatOf("-", word))) words.emplace_back(word);
    } catch (const UsageError&) {
      continue;
    }
  }
  return words;
}

Completion ValueOf(const CLI::Option& option, const std::string& typed) {
  Completion completion;
  if (const WordsFor* const words = OfferedWords(option)) {
    completion.words = (*words)(typed);
  } else if (option.get_type_name() == "FORMAT") {
    completion.words = FormatWords();
  } else if (const Accepts* const accepts = FilesOf(option)) {
    completion.files = true;
    completion.words = Files(typed, *accepts);
  }
  return completion;
}

Completion FlagsOf(const Typed& typed) {
  Completion completion;
  for (const CLI::Option* option : typed.command->get_options()) {
    const bool given =
        std::find(typed.given.begin(), typed.given.end(), option) != typed.given.end();
    if (given && !Repeats(*option)) continue;
    for (const std::string& name : option->get_lnames()) completion.words.push_back("--" + name);
  }
  return completion;
}

// The command's own, or else, where none begins as is typed, the files that can stand for one
// (short_forms.h); nothing where the command has none.
Completion CommandsOf(const CLI::App& command, const std::string& word) {
  Completion completion;
  for (const CLI::App* below : Commands(command)) completion.words.push_back(below->get_name());
  const bool begun = std::any_of(completion.words.begin(),
                                 completion.words.end(),
                                 [&](const std::string& name) { return Begins(name, word); });
  if (completion.words.empty() || begun) return completion;
  const bool fits = command.get_name() == "fit";
  if (fits || command.get_parent() == nullptr)
    return {.words = Files(word, OfFormat(fits ? IsCloudFormat : IsReadable)), .files = true};
  return completion;
}

Completion Unfiltered(const Typed& typed, const std::string& word) {
  if (typed.wants != nullptr) return ValueOf(*typed.wants, word);
  if (!typed.only_positionals && Begins(word, "-")) {
    const size_t sign = word.find('=');
    if (sign == std::string::npos) return FlagsOf(typed);
    const CLI::Option* const option = Named(*typed.command, word);
    if (option == nullptr || !TakesValue(*option)) return {};
    Completion completion = ValueOf(*option, word.substr(sign + 1));
    for (std::string& value : completion.words) value = word.substr(0, sign + 1) + value;
    return completion;
  }
  if (const Completion commands = CommandsOf(*typed.command, word); !commands.words.empty())
    return commands;
  const std::vector<const CLI::Option*> positionals = Positionals(*typed.command);
  if (positionals.empty()) return FlagsOf(typed);
  // The last one may come again.
  if (typed.positionals < positionals.size()) return ValueOf(*positionals[typed.positionals], word);
  return Repeats(*positionals.back()) ? ValueOf(*positionals.back(), word) : FlagsOf(typed);
}

bool IsBreak(const std::string& word) {
  return !word.empty() && word.find_first_not_of("=:") == std::string::npos;
}

// Puts together again what was split at '=' and ':'. Returns how much of the last word is not to be
// typed again.
size_t Rejoin(std::vector<std::string>& words) {
  std::vector<std::string> whole;
  size_t before = 0;
  bool joins = false;
  for (const std::string& word : words) {
    const bool breaks = IsBreak(word);
    if (!whole.empty() && (joins || breaks)) {
      before = whole.back().size() + (breaks ? word.size() : 0);
      whole.back() += word;
    } else {
      before = 0;
      whole.push_back(word);
    }
    joins = breaks;
  }
  words = std::move(whole);
  return before;
}

}  // namespace

Completion Complete(const CLI::App& app, std::vector<std::string> words) {
  if (words.empty()) words.emplace_back();
  const size_t before = Rejoin(words);
  const std::string last = Unquoted(words.back());
  words.pop_back();
  try {
    if (words != std::vector<std::string>{"help"}) words = WithCommand(app, std::move(words)).words;
  } catch (const std::exception&) {
    return {};  // after a file nothing can be done with
  }
  Completion completion = Unfiltered(Walk(app, words), last);
  std::vector<std::string>& found = completion.words;
  std::erase_if(found, [&](const std::string& word) { return !Begins(word, last); });
  std::sort(found.begin(), found.end());
  for (std::string& word : found) {
    completion.open = completion.open || word.back() == '=' || word.back() == ':';
    word.erase(0, std::min(before, word.size()));
  }
  return completion;
}

void PrintCompletion(const CLI::App& app, const std::vector<std::string>& words) {
  const Completion completion = Complete(app, words);
  std::puts(completion.files ? "files" : completion.open ? "open" : "words");
  for (const std::string& word : completion.words) std::puts(word.c_str());
}

void AddCompletionCommand(CLI::App& app, Action& action) {
  auto shell = std::make_shared<std::string>();
  CLI::App& command = *app.add_subcommand(
      "completion", "Print the script that completes commands, flags and files in a shell");
  CLI::Option& option =
      *command.add_option("SHELL", *shell, "The shell it is for: bash, zsh or fish")->required();
  Allow(option, {"bash", "zsh", "fish"});
  command.footer(
      "An installed batten has it in place already. The script asks the program what can stand at\n"
      "the cursor: commands, flags, their words, files that can be read or written there.\n"
      "Examples:\n"
      "  source <(batten completion bash)\n"
      "  batten completion bash > ~/.local/share/bash-completion/completions/batten\n"
      "  source <(batten completion zsh)\n"
      "  batten completion fish > ~/.config/fish/completions/batten.fish");
  command.callback([shell, &action] {
    action = [shell] {
      std::fputs(CompletionScript(*shell), stdout);
      return kDone;
    };
  });
}

}  // namespace batten::internal
