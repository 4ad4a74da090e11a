// SPDX-License-Identifier: MIT
#include "batten/io/atomic_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <stdexcept>
#include <string>

#include "batten/io/read_error.h"
#include "temporary_folder.h"

namespace batten::internal::atomic_file_test {

using ::testing::HasSubstr;

TEST(AtomicFileTest, ShowsTheWholeTextAfterCommit) {
  const TemporaryFolder folder;
  const std::string text(3'000'000, 'x');
  AtomicFile file(folder.File("a.txt"));
  file.Write(text);
  file.Write("end");
  file.Commit();
  EXPECT_EQ(folder.Text("a.txt"), text + "end");
  EXPECT_EQ(folder.Entries(), 1);
}

TEST(AtomicFileTest, LeavesNothingWithoutCommit) {
  const TemporaryFolder folder;
  {
    AtomicFile file(folder.File("a.txt"));
    file.Write(std::string(3'000'000, 'x'));
    EXPECT_FALSE(std::filesystem::exists(folder.File("a.txt")));
  }
  EXPECT_EQ(folder.Entries(), 0);
}

TEST(AtomicFileTest, LeavesAnOldTargetUntouchedWithoutCommit) {
  const TemporaryFolder folder;
  folder.With("a.txt", "old");
  { AtomicFile(folder.File("a.txt")).Write("new"); }
  EXPECT_EQ(folder.Text("a.txt"), "old");
  EXPECT_EQ(folder.Entries(), 1);
}

TEST(AtomicFileTest, ReplacesAnOldTargetOnCommit) {
  const TemporaryFolder folder;
  folder.With("a.txt", "a much longer old text");
  AtomicFile file(folder.File("a.txt"));
  file.Write("new");
  EXPECT_EQ(folder.Text("a.txt"), "a much longer old text");
  file.Commit();
  EXPECT_EQ(folder.Text("a.txt"), "new");
}

TEST(AtomicFileTest, KeepsTheTargetsExtensionInItsTemporaryName) {
  const TemporaryFolder folder;
  const AtomicFile file(folder.File("a.step"));
  const std::filesystem::path temporary = file.temporary_path();
  EXPECT_EQ(temporary.extension(), ".step");
  EXPECT_EQ(temporary.parent_path(), folder.path());
  EXPECT_TRUE(std::filesystem::exists(temporary));
}

TEST(AtomicFileTest, RefusesADirectoryAsItsTarget) {
  const TemporaryFolder folder;
  try {
    AtomicFile file(folder.path().string());
    FAIL() << "nothing was thrown";
  } catch (const WriteError& error) {
    EXPECT_THAT(error.what(), HasSubstr(folder.path().string()));
    EXPECT_THAT(error.what(), HasSubstr("directory"));
  }
}

TEST(AtomicFileTest, RefusesAFolderThatDoesNotExist) {
  const TemporaryFolder folder;
  EXPECT_THROW(AtomicFile(folder.File("missing/a.txt")), WriteError);
  EXPECT_EQ(folder.Entries(), 0);
}

TEST(AtomicFileTest, RefusesAFolderThatCanNotBeWritten) {
  EXPECT_THROW(AtomicFile("/proc/a.txt"), WriteError);  // not even by root
  if (::geteuid() == 0) return;
  const TemporaryFolder folder;
  std::filesystem::permissions(folder.path(), std::filesystem::perms::owner_read);
  EXPECT_THROW(AtomicFile(folder.File("a.txt")), WriteError);
}

TEST(AtomicFileTest, RefusesANameTooLongForTheFileSystem) {
  const TemporaryFolder folder;
  try {
    AtomicFile file(folder.File(std::string(300, 'a') + ".txt"));
    FAIL() << "nothing was thrown";
  } catch (const WriteError& error) {
    EXPECT_THAT(error.what(), HasSubstr("can't be written: File name too long"));
  }
  EXPECT_EQ(folder.Entries(), 0);
}

TEST(OutputBatchTest, FilesAppearTogether) {
  const TemporaryFolder folder;
  {
    OutputBatch batch;
    for (const char* const name : {"a.txt", "b.txt"}) {
      AtomicFile file(folder.File(name));
      file.Write(name);
      file.Commit();
    }
    EXPECT_FALSE(std::filesystem::exists(folder.File("a.txt")));
    OutputBatch::Commit();
    EXPECT_EQ(folder.Text("a.txt"), "a.txt");
    EXPECT_EQ(folder.Text("b.txt"), "b.txt");
  }
  EXPECT_EQ(folder.Entries(), 2);
}

TEST(OutputBatchTest, LeavesNothingWithoutCommit) {
  const TemporaryFolder folder;
  folder.With("b.txt", "old");
  {
    const OutputBatch batch;
    for (const char* const name : {"a.txt", "b.txt"}) {
      AtomicFile file(folder.File(name));
      file.Write(name);
      file.Commit();
    }
    EXPECT_THROW(OutputBatch(), std::logic_error);
  }
  EXPECT_EQ(folder.Text("b.txt"), "old");
  EXPECT_EQ(folder.Entries(), 1);
  AtomicFile after(folder.File("a.txt"));
  after.Commit();
  EXPECT_EQ(folder.Entries(), 2);
}

}  // namespace batten::internal::atomic_file_test
