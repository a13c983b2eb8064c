#include "server/robot/session_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/robot/limits.h"
#include "tests/support/manual_clock.h"

namespace uplink::robot {
namespace {

using ::testing::ElementsAre;
using ::testing::SizeIs;

model::SessionId Id(std::uint8_t number) { return model::SessionId({number}); }

class SessionTableTest : public ::testing::Test {
 protected:
  void Fill() {
    for (std::uint8_t number = 1; number <= kSessionsMax; ++number) {
      clock_.Advance(std::chrono::seconds(1));
      table_.FindOrCreate(Id(number))->last_used = clock_.Steady();
    }
  }

  testing::ManualClock clock_;
  SessionTable table_;
};

TEST_F(SessionTableTest, FindsWhatItCreated) {
  EXPECT_EQ(table_.Find(Id(1)), nullptr);
  SessionMemory* memory = table_.FindOrCreate(Id(1));
  EXPECT_EQ(table_.Find(Id(1)), memory);
  EXPECT_EQ(table_.FindOrCreate(Id(1)), memory);
  EXPECT_THAT(table_.Ids(), ElementsAre(Id(1)));
}

TEST_F(SessionTableTest, OneTooManyForgetsTheLeastRecentlyUsedIdleOne) {
  Fill();
  EXPECT_EQ(table_.Find(Id(1))->numbers.AddWaiting(1), 1U);
  EXPECT_NE(table_.FindOrCreate(Id(100)), nullptr);
  EXPECT_THAT(table_.Ids(), SizeIs(kSessionsMax));
  EXPECT_NE(table_.Find(Id(1)), nullptr) << "it waits for a commit";
  EXPECT_EQ(table_.Find(Id(2)), nullptr);
}

TEST_F(SessionTableTest, ThereIsNoRoomWhileAllWait) {
  Fill();
  for (const model::SessionId& id : table_.Ids()) {
    EXPECT_EQ(table_.Find(id)->numbers.AddWaiting(1), 1U);
  }
  EXPECT_EQ(table_.waiting(), kSessionsMax);
  EXPECT_EQ(table_.FindOrCreate(Id(100)), nullptr);
  table_.Clear();
  EXPECT_EQ(table_.waiting(), 0U);
  EXPECT_NE(table_.FindOrCreate(Id(100)), nullptr);
}

TEST_F(SessionTableTest, ForgetsWhatIsIdleAndNotInUse) {
  for (std::uint8_t number = 1; number <= 3; ++number) {
    table_.FindOrCreate(Id(number))->last_used = clock_.Steady();
  }
  EXPECT_EQ(table_.Find(Id(1))->numbers.AddWaiting(1), 1U);
  clock_.Advance(std::chrono::hours(1));
  table_.ForgetIdle(clock_.Steady(), std::chrono::hours(1), Id(2));
  EXPECT_THAT(table_.Ids(), SizeIs(3)) << "idle for just the limit";
  clock_.Advance(std::chrono::seconds(1));
  table_.ForgetIdle(clock_.Steady(), std::chrono::hours(1), Id(2));
  EXPECT_THAT(table_.Ids(), ElementsAre(Id(1), Id(2)));
}

}  // namespace
}  // namespace uplink::robot
