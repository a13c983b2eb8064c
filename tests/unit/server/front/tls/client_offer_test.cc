// What the log says of a client with which we share nothing.
#include "server/front/tls/client_offer.h"

#include <cstdint>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/ssl.h>

#include "server/config/tls_groups.h"
#include "server/front/tls/tls_engine.h"
#include "tests/support/memory_tls.h"
#include "tests/unit/server/front/tls/handshake.h"

namespace uplink::front {
namespace {

using ::testing::EndsWith;
using ::testing::HasSubstr;
using testing::MemoryTls;
using ::testing::Not;
using ::testing::StartsWith;

std::string Number(std::size_t value, std::size_t bytes) {
  std::string text;
  for (std::size_t i = bytes; i > 0; --i) text += static_cast<char>(value >> (8 * (i - 1)));
  return text;
}

std::string Sized(const std::string& content, std::size_t length_bytes) {
  return Number(content.size(), length_bytes) + content;
}

/// A ClientHello that says TLS 1.2 where old clients do, and offers these versions where new ones
/// do; none: it has no such place.
std::string HelloOf(const std::vector<std::uint16_t>& versions) {
  std::string list;
  for (const std::uint16_t version : versions) list += Number(version, 2);
  const std::string extensions =
      versions.empty() ? "" : Number(TLSEXT_TYPE_supported_versions, 2) + Sized(Sized(list, 1), 2);
  const std::string body = Number(TLS1_2_VERSION, 2) + std::string(32, 'r') + Sized("", 1) +
                           Sized(Number(0x1301, 2), 2) + Sized(std::string(1, '\0'), 1) +
                           Sized(extensions, 2);
  return Number(22, 1) + Number(TLS1_VERSION, 2) + Sized(Number(1, 1) + Sized(body, 3), 2);
}

class ClientOfferTest : public ::testing::Test {
 protected:
  /// What the log would say beside `nothing_shared` of a client that says this.
  std::string SaidOfHello(const std::string& hello) {
    TlsEngine engine(Context(), method_, buffers_);
    buffers_.in = hello;
    EXPECT_EQ(engine.Handshake(), TlsEngine::Step::kFailed);
    return DetailOf(engine);
  }
  std::string SaidOf(MemoryTls::Options options) {
    options.identity = robot_;
    TlsEngine engine(Context(), method_, buffers_);
    MemoryTls client(options);
    EXPECT_EQ(ShakeHands(engine, buffers_, client), TlsEngine::Step::kFailed);
    return DetailOf(engine);
  }
  void Accept12() {
    config::TlsConfig tls;
    tls.min_version = config::TlsVersion::k12;
    rules_ = {.minimum = tls.min_version, .groups = config::ServedGroups(tls)};
  }

  transport::TlsRules rules_;
  const testing::TestAuthority authority_;
  testing::KeyPair server_ = authority_.Issue(testing::ServerSpec());

 private:
  std::shared_ptr<const TlsContext> Context() {
    auto made = TlsContext::Make({.certificate = server_.certificate,
                                  .key = server_.key,
                                  .client_ca = authority_.certificate()},
                                 rules_);
    EXPECT_TRUE(made.ok()) << made.status();
    return *made;
  }
  std::string DetailOf(const TlsEngine& engine) {
    EXPECT_EQ(engine.failure(), TlsEngine::Failure::kNothingShared);
    buffers_.in = {};
    buffers_.out.clear();
    return std::string(engine.detail());
  }

  const testing::KeyPair robot_ = authority_.Issue(testing::RobotSpec("rcan://x.local/robots/1"));
  const BufferMethod method_;
  TlsBuffers buffers_{};
};

TEST_F(ClientOfferTest, VersionsAreNamed) {
  EXPECT_EQ(SaidOf({.version_max = TLS1_2_VERSION}),
            "it offers TLS 1.2, and we take TLS 1.3 (tls.min_version)");
  EXPECT_EQ(SaidOfHello(HelloOf({})), "it offers TLS 1.2, and we take TLS 1.3 (tls.min_version)");
  EXPECT_EQ(SaidOfHello(HelloOf({TLS1_2_VERSION, TLS1_1_VERSION})),
            "it offers TLS 1.2, TLS 1.1, and we take TLS 1.3 (tls.min_version)");
  Accept12();
  EXPECT_EQ(SaidOfHello(HelloOf({TLS1_1_VERSION, 0x0200})),
            "it offers TLS 1.1, 0x0200, and we take TLS 1.2, TLS 1.3 (tls.min_version)");
}

TEST_F(ClientOfferTest, WhatServersPassOverIsNotNamed) {
  EXPECT_EQ(SaidOfHello(HelloOf({0x0A0A, TLS1_2_VERSION, 0xFAFA})),
            "it offers TLS 1.2, and we take TLS 1.3 (tls.min_version)");
}

TEST_F(ClientOfferTest, EightOfAListAreNamedAndTheOthersCounted) {
  std::vector<std::uint16_t> versions;
  while (versions.size() < 8)
    versions.push_back(static_cast<std::uint16_t>(0x0501 + versions.size()));
  EXPECT_THAT(SaidOfHello(HelloOf(versions)), HasSubstr("0x0507, 0x0508, and we take"));
  versions.push_back(0x0509);
  EXPECT_THAT(SaidOfHello(HelloOf(versions)), HasSubstr("0x0508 and 1 more, and we take"));
}

TEST_F(ClientOfferTest, GroupsAreNamedAsTheConfigurationNamesThem) {
  EXPECT_EQ(SaidOf({.groups = "P-384:P-521:X448"}),
            "it offers the groups P-384, P-521, X448, and we take X25519, P-256 (tls.groups)");
}

TEST_F(ClientOfferTest, SuitesAreNamedBesideWhatTheyDependOn) {
  Accept12();
  const std::string said =
      SaidOf({.version_max = TLS1_2_VERSION, .suites_of_12 = "ECDHE-RSA-AES128-GCM-SHA256"});
  EXPECT_THAT(said, StartsWith("it offers the suites ECDHE-RSA-AES128-GCM-SHA256"));
  EXPECT_THAT(said, HasSubstr(" for our key EC (prime256v1), whose curve"));
  EXPECT_THAT(said, EndsWith(" and the groups X25519, P-256, P-384, P-521"));
}

TEST_F(ClientOfferTest, SignaturesAreNamedBesideOurKey) {
  EXPECT_EQ(
      SaidOf({.signatures = "rsa_pss_rsae_sha256:rsa_pkcs1_sha256"}),
      "it offers the signature algorithms rsa_pss_rsae_sha256, rsa_pkcs1_sha256, and our key is EC "
      "(prime256v1)");
}

TEST_F(ClientOfferTest, ProtocolsAreNamed) {
  EXPECT_EQ(SaidOf({.protocols = "\x08http/1.1"}), "it offers by ALPN http/1.1, and we take h2");
  EXPECT_EQ(SaidOf({.protocols = "\x08http/1.1\x08http/1.0"}),
            "it offers by ALPN http/1.1, http/1.0, and we take h2");
  EXPECT_EQ(SaidOf({.protocols = ""}), "it offers by ALPN none, and we take h2");
  EXPECT_EQ(SaidOf({.protocols = "\x03"
                                 "a\nb"}),
            "it offers by ALPN a\\x0ab, and we take h2");
}

TEST_F(ClientOfferTest, ProtocolsAreCutAtTheirBound) {
  const std::string most(63, 'x');
  EXPECT_THAT(SaidOf({.protocols = Sized(most, 1)}), HasSubstr("ALPN " + most + ", and"));
  const std::string said = SaidOf({.protocols = Sized(most, 1) + Sized("more", 1)});
  EXPECT_THAT(said, HasSubstr("ALPN " + most + ", and"));
  EXPECT_THAT(said, Not(HasSubstr("more")));
}

/// The thread's memory of an offer is another client's otherwise.
TEST_F(ClientOfferTest, OfAnotherClientNothingIsSaid) {
  EXPECT_THAT(SaidOf({.protocols = "\x08http/1.1"}), HasSubstr("http/1.1"));
  EXPECT_THAT(SaidOf({.protocols = ""}), EndsWith("none, and we take h2"));
}

}  // namespace
}  // namespace uplink::front
