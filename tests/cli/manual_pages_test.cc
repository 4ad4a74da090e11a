// SPDX-License-Identifier: MIT
// The pages of the manual say what --help says.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <map>
#include <sstream>

#include "test_clouds.h"

namespace batten::internal::manual_pages_test {

using ::testing::AllOf;
using ::testing::HasSubstr;

using Pages = std::map<std::string, std::string>;

Pages PagesIn(const std::filesystem::path& folder) {
  Pages pages;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    std::ifstream file(entry.path(), std::ios::binary);
    pages[entry.path().stem().string()] = std::string(std::istreambuf_iterator<char>(file), {});
  }
  return pages;
}

// "batten-fit-surface" as the arguments of a command line that asks for help.
std::vector<std::string> HelpArguments(const std::string& page) {
  std::vector<std::string> words;
  std::istringstream parts(page);
  for (std::string word; std::getline(parts, word, '-');) words.push_back(word);
  words.erase(words.begin());
  words.emplace_back("--help");
  return words;
}

std::vector<std::string> Words(const std::string& text) {
  std::istringstream stream(text);
  return {std::istream_iterator<std::string>(stream), {}};
}

// A character of at most three bytes.
std::string Utf8(unsigned long code) {
  const auto tail = [](unsigned long bits) { return static_cast<char>(0x80 | (bits & 0x3F)); };
  if (code < 0x800) return {static_cast<char>(0xC0 | code >> 6), tail(code)};
  return {static_cast<char>(0xE0 | code >> 12), tail(code >> 6), tail(code)};
}

// What a reader of the page sees, without macros and escapes.
std::string Plain(const std::string& roff) {
  std::string text;
  bool macro = false;
  for (size_t k = 0; k < roff.size(); ++k) {
    const bool begins = k == 0 || roff[k - 1] == '\n';
    if (begins) macro = roff[k] == '.';
    if (begins && macro) {
      const size_t end = std::min(roff.find_first_of(" \n", k), roff.size());
      k = end - (roff[end] == '\n' ? 1 : 0);
      continue;
    }
    if (roff.compare(k, 2, "\\&") == 0) {
      ++k;
    } else if (roff.compare(k, 4, "\\(dq") == 0) {
      text += '"';
      k += 3;
    } else if (roff.compare(k, 3, "\\[u") == 0) {
      const size_t end = roff.find(']', k);
      text += Utf8(std::stoul(roff.substr(k + 3, end - k - 3), nullptr, 16));
      k = end;
    } else if (roff[k] == '\\') {
      text += roff[++k] == 'e' ? '\\' : roff[k];
    } else if (roff[k] != '"' || !macro) {
      text += roff[k];
    }
  }
  return text;
}

// Characters, of UTF-8.
std::ptrdiff_t Columns(const std::string& line) {
  return std::count_if(line.begin(), line.end(), [](char c) { return (c & 0xC0) != 0x80; });
}

class ManualPagesTest : public ::testing::Test {
 protected:
  Pages Written(const std::string& kind) {
    const ProgramRun run = Batten({"__pages", kind, folder_.File(kind)});
    EXPECT_EQ(run.code, 0) << run.err;
    return PagesIn(folder_.File(kind));
  }

  TemporaryFolder folder_;
};

TEST_F(ManualPagesTest, DocsHoldWhatHelpPrints) {
  const Pages written = Written("markdown");
  const Pages kept = PagesIn(BATTEN_SOURCE_DIR "/docs/cli");
  EXPECT_GE(written.size(), 20u);
  for (const auto& [name, text] : written) {
    const auto found = kept.find(name);
    ASSERT_TRUE(found != kept.end()) << "run scripts/make-cli-pages: there is no " << name;
    EXPECT_EQ(found->second, text) << "run scripts/make-cli-pages";
    const std::string help = Batten(HelpArguments(name)).out;
    EXPECT_THAT(text, HasSubstr("```text\n" + help + "```\n")) << name;
    std::istringstream lines(help);
    for (std::string line; std::getline(lines, line);) EXPECT_LE(Columns(line), 100) << line;
  }
  EXPECT_EQ(kept.size(), written.size()) << "run scripts/make-cli-pages: some are of no command";
}

TEST_F(ManualPagesTest, ManPagesSayTheWordsOfHelpInItsOrder) {
  for (const auto& [name, text] : Written("man")) {
    const std::vector<std::string> shown = Words(Plain(text));
    auto at = shown.begin();
    std::istringstream help(Batten(HelpArguments(name)).out);
    for (std::string line; std::getline(help, line);) {
      // Headings, which man pages have in capitals.
      if (line.empty() || (line[0] != ' ' && line.back() == ':')) continue;
      if (line.compare(0, 7, "Usage: ") == 0) line.erase(0, 7);
      for (const std::string& word : Words(line)) {
        at = std::find(at, shown.end(), word);
        ASSERT_NE(at, shown.end()) << name << ": " << line << ": " << word;
        ++at;
      }
    }
  }
}

// mandoc and groff, where they are installed.
TEST_F(ManualPagesTest, ManPagesAreWellFormed) {
  const bool mandoc = std::system("command -v mandoc > /dev/null") == 0;
  const bool groff = std::system("command -v groff > /dev/null") == 0;
  if (!mandoc && !groff) GTEST_SKIP() << "neither mandoc nor groff is installed";
  for (const auto& [name, text] : Written("man")) {
    const std::string page = folder_.File("man/" + name + ".1"), out = folder_.File("lint");
    if (mandoc) {
      // No date: pages are the same bytes whenever they are made.
      std::system(("mandoc -T lint -W warning " + page + " 2>&1 | grep -v 'missing date' > " + out)
                      .c_str());
      EXPECT_EQ(folder_.Text("lint"), "") << name;
    }
    if (groff) {
      std::system(("groff -man -Tutf8 -ww -z " + page + " > " + out + " 2>&1").c_str());
      EXPECT_EQ(folder_.Text("lint"), "") << name;
    }
  }
}

TEST_F(ManualPagesTest, OtherKindsAreRefused) {
  EXPECT_EQ(Batten({"__pages", "pdf", folder_.File("x")}).code, 2);
  EXPECT_EQ(Batten({"__pages", "man"}).code, 2);
}

}  // namespace batten::internal::manual_pages_test
