// Who gets through the handshake, and what those are told that do not.
#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/ssl.h>

#include "tests/component/front/front_world.h"
#include "tests/component/front/shared_lines.h"

namespace uplink::testing {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::StartsWith;
using transport::TurnedAway;

/// The server ends it: with this alert, in order, so that the alert is not lost on its way.
void ExpectAlert(RawHttp2& client, int description) {
  // What a client would say at once: it must not turn the end into a reset.
  client.Send(http2::Preface() + http2::Settings({}));
  EXPECT_TRUE(client.ReadUntilEnd());
  EXPECT_EQ(client.alert(), description);
  EXPECT_EQ(client.end(), RawTcp::End::kClosed);
}

TEST(Tls, HttpTwoIsAgreedOn) {
  RelayWorld world;
  RawHttp2::Options options = ClientOf(world, RobotKeys(world, 1));
  options.protocols = {"http/1.1", "h2"};
  RawHttp2 client(options);
  EXPECT_EQ(client.protocol(), "h2");
  EXPECT_TRUE(client.Begin());
  EXPECT_TRUE(client.Sync());
}

TEST(Tls, WithoutAProtocolNothingIsServed) {
  RelayWorld world;
  RawHttp2::Options options = ClientOf(world, RobotKeys(world, 1));
  options.protocols.clear();
  RawHttp2 client(options);
  client.Send(http2::Preface() + http2::Settings({}) + OpenRelay(1));
  EXPECT_TRUE(client.ReadUntilEnd());
  EXPECT_EQ(client.settings().size(), 0U);
  EXPECT_EQ(TurnedAwayFor(world, TurnedAway::kNothingShared), 1);
  EXPECT_EQ(world.session_probe.streams_total.value(), 0);
}

TEST(Tls, WithHttpOneAloneNothingIsServed) {
  RelayWorld world;
  RawHttp2::Options options = ClientOf(world, RobotKeys(world, 1));
  options.protocols = {"http/1.1"};
  RawHttp2 client(options);
  ExpectAlert(client, SSL_AD_NO_APPLICATION_PROTOCOL);
  EXPECT_EQ(TurnedAwayFor(world, TurnedAway::kNothingShared), 1);
}

/// Whether a client that offers these alone is served by TLS 1.2.
bool Serves12With(const RelayWorld& world, const std::string& suites) {
  RawHttp2::Options options = ClientOf(world, RobotKeys(world, 1));
  options.tls_max = TLS1_2_VERSION;
  options.suites_of_12 = suites;
  RawHttp2 client(options);
  return client.Begin();
}

TEST(Tls, Tls12HasTheSuitesThatHttpTwoAllowsAlone) {
  RelayWorld world(With12());
  EXPECT_TRUE(Serves12With(world, "ECDHE-ECDSA-AES128-GCM-SHA256"));
  EXPECT_TRUE(Serves12With(world, "ECDHE-ECDSA-AES256-GCM-SHA384"));
  EXPECT_TRUE(Serves12With(world, "ECDHE-ECDSA-CHACHA20-POLY1305"));
  EXPECT_EQ(TurnedAwayFor(world, TurnedAway::kNothingShared), 0);
  // CBC, which padding oracles have read (Lucky 13).
  EXPECT_FALSE(Serves12With(world, "ECDHE-ECDSA-AES256-SHA384"));
  EXPECT_FALSE(Serves12With(world, "ECDHE-ECDSA-AES128-SHA256"));
  EXPECT_FALSE(Serves12With(world, "ECDHE-ECDSA-AES128-SHA"));
  EXPECT_FALSE(Serves12With(world, "ECDHE-ECDSA-AES128-CCM"));
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(world, TurnedAway::kNothingShared) == 4; }));
}

TEST(Tls, AVersionBelowTheMinimumIsRefused) {
  for (const auto& [options, offered] :
       {std::pair{RelayWorld::Options(), TLS1_2_VERSION}, std::pair{With12(), TLS1_1_VERSION}}) {
    RelayWorld world(options);
    RawHttp2::Options robot = ClientOf(world, RobotKeys(world, 1));
    robot.tls_max = offered;
    // The library offers TLS 1.1 no more by itself.
    robot.suites_of_12 = "DEFAULT@SECLEVEL=0";
    RawHttp2 client(robot);
    EXPECT_FALSE(client.handshaken());
    ExpectAlert(client, SSL_AD_PROTOCOL_VERSION);
    EXPECT_EQ(TurnedAwayFor(world, TurnedAway::kNothingShared), 1);
  }
}

TEST(Tls, AForeignCertificateIsToldSoByAnAlert) {
  const TestAuthority foreign("another authority");
  for (const int version : {TLS1_2_VERSION, TLS1_3_VERSION}) {
    RelayWorld world(With12());
    RawHttp2::Options robot = ClientOf(world, foreign.Issue(RobotSpec(RuriOf(1))));
    robot.tls_max = version;
    RawHttp2 client(robot);
    ExpectAlert(client, SSL_AD_UNKNOWN_CA);
    EXPECT_EQ(TurnedAwayFor(world, TurnedAway::kUntrusted), 1);
    EXPECT_EQ(world.relay_probe.handshakes_failed_total.value(), 1);
    EXPECT_EQ(world.session_probe.streams_total.value(), 0);
    EXPECT_EQ(world.relay_probe.refused_identity_total.value(), 0);
  }
}

TEST(Tls, NoCertificateIsToldSoByAnAlert) {
  RelayWorld world;
  RawHttp2 client(ClientOf(world, {}));
  ExpectAlert(client, SSL_AD_CERTIFICATE_REQUIRED);
  EXPECT_EQ(TurnedAwayFor(world, TurnedAway::kNoCertificate), 1);
}

TEST(Tls, AFirstMessageThatIsTooLargeIsNotWaitedFor) {
  SharedLines::Lines lines;
  const SystemClock clock;
  const log::Logger logger(std::make_unique<SharedLines>(lines), clock, log::Format::kText,
                           log::Level::kInfo);
  RelayWorld::Options of_world;
  of_world.logger = &logger;
  RelayWorld world(of_world);
  RawTcp client(world.server().port());
  // A ClientHello of 4 KiB and a byte is announced; none of it comes.
  static_cast<void>(client.SendSome(std::string("\x16\x03\x01\x10\x05\x01\x00\x10\x01", 9)));
  EXPECT_TRUE(client.WaitForEnd(kPatience));
  EXPECT_TRUE(Eventually([&] { return TurnedAwayFor(world, TurnedAway::kHandshakeError) == 1; }));
  EXPECT_TRUE(Eventually([&] { return !lines.All().empty(); }));
  EXPECT_THAT(lines.All(),
              ElementsAre(HasSubstr("why=\"handshake_error: a first message of over 4 KiB\"")));
}

TEST(Tls, AFirstMessageUpToItsLimitIsWaitedFor) {
  RelayWorld world;
  RawTcp client(world.server().port());
  static_cast<void>(client.SendSome(std::string("\x16\x03\x01\x10\x04\x01\x00\x10\x00", 9)));
  // A later handshake is over, and this one is still under way.
  RawHttp2 other(ClientOf(world, RobotKeys(world, 1)));
  EXPECT_TRUE(other.Begin());
  EXPECT_TRUE(Eventually([&] { return world.relay_probe.handshakes_under_way.value() == 1; }))
      << "the later one counts until its server's side is done";
  EXPECT_EQ(TurnedAwayFor(world, TurnedAway::kHandshakeError), 0);
}

/// A robot's certificate with so many intermediate authorities between it and the world's.
KeyPair BehindIntermediates(const ListenerWorld& world, int count) {
  std::vector<std::unique_ptr<TestAuthority>> authorities;
  std::string chain;
  for (int i = 1; i <= count; ++i) {
    const TestAuthority& issuer = i == 1 ? world.authority : *authorities.back();
    authorities.push_back(
        std::make_unique<TestAuthority>("intermediate " + std::to_string(i), issuer));
    chain.insert(0, authorities.back()->certificate());
  }
  KeyPair keys = authorities.back()->Issue(RobotSpec(RuriOf(1)));
  keys.certificate += chain;
  return keys;
}

constexpr int kIntermediatesMax = 8;

TEST(Tls, AChainOfAsManyIntermediatesAsThereMayBeIsTaken) {
  RelayWorld world;
  RawHttp2 client(ClientOf(world, BehindIntermediates(world, kIntermediatesMax)));
  ASSERT_TRUE(client.Begin());
  client.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1) + FaultsMessage(1, 1)));
  EXPECT_TRUE(client.ReadUntil([&] { return LastAck(client.At(1)).through_seq() == 1; }));
}

TEST(Tls, AChainOfOneIntermediateMoreIsRefused) {
  RelayWorld world;
  RawHttp2 client(ClientOf(world, BehindIntermediates(world, kIntermediatesMax + 1)));
  ExpectAlert(client, SSL_AD_UNKNOWN_CA);
  EXPECT_EQ(TurnedAwayFor(world, TurnedAway::kUntrusted), 1);
  EXPECT_EQ(world.relay_probe.connections.value(), 0);
}

/// TLS holds names in certificates against these, and a gateway says its robots' names later.
TEST(Tls, AGatewayIsHeldAgainstTheNameConstraintsOfItsChain) {
  RelayWorld world;
  const TestAuthority hall("hall", world.authority, "permitted;URI:hall.example");
  CertificateSpec spec;
  spec.common_names = {"hall"};
  spec.units = {"gateway"};
  KeyPair keys = hall.Issue(spec);
  keys.certificate += hall.certificate();
  RawHttp2 client(ClientOf(world, keys));
  ASSERT_TRUE(client.Begin());
  client.Send(OpenRelay(1) + http2::Data(1, HelloMessage(1, "rcan://hall.example/acme/rover/1")) +
              OpenRelay(3) + http2::Data(3, HelloMessage(1, RuriOf(1))));
  ASSERT_TRUE(client.ReadUntilOver(3));
  EXPECT_EQ(StatusOf(client.At(3)), "7");
  EXPECT_THAT(client.At(3).Trailer("grpc-message"), HasSubstr("name constraints"));
  ASSERT_TRUE(client.ReadUntil([&] { return !FramesOf(client.At(1)).empty(); }));
  EXPECT_TRUE(FramesOf(client.At(1)).front().has_welcome());
}

/// What a certificate is refused for, by the sentence that its holder is told.
struct Refused {
  const char* name;
  CertificateSpec spec;
  const char* sentence;
};

std::vector<Refused> AllRefused() {
  CertificateSpec expired = RobotSpec(RuriOf(1));
  expired.not_after_s = -60;
  CertificateSpec future = RobotSpec(RuriOf(1));
  future.not_before_s = 600;
  CertificateSpec server = RobotSpec(RuriOf(1));
  server.key_usages = {"serverAuth"};
  CertificateSpec viewer;
  viewer.organizations = {"*"};
  viewer.units = {"viewer"};
  return {
      {"Expired", expired, "client certificate: it, or one that signed it, has expired"},
      {"OfTheFuture", future, "client certificate: it, or one that signed it, is not valid yet"},
      {"OfAServer", server,
       "client certificate: its key usage or extended key usage lacks what a client needs"},
      {"OfARoleThatNothingTakes", viewer, "the certificate is of role viewer; "}};
}

class RefusedCertificate : public ::testing::TestWithParam<Refused> {};

INSTANTIATE_TEST_SUITE_P(All, RefusedCertificate, ::testing::ValuesIn(AllRefused()),
                         [](const auto& instance) { return instance.param.name; });

/// Whatever it asks for.
TEST_P(RefusedCertificate, IsToldItsSentenceAndNoMoreThenTheConnectionEnds) {
  const auto& [name, spec, sentence] = GetParam();
  RelayWorld world;
  const KeyPair keys = world.authority.Issue(spec);
  const std::vector<http2::Fields> requests = {
      {}, {{":path", "/other.S/M"}}, {{":method", "GET"}}, {{"grpc-encoding", "gzip"}}};
  for (const http2::Fields& changes : requests) {
    RawHttp2 client(ClientOf(world, keys));
    ASSERT_TRUE(client.Begin());
    client.Send(OpenRelay(1, changes));
    ASSERT_TRUE(client.ReadUntilOver(1));
    EXPECT_EQ(StatusOf(client.At(1)), "16");
    EXPECT_THAT(client.At(1).Trailer("grpc-message"), StartsWith(sentence));
    EXPECT_TRUE(client.ReadUntilEnd());
    EXPECT_EQ(client.goaway_code(), http2::kNoError);
    EXPECT_EQ(client.end(), RawTcp::End::kClosed);
  }
  EXPECT_EQ(world.session_probe.streams_total.value(), 0);
  EXPECT_EQ(world.relay_probe.refused_identity_total.value(),
            static_cast<std::int64_t>(requests.size()));
  EXPECT_TRUE(Eventually([&] { return world.relay_probe.connections.value() == 0; }));
}

}  // namespace
}  // namespace uplink::testing
