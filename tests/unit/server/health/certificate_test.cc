#include "server/health/certificate.h"

#include <chrono>
#include <filesystem>
#include <fstream>

#include <gtest/gtest.h>

#include "server/health/process.h"
#include "tests/support/certificates.h"

namespace uplink::health {
namespace {

std::string WriteFile(const std::string& name, const std::string& text) {
  std::string path = (std::filesystem::path(::testing::TempDir()) / name).string();
  std::ofstream(path) << text;
  return path;
}

TEST(CertificateExpiry, ReadsTheEndOfTheFirstCertificate) {
  const testing::TestAuthority authority;
  testing::CertificateSpec spec = testing::ServerSpec();
  spec.not_after_s = 7200;
  const SystemTime before = SystemClock().System();
  const std::string path =
      WriteFile("expiry.pem", authority.Issue(spec).certificate + authority.certificate());
  const auto expiry = CertificateExpiry(path);
  ASSERT_TRUE(expiry.ok()) << expiry.status();
  EXPECT_GE(*expiry, before + std::chrono::seconds(7198));
  EXPECT_LE(*expiry, SystemClock().System() + std::chrono::seconds(7201));
}

TEST(CertificateExpiry, NamesAFileThatHoldsNone) {
  const std::string path = WriteFile("none.pem", "not a certificate");
  for (const std::string& bad : {path, std::string("/nonexistent/a.pem")}) {
    const auto expiry = CertificateExpiry(bad);
    EXPECT_EQ(expiry.status().code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_NE(std::string(expiry.status().message()).find(bad), std::string::npos);
  }
}

TEST(Process, ReadsFiguresThatCannotBeZero) {
  const ProcessFigures figures = ReadProcess();
  EXPECT_GT(figures.resident_bytes, 0U);
  EXPECT_GE(figures.threads, 1U);
  EXPECT_GE(DescriptorsMax(), OpenDescriptors());
}

TEST(Process, CountsADescriptorThatIsOpened) {
  const std::size_t before = OpenDescriptors();
  const std::ifstream open("/proc/self/stat");
  EXPECT_EQ(OpenDescriptors(), before + 1);
}

}  // namespace
}  // namespace uplink::health
