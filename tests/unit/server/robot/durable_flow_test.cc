#include "server/robot/durable_flow.h"

#include <chrono>

#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using std::chrono::seconds;

class DurableFlowTest : public ::testing::Test {
 protected:
  HeldBack LookAt(std::size_t bytes) { return flow_.LookAt(bytes, limits_, clock_.Steady()).by; }
  milliseconds Wait(std::size_t bytes) {
    return std::chrono::duration_cast<milliseconds>(
        flow_.LookAt(bytes, limits_, clock_.Steady()).again - clock_.Steady());
  }
  void Take(std::size_t bytes) { flow_.Take(bytes, limits_, clock_.Steady()); }

  testing::ManualClock clock_;
  FlowLimits limits_{.records = {.rate = 10, .burst = 20}, .bytes = {.rate = 1000, .burst = 5000}};
  DurableFlow flow_;
};

TEST_F(DurableFlowTest, StopsAtTheRecordsBurst) {
  for (int i = 0; i < 20; ++i) {
    EXPECT_EQ(LookAt(1), HeldBack::kNone) << i;
    Take(1);
  }
  EXPECT_EQ(LookAt(1), HeldBack::kFlow);
  EXPECT_EQ(Wait(1), milliseconds(100));
  clock_.Advance(milliseconds(100));
  EXPECT_EQ(LookAt(1), HeldBack::kNone);
}

TEST_F(DurableFlowTest, StopsAtTheBytesBurst) {
  Take(5000);
  EXPECT_EQ(LookAt(500), HeldBack::kFlow);
  EXPECT_EQ(Wait(500), milliseconds(500));
  clock_.Advance(milliseconds(500));
  EXPECT_EQ(LookAt(500), HeldBack::kNone);
  EXPECT_EQ(LookAt(501), HeldBack::kFlow);
}

TEST_F(DurableFlowTest, AFullBucketPassesARecordThatIsLargerThanIt) {
  EXPECT_EQ(LookAt(1'000'000), HeldBack::kNone);
  Take(1'000'000);
  EXPECT_EQ(LookAt(1), HeldBack::kFlow);
}

TEST_F(DurableFlowTest, CountsItsBytes) {
  Take(70);
  Take(7);
  EXPECT_EQ(flow_.bytes_total(), 77U);
}

TEST_F(DurableFlowTest, AFullDiskStopsIt) {
  flow_.LimitForDisk(0);
  EXPECT_EQ(LookAt(1), HeldBack::kDisk);
  EXPECT_EQ(Wait(1), seconds(1)) << "until it looks again";
  flow_.LimitForDisk(std::nullopt);
  EXPECT_EQ(LookAt(1), HeldBack::kNone);
}

TEST_F(DurableFlowTest, ADiskThatIsNearlyFullSlowsIt) {
  limits_.bytes = {};
  flow_.LimitForDisk(100);
  EXPECT_EQ(LookAt(1000), HeldBack::kNone) << "ten seconds of its rate at once";
  Take(1000);
  EXPECT_EQ(LookAt(50), HeldBack::kDisk);
  EXPECT_EQ(Wait(50), milliseconds(500));
  clock_.Advance(milliseconds(500));
  EXPECT_EQ(LookAt(50), HeldBack::kNone);
  EXPECT_EQ(LookAt(5000), HeldBack::kDisk);
  EXPECT_EQ(Wait(5000), seconds(1)) << "the limit may be over sooner";
  clock_.Advance(seconds(10));
  EXPECT_EQ(LookAt(5000), HeldBack::kNone) << "never zero: a full bucket passes any record";
}

TEST_F(DurableFlowTest, ItsOwnBucketsComeFirst) {
  flow_.LimitForDisk(1'000'000);
  for (int i = 0; i < 20; ++i) Take(1);
  EXPECT_EQ(LookAt(1), HeldBack::kFlow);
}

TEST_F(DurableFlowTest, AFullDiskStopsAlsoWhatTheFlowDoesNotCount) {
  EXPECT_FALSE(flow_.disk_limits());
  flow_.LimitForDisk(10);
  EXPECT_TRUE(flow_.disk_limits());
  EXPECT_EQ(flow_.LookAtDisk(clock_.Steady()).by, HeldBack::kNone);
  flow_.LimitForDisk(0);
  EXPECT_EQ(flow_.LookAtDisk(clock_.Steady()).by, HeldBack::kDisk);
  flow_.LimitForDisk(std::nullopt);
  EXPECT_FALSE(flow_.disk_limits());
  EXPECT_EQ(flow_.LookAtDisk(clock_.Steady()).by, HeldBack::kNone);
}

TEST_F(DurableFlowTest, WhatIsKeptOfRejectionsCountsAsStored) {
  flow_.CountKept(300);
  Take(5);
  EXPECT_EQ(flow_.bytes_total(), 305U);
}

}  // namespace
}  // namespace uplink::robot
