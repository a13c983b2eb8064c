#include "server/health/certificate_watch.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/health/readiness.h"
#include "server/identity/expiry.h"
#include "tests/support/fake_store.h"
#include "tests/support/kept_lines.h"
#include "tests/support/manual_clock.h"

namespace uplink::health {
namespace {

using ::testing::_;
using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::SizeIs;

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
  identity::ServedPems served_{.expiry = clock_.System() + 2 * kCertificateNotice,
                               .certificate_sha256 = "aa",
                               .client_ca_sha256 = "bb",
                               .authorities = 1};
};

TEST_F(CertificateWatchTest, TellsOnceWhatIsServedAndEachTimeThatItChanges) {
  for (int look = 0; look < 2; ++look) watch_.OnLook(served_, absl::OkStatus());
  EXPECT_EQ(UnixMs(monitor_.certificate_expiry()), UnixMs(served_.expiry));
  // As with a new key whose certificate ends at the same time.
  served_.certificate_sha256 = "cc";
  watch_.OnLook(served_, absl::OkStatus());
  served_.client_ca_sha256 = "dd";
  served_.authorities = 2;
  watch_.OnLook(served_, absl::OkStatus());
  EXPECT_THAT(lines_, ElementsAre(AllOf(HasSubstr("info certificates_served expires=20"),
                                        HasSubstr("authorities=1 certificate_sha256=aa"
                                                  " client_ca_sha256=bb")),
                                  HasSubstr("authorities=1 certificate_sha256=cc"),
                                  HasSubstr("authorities=2 certificate_sha256=cc"
                                            " client_ca_sha256=dd")));
}

TEST_F(CertificateWatchTest, TellsOnceThatTheFilesDoNotFitAndOnceThatTheyFitAgain) {
  watch_.OnLook(served_, absl::OkStatus());
  lines_.clear();
  for (int look = 0; look < 2; ++look) {
    watch_.OnLook(served_, absl::FailedPreconditionError("no key"));
  }
  for (int look = 0; look < 2; ++look) watch_.OnLook(served_, absl::OkStatus());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("certificate_mismatch why=\"no key\""),
                                  HasSubstr("certificate_fits_again")));
}

TEST_F(CertificateWatchTest, TellsAnotherReasonWhyTheFilesDoNotFit) {
  for (const char* why : {"no key", "no key", "a broken authority", "no key"}) {
    watch_.OnLook(served_, absl::FailedPreconditionError(why));
  }
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("why=\"no key\""), HasSubstr("a broken authority"),
                                  HasSubstr("why=\"no key\"")));
}

TEST_F(CertificateWatchTest, TellsAWeekBeforeTheCertificateExpiresAndWhenItHas) {
  served_.expiry = clock_.System() + kCertificateNotice + milliseconds(1);
  watch_.OnLook(served_, absl::OkStatus());
  lines_.clear();
  watch_.OnLook(served_, absl::OkStatus());
  EXPECT_THAT(lines_, IsEmpty());
  clock_.Advance(milliseconds(1));
  for (int look = 0; look < 2; ++look) watch_.OnLook(served_, absl::OkStatus());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("warn certificate_expiring expires=20")));
  clock_.Advance(kCertificateNotice - milliseconds(1));
  watch_.OnLook(served_, absl::OkStatus());
  EXPECT_THAT(lines_, SizeIs(1));
  clock_.Advance(milliseconds(1));
  for (int look = 0; look < 2; ++look) watch_.OnLook(served_, absl::OkStatus());
  EXPECT_THAT(lines_, ElementsAre(_, HasSubstr("error certificate_expired expires=20")));
}

TEST_F(CertificateWatchTest, ACertificateWithoutAnEndNeverExpires) {
  served_.expiry = identity::kNoExpiry;
  watch_.OnLook(served_, absl::OkStatus());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("info certificates_served expires=never ")));
  EXPECT_EQ(UnixMs(monitor_.certificate_expiry()), 253'402'300'799'000);
}

TEST_F(CertificateWatchTest, AnEndBehindThatOfNanosecondsIsWrittenAsItIs) {
  served_.expiry = FromUnixMs(253'370'764'800'000);
  watch_.OnLook(served_, absl::OkStatus());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("certificates_served expires=9999-01-01T00:00:00Z ")));
}

TEST_F(CertificateWatchTest, TellsOfARenewedCertificateThatItExpiresToo) {
  served_.expiry = clock_.System() + std::chrono::hours(1);
  watch_.OnLook(served_, absl::OkStatus());
  served_.expiry = clock_.System() + 2 * kCertificateNotice;
  watch_.OnLook(served_, absl::OkStatus());
  lines_.clear();
  clock_.Advance(kCertificateNotice);
  watch_.OnLook(served_, absl::OkStatus());
  EXPECT_THAT(lines_, ElementsAre(HasSubstr("certificate_expiring")));
}

}  // namespace
}  // namespace uplink::health
