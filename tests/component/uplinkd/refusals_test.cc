#include <filesystem>
#include <memory>
#include <string>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>

#include "tests/component/uplinkd/uplinkd_fixture.h"
#include "tests/support/eventually.h"
#include "tests/support/pem_texts.h"

// What the real program says of streams that it refuses, in its log and in its metrics, and of a
// certificate that does not fit its key.
namespace uplink::testing {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

class Refusals : public UplinkdTest {
 protected:
  /// What the metrics page says behind a name; the page is published a moment after the event.
  void ExpectMetric(const std::string& line) const {
    EXPECT_TRUE(Eventually([&] {
      return HttpGet(http_, "/metrics").body.find("\n" + line + "\n") != std::string::npos;
    })) << line;
  }
  /// Whether a robot is welcomed.
  [[nodiscard]] bool Connects() const {
    TestAgent agent(Channel(RobotSpec("rcan://a")));
    return agent.Connect(model::SessionId()).has_value();
  }
};

TEST_F(Refusals, ABrokenRuleIsAProtocolErrorWithALine) {
  Serve();
  TestAgent agent(Channel(RobotSpec("rcan://a")));
  agent.Send(BatchFrame({{1, "payload that is no one's business"}}));
  EXPECT_EQ(agent.End().error_code(), grpc::StatusCode::INVALID_ARGUMENT);
  ASSERT_TRUE(process_->WaitFor("the first frame must be a hello")) << process_->text();
  EXPECT_THAT(process_->text(), HasSubstr("warn protocol_error source="));
  EXPECT_THAT(process_->text(), HasSubstr("robot=rcan://a"));
  EXPECT_THAT(process_->text(), Not(HasSubstr("no one's business")));
  ExpectMetric("uplinkd_protocol_errors_total 1");
  ExpectMetric("uplinkd_streams_refused_total{cause=\"identity\"} 0");
}

TEST_F(Refusals, ARoleThatMayNotRelayIsRefusedForItsIdentity) {
  Serve();
  CertificateSpec viewer = RobotSpec("rcan://a");
  viewer.units = {"viewer"};
  viewer.uris = {};
  TestAgent agent(Channel(viewer));
  static_cast<void>(agent.Connect(model::SessionId()));
  EXPECT_EQ(agent.End().error_code(), grpc::StatusCode::UNAUTHENTICATED);
  ASSERT_TRUE(process_->WaitFor("stream_refused")) << process_->text();
  ExpectMetric("uplinkd_streams_refused_total{cause=\"identity\"} 1");
  ExpectMetric("uplinkd_protocol_errors_total 0");
}

TEST_F(Refusals, AGatewayIsNamedByItsRobotsAndByWhatItIsRefused) {
  Serve();
  CertificateSpec gateway = RobotSpec("rcan://a", "north");
  gateway.common_names = {"hall"};
  gateway.units = {"gateway"};
  const auto channel = Channel(gateway);
  const auto hello = [](const std::string& ruri) {
    v1::RelayRequest frame = HelloFrame(model::SessionId());
    frame.mutable_hello()->set_robot_ruri(ruri);
    return frame;
  };
  TestAgent granted(channel);
  granted.Send(hello("rcan://a"));
  ASSERT_TRUE(granted.Read());
  EXPECT_THAT(HttpGet(http_, "/api/v1/robots").body,
              HasSubstr(R"("gateway":"CN=hall,OU=gateway,O=north")"));
  ExpectMetric("uplinkd_gateway_streams 1");
  TestAgent denied(channel);
  denied.Send(hello("rcan://b"));
  EXPECT_EQ(denied.End().error_code(), grpc::StatusCode::PERMISSION_DENIED);
  ASSERT_TRUE(process_->WaitFor("stream_refused")) << process_->text();
  EXPECT_THAT(process_->text(), HasSubstr("CN=hall,OU=gateway,O=north"));
  EXPECT_THAT(process_->text(), HasSubstr("rcan://b"));
  ExpectMetric("uplinkd_streams_refused_total{cause=\"identity\"} 1");
  ExpectMetric("uplinkd_streams_refused_total{cause=\"gateway\"} 0");
}

TEST_F(Refusals, OneRobotTooManyIsRefusedForWantOfRoom) {
  folder_.WriteConfig("[limits]\nrobots_max = 1\n");
  Serve();
  TestAgent first(Channel(RobotSpec("rcan://a")));
  ASSERT_TRUE(first.Connect(model::SessionId()));
  TestAgent second(Channel(RobotSpec("rcan://b")));
  static_cast<void>(second.Connect(model::SessionId()));
  EXPECT_EQ(second.End().error_code(), grpc::StatusCode::RESOURCE_EXHAUSTED);
  ASSERT_TRUE(process_->WaitFor("stream_refused")) << process_->text();
  EXPECT_THAT(process_->text(), HasSubstr("limits.robots_max"));
  ExpectMetric("uplinkd_streams_refused_total{cause=\"full\"} 1");
  ExpectMetric("uplinkd_protocol_errors_total 0");
  EXPECT_THAT(HttpGet(http_, "/api/v1/status").body, HasSubstr(R"("degraded":["robots_max")"));
}

TEST_F(Refusals, FilesThatDoNotFitAreSaidAndTheLastGoodOnesServed) {
  Serve();
  const KeyPair renewed = folder_.authority().Issue(ServerSpec());
  // What a copy in place leaves for a moment, half a copy, and the first of two steps.
  for (const std::string& text : {std::string(), renewed.key.substr(0, 60), renewed.key}) {
    std::filesystem::remove(folder_.Path("server.key"));
    folder_.Write("server.key", text);
    ASSERT_TRUE(process_->WaitFor("certificate_mismatch")) << process_->text();
    EXPECT_THAT(HttpGet(http_, "/readyz").body, HasSubstr("certificate_mismatch"));
    EXPECT_EQ(HttpGet(http_, "/readyz").status, 200);
    EXPECT_TRUE(Connects()) << process_->text();
  }
  folder_.Write("server.crt", renewed.certificate);
  ASSERT_TRUE(process_->WaitFor("certificate_fits_again")) << process_->text();
  EXPECT_THAT(HttpGet(http_, "/readyz").body, Not(HasSubstr("certificate_mismatch")));
  EXPECT_TRUE(Connects()) << process_->text();
}

TEST_F(Refusals, AKeyBehindItsParametersIsServedAfterARenewalAndAfterARestart) {
  Serve();
  const KeyPair renewed = folder_.authority().Issue(ServerSpec());
  const auto renew = [&](const std::string& key) {
    std::filesystem::remove(folder_.Path("server.key"));
    folder_.Write("server.key", key);
    folder_.Write("server.crt", renewed.certificate);
  };
  // What a server that runs refuses, a start refuses, too.
  renew(LockedKey(renewed.key));
  ASSERT_TRUE(process_->WaitFor("server.key: PEM block 1, from line 1, is a private key behind a"))
      << process_->text();
  EXPECT_TRUE(Connects()) << process_->text();
  EXPECT_EQ(folder_.Start({"--check-config"})->WaitForExit(), 2);

  const std::size_t before = process_->text().size();
  renew(EcparamKey(renewed.key));
  ASSERT_TRUE(process_->WaitFor("certificates_served", std::chrono::seconds(30), before))
      << process_->text();
  EXPECT_TRUE(Connects()) << process_->text();
  EXPECT_EQ(folder_.Start({"--check-config"})->WaitForExit(), 0);
  process_->Signal(SIGTERM);
  ASSERT_EQ(process_->WaitForExit(), 0) << process_->text();
  Serve();
  EXPECT_TRUE(Connects()) << process_->text();
}

TEST_F(Refusals, AnExpiredCertificateStartsIsNotedAndGivesWayToANewOne) {
  const auto write = [&](const CertificateSpec& spec) {
    const KeyPair made = folder_.authority().Issue(spec);
    std::filesystem::remove(folder_.Path("server.key"));
    folder_.Write("server.key", made.key);
    folder_.Write("server.crt", made.certificate);
  };
  CertificateSpec expired = ServerSpec();
  expired.not_after_s = -60;
  write(expired);
  // What the server starts with, the check lets pass.
  const auto check = folder_.Start({"--check-config"});
  EXPECT_EQ(check->WaitForExit(), 0) << check->text();
  EXPECT_THAT(check->text(), HasSubstr("note: "));
  EXPECT_THAT(check->text(), HasSubstr("tls.certificate_file: the certificate expired 0 h ago"));
  Serve();
  EXPECT_TRUE(Eventually([&] { return HttpGet(http_, "/readyz").status == 503; }));
  EXPECT_THAT(HttpGet(http_, "/readyz").body, HasSubstr("certificate_expired"));

  write(ServerSpec());
  EXPECT_TRUE(Eventually([&] { return HttpGet(http_, "/readyz").status == 200; }))
      << process_->text();
  EXPECT_TRUE(Connects()) << process_->text();
  const auto again = folder_.Start({"--check-config"});
  EXPECT_EQ(again->WaitForExit(), 0);
  EXPECT_THAT(again->text(), Not(HasSubstr("expired")));
}

TEST_F(Refusals, ABrokenAuthorityIsSaidAndTheLastGoodOnesServed) {
  Serve();
  const std::string good = folder_.authority().certificate();
  const TestAuthority other("other");
  std::string broken = good + other.certificate();
  broken.replace(broken.rfind("\nMII"), 4, "\nXXX");
  folder_.Write("ca.crt", broken);
  ASSERT_TRUE(process_->WaitFor("certificate_mismatch")) << process_->text();
  EXPECT_THAT(process_->text(), HasSubstr("ca.crt: PEM block 2"));
  process_->Signal(SIGHUP);
  ASSERT_TRUE(process_->WaitFor("reload_refused")) << process_->text();
  EXPECT_TRUE(Connects()) << process_->text();
  const auto second = folder_.Start();
  EXPECT_EQ(second->WaitForExit(), 2) << second->text();
  EXPECT_THAT(second->text(), HasSubstr("tls.client_ca_file"));
  folder_.Write("ca.crt", good + other.certificate());
  ASSERT_TRUE(process_->WaitFor("certificate_fits_again")) << process_->text();
}

TEST_F(Refusals, AnAuthorityThatEverybodyMayWriteIsNotTakenOver) {
  using std::filesystem::perms;
  Serve();
  const TestAuthority other("other");
  std::filesystem::permissions(folder_.Path("ca.crt"), perms{0666});
  folder_.Write("ca.crt", folder_.authority().certificate() + other.certificate());
  ASSERT_TRUE(process_->WaitFor("certificate_mismatch")) << process_->text();
  EXPECT_THAT(process_->text(), HasSubstr("may write " + folder_.Path("ca.crt")));
  EXPECT_THAT(HttpGet(http_, "/readyz").body, HasSubstr("certificate_mismatch"));
  EXPECT_TRUE(Connects()) << process_->text();
  TestAgent stranger(MakeChannel({.port = relay_,
                                  .server_ca = folder_.authority().certificate(),
                                  .identity = other.Issue(RobotSpec("rcan://a"))}));
  EXPECT_FALSE(stranger.Connect(model::SessionId())) << process_->text();
  EXPECT_EQ(stranger.End().error_code(), grpc::StatusCode::UNAVAILABLE);
  const auto second = folder_.Start();
  EXPECT_EQ(second->WaitForExit(), 2) << second->text();
  EXPECT_THAT(second->text(), HasSubstr("tls.client_ca_file"));

  std::filesystem::permissions(folder_.Path("ca.crt"), perms{0644});
  ASSERT_TRUE(process_->WaitFor("certificate_fits_again")) << process_->text();
  std::filesystem::permissions(folder_.Path("uplinkd.toml"), perms{0666});
  process_->Signal(SIGHUP);
  ASSERT_TRUE(process_->WaitFor("reload_refused")) << process_->text();
  EXPECT_THAT(process_->text(), HasSubstr("may write " + folder_.Path("uplinkd.toml")));
}

TEST_F(Refusals, AReloadThatChangesNothingIsNoWarning) {
  Serve();
  process_->Signal(SIGHUP);
  ASSERT_TRUE(process_->WaitFor("reloaded ")) << process_->text();
  EXPECT_THAT(process_->text(), HasSubstr("info reloaded "));
}

}  // namespace
}  // namespace uplink::testing
