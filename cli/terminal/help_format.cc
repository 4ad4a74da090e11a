// SPDX-License-Identifier: MIT
#include "cli/terminal/help_format.h"

#include <memory>
#include <sstream>
#include <utility>

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
    const HelpEntry entry = Entry(option, positional);
    return HelpLines(entry.name, entry.text, get_column_width());
  }

  std::string make_subcommand(const CLI::App* sub) const override {
    return HelpLines(sub->get_display_name(true), sub->get_description(), get_column_width());
  }

  HelpEntry Entry(const CLI::Option* option, bool positional) const {
    return {make_option_name(option, positional) + make_option_opts(option),
            make_option_desc(option)};
  }
};

const WrappingFormatter& FormatterOf(const CLI::App& command) {
  return dynamic_cast<const WrappingFormatter&>(*command.get_formatter());
}

}  // namespace

std::string HelpLines(const std::string& name, const std::string& text, size_t column) {
  std::ostringstream out;
  CLI::detail::format_help(out, name, Wrapped(text, kColumns - column), column);
  return out.str();
}

void WrapHelp(CLI::App& app) { app.formatter(std::make_shared<WrappingFormatter>()); }

std::vector<HelpGroup> HelpGroups(const CLI::App& command) {
  const WrappingFormatter& formatter = FormatterOf(command);
  std::vector<HelpGroup> groups;
  const auto add = [&](const std::string& heading, bool positional, const std::string& group) {
    HelpGroup one{heading, {}};
    for (const CLI::Option* option : command.get_options()) {
      if (option->get_positional() != positional || option->get_group().empty()) continue;
      if (!positional && option->get_group() != group) continue;
      one.entries.push_back(formatter.Entry(option, positional));
    }
    if (!one.entries.empty()) groups.push_back(std::move(one));
  };
  add("Positionals", true, "");
  for (const std::string& group : command.get_groups()) {
    if (!group.empty()) add(group, false, group);
  }
  return groups;
}

std::string HelpUsage(const CLI::App& command, const std::string& full_name) {
  const std::string usage = FormatterOf(command).make_usage(&command, full_name);
  const std::string head = "Usage: ";
  return usage.substr(head.size(), usage.find('\n') - head.size());
}

void GroupFlags(CLI::App& command,
                const std::string& heading,
                const std::vector<std::string>& flags) {
  for (const std::string& flag : flags) {
    if (CLI::Option* const option = command.get_option_no_throw(flag)) option->group(heading);
  }
}

}  // namespace batten::internal
