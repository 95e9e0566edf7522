// Temporary files are removed with the process that created them, even if it is killed.
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "base/error.h"
#include "base/spool_file.h"
#include "base/temporary_folder.h"

namespace gradus::temporary_test {
namespace {

namespace fs = std::filesystem;

// Runs with a TMPDIR of its own.
class J1_Temporary : public ::testing::Test {
 protected:
  void SetUp() override {
    place_ = (fs::temp_directory_path() / "gradus-test-XXXXXX").string();
    ASSERT_NE(mkdtemp(place_.data()), nullptr);
    const char* const set = std::getenv("TMPDIR");
    was_set_ = set != nullptr;
    old_ = was_set_ ? set : "";
    setenv("TMPDIR", place_.c_str(), 1);
  }
  void TearDown() override {
    was_set_ ? setenv("TMPDIR", old_.c_str(), 1) : unsetenv("TMPDIR");
    fs::remove_all(place_);
  }
  size_t files() const { return size_t(std::distance(fs::directory_iterator(place_), fs::directory_iterator())); }
  std::string place_, old_;
  bool was_set_ = false;
};

TEST_F(J1_Temporary, AFolderIsRemovedWithItsOwner) {
  {
    const TemporaryFolder first, second;
    EXPECT_NE(first.path(), second.path());
    std::ofstream(fs::path(first.path()) / "file") << "text";
    EXPECT_EQ(files(), 2u);
  }
  EXPECT_EQ(files(), 0u);
}

// Regression: gigabytes of raw frames stayed on the disk.
TEST_F(J1_Temporary, AFolderOfAKilledProcessIsRemovedWhenTheNextIsMade) {
  const TemporaryFolder living;
  const pid_t child = fork();
  if (child == 0) {
    const TemporaryFolder folder;
    std::ofstream(fs::path(folder.path()) / "file") << "text";
    raise(SIGKILL);
  }
  waitpid(child, nullptr, 0);
  ASSERT_EQ(files(), 2u);
  const TemporaryFolder next;
  EXPECT_EQ(files(), 2u);
  EXPECT_TRUE(fs::exists(living.path())) << "those that live keep theirs";
}

TEST_F(J1_Temporary, ASpoolFileHasNoNameAndKeepsItsContent) {
  SpoolFile file;
  EXPECT_EQ(files(), 0u);
  file.write(1000000, "far", 3);
  file.write(0, "near", 4);
  char text[4];
  file.read(1000000, text, 3);
  EXPECT_EQ(std::string(text, 3), "far");
  file.read(1, text, 3);
  EXPECT_EQ(std::string(text, 3), "ear");
  EXPECT_THROW(file.read(1000001, text, 3), Error) << "there is less";
}

// Regression: where no more files could be opened, folders were created without end.
TEST_F(J1_Temporary, AFolderThatCannotBeOpenedIsRemovedAndNamed) {
  const int next = dup(0);
  close(next);
  rlimit before{};
  ASSERT_EQ(getrlimit(RLIMIT_NOFILE, &before), 0);
  const rlimit none_left{rlim_t(next), before.rlim_max};
  ASSERT_EQ(setrlimit(RLIMIT_NOFILE, &none_left), 0);
  std::string text;
  try {
    TemporaryFolder();
  } catch (const Error& e) {
    text = e.what();
  }
  setrlimit(RLIMIT_NOFILE, &before);
  EXPECT_EQ(text, "cannot make a temporary folder in " + place_ + ": Too many open files");
  EXPECT_EQ(files(), 0u);
}

TEST_F(J1_Temporary, AMissingPlaceIsReplacedByTheSystemsDefault) {
  setenv("TMPDIR", (place_ + "/missing").c_str(), 1);
  EXPECT_EQ(temporary_path(), "/tmp");
}

TEST_F(J1_Temporary, APlaceThatCannotBeWrittenIsNamed) {
  setenv("TMPDIR", "/proc", 1);
  const auto refusal = [](auto&& make) {
    try {
      make();
      return std::string();
    } catch (const Error& e) {
      return std::string(e.what());
    }
  };
  EXPECT_EQ(refusal([] { SpoolFile(); }).find("cannot make a temporary file in /proc: "), 0u);
  EXPECT_EQ(refusal([] { TemporaryFolder(); }).find("cannot make a temporary folder in /proc: "), 0u);
}

}  // namespace
}  // namespace gradus::temporary_test
