// SPDX-License-Identifier: MIT
#include "cli/commands/manual_pages.h"

#include <fmt/format.h>

#include <filesystem>
#include <sstream>
#include <system_error>

#include "batten/io/atomic_file.h"
#include "batten/io/read_error.h"
#include "cli/terminal/cli11.h"
#include "cli/terminal/help_format.h"
#include "cli/terminal/this_run.h"

namespace batten::internal {
namespace {

// The UTF-8 character that begins there, which is not one of ASCII, as roff names it.
std::string RoffCharacter(const std::string& text, size_t& at) {
  const auto first = static_cast<unsigned char>(text[at]);
  const int more = first >= 0xF0 ? 3 : first >= 0xE0 ? 2 : 1;
  unsigned code = first & (0x3Fu >> more);
  for (int k = 0; k < more && at + 1 < text.size(); ++k) {
    code = code << 6 | (static_cast<unsigned char>(text[++at]) & 0x3Fu);
  }
  return fmt::format("\\[u{:04X}]", code);
}

// Without what roff would read as its own: backslashes, hyphens, dots and quotes that begin a line.
std::string Roff(const std::string& text) {
  std::string roff;
  for (size_t k = 0; k < text.size(); ++k) {
    const char letter = text[k];
    const bool begins = roff.empty() || roff.back() == '\n';
    if (begins && (letter == '.' || letter == '\'')) roff += "\\&";
    if (static_cast<unsigned char>(letter) >= 0x80) {
      roff += RoffCharacter(text, k);
    } else if (letter == '\\') {
      roff += "\\e";
    } else if (letter == '-') {
      roff += "\\-";
    } else {
      roff += letter;
    }
  }
  return roff;
}

// An argument of a macro.
std::string RoffArgument(const std::string& text) {
  std::string quoted = "\"";
  for (const char letter : Roff(text))
    quoted += letter == '"' ? std::string("\\(dq") : std::string(1, letter);
  return quoted + '"';
}

std::string InCapitals(std::string text) {
  for (char& letter : text) {
    if (letter >= 'a' && letter <= 'z') letter = static_cast<char>(letter - 'a' + 'A');
  }
  return text;
}

// Text that flows, lines that begin with blanks as they are, a heading for the examples.
std::string RoffOfFooter(const std::string& footer) {
  std::ostringstream out;
  std::istringstream lines(footer);
  bool as_it_is = false, flows = false;
  out << ".SH DESCRIPTION\n";
  for (std::string line; std::getline(lines, line);) {
    const bool keeps = line.compare(0, 2, "  ") == 0;
    if (as_it_is && !keeps) out << ".fi\n";
    if (keeps && !as_it_is) out << (flows ? ".PP\n.nf\n" : ".nf\n");
    if (!keeps && as_it_is && line != "Examples:") out << ".PP\n";
    as_it_is = keeps;
    flows = !keeps;
    if (line == "Examples:") {
      out << ".SH EXAMPLES\n";
      flows = false;
    } else {
      out << Roff(line) << '\n';
    }
  }
  if (as_it_is) out << ".fi\n";
  const std::string text = out.str(), empty = ".SH DESCRIPTION\n.SH EXAMPLES\n";
  return text.compare(0, empty.size(), empty) == 0 ? text.substr(text.find('\n') + 1) : text;
}

struct PageOf {
  const CLI::App* command;
  std::string name;  // "batten fit surface"
};

std::string PageName(std::string name) {
  for (char& letter : name) letter = letter == ' ' ? '-' : letter;
  return name;
}

std::vector<PageOf> PagesBelow(const PageOf& one) {
  std::vector<PageOf> below;
  for (const CLI::App* sub : one.command->get_subcommands([](const CLI::App*) { return true; })) {
    below.push_back({sub, one.name + ' ' + sub->get_name()});
  }
  return below;
}

void CollectPages(const PageOf& one, std::vector<PageOf>& all) {
  all.push_back(one);
  for (const PageOf& sub : PagesBelow(one)) CollectPages(sub, all);
}

std::vector<PageOf> AllPages(const CLI::App& app) {
  std::vector<PageOf> all;
  CollectPages({&app, app.get_name()}, all);
  return all;
}

std::string ManPage(const PageOf& one) {
  std::ostringstream out;
  const std::string page = PageName(one.name);
  out << ".TH " << RoffArgument(InCapitals(page)) << " 1 \"\" "
      << RoffArgument(std::string("batten ") + Version()) << " \"batten\"\n.SH NAME\n"
      << Roff(page) << " \\- " << Roff(one.command->get_description()) << "\n.SH SYNOPSIS\n"
      << Roff(HelpUsage(*one.command, one.name)) << '\n';
  for (const HelpGroup& group : HelpGroups(*one.command)) {
    out << ".SH " << RoffArgument(InCapitals(group.heading)) << '\n';
    for (const HelpEntry& entry : group.entries) {
      out << ".TP\n.B " << RoffArgument(entry.name) << '\n' << Roff(entry.text) << '\n';
    }
  }
  const std::vector<PageOf> below = PagesBelow(one);
  if (!below.empty()) out << ".SH SUBCOMMANDS\n";
  for (const PageOf& sub : below) {
    out << ".TP\n.B " << RoffArgument(sub.command->get_name()) << '\n'
        << Roff(sub.command->get_description()) << '\n';
  }
  if (!one.command->get_footer().empty()) out << RoffOfFooter(one.command->get_footer());
  std::vector<std::string> beside;
  if (one.command->get_parent() != nullptr) {
    beside.push_back(PageName(one.name.substr(0, one.name.rfind(' '))));
  }
  for (const PageOf& sub : below) beside.push_back(PageName(sub.name));
  for (size_t k = 0; k < beside.size(); ++k) {
    out << (k == 0 ? ".SH SEE ALSO\n" : "") << ".BR " << Roff(beside[k]) << " (1)"
        << (k + 1 < beside.size() ? "," : "") << '\n';
  }
  return out.str();
}

std::string MarkdownPage(const PageOf& one) {
  std::ostringstream out;
  const bool below = one.command->get_parent() != nullptr;
  const std::string above = below ? one.name.substr(0, one.name.rfind(' ')) : "";
  out << "# " << one.name << "\n\n```text\n" << one.command->help(above) << "```\n";
  std::string links;
  const auto link = [&](const std::string& name) {
    links += (links.empty() ? "" : " · ") + ('[' + name) + "](" + PageName(name) + ".md)";
  };
  if (below) link(above);
  for (const PageOf& sub : PagesBelow(one)) link(sub.name);
  if (!links.empty()) out << '\n' << links << '\n';
  return out.str();
}

}  // namespace

std::vector<ManualPage> ManPages(const CLI::App& app) {
  std::vector<ManualPage> pages;
  for (const PageOf& one : AllPages(app)) pages.push_back({PageName(one.name), ManPage(one)});
  return pages;
}

std::vector<ManualPage> MarkdownPages(const CLI::App& app) {
  std::vector<ManualPage> pages;
  for (const PageOf& one : AllPages(app)) pages.push_back({PageName(one.name), MarkdownPage(one)});
  return pages;
}

void WriteManualPages(const CLI::App& app, const std::vector<std::string>& words) {
  const bool man = words.size() == 2 && words[0] == "man";
  if (!man && !(words.size() == 2 && words[0] == "markdown")) {
    throw UsageError("usage: batten __pages man|markdown FOLDER");
  }
  const std::filesystem::path folder = words[1];
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw WriteError(words[1], error.message());
  for (const ManualPage& page : man ? ManPages(app) : MarkdownPages(app)) {
    AtomicFile file((folder / (page.name + (man ? ".1" : ".md"))).string());
    file.Write(page.text);
    file.Commit();
  }
}

}  // namespace batten::internal
