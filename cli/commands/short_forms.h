// SPDX-License-Identifier: MIT
// Command lines whose command is left out or has another name: what they stand for.
#pragma once

#include <string>
#include <vector>

#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// A command line with its command, and a sentence on what was typed: what the file was taken for,
// why, and what makes something else of it. The sentence is empty where the words are as they were,
// or where nothing is known of the file.
struct FullCommand {
  std::vector<std::string> words;
  std::string taken;
};

// The words after the program's name with the command that a file in its place stands for, or a
// first word that is no command:
//   scan.ply …, fit scan.ply …        fit surface scan.ply …, or another fit: file_kind.h
//   scan.ply … --as curve             fit curve scan.ply …
//   part.step …                       info part.step …
//   curve scan.xyz …                  fit curve scan.xyz …, and so with each fit
//   plane scan.xyz …                  fit primitive scan.xyz --kind plane …
//   mesh part.step …, view part.step  tessellate part.step …, info part.step
//   help fit …                        fit … --help
// All others come back as they are. A command is one even where a file has its name, and so is such
// a first word where another word follows that is no flag. Throws UsageError for files of a format
// that is not read, and for --as with another word.
FullCommand WithCommand(const CLI::App& app, std::vector<std::string> words);

// The same with names for what a fit so called is to write, after its first cloud and in the
// working directory, unless they are given: scan.step and, beside that, scan.report.html and
// scan.report.json. Throws UsageError where one of them is there already: nobody asked for it to be
// written over.
FullCommand InFull(const CLI::App& app, const std::vector<std::string>& words);

// Whether the words write that page.
bool WritesPageUnasked(const std::vector<std::string>& typed, const std::vector<std::string>& full);

}  // namespace batten::internal
