#include "server/journal/writer.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/eventually.h"
#include "tests/unit/server/journal/journal_bench.h"

namespace uplink::journal {
namespace {

using ::testing::ElementsAre;
using testing::Eventually;
using testing::kPatience;

constexpr BackoffLimits kBackoff{.first = milliseconds(2), .longest = milliseconds(4)};

std::uint64_t AlwaysSeven() { return 7; }

class JournalWriterTest : public ::testing::Test {
 protected:
  JournalBench bench_;
  RecordingClient robot_{"rcan://bench/1"};
};

TEST_F(JournalWriterTest, CommitsWhatComes) {
  JournalWriter writer(bench_.journal, kBackoff, AlwaysSeven);
  bench_.Open(robot_);
  bench_.Append(robot_, 1);
  EXPECT_TRUE(Eventually([this] { return bench_.journal.idle(); }));
  bench_.Append(robot_, 2);
  EXPECT_TRUE(Eventually([this] { return bench_.journal.idle(); }));
  EXPECT_THAT(bench_.Stored(robot_), ElementsAre(1, 2));
}

TEST_F(JournalWriterTest, WhatGathersDuringACommitIsTheNextBatch) {
  bench_.Open(robot_);
  bench_.Run();
  bench_.store.Block();
  JournalWriter writer(bench_.journal, kBackoff, AlwaysSeven);
  bench_.Append(robot_, 1);
  ASSERT_TRUE(bench_.store.WaitUntilBlocked(kPatience));
  for (model::Seq seq = 2; seq <= 20; ++seq) bench_.Append(robot_, seq);
  bench_.store.Release();
  EXPECT_TRUE(Eventually([this] { return bench_.journal.idle(); }));
  EXPECT_EQ(bench_.store.commits(), 2U);
}

TEST_F(JournalWriterTest, TriesAgainUntilTheStoreIsBack) {
  bench_.store.FailNext(3, testing::FailAt::kBefore);
  JournalWriter writer(bench_.journal, kBackoff, AlwaysSeven);
  bench_.Open(robot_);
  bench_.Append(robot_, 1);
  EXPECT_TRUE(Eventually([this] { return bench_.journal.idle(); }));
  EXPECT_EQ(bench_.probe.store_errors.value(), 3);
  EXPECT_THAT(bench_.Stored(robot_), ElementsAre(1));
}

TEST_F(JournalWriterTest, StopsWhileItWaitsForWork) {
  JournalWriter writer(bench_.journal, kBackoff, AlwaysSeven);
  writer.Stop();
  writer.Stop();
  bench_.Open(robot_);
  EXPECT_FALSE(bench_.journal.idle());
}

TEST_F(JournalWriterTest, StopsInTheMiddleOfALongPause) {
  bench_.store.FailNext(1'000'000, testing::FailAt::kBefore);
  const BackoffLimits hours{.first = std::chrono::hours(5), .longest = std::chrono::hours(5)};
  JournalWriter writer(bench_.journal, hours, AlwaysSeven);
  bench_.Open(robot_);
  ASSERT_TRUE(Eventually([this] { return bench_.probe.store_errors.value() > 0; }));
  writer.Stop();
  EXPECT_FALSE(bench_.journal.idle()) << "what is not committed stays";
}

TEST_F(JournalWriterTest, StopsAfterTheCallThatIsUnderWay) {
  bench_.Open(robot_);
  bench_.Run();
  bench_.store.Block();
  {
    JournalWriter writer(bench_.journal, kBackoff, AlwaysSeven);
    bench_.Append(robot_, 1);
    ASSERT_TRUE(bench_.store.WaitUntilBlocked(kPatience));
    bench_.store.Release();
  }
  EXPECT_THAT(bench_.Stored(robot_), ElementsAre(1));
}

}  // namespace
}  // namespace uplink::journal
