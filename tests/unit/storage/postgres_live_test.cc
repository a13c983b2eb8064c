// Checkpoints that a server gave up, and that its database runs all the same.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/postgres/link/connection.h"
#include "storage/postgres/live_rows.h"
#include "storage/postgres/store.h"
#include "tests/support/postgres_database.h"

namespace uplink::storage::postgres {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class PostgresLiveTest : public ::testing::Test {
 protected:
  void SetUp() override {
    ConnectionOptions options;
    options.url = *ParseUrl(database_.url());
    auto connection = Connection::Open(options, clock_);
    ASSERT_TRUE(connection.ok()) << connection.status();
    connection_ = *std::move(connection);
  }
  /// The epoch since which the process holds the robot then.
  Epoch Open(const ProcessId& process) {
    StoreOptions options;
    options.url = database_.url();
    options.process = process;
    auto store = PostgresStore::Open(std::move(options), clock_);
    EXPECT_TRUE(store.ok()) << store.status();
    const OpenRequest request{robot_, model::SessionId({7}), 0, clock_.System(), {}};
    const auto opened = (*store)->OpenStreams({&request, 1});
    EXPECT_TRUE(opened.ok()) << opened.status();
    return opened.ok() ? opened->front().held_since : 0;
  }
  /// The places that were passed over.
  std::vector<std::size_t> Write(const LiveWriter& writer, Epoch held_since,
                                 const std::string& motion) {
    LiveRow row{.ruri = robot_->ruri, .held_since = held_since};
    row.parts[static_cast<std::size_t>(LivePart::kMotion)] = motion;
    const auto passed_over = WriteLive(*connection_, {&row, 1}, writer, {});
    EXPECT_TRUE(passed_over.ok()) << passed_over.status();
    return passed_over.value_or(std::vector<std::size_t>());
  }
  std::string Motion() {
    const auto live = ReadLiveOf(*connection_, std::vector<std::string>{robot_->ruri});
    EXPECT_TRUE(live.ok() && live->rows.size() == 1) << live.status();
    return live.ok() && live->rows.size() == 1
               ? live->rows[0].parts[static_cast<std::size_t>(LivePart::kMotion)].value_or("")
               : "";
  }

  const SystemClock clock_{};
  testing::PostgresDatabase database_;
  std::unique_ptr<Connection> connection_;
  const RobotRef robot_ =
      std::make_shared<const model::RobotId>(model::RobotId{"rcan://robots/a", "f1"});
};

TEST_F(PostgresLiveTest, OneThatRunsLatePutsNothingOlderOverTheNext) {
  const ProcessId process{1};
  const Epoch hold = Open(process);
  EXPECT_THAT(Write({process, 2}, hold, "newer"), IsEmpty());
  EXPECT_THAT(Write({process, 1}, hold, "older"), ElementsAre(0U));
  EXPECT_EQ(Motion(), "newer");
  EXPECT_THAT(Write({process, 3}, hold, "newest"), IsEmpty());
  EXPECT_EQ(Motion(), "newest");
}

TEST_F(PostgresLiveTest, ALaterHoldCountsItsCallsAnew) {
  const ProcessId process{1};
  EXPECT_THAT(Write({process, 9}, Open(process), "first"), IsEmpty());
  const Epoch second = Open({2});
  EXPECT_THAT(Write({{2}, 1}, second, "second"), IsEmpty());
  EXPECT_EQ(Motion(), "second");
  EXPECT_THAT(Write({{2}, 9}, second - 1, "of an earlier hold"), ElementsAre(0U));
  EXPECT_EQ(Motion(), "second");
}

}  // namespace
}  // namespace uplink::storage::postgres
