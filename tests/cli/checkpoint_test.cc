// SPDX-License-Identifier: MIT
// Laws of --checkpoint: a job that is killed goes on after its last finished pass, to the same
// bytes.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "test_clouds.h"

namespace batten::internal::checkpoint_test {

using ::testing::HasSubstr;

class CheckpointTest : public ::testing::TestWithParam<std::vector<std::string>> {
 protected:
  ProgramRun Fit(const std::string& out,
                 const std::vector<std::string>& more,
                 const ProgramInput& input = {}) {
    std::vector<std::string> words = {"fit", "surface", a_, b_, "-o", folder_.File(out)};
    words.insert(words.end(), GetParam().begin(), GetParam().end());
    words.insert(words.end(), more.begin(), more.end());
    return Batten(words, input);
  }
  // Leaves two finished passes and no result.
  void Kill(const std::string& passes) {
    const ProgramRun run = Fit("never.json",
                               {"--checkpoint", folder_.File(passes)},
                               {"", {}, folder_.File(passes) + "/pass-2"});
    ASSERT_EQ(run.code, 128 + SIGKILL);
    ASSERT_FALSE(std::filesystem::exists(folder_.File("never.json")));
    ASSERT_TRUE(std::filesystem::exists(folder_.File(passes) + "/pass-2"));
  }

  TemporaryFolder folder_;
  std::string a_ = folder_.With("a.xyz", ToText(WavySheet(90000))),
              b_ = folder_.With("b.xyz", ToText(WavySheet(60000, 2)));
};

TEST_P(CheckpointTest, AKilledJobGoesOnToTheSameBytes) {
  ASSERT_EQ(Fit("whole.json", {}).code, 0);
  Kill("passes");
  const ProgramRun run = Fit("resumed.json", {"--checkpoint", folder_.File("passes")});
  EXPECT_EQ(run.code, 0) << run.err;
  EXPECT_THAT(run.err, HasSubstr("finished passes"));
  EXPECT_EQ(folder_.Text("resumed.json"), folder_.Text("whole.json"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("passes")));
}

TEST_P(CheckpointTest, AnotherJobIsRefused) {
  Kill("passes");
  const auto refused = [&](const std::vector<std::string>& more) {
    std::vector<std::string> words = {"--checkpoint", folder_.File("passes")};
    words.insert(words.end(), more.begin(), more.end());
    const ProgramRun run = Fit("x.json", words);
    EXPECT_EQ(run.code, 1);
    EXPECT_EQ(run.error_lines(), 1);
    return run.err;
  };
  EXPECT_THAT(refused({"--degree", "2"}), HasSubstr("--degree was not given and is '2'"));
  // What is written does not matter, but files do.
  std::ofstream(b_, std::ios::app) << "1 1 1\n";
  EXPECT_THAT(refused({}), HasSubstr("b.xyz: changed"));
  std::ofstream(folder_.File("passes") + "/pass-1", std::ios::trunc) << "{}\n";
  EXPECT_THAT(refused({}), HasSubstr("pass-1: is not a whole pass"));
  EXPECT_FALSE(std::filesystem::exists(folder_.File("x.json")));
}

INSTANTIATE_TEST_SUITE_P(
    Passes,
    CheckpointTest,
    ::testing::Values(std::vector<std::string>{"--memory", "34MB", "--trim", "none"},
                      std::vector<std::string>{"--tiles", "2x2", "--trim", "none"}));

TEST(CheckpointFlagTest, NeedsPasses) {
  const ProgramRun run = Batten({"fit", "surface", "a.xyz", "-o", "x.json", "--checkpoint", "d"});
  EXPECT_EQ(run.code, 2);
  EXPECT_THAT(run.err, HasSubstr("--checkpoint d: keeps finished passes"));
}

}  // namespace batten::internal::checkpoint_test
