#include "tools/pki/kept.h"

#include <chrono>
#include <filesystem>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/certificates.h"
#include "tests/support/temp_folder.h"

namespace uplink::pki {
namespace {

using ::testing::HasSubstr;

class KeptTest : public ::testing::Test {
 protected:
  KeptTest() {
    Put("ca", authority_->credentials());
    Put("server", Issue(*authority_, ServerProfile({"uplink.example.org", "2001:db8::1"})));
  }

  static Credentials Issue(const Authority& authority, const absl::StatusOr<Profile>& profile) {
    return *authority.Issue(*profile, 1);
  }
  void Put(const std::string& name, const Credentials& credentials) {
    ASSERT_TRUE(directory_.Write(name, credentials, Existing::kReplace).ok());
  }
  [[nodiscard]] std::string Judge(const std::vector<std::string>& hosts,
                                  const std::string& name = "server") const {
    const absl::Status status =
        CheckKept(directory_, name, {authority_->credentials().certificate_pem, hosts, {}}, now_);
    return std::string(status.message());
  }

  /// Of a client's pair r1.
  [[nodiscard]] std::string JudgeClient(const absl::StatusOr<Profile>& wanted) const {
    const absl::Status status =
        CheckKept(directory_, "r1", {authority_->credentials().certificate_pem, {}, *wanted}, now_);
    return std::string(status.message());
  }

  const testing::TempFolder folder_;
  const Directory directory_{folder_.File(".")};
  const std::unique_ptr<Authority> authority_ = *Authority::Create("one", 1);
  SystemTime now_ = SystemClock().System();
};

TEST_F(KeptTest, AGoodPairStays) {
  EXPECT_EQ(Judge({"uplink.example.org"}), "");
  EXPECT_EQ(Judge({"UPLINK.example.org", "2001:0db8:0::1"}), "");
  EXPECT_TRUE(CheckKept(directory_, "ca", {}, now_).ok());
  Put("r1", Issue(*authority_, RobotProfile("rcan://a", "north", "r1")));
  EXPECT_EQ(Judge({}, "r1"), "");
  EXPECT_EQ(JudgeClient(RobotProfile("rcan://a", "north", "r1")), "");
  Put("r1", Issue(*authority_, GatewayProfile({"rcan://a", "rcan://b"}, "north", "r1")));
  EXPECT_EQ(JudgeClient(GatewayProfile({"rcan://b", "rcan://a"}, "north", "r1")), "");
  Put("r1", Issue(*authority_, OperatorProfile("viewer", "*", "r1")));
  EXPECT_EQ(JudgeClient(OperatorProfile("viewer", "*", "r1")), "");
}

TEST_F(KeptTest, AnotherIdentityIsNamed) {
  Put("r1", Issue(*authority_, RobotProfile("rcan://a", "north", "r1")));
  EXPECT_THAT(JudgeClient(RobotProfile("rcan://b", "north", "r1")),
              HasSubstr("r1.crt: has the RURI rcan://a, and not rcan://b; --force"));
  EXPECT_THAT(JudgeClient(RobotProfile("rcan://a", "south", "r2")),
              HasSubstr("has the fleet north, and not south; the name r1, and not r2; --force"));
  EXPECT_THAT(JudgeClient(GatewayProfile({}, "north", "r1")),
              HasSubstr("has the role robot, and not gateway; the RURI rcan://a, and not none;"));
  Put("r1", Issue(*authority_, OperatorProfile("viewer", "*", "r1")));
  EXPECT_THAT(JudgeClient(OperatorProfile("admin", "*", "r1")),
              HasSubstr("has the role viewer, and not admin; --force"));
  Put("r1", Issue(*authority_, ServerProfile({"localhost"})));
  EXPECT_THAT(JudgeClient(RobotProfile("rcan://a", "north", "r1")),
              HasSubstr("its extended key usage lacks clientAuth; --force"));
}

TEST_F(KeptTest, AClientsCertificateIsNoAuthoritys) {
  Put("ca", Issue(*authority_, RobotProfile("rcan://a", "north", "ca")));
  EXPECT_THAT(std::string(CheckKept(directory_, "ca", {}, now_).message()),
              HasSubstr("ca.crt: is no authority's certificate; --force"));
}

TEST_F(KeptTest, AKeyThatOthersMayReadIsNamed) {
  for (const mode_t mode : {0640U, 0604U, 0620U}) {
    ASSERT_EQ(chmod(directory_.KeyPath("server").c_str(), mode), 0);
    EXPECT_THAT(Judge({"uplink.example.org"}),
                HasSubstr("server.key: others than its owner may read or write the key (mode 06"));
  }
  ASSERT_EQ(chmod(directory_.KeyPath("server").c_str(), 0400), 0);
  EXPECT_EQ(Judge({"uplink.example.org"}), "");
}

TEST_F(KeptTest, HostsThatItLacksAreNamed) {
  EXPECT_THAT(Judge({"uplink.example.org", "192.0.2.7", "other"}),
              HasSubstr("server.crt: is for uplink.example.org, 2001:db8::1, and not for "
                        "192.0.2.7, other; --force"));
}

TEST_F(KeptTest, ANameThatSteersATerminalIsEscaped) {
  const testing::TestAuthority authority;
  testing::CertificateSpec spec = testing::ServerSpec();
  spec.dns_names = {"a\n\x1b[2Jb"};
  const testing::KeyPair pair = authority.Issue(spec);
  Put("server", {.certificate_pem = pair.certificate, .key_pem = pair.key});
  const absl::Status status =
      CheckKept(directory_, "server", {authority.certificate(), {"other"}}, now_);
  EXPECT_THAT(std::string(status.message()), HasSubstr("is for a\\x0a\\x1b[2Jb, "));
}

TEST_F(KeptTest, AnotherAuthorityIsNamed) {
  const auto other = *Authority::Create("one", 1);
  Put("server", Issue(*other, ServerProfile({"localhost"})));
  EXPECT_THAT(Judge({"localhost"}), HasSubstr("was not signed by the authority of "));
}

TEST_F(KeptTest, OneThatExpiredIsNamed) {
  now_ += std::chrono::hours(23);
  EXPECT_EQ(Judge({"uplink.example.org"}), "");
  now_ += std::chrono::hours(1);
  EXPECT_THAT(Judge({"uplink.example.org"}), HasSubstr("server.crt: expired at "));
  EXPECT_THAT(std::string(CheckKept(directory_, "ca", {}, now_).message()),
              HasSubstr("ca.crt: expired at "));
}

TEST_F(KeptTest, AKeyOfAnotherIsNamed) {
  std::filesystem::copy(directory_.KeyPath("ca"), directory_.KeyPath("server"),
                        std::filesystem::copy_options::overwrite_existing);
  EXPECT_THAT(Judge({"uplink.example.org"}), HasSubstr("server.key: is not the key of "));
}

TEST_F(KeptTest, ARobotsCertificateIsNoServers) {
  Put("server", Issue(*authority_, RobotProfile("rcan://a", "north", "r1")));
  EXPECT_THAT(Judge({"localhost"}), HasSubstr("is no certificate of a server"));
}

TEST_F(KeptTest, WhatIsNoCertificateIsNamed) {
  std::ofstream(directory_.CertificatePath("server")) << "notes";
  EXPECT_THAT(Judge({"localhost"}), HasSubstr("server.crt"));
}

TEST_F(KeptTest, APairIsWholeOrAbsent) {
  EXPECT_TRUE(*directory_.HasPair("ca"));
  EXPECT_FALSE(*directory_.HasPair("r1"));
  std::filesystem::remove(directory_.CertificatePath("ca"));
  const std::string message(directory_.HasPair("ca").status().message());
  EXPECT_THAT(message, HasSubstr("ca.key is there and "));
  EXPECT_THAT(message, HasSubstr("ca.crt is missing; restore the missing file"));
  std::filesystem::remove(directory_.KeyPath("server"));
  EXPECT_THAT(std::string(directory_.HasPair("server").status().message()),
              HasSubstr("server.key is missing"));
}

}  // namespace
}  // namespace uplink::pki
