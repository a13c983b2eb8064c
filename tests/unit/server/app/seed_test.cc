#include "server/seed.h"

#include <gtest/gtest.h>

#include "tests/support/fake_store.h"
#include "tests/support/manual_clock.h"
#include "tests/support/switched_reader.h"

namespace uplink {
namespace {

class SeedTest : public ::testing::Test {
 protected:
  void Know(const std::string& ruri) {
    const storage::OpenRequest request{
        std::make_shared<const model::RobotId>(model::RobotId{ruri, "f"}),
        model::SessionId({1}),
        0,
        clock_.System(),
        {}};
    ASSERT_TRUE(store_.OpenStreams({&request, 1}).ok());
  }

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeStore store_{database_, storage::ProcessId{1}};
  testing::SwitchedReader reader_{store_};
  metrics::Ledger ledger_;
  journal::JournalProbe probe_;
  fleet::Fleet fleet_{clock_, 2, {}};
  journal::Journal journal_{store_, {}, clock_, ledger_, probe_, storage::ProcessId{1}};
  journal::Shards journals_{{&journal_}};
  Seed seed_{fleet_, journals_, reader_, clock_};
};

TEST_F(SeedTest, TakesTheRobotsOfTheStore) {
  Know("rcan://a");
  EXPECT_FALSE(seed_.done());
  EXPECT_TRUE(seed_.Run(2).ok());
  EXPECT_TRUE(seed_.done());
  EXPECT_EQ(fleet_.size(), 1U);
}

TEST_F(SeedTest, CanBeRunAgainWhileTheStoreIsAway) {
  Know("rcan://a");
  reader_.SetAway(true);
  EXPECT_FALSE(seed_.Run(2).ok());
  EXPECT_FALSE(seed_.done());
  EXPECT_EQ(fleet_.size(), 0U);
  reader_.SetAway(false);
  EXPECT_TRUE(seed_.Run(2).ok());
  EXPECT_EQ(fleet_.size(), 1U);
}

TEST_F(SeedTest, ARobotThatHasComeByItselfStaysAsItIs) {
  Know("rcan://a");
  ASSERT_TRUE(fleet_.FindOrAdmit({"rcan://a", "another"}).ok());
  EXPECT_TRUE(seed_.Run(2).ok());
  EXPECT_EQ(fleet_.Find("rcan://a")->id()->fleet, "another");
}

TEST_F(SeedTest, MoreRobotsThanThereMayBeAreAnError) {
  for (const char* ruri : {"rcan://a", "rcan://b"}) Know(ruri);
  ASSERT_TRUE(fleet_.FindOrAdmit({"rcan://c", "f"}).ok());
  EXPECT_FALSE(seed_.Run(2).ok());
  EXPECT_TRUE(seed_.done()) << "trying again would change nothing";
}

}  // namespace
}  // namespace uplink
