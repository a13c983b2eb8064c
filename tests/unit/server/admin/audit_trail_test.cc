#include "server/admin/audit_trail.h"

#include <chrono>
#include <fstream>
#include <iterator>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/admin/actions.h"
#include "server/admin/audit_rows.h"
#include "tests/support/fake_access_store.h"
#include "tests/support/fake_database.h"
#include "tests/support/fake_reader.h"
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

  /// The oldest first.
  std::vector<storage::AuditRow> Audit() {
    storage::AuditQuery query;
    query.rows.order = storage::ListOrder::kOldestFirst;
    query.rows.page_size = storage::kPageSizeMax;
    auto page = testing::FakeReader(database_).Audit(query);
    EXPECT_TRUE(page.ok()) << page.status();
    return page.ok() ? page->rows : std::vector<storage::AuditRow>();
  }

  testing::ManualClock clock_;
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  testing::FakeDatabase database_;
  testing::FakeAccessStore store_{database_};
  SharedStore shared_{store_};
  AuditTrail trail_{logger_};
};

TEST_F(AuditTrailTest, WritesWhatWaitsInItsOrder) {
  trail_.Note(Row("a"));
  trail_.Note(Row("b"));
  trail_.Flush(shared_);
  EXPECT_THAT(Audit(), ElementsAre(Field(&storage::AuditRow::target, "a"),
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
  EXPECT_THAT(Audit(), ElementsAre(Field(&storage::AuditRow::target, "a")));
}

TEST_F(AuditTrailTest, LosesTheOldestOfTooManyAndSaysSo) {
  for (std::size_t i = 0; i < kAuditWaitingMax + 3; ++i) trail_.Note(Row(std::to_string(i)));
  EXPECT_EQ(trail_.waiting(), kAuditWaitingMax);
  trail_.Flush(shared_);
  EXPECT_EQ(Audit().front().target, "3");
  EXPECT_THAT(lines_, Contains(HasSubstr("error audit_rows_lost rows=3")));
}

TEST_F(AuditTrailTest, LeavesOutRefusalsOverTheirBoundAndSaysHowMany) {
  for (int i = 0; i < kRefusedPerMinuteMax + 5; ++i) {
    storage::AuditRow row = Row("a");
    row.who = std::to_string(i);
    trail_.NoteRefused(std::move(row));
  }
  EXPECT_EQ(trail_.waiting(), static_cast<std::size_t>(kRefusedPerMinuteMax));
  clock_.Advance(std::chrono::minutes(1));
  trail_.NoteRefused(Row("b"));
  trail_.Flush(shared_);
  EXPECT_EQ(Audit().back().detail, "5 more before it. ");
}

TEST_F(AuditTrailTest, ACallerThatIsRefusedAgainAndAgainHidesNoOther) {
  storage::AuditRow noisy = Row("a");
  noisy.who = "noisy";
  for (int i = 0; i < 10 * kRefusedPerMinuteMax; ++i) trail_.NoteRefused(noisy);
  EXPECT_EQ(trail_.waiting(), kRefusedOfCallerMax);
  storage::AuditRow other = Row("b");
  other.who = "other";
  trail_.NoteRefused(other);
  EXPECT_EQ(trail_.waiting(), kRefusedOfCallerMax + 1);
  trail_.Flush(shared_);
  EXPECT_EQ(Audit().back().who, "other");
  EXPECT_EQ(Audit().back().detail, "980 more before it. ");
  clock_.Advance(std::chrono::minutes(1));
  noisy.at = clock_.System();
  trail_.NoteRefused(noisy);
  EXPECT_EQ(trail_.waiting(), 1U) << "a new minute";
}

TEST(AuditActions, ThePageHasEachOne) {
  std::ifstream page("docs/reference/audit.md");
  ASSERT_TRUE(page) << "docs/reference/audit.md cannot be read";
  const std::string text{std::istreambuf_iterator<char>(page), {}};
  for (const Action& action : kActions) {
    EXPECT_THAT(text, HasSubstr("`" + std::string(action.word) + "`"));
  }
}

TEST(AuditRows, ShowTextsOfClientsAsPrintable) {
  Asker asker = AskerOf(identity::LocalCaller(), "");
  asker.caller.name = "a\nb";
  const storage::AuditRow row =
      RowOf(asker, {.action = kRobotBlock, .detail = std::string(2'000, 'x')},
            absl::PermissionDeniedError("no"), SystemTime());
  EXPECT_EQ(row.who, "a\\x0ab");
  EXPECT_EQ(row.outcome, "PERMISSION_DENIED");
  EXPECT_EQ(row.detail.size(), storage::kAuditTextBytesMax);
}

}  // namespace
}  // namespace uplink::admin
