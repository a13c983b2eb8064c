#include "schema/base/write_all.h"

#include <csignal>
#include <thread>

#include <gtest/gtest.h>
#include <sys/eventfd.h>

#include "tests/support/small_pipe.h"

namespace uplink {
namespace {

using testing::SmallPipe;

constexpr WriteWait kNoWait{.room = milliseconds(0), .stop = -1};

TEST(WriteAllTest, WritesWhatFits) {
  SmallPipe pipe;
  EXPECT_EQ(WriteAll(pipe.writer(), "one\n", kNoWait), Written::kAll);
  EXPECT_EQ(WriteAll(pipe.writer(), "", kNoWait), Written::kAll);
  EXPECT_EQ(pipe.ReadUntil("\n"), "one\n");
}

TEST(WriteAllTest, WaitsForAReaderNoLongerThanItMay) {
  const SmallPipe pipe;
  pipe.Fill();
  EXPECT_EQ(WriteAll(pipe.writer(), "x", {.room = milliseconds(20), .stop = -1}), Written::kLate);
  EXPECT_EQ(fcntl(pipe.writer(), F_GETFL) & O_NONBLOCK, 0) << "others share the descriptor";
}

TEST(WriteAllTest, IsLateInTheMiddleOfWhatIsLongerThanThePipe) {
  const SmallPipe pipe;
  const std::string text(SmallPipe::kBytes + 1, 'x');
  EXPECT_EQ(WriteAll(pipe.writer(), text, {.room = milliseconds(20), .stop = -1}), Written::kLate);
}

TEST(WriteAllTest, GoesOnOnceThereIsRoom) {
  SmallPipe pipe;
  pipe.Fill();
  Written written = Written::kFailed;
  std::jthread writer([&] {
    written = WriteAll(pipe.writer(), std::string(3 * SmallPipe::kBytes, 'x') + "end", {});
  });
  pipe.ReadUntil("end");
  writer.join();
  EXPECT_EQ(written, Written::kAll);
}

TEST(WriteAllTest, EndsWhenItIsStoppedThoughThereIsRoom) {
  const SmallPipe pipe;
  const int stop = eventfd(1, EFD_CLOEXEC);
  EXPECT_EQ(WriteAll(pipe.writer(), "x", {.room = std::nullopt, .stop = stop}), Written::kStopped);
  close(stop);
}

TEST(WriteAllTest, FailsWhereNobodyCanReadAnyMore) {
  const auto before = std::signal(SIGPIPE, SIG_IGN);
  SmallPipe pipe;
  pipe.CloseReader();
  EXPECT_EQ(WriteAll(pipe.writer(), "x", {}), Written::kFailed);
  EXPECT_EQ(WriteAll(-1, "x", kNoWait), Written::kLate) << "poll passes over it";
  EXPECT_EQ(WriteAll(1 << 20, "x", {}), Written::kFailed) << "no such descriptor";
  const int full_disk = open("/dev/full", O_WRONLY | O_CLOEXEC);
  EXPECT_EQ(WriteAll(full_disk, "x", {}), Written::kFailed);
  close(full_disk);
  std::signal(SIGPIPE, before);
}

}  // namespace
}  // namespace uplink
