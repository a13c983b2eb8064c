// Certificates and keys that are taken back: real sockets and TLS, and a list that changes.
#include <memory>
#include <string>
#include <utility>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/identity/authority_rules.h"
#include "server/identity/deny_list.h"
#include "server/identity/pem.h"
#include "server/identity/scope.h"
#include "tests/component/front/connection_bench.h"
#include "tests/support/eventually.h"
#include "tests/support/relay_bytes.h"

namespace uplink::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;

constexpr const char* kUnauthenticated = "16";

/// What a list can name of a certificate.
struct Names {
  explicit Names(const KeyPair& keys) {
    const auto read = identity::ReadCertificates({"robot.crt", keys.certificate});
    EXPECT_TRUE(read.ok()) << read.status();
    if (!read.ok()) return;
    const X509& certificate = *read->front();
    const storage::CertificateFacts facts = identity::FactsOf(identity::ShownBy(certificate));
    serial = facts.serial + " " + identity::IssuerOf(certificate);
    sha256 = facts.sha256;
    key = facts.key_sha256;
  }
  std::string serial;
  std::string sha256;
  std::string key;
};

/// A robot that streams, and what else comes.
class Revoked : public ::testing::Test {
 protected:
  void Begin() {
    robot_ = std::make_unique<RawHttp2>(bench_.Client(keys_));
    ASSERT_TRUE(robot_->Begin());
    robot_->Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
    ASSERT_TRUE(robot_->Sync());
    bench_.Commit();
    ASSERT_TRUE(robot_->ReadUntil([&] { return !FramesOf(robot_->At(1)).empty(); }));
  }
  void Deny(storage::RevokedBy by, const std::string& value) {
    identity::DeniedCertificates denied;
    ASSERT_TRUE(denied.Add(by, value));
    bench_.Deny(std::move(denied));
  }
  /// The stream of Begin ends as one that was revoked.
  void ExpectEnd() {
    ASSERT_TRUE(robot_->ReadUntil([&] { return robot_->At(1).over(); }));
    EXPECT_EQ(StatusOf(robot_->At(1)), kUnauthenticated);
    EXPECT_EQ(robot_->At(1).Trailer("grpc-message"), "certificate revoked");
    const KeptConnections& kept = bench_.bench().connections();
    ASSERT_TRUE(Eventually([&] { return !kept.ended().empty(); }));
    EXPECT_THAT(kept.Ends(), ElementsAre("refused"));
    EXPECT_EQ(kept.ended()[0].ended->detail, "certificate revoked");
    EXPECT_EQ(Count(transport::Denied::kEnded), 1);
  }
  /// The status of the first call of a new connection; empty: it is served.
  [[nodiscard]] std::string StatusOfNew(const KeyPair& keys) {
    RawHttp2 robot(bench_.Client(keys));
    EXPECT_TRUE(robot.Begin());
    robot.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1)));
    static_cast<void>(robot.Sync());
    bench_.Commit();
    EXPECT_TRUE(
        robot.ReadUntil([&] { return robot.At(1).over() || !FramesOf(robot.At(1)).empty(); }));
    return StatusOf(robot.At(1));
  }
  [[nodiscard]] std::int64_t Count(transport::Denied why) {
    return bench_.bench().relay_probe().denied_total[static_cast<std::size_t>(why)].value();
  }

  ConnectionBench bench_;
  const KeyPair keys_ = bench_.authority().Issue(RobotSpec(fuzz::RuriOf(1)));
  const Names names_{keys_};
  std::unique_ptr<RawHttp2> robot_;
};

TEST_F(Revoked, AStreamEndsByTheCertificatesDigest) {
  Begin();
  Deny(storage::RevokedBy::kCertificate, names_.sha256);
  ExpectEnd();
}

TEST_F(Revoked, AStreamEndsByItsKey) {
  Begin();
  Deny(storage::RevokedBy::kKey, names_.key);
  ExpectEnd();
}

TEST_F(Revoked, AStreamEndsByIssuerAndSerial) {
  Begin();
  Deny(storage::RevokedBy::kIssuerSerial, names_.serial);
  ExpectEnd();
}

TEST_F(Revoked, AnotherSerialOrIssuerEndsNothing) {
  Begin();
  Deny(storage::RevokedBy::kIssuerSerial, names_.serial + " 2");
  Deny(storage::RevokedBy::kIssuerSerial, "0" + names_.serial);
  Deny(storage::RevokedBy::kKey, names_.sha256);
  Deny(storage::RevokedBy::kCertificate, names_.key);
  ASSERT_TRUE(robot_->Sync());
  EXPECT_FALSE(robot_->At(1).over());
  EXPECT_THAT(bench_.bench().connections().ended(), IsEmpty());
  EXPECT_EQ(Count(transport::Denied::kEnded), 0);
}

TEST_F(Revoked, ANewConnectionIsRefused) {
  Deny(storage::RevokedBy::kCertificate, names_.sha256);
  EXPECT_EQ(StatusOfNew(keys_), kUnauthenticated);
  EXPECT_EQ(Count(transport::Denied::kRevoked), 1);
}

TEST_F(Revoked, OthersComeInAndItDoesAgainOnceItIsTakenBack) {
  Deny(storage::RevokedBy::kCertificate, names_.sha256);
  EXPECT_EQ(StatusOfNew(bench_.authority().Issue(RobotSpec(fuzz::RuriOf(2)))), "");
  bench_.Deny({});
  EXPECT_EQ(StatusOfNew(keys_), "");
}

TEST_F(Revoked, NoCallFollowsOnAConnectionThatWasEnded) {
  Begin();
  Deny(storage::RevokedBy::kCertificate, names_.sha256);
  ExpectEnd();
  EXPECT_TRUE(robot_->ReadUntilEnd());
}

TEST_F(Revoked, AStreamOutsideItsAuthoritysNewEntryEnds) {
  Begin();
  const auto entry = [this](const identity::Scope& fleets) {
    identity::AuthorityRules rules;
    EXPECT_TRUE(
        rules
            .Add({"hall.pem", bench_.authority().certificate()}, {.name = "hall", .fleets = fleets})
            .ok());
    return rules;
  };
  bench_.Trust(entry(identity::Scope::All()));
  ASSERT_TRUE(robot_->Sync());
  EXPECT_FALSE(robot_->At(1).over());
  bench_.Trust(entry(identity::Scope::Of({"north"})));
  ASSERT_TRUE(robot_->ReadUntil([&] { return robot_->At(1).over(); }));
  EXPECT_EQ(StatusOf(robot_->At(1)), kUnauthenticated);
  EXPECT_THAT(robot_->At(1).Trailer("grpc-message"),
              HasSubstr("its authority hall may not vouch for the fleet"));
  EXPECT_EQ(Count(transport::Denied::kAuthority), 1);
  EXPECT_EQ(StatusOfNew(keys_), kUnauthenticated);
}

TEST_F(Revoked, AConnectionWithoutCallsEndsToo) {
  RawHttp2 idle(bench_.Client(keys_));
  ASSERT_TRUE(idle.Begin());
  ASSERT_TRUE(idle.Sync());
  Deny(storage::RevokedBy::kKey, names_.key);
  EXPECT_TRUE(idle.ReadUntilEnd());
}

}  // namespace
}  // namespace uplink::testing
