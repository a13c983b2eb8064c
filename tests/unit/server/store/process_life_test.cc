#include "server/store/process_life.h"

#include <array>
#include <fstream>
#include <string>

#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

namespace uplink::store {
namespace {

/// The life of this process, as another one beside it would have it.
std::string LifeOf(pid_t process, const std::string& start) {
  std::string life = LifeOfThisProcess();
  for (int i = 0; i < 2; ++i) life.erase(life.rfind('/'));
  return life + "/" + std::to_string(process) + "/" + start;
}

/// The 22nd field of /proc/PID/stat; no name of these processes has a space.
std::string StartOf(pid_t process) {
  std::ifstream stat("/proc/" + std::to_string(process) + "/stat");
  std::string field;
  for (int i = 0; i < 22; ++i) stat >> field;
  return field;
}

TEST(ProcessLife, IsTheSameAtEachCallAndNotGone) {
  EXPECT_FALSE(LifeOfThisProcess().empty());
  EXPECT_EQ(LifeOfThisProcess(), LifeOfThisProcess());
  EXPECT_FALSE(IsGone(LifeOfThisProcess()));
}

TEST(ProcessLife, TheBootHasOneNameWhoeverTells) {
  EXPECT_EQ(BootId("0b6a-11", ""), "0b6a11");
  EXPECT_EQ(BootId("0b6a-11", "ffff"), "0b6a11") << "the kernel knows best";
  EXPECT_EQ(BootId("", "0b6a11"), "0b6a11") << "/proc hides it";
  EXPECT_EQ(BootId("", ""), "");
}

TEST(ProcessLife, AProcessThatEndedIsGone) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ASSERT_GT(child, 0);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  EXPECT_TRUE(IsGone(LifeOf(child, "1")));
}

TEST(ProcessLife, AProcessThatEndedAndWasNotWaitedForIsGone) {
  const pid_t child = ::fork();
  if (child == 0) ::_exit(0);
  ASSERT_GT(child, 0);
  siginfo_t ended{};
  ASSERT_EQ(::waitid(P_PID, static_cast<id_t>(child), &ended, WEXITED | WNOWAIT), 0);
  EXPECT_TRUE(IsGone(LifeOf(child, StartOf(child))));
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
}

TEST(ProcessLife, AProcessBesideThisOneIsSeen) {
  std::array<int, 2> pipe{};
  ASSERT_EQ(::pipe(pipe.data()), 0);
  const pid_t child = ::fork();
  if (child == 0) {
    char byte = 0;
    ::close(pipe[1]);
    ::_exit(static_cast<int>(::read(pipe[0], &byte, 1)));
  }
  ASSERT_GT(child, 0);
  EXPECT_FALSE(IsGone(LifeOf(child, StartOf(child))));
  ::close(pipe[1]);
  ASSERT_EQ(::waitpid(child, nullptr, 0), child);
  ::close(pipe[0]);
}

TEST(ProcessLife, AnotherProcessOfTheSameNumberIsNotIt) {
  EXPECT_TRUE(IsGone(LifeOf(::getpid(), "1"))) << "it started at another time";
}

TEST(ProcessLife, WhatCannotBeSeenFromHereIsNotGone) {
  for (const char* life : {"", "/", "elsewhere/pid:[1]/1/1", "a/b/c/d"}) {
    EXPECT_FALSE(IsGone(life)) << life;
  }
  const std::string here = LifeOfThisProcess();
  EXPECT_FALSE(IsGone(here.substr(0, here.rfind('/')))) << "cut short";
  const std::string gone = LifeOf(::getpid(), "1");
  ASSERT_TRUE(IsGone(gone));
  std::string other_boot = gone;
  other_boot[0] = other_boot[0] == '0' ? '1' : '0';
  EXPECT_FALSE(IsGone(other_boot)) << "another boot";
  std::string no_number = LifeOf(1, "1");
  no_number.replace(no_number.rfind("/1/1"), 4, "/../1");
  EXPECT_FALSE(IsGone(no_number));
}

TEST(ProcessLife, TheMachineHasAName) { EXPECT_FALSE(HostName().empty()); }

}  // namespace
}  // namespace uplink::store
