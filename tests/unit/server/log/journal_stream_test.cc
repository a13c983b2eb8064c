#include "server/log/journal_stream.h"

#include <string>

#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/small_pipe.h"

namespace uplink::log {
namespace {

TEST(JournalStreamTest, IsTheStreamOfThisDeviceAndInode) {
  const testing::SmallPipe pipe;
  struct stat here {};
  ASSERT_EQ(fstat(pipe.writer(), &here), 0);
  const auto named = [](std::uint64_t device, std::uint64_t inode) {
    return std::to_string(device) + ":" + std::to_string(inode);
  };
  EXPECT_TRUE(IsJournal(named(here.st_dev, here.st_ino), pipe.writer()));
  EXPECT_FALSE(IsJournal(named(here.st_dev, here.st_ino + 1), pipe.writer()));
  EXPECT_FALSE(IsJournal(named(here.st_dev + 1, here.st_ino), pipe.writer()));
  EXPECT_FALSE(IsJournal(named(here.st_dev, here.st_ino), -1));
}

TEST(JournalStreamTest, IsNoneWhereTheVariableIsNotAsSystemdWritesIt) {
  const testing::SmallPipe pipe;
  struct stat here {};
  ASSERT_EQ(fstat(pipe.writer(), &here), 0);
  const std::string good = std::to_string(here.st_dev) + ":" + std::to_string(here.st_ino);
  for (const std::string& text :
       {std::string(), std::string(":"), std::string("8"), " " + good, good + " ", good + ":",
        "-" + good, std::string("99999999999999999999:1"), std::string("a:b")}) {
    EXPECT_FALSE(IsJournal(text, pipe.writer())) << text;
  }
}

}  // namespace
}  // namespace uplink::log
