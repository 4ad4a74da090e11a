// SPDX-License-Identifier: MIT
// The module of OpenCASCADE: where it is looked for, and what is said where it is not.
#include "io/exchange/opencascade_module.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdlib>
#include <set>
#include <stdexcept>
#include <string>
#include <thread>
#include <vector>

#include "temporary_folder.h"

namespace batten::internal::opencascade_module_test {

using ::testing::AllOf;
using ::testing::HasSubstr;

// What is said where none of the folders has a module that loads.
std::string Refusal(const std::vector<std::string>& folders) {
  try {
    LoadOpenCascade(folders);
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "(loaded)";
}

TEST(OpenCascadeModuleTest, AModuleThatIsNowhereIsNamedWithTheFoldersAndWhatToDo) {
  const TemporaryFolder empty;
  EXPECT_THAT(Refusal({empty.path().string(), "/no/such/folder"}),
              AllOf(HasSubstr("libbatten_opencascade.so"),
                    HasSubstr(empty.path().string() + ", /no/such/folder"),
                    HasSubstr("No such file or directory"),
                    HasSubstr("BATTEN_MODULES")));
}

TEST(OpenCascadeModuleTest, OfAFileThatIsThereItIsSaidWhyItDoesNotLoad) {
  const TemporaryFolder folder;
  folder.With("libbatten_opencascade.so", "no module");
  EXPECT_THAT(Refusal({"/no/such/folder", folder.path().string(), "/nor/this"}),
              HasSubstr(folder.path().string() + "/libbatten_opencascade.so: file too short"));
}

TEST(OpenCascadeModuleTest, TheVariableIsLookedAtFirst) {
  const char* const before = std::getenv("BATTEN_MODULES");
  const std::string value = before != nullptr ? before : "";
  setenv("BATTEN_MODULES", "/mine", 1);
  EXPECT_EQ(OpenCascadeFolders().front(), "/mine");
  setenv("BATTEN_MODULES", "", 1);
  EXPECT_NE(OpenCascadeFolders().front(), "");
  if (before != nullptr) {
    setenv("BATTEN_MODULES", value.c_str(), 1);
  } else {
    unsetenv("BATTEN_MODULES");
  }
}

TEST(OpenCascadeModuleTest, ThreadsThatAskAtOnceGetOneTable) {
  constexpr std::size_t kThreads = 8;
  std::vector<const OpenCascadeFunctions*> found(kThreads);
  std::vector<std::thread> threads;
  for (auto& one : found) threads.emplace_back([&one] { one = &OpenCascade(); });
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(std::set(found.begin(), found.end()).size(), 1u);
  EXPECT_NE(found.front(), nullptr);
}

}  // namespace batten::internal::opencascade_module_test
