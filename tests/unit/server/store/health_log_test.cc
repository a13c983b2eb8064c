#include "server/store/health_log.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::store {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class HealthLogTest : public ::testing::Test {
 protected:
  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  storage::StoreFacts facts_;
  absl::Status retention_;
  absl::Status checkpoints_;
  absl::Status store_;
  std::vector<journal::WentBack> went_back_;
  HealthLog health_log_{{.facts = [this] { return facts_; },
                         .retention = [this] { return retention_; },
                         .checkpoints = [this] { return checkpoints_; },
                         .store = [this] { return store_; },
                         .went_back = [this] { return std::exchange(went_back_, {}); }},
                        logger_};
};

TEST_F(HealthLogTest, AStoreThatWorksMakesNoLine) {
  health_log_.LookAtFacts();
  health_log_.Look();
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(HealthLogTest, TellsOnceThatSomethingFailsAndOnceThatItWorksAgain) {
  store_ = absl::UnavailableError("gone");
  health_log_.Look();
  health_log_.Look();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_fails why=gone")));
  store_ = absl::OkStatus();
  health_log_.Look();
  health_log_.Look();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_fails"), HasSubstr("store_works_again")));
}

TEST_F(HealthLogTest, RetentionAndCheckpointsHaveTurnsOfTheirOwn) {
  retention_ = absl::InternalError("a");
  checkpoints_ = absl::InternalError("b");
  health_log_.Look();
  EXPECT_THAT(lines_,
              ElementsAre(HasSubstr("retention_fails why=a"), HasSubstr("checkpoint_fails why=b")));
  lines_.clear();
  retention_ = absl::OkStatus();
  health_log_.Look();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("retention_works_again")));
  lines_.clear();
  checkpoints_ = absl::OkStatus();
  health_log_.Look();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("checkpoint_works_again")));
}

TEST_F(HealthLogTest, TellsOnceThatAnOldSnapshotIsThereAndOnceThatItIsGone) {
  facts_.oldest_snapshot = storage::kOldSnapshot;
  health_log_.Look();
  EXPECT_THAT(lines_, IsEmpty());
  facts_.oldest_snapshot += milliseconds(1);
  health_log_.Look();
  health_log_.Look();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_old_snapshot")));
  facts_.oldest_snapshot = milliseconds(0);
  health_log_.Look();
  health_log_.Look();
  EXPECT_THAT(lines_,
              ElementsAre(HasSubstr("store_old_snapshot"), HasSubstr("store_old_snapshot_gone")));
}

TEST_F(HealthLogTest, TellsPerShardOfHowManyRobotsTheStoreWentBackAndNamesTheFirst) {
  went_back_ = {{.shard = 1, .robots = 2, .named = {"rcan://a", "rcan://b"}},
                {.shard = 3, .robots = 9, .named = {"rcan://c"}}};
  health_log_.Look();
  health_log_.Look();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr(R"(shard=1 robots=2 named="rcan://a rcan://b")"),
                                  HasSubstr("shard=3 robots=9 named=rcan://c")));
}

TEST_F(HealthLogTest, TellsOnceThatTheStoreIsUnsafe) {
  facts_.unsafe = true;
  health_log_.LookAtFacts();
  health_log_.Look();
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_unsafe")));
}

TEST_F(HealthLogTest, TellsOfAClockThatDiffersByMoreThanFiveSecondsEitherWay) {
  for (const milliseconds offset : {milliseconds(5001), milliseconds(-5001)}) {
    facts_.clock_offset = milliseconds(5000);
    health_log_.LookAtFacts();
    EXPECT_THAT(lines_, IsEmpty());
    facts_.clock_offset = offset;
    health_log_.LookAtFacts();
    health_log_.LookAtFacts();
    EXPECT_THAT(lines_, ElementsAre(HasSubstr("store_clock_differs offset_ms=" +
                                              std::to_string(offset.count()))));
    lines_.clear();
  }
}

}  // namespace
}  // namespace uplink::store
