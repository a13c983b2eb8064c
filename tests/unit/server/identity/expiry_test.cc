#include "server/identity/expiry.h"

#include <chrono>
#include <filesystem>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "tests/support/certificates.h"
#include "tests/support/odd_certificates.h"

namespace uplink::identity {
namespace {

namespace odd = uplink::testing::odd;
using std::chrono::sys_days;
using std::chrono::year;

std::string WriteFile(const std::string& name, const std::string& text) {
  std::string path = (std::filesystem::path(::testing::TempDir()) / name).string();
  std::ofstream(path) << text;
  return path;
}

/// A certificate that ends then; `der` is GeneralizedTime's text.
NamedPem Ending(const std::string& der) {
  odd::Parts parts;
  parts.key = odd::Ed25519Key();
  parts.not_after = der;
  return {"a.crt", odd::PemOf(odd::CertificateOf(parts))};
}

TEST(Expiry, IsWhatTheCertificateSays) {
  const auto expiry = ExpiryOf(Ending("20991231235959Z"));
  ASSERT_TRUE(expiry.ok()) << expiry.status();
  EXPECT_EQ(ExpiryText(*expiry), "2099-12-31T23:59:59Z");
}

TEST(Expiry, BeyondTheEndOfNanosecondsIsWrittenAsItIs) {
  // 2262-04-11 is the last day that std::chrono::system_clock knows.
  for (const char* year : {"2262", "2263", "2600", "9998"}) {
    const auto expiry = ExpiryOf(Ending(std::string(year) + "1231235959Z"));
    ASSERT_TRUE(expiry.ok()) << expiry.status();
    EXPECT_EQ(ExpiryText(*expiry), std::string(year) + "-12-31T23:59:59Z");
  }
}

TEST(Expiry, WithoutAnEndIsNever) {
  const auto expiry = ExpiryOf(Ending("99991231235959Z"));
  ASSERT_TRUE(expiry.ok()) << expiry.status();
  EXPECT_EQ(*expiry, kNoExpiry);
  EXPECT_EQ(*expiry, sys_days(year{10'000} / 1 / 1) - std::chrono::seconds(1));
  EXPECT_EQ(ExpiryText(*expiry), "never");
  EXPECT_EQ(ExpiryText(kNoExpiry - std::chrono::seconds(1)), "9999-12-31T23:59:58Z");
}

TEST(Expiry, BeforeTheEpochIsInThePast) {
  const auto expiry = ExpiryOf(Ending("19010101000000Z"));
  ASSERT_TRUE(expiry.ok()) << expiry.status();
  EXPECT_LT(*expiry, FromUnixMs(0));
  EXPECT_EQ(ExpiryText(*expiry), "1901-01-01T00:00:00Z");
}

TEST(ExpiryOfFile, IsTheEndOfTheFirstCertificate) {
  const testing::TestAuthority authority;
  testing::CertificateSpec spec = testing::ServerSpec();
  spec.not_after_s = 7200;
  const SystemTime before = SystemClock().System();
  const std::string path =
      WriteFile("expiry.pem", authority.Issue(spec).certificate + authority.certificate());
  const auto expiry = ExpiryOfFile(path);
  ASSERT_TRUE(expiry.ok()) << expiry.status();
  EXPECT_GE(*expiry, before + std::chrono::seconds(7198));
  EXPECT_LE(*expiry, SystemClock().System() + std::chrono::seconds(7201));
}

TEST(ExpiryOfFile, NamesAFileThatHoldsNone) {
  const std::string path = WriteFile("none.pem", "not a certificate");
  for (const std::string& bad : {path, std::string("/nonexistent/a.pem")}) {
    const auto expiry = ExpiryOfFile(bad);
    EXPECT_EQ(expiry.status().code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_NE(std::string(expiry.status().message()).find(bad), std::string::npos);
  }
}

}  // namespace
}  // namespace uplink::identity
