// Checkpoints that a server gave up, and that its database runs all the same.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "storage/postgres/link/connection.h"
#include "storage/postgres/live_rows.h"
#include "tests/unit/storage/postgres_fixture.h"

namespace uplink::storage::postgres {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

class PostgresLiveTest : public PostgresFixture {
 protected:
  void SetUp() override { connection_ = Connect(); }
  /// The epoch since which the process holds the robot then.
  Epoch Open(const ProcessId& process) {
    return PostgresFixture::Open(*Store(process.front())).held_since;
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

  std::unique_ptr<Connection> connection_;
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
