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

TEST(LookAtCertificate, ReadsTheEndOfTheFirstCertificate) {
  const testing::TestAuthority authority;
  testing::CertificateSpec spec = testing::ServerSpec();
  spec.not_after_s = 7200;
  const SystemTime before = SystemClock().System();
  const testing::KeyPair pair = authority.Issue(spec);
  const std::string path = WriteFile("expiry.pem", pair.certificate + authority.certificate());
  const std::string key = WriteFile("expiry.key", pair.key);
  const auto look = LookAtCertificate(path, key);
  ASSERT_TRUE(look.ok()) << look.status();
  EXPECT_GE(look->expiry, before + std::chrono::seconds(7198));
  EXPECT_LE(look->expiry, SystemClock().System() + std::chrono::seconds(7201));
  EXPECT_TRUE(look->pair.ok()) << look->pair;
}

TEST(LookAtCertificate, SaysThatTheKeyIsAnothers) {
  const testing::TestAuthority authority;
  const std::string path =
      WriteFile("fits.pem", authority.Issue(testing::ServerSpec()).certificate);
  const std::string key = WriteFile("other.key", authority.Issue(testing::ServerSpec()).key);
  for (const std::string& bad : {key, std::string("/nonexistent/a.key")}) {
    const auto look = LookAtCertificate(path, bad);
    ASSERT_TRUE(look.ok()) << look.status();
    EXPECT_NE(std::string(look->pair.message()).find(bad), std::string::npos);
  }
}

TEST(LookAtCertificate, NamesAFileThatHoldsNone) {
  const std::string path = WriteFile("none.pem", "not a certificate");
  for (const std::string& bad : {path, std::string("/nonexistent/a.pem")}) {
    const auto look = LookAtCertificate(bad, bad);
    EXPECT_EQ(look.status().code(), absl::StatusCode::kFailedPrecondition);
    EXPECT_NE(std::string(look.status().message()).find(bad), std::string::npos);
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
