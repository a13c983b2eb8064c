#include "server/admin/audit_trail.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/admin/actions.h"
#include "server/admin/audit_rows.h"
#include "tests/support/memory_access_store.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::admin {
namespace {

using ::testing::Contains;
using ::testing::ElementsAre;
using ::testing::Field;
using ::testing::HasSubstr;
using ::testing::SizeIs;

class AuditTrailTest : public ::testing::Test {
 protected:
  storage::AuditRow Row(const std::string& target) {
    return RowOfServer("127.0.0.1:4443", {.action = kServerStart, .target = target},
                       clock_.System());
  }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  testing::MemoryAccessStore store_;
  SharedStore shared_{store_};
  AuditTrail trail_{logger_};
};

TEST_F(AuditTrailTest, WritesWhatWaitsInItsOrder) {
  trail_.Note(Row("a"));
  trail_.Note(Row("b"));
  trail_.Flush(shared_);
  EXPECT_THAT(store_.audit, ElementsAre(Field(&storage::AuditRow::target, "a"),
                                        Field(&storage::AuditRow::target, "b")));
  EXPECT_EQ(trail_.waiting(), 0U);
  EXPECT_THAT(lines_, SizeIs(2));
}

TEST_F(AuditTrailTest, KeepsWhatTheStoreRefused) {
  store_.status = absl::UnavailableError("away");
  trail_.Note(Row("a"));
  trail_.Flush(shared_);
  EXPECT_EQ(trail_.waiting(), 1U);
  store_.status = absl::OkStatus();
  trail_.Flush(shared_);
  EXPECT_THAT(store_.audit, ElementsAre(Field(&storage::AuditRow::target, "a")));
}

TEST_F(AuditTrailTest, LosesTheOldestOfTooManyAndSaysSo) {
  for (std::size_t i = 0; i < kAuditWaitingMax + 3; ++i) trail_.Note(Row(std::to_string(i)));
  EXPECT_EQ(trail_.waiting(), kAuditWaitingMax);
  trail_.Flush(shared_);
  EXPECT_EQ(store_.audit.front().target, "3");
  EXPECT_THAT(lines_, Contains(HasSubstr("error audit_rows_lost rows=3")));
}

TEST(AuditRows, ShowTextsOfClientsAsPrintable) {
  Asker asker = AskerOf(identity::LocalCaller(), "");
  asker.caller.name = "a\nb";
  const storage::AuditRow row =
      RowOf(asker, {.action = kRobotBlock, .detail = std::string(2'000, 'x')},
            absl::PermissionDeniedError("no"), SystemTime());
  EXPECT_EQ(row.who, "a\\x0Ab");
  EXPECT_EQ(row.outcome, "PERMISSION_DENIED");
  EXPECT_EQ(row.detail.size(), storage::kAuditTextBytesMax);
}

}  // namespace
}  // namespace uplink::admin
