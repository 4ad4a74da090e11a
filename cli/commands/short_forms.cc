// SPDX-License-Identifier: MIT
#include "cli/commands/short_forms.h"

#include <algorithm>
#include <filesystem>
#include <system_error>

#include "batten/fitting/closed_surface.h"
#include "batten/io/file_format.h"
#include "batten/io/polygon_reader.h"
#include "batten/io/read_cloud.h"
#include "batten/io/read_error.h"
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

std::string FormatGiven(const Words& words) {
  const std::string flag = "--format";
  for (size_t k = 0; k < words.size(); ++k) {
    if (words[k] == flag && k + 1 < words.size()) return words[k + 1];
    if (words[k].rfind(flag + "=", 0) == 0) return words[k].substr(flag.size() + 1);
  }
  return "";
}

bool HoldsGeometry(const Words& words, size_t place) {
  return IsGeometryFormat(InputFormat(words[place], FormatGiven(words)));
}

// Whether the file holds a closed mesh, which is a body and no sheet.
bool HoldsBody(const Words& words, size_t place) {
  const std::string& path = words[place];
  if (!MayHoldFaces(path) || !FormatGiven(words).empty()) return false;
  try {
    const PolygonMesh mesh = ReadPolygons(path);
    return !mesh.faces.empty() && CloseSurface(mesh.vertices, mesh.faces).filled == 0;
  } catch (const std::exception&) {
    return false;  // the fit says why
  }
}

bool GivesOutput(const Words& words) {
  return Given(words, "--output") ||
         std::any_of(words.begin(), words.end(), [](const std::string& word) {
           return word.rfind("-o", 0) == 0;  // -o OUT, -oOUT, -o=OUT
         });
}

// The words of a fit and the outputs that are not named.
Words WithOutputs(Words words, const std::string& cloud) {
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

}  // namespace

Words WithCommand(const CLI::App& app, Words words) {
  const bool help = !words.empty() && words[0] == "help";
  if (help && (words.size() == 1 || words[1].rfind('-', 0) != 0)) {
    words.erase(words.begin());
    words.emplace_back("--help");
  } else if (StandsForCommand(app, words, 0)) {
    const Words command = HoldsGeometry(words, 0) ? Words{"info"}
                          : HoldsBody(words, 0)   ? Words{"fit", "solid"}
                                                  : Words{"fit", "surface"};
    words.insert(words.begin(), command.begin(), command.end());
  } else if (!words.empty() && words[0] == "fit" &&
             StandsForCommand(*app.get_subcommand("fit"), words, 1)) {
    if (HoldsGeometry(words, 1)) {
      throw UsageError(
          words[1] + " holds geometry: a fit is of points ('batten info' says what a file holds)");
    }
    words.insert(words.begin() + 1, HoldsBody(words, 1) ? "solid" : "surface");
  }
  return words;
}

Words InFull(const CLI::App& app, const Words& words) {
  Words full = WithCommand(app, words);
  const bool named = full == words || full[0] != "fit" || full.size() < 3 || GivesOutput(full) ||
                     Given(full, "--help") || Given(full, "-h");
  return named ? full : WithOutputs(full, full[2]);
}

bool WritesPageUnasked(const Words& typed, const Words& full) {
  return Given(full, "--report") && !Given(typed, "--report");
}

}  // namespace batten::internal
