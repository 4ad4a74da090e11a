// SPDX-License-Identifier: MIT
// Manual pages of the commands, from their own declarations: what they say is what --help says.
#pragma once

#include <string>
#include <vector>

#include "cli/terminal/cli11_forward.h"

namespace batten::internal {

// A page: the name of its file without the extension, and its text.
struct ManualPage {
  std::string name, text;  // "batten-fit-surface"
};

// Of the program and every command below it, in roff for man(1), section 1; the text of a page is
// that of --help in its order, unwrapped.
std::vector<ManualPage> ManPages(const CLI::App& app);

// The same in Markdown: --help as it is printed, and links.
std::vector<ManualPage> MarkdownPages(const CLI::App& app);

// Answers `batten __pages man|markdown FOLDER`: writes every page into the folder, which is made
// where it is missing. Throws UsageError for other words, WriteError.
void WriteManualPages(const CLI::App& app, const std::vector<std::string>& words);

}  // namespace batten::internal
