#include "server/health/memory_limit.h"

#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/temp_folder.h"

namespace uplink::health {
namespace {

constexpr std::size_t kMiB = std::size_t{1} << 20;
constexpr std::size_t kMachine = 8192 * kMiB;

/// A tree of control groups as the kernel shows it, in a folder of its own.
class MemoryLimitTest : public ::testing::Test {
 protected:
  void Write(const std::string& name, const std::string& text) const {
    std::filesystem::create_directories(std::filesystem::path(folder_.File(name)).parent_path());
    std::ofstream(folder_.File(name)) << text;
  }
  void Limit(const std::string& name, std::size_t bytes) const {
    Write(name, std::to_string(bytes) + "\n");
  }
  /// Which group the process is in, and where the hierarchy is mounted from its group `root` on.
  void Version2(const std::string& group, const std::string& root = "/") const {
    Write("cgroup", "0::" + group + "\n");
    Write("mountinfo", "20 1 0:4 / /proc rw - proc proc rw\n31 23 0:28 " + root + " " +
                           folder_.File("fs") + " rw,relatime shared:9 - cgroup2 cgroup2 rw\n");
  }
  void Version1(const std::string& group) const {
    Write("cgroup", "4:cpu,memory:" + group + "\n1:name=systemd:/other\n0::/other\n");
    Write("mountinfo", "31 23 0:28 / " + folder_.File("cpu") + " rw - cgroup cgroup rw,cpu\n" +
                           "32 23 0:29 / " + folder_.File("fs") +
                           " rw - cgroup cgroup rw,memory\n");
  }
  [[nodiscard]] std::size_t Read() const {
    return MemoryLimit({folder_.File("cgroup"), folder_.File("mountinfo")}, kMachine);
  }

  testing::TempFolder folder_;
};

TEST_F(MemoryLimitTest, IsThatOfTheProcessesOwnGroup) {
  Version2("/system.slice/uplinkd.service");
  Write("fs/memory.max", "max\n");
  Limit("fs/system.slice/other.service/memory.max", 1 * kMiB);
  Limit("fs/system.slice/uplinkd.service/memory.max", 512 * kMiB);
  EXPECT_EQ(Read(), 512 * kMiB);
}

TEST_F(MemoryLimitTest, IsTheLeastOfAllGroupsAbove) {
  Version2("/system.slice/uplinkd.service");
  Limit("fs/system.slice/uplinkd.service/memory.max", 512 * kMiB);
  Limit("fs/system.slice/memory.max", 300 * kMiB);
  EXPECT_EQ(Read(), 300 * kMiB);
  Limit("fs/memory.max", 200 * kMiB);
  EXPECT_EQ(Read(), 200 * kMiB);
}

TEST_F(MemoryLimitTest, OfAContainerIsThatOfWhatIsMounted) {
  Version2("/");
  Limit("fs/memory.max", 256 * kMiB);
  EXPECT_EQ(Read(), 256 * kMiB);
  Version2("/docker/0a1b", "/docker/0a1b");  // it sees the host's name of its group
  EXPECT_EQ(Read(), 256 * kMiB);
  Version2("/docker/0a1b/worker", "/docker/0a1b");
  Limit("fs/worker/memory.max", 128 * kMiB);
  EXPECT_EQ(Read(), 128 * kMiB);
  Version2("/../elsewhere");
  EXPECT_EQ(Read(), 256 * kMiB);
  Version2("/docker/0a1bc", "/docker/0a1b");
  EXPECT_EQ(Read(), 256 * kMiB) << "another group whose name begins alike";
}

TEST_F(MemoryLimitTest, OfVersionOneIsThatOfItsMemoryController) {
  Version1("/docker/0a1b");
  Limit("cpu/docker/0a1b/memory.limit_in_bytes", 1 * kMiB);
  Write("fs/docker/memory.limit_in_bytes", "9223372036854771712\n");  // its word for none
  EXPECT_EQ(Read(), kMachine);
  Limit("fs/docker/0a1b/memory.limit_in_bytes", 512 * kMiB);
  EXPECT_EQ(Read(), 512 * kMiB);
}

TEST_F(MemoryLimitTest, IsNeverMoreThanTheMachineHas) {
  Version2("/a");
  Limit("fs/a/memory.max", 2 * kMachine);
  EXPECT_EQ(Read(), kMachine);
}

TEST_F(MemoryLimitTest, WhatCannotBeReadIsNoLimit) {
  EXPECT_EQ(Read(), kMachine);
  Version2("/a");
  EXPECT_EQ(Read(), kMachine);
  for (const char* text : {"", "max\n", "0\n", "-1\n", "999999999999999999999999\n"}) {
    Write("fs/a/memory.max", text);
    EXPECT_EQ(Read(), kMachine) << text;
  }
  Write("cgroup", "nonsense\n:\n0:\n");
  Write("mountinfo", "nonsense - cgroup2\n - \n31 23\n");
  EXPECT_EQ(Read(), kMachine);
}

TEST_F(MemoryLimitTest, FoldersWithBlanksAreFound) {
  Write("cgroup", "0::/a\n");
  Write("mountinfo", "31 23 0:28 / " + folder_.path() + "/with\\040blank rw - cgroup2 c rw\n");
  Limit("with blank/a/memory.max", 64 * kMiB);
  EXPECT_EQ(Read(), 64 * kMiB);
}

}  // namespace
}  // namespace uplink::health
