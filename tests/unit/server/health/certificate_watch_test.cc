#include "server/health/certificate_watch.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/fake_store.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::health {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

class CertificateWatchTest : public ::testing::Test {
 protected:
  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeStore store_{database_, storage::ProcessId{1}};
  metrics::Ledger ledger_;
  journal::JournalProbe journal_probe_;
  session::SessionProbe sessions_;
  fleet::Fleet fleet_{clock_, 5, {}};
  journal::Journal journal_{store_, {}, clock_, ledger_, journal_probe_, storage::ProcessId{1}};
  journal::Shards shards_{{&journal_}};
  Monitor monitor_{{clock_, fleet_, shards_, journal_probe_, sessions_, {}, clock_.System()}};
  std::vector<std::string> lines_;
  log::Logger logger_{std::make_unique<testing::KeptLines>(lines_), clock_, log::Format::kText,
                      log::Level::kInfo};
  CertificateWatch watch_{monitor_, logger_};
};

TEST_F(CertificateWatchTest, FollowsTheExpiryWithoutALine) {
  const SystemTime later = clock_.System() + std::chrono::hours(24);
  watch_.OnLook(later, absl::OkStatus());
  EXPECT_EQ(UnixMs(monitor_.certificate_expiry()), UnixMs(later));
  EXPECT_THAT(lines_, IsEmpty());
}

TEST_F(CertificateWatchTest, TellsOnceThatTheFilesDoNotFitAndOnceThatTheyFitAgain) {
  for (int look = 0; look < 2; ++look) {
    watch_.OnLook(clock_.System(), absl::FailedPreconditionError("no key"));
  }
  for (int look = 0; look < 2; ++look) watch_.OnLook(clock_.System(), absl::OkStatus());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("certificate_mismatch why=\"no key\""),
                                  HasSubstr("certificate_fits_again")));
}

}  // namespace
}  // namespace uplink::health
