// SPDX-License-Identifier: MIT
#include "cli/terminal/help_format.h"

#include <memory>
#include <sstream>

#include "cli/terminal/cli11.h"

namespace batten::internal {
namespace {

constexpr size_t kColumns = 100;

// Broken at blanks where a line would be longer than `width`; breaks that are there stay.
std::string Wrapped(const std::string& text, size_t width) {
  std::string wrapped, line;
  std::istringstream lines(text);
  for (std::string given; std::getline(lines, given); line.clear()) {
    std::istringstream words(given);
    for (std::string word; words >> word;) {
      if (!line.empty() && line.size() + 1 + word.size() > width) {
        wrapped += line + '\n';
        line.clear();
      }
      line += (line.empty() ? "" : " ") + word;
    }
    wrapped += line + '\n';
  }
  if (!wrapped.empty()) wrapped.pop_back();
  return wrapped;
}

class WrappingFormatter : public CLI::Formatter {
 public:
  std::string make_option(const CLI::Option* option, bool positional) const override {
    std::ostringstream out;
    CLI::detail::format_help(out,
                             make_option_name(option, positional) + make_option_opts(option),
                             Wrapped(make_option_desc(option), kColumns - get_column_width()),
                             get_column_width());
    return out.str();
  }
};

}  // namespace

void WrapHelp(CLI::App& app) { app.formatter(std::make_shared<WrappingFormatter>()); }

void GroupFlags(CLI::App& command,
                const std::string& heading,
                const std::vector<std::string>& flags) {
  for (const std::string& flag : flags) {
    if (CLI::Option* const option = command.get_option_no_throw(flag)) option->group(heading);
  }
}

}  // namespace batten::internal
