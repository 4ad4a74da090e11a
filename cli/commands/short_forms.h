// SPDX-License-Identifier: MIT
// Command lines whose command is left out: what they stand for.
#pragma once

#include <string>
#include <vector>

#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// The words after the program's name with the command that a file in its place stands for:
//   scan.ply …, fit scan.ply …   fit surface scan.ply …, fit solid … where it holds a closed mesh
//   part.step …                  info part.step …
//   help fit …                   fit … --help
// All others come back as they are. A command is one even where a file has its name. Throws
// UsageError for files of a format that is not read.
std::vector<std::string> WithCommand(const CLI::App& app, std::vector<std::string> words);

// The same with names for what a fit so called is to write, after its first cloud and in the
// working directory, unless they are given: scan.step and, beside that, scan.report.html and
// scan.report.json. Throws UsageError where one of them is there already: nobody asked for it to be
// written over.
std::vector<std::string> InFull(const CLI::App& app, const std::vector<std::string>& words);

// Whether the words write that page.
bool WritesPageUnasked(const std::vector<std::string>& typed, const std::vector<std::string>& full);

}  // namespace batten::internal
