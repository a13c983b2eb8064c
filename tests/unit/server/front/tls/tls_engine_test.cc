#include "server/front/tls/tls_engine.h"

#include <memory>
#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <openssl/bio.h>
#include <openssl/pem.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include "server/config/tls_groups.h"
#include "server/identity/authority_rules.h"
#include "server/identity/certificate_gate.h"
#include "server/identity/pem.h"
#include "server/identity/scope.h"
#include "tests/support/memory_tls.h"
#include "tests/support/odd_certificates.h"
#include "tests/unit/server/front/tls/handshake.h"

namespace uplink::front {
namespace {

namespace odd = testing::odd;
using identity::CertificateFlaw;
using testing::CertificateSpec;
using ::testing::HasSubstr;
using testing::KeyPair;
using testing::MemoryTls;
using testing::RobotSpec;
using testing::ShownChain;
using Failure = TlsEngine::Failure;

constexpr char kRuri[] = "rcan://x.local/robots/1";

transport::TlsRules RulesOf(config::TlsVersion minimum) {
  config::TlsConfig tls;
  tls.min_version = minimum;
  return {.minimum = minimum, .groups = config::ServedGroups(tls)};
}

/// What came of a handshake.
struct Outcome {
  bool done = false;
  Failure failure = Failure::kNone;
  CertificateFlaw flaw = CertificateFlaw::kNone;
  std::string detail;
  std::optional<int> alert;
  std::string ruri;
};

class TlsEngineTest : public ::testing::Test {
 protected:
  Outcome Handshake(const MemoryTls::Options& options) {
    auto context = TlsContext::Make(texts_, rules_);
    EXPECT_TRUE(context.ok()) << context.status();
    TlsEngine engine(*context, method_, buffers_);
    MemoryTls client(options);
    const TlsEngine::Step step = ShakeHands(engine, buffers_, client);
    static_cast<void>(client.Step(buffers_.out));
    buffers_.out.clear();
    buffers_.in = {};
    Outcome outcome{.done = step == TlsEngine::Step::kDone,
                    .failure = engine.failure(),
                    .flaw = engine.certificate_flaw(),
                    .detail = std::string(engine.detail()),
                    .alert = client.alert()};
    if (outcome.done) outcome.ruri = engine.Peer().ruri;
    return outcome;
  }

  MemoryTls::Options Robot() const { return With(RobotSpec(kRuri)); }
  MemoryTls::Options With(const CertificateSpec& spec) const {
    return {.identity = authority_.Issue(spec), .behind = nullptr};
  }
  static std::shared_ptr<const ShownChain> Behind(std::size_t count,
                                                  const std::string& certificate) {
    return std::make_shared<ShownChain>(std::vector<std::string>(count, certificate));
  }

  const testing::TestAuthority authority_;
  const KeyPair server_ = authority_.Issue(testing::ServerSpec());
  transport::PemTexts texts_{.certificate = server_.certificate,
                             .key = server_.key,
                             .client_ca = authority_.certificate()};
  transport::TlsRules rules_ = RulesOf(config::TlsVersion::k13);
  const BufferMethod method_;
  TlsBuffers buffers_{};
};

/// A robot's side of a handshake whose peer answers in pieces of so many bytes.
class TlsEnginePieces : public TlsEngineTest {
 protected:
  struct Result {
    TlsEngine::Step step = TlsEngine::Step::kMore;
    std::size_t reads = 0;
    /// Of the client's bytes, those that came and those that were read.
    std::size_t came = 0;
    std::size_t read = 0;
    Failure failure = Failure::kNone;
    std::string detail;
  };
  Result HandshakeIn(std::size_t piece, std::size_t padded_bytes = 0) {
    auto context = TlsContext::Make(texts_, rules_);
    EXPECT_TRUE(context.ok()) << context.status();
    TlsEngine engine(*context, method_, buffers_);
    robot_.padded_bytes = padded_bytes;
    MemoryTls client(robot_);
    Result result;
    while (result.step == TlsEngine::Step::kMore) {
      const std::string heard = client.Step(buffers_.out);
      buffers_.out.clear();
      if (heard.empty()) break;
      for (std::size_t at = 0; at < heard.size() && result.step == TlsEngine::Step::kMore;
           at += piece) {
        buffers_.in = std::string_view(heard).substr(at, piece);
        result.came += buffers_.in.size();
        result.read += buffers_.in.size();
        ++result.reads;
        result.step = engine.Handshake();
        result.read -= buffers_.in.size();
      }
    }
    buffers_.out.clear();
    buffers_.in = {};
    result.failure = engine.failure();
    result.detail = engine.detail();
    return result;
  }

  MemoryTls::Options robot_ = Robot();
};

TEST_F(TlsEnginePieces, SmallSegmentsAreTaken) {
  const Result result = HandshakeIn(64);
  EXPECT_EQ(result.step, TlsEngine::Step::kDone);
  EXPECT_LE(result.reads, kHandshakeReadsMax);
}

TEST_F(TlsEnginePieces, OneByteAtATimeEndsTheHandshake) {
  const Result result = HandshakeIn(1);
  EXPECT_EQ(result.step, TlsEngine::Step::kFailed);
  EXPECT_EQ(result.reads, kHandshakeReadsMax + 1);
  EXPECT_EQ(result.detail, "a handshake in over 128 pieces");
}

TEST_F(TlsEnginePieces, ARecordIsTakenWholeAndThreeThatArePaddedToTheirMostAreNot) {
  EXPECT_EQ(HandshakeIn(kRecordBytes).step, TlsEngine::Step::kDone);
  // Certificate, signature and Finished have a record each.
  EXPECT_EQ(HandshakeIn(kRecordBytes, kRecordBytes).detail, "a handshake of over 48 KiB");
}

/// Certificate, signature and Finished come at once, in a record each, whose sizes grow by a byte.
TEST_F(TlsEnginePieces, NoByteIsReadPastTheBound) {
  constexpr std::size_t kPadded = 10'000;
  constexpr std::size_t kAtOnce = 2 * kHandshakeBytesMax;
  const Result some = HandshakeIn(kAtOnce, kPadded);
  ASSERT_EQ(some.step, TlsEngine::Step::kDone);
  const std::size_t most = kPadded + (kHandshakeBytesMax - some.came) / 3;
  const Result taken = HandshakeIn(kAtOnce, most);
  EXPECT_EQ(taken.step, TlsEngine::Step::kDone) << taken.detail;
  EXPECT_EQ(taken.read, taken.came);
  const Result refused = HandshakeIn(kAtOnce, most + 1);
  EXPECT_EQ(refused.step, TlsEngine::Step::kFailed);
  EXPECT_EQ(refused.detail, "a handshake of over 48 KiB");
  EXPECT_GT(refused.came, kHandshakeBytesMax);
  EXPECT_LE(refused.came, kHandshakeBytesMax + 3);
  EXPECT_EQ(refused.read, kHandshakeBytesMax);
}

/// It names what it failed for, whatever else is true of it.
TEST_F(TlsEnginePieces, AHandshakeThatFailsHasOneCause) {
  constexpr std::size_t kAtOnce = 2 * kHandshakeBytesMax;
  const testing::TestAuthority other("another authority");
  robot_.identity = other.Issue(RobotSpec(kRuri));
  const Result stranger = HandshakeIn(kAtOnce);
  EXPECT_EQ(stranger.failure, Failure::kUntrusted);
  EXPECT_EQ(stranger.detail, "unable to get local issuer certificate");
  const Result large_stranger = HandshakeIn(kAtOnce, kRecordBytes);
  EXPECT_GT(large_stranger.came, kHandshakeBytesMax);
  EXPECT_EQ(large_stranger.failure, Failure::kUntrusted);
  EXPECT_EQ(large_stranger.detail, stranger.detail);
  robot_.behind = Behind(1, odd::CertificateWith(odd::ExplicitCurveKey()));
  const Result odd_one = HandshakeIn(kAtOnce, kRecordBytes);
  EXPECT_EQ(odd_one.failure, Failure::kCertificate);
  EXPECT_EQ(odd_one.detail, identity::TextOf(CertificateFlaw::kKeyKind));
}

/// Both versions, since their Certificate messages differ.
class TlsEngineGate : public TlsEngineTest, public ::testing::WithParamInterface<int> {
 protected:
  TlsEngineGate() { rules_ = RulesOf(config::TlsVersion::k12); }
  Outcome Shows(std::shared_ptr<const ShownChain> behind) {
    MemoryTls::Options options = Robot();
    options.version_max = GetParam();
    options.behind = std::move(behind);
    return Handshake(options);
  }
  void ExpectTurnedAway(const Outcome& outcome, CertificateFlaw flaw) {
    EXPECT_FALSE(outcome.done);
    EXPECT_EQ(outcome.failure, Failure::kCertificate);
    EXPECT_EQ(outcome.flaw, flaw);
  }
};

TEST_P(TlsEngineGate, ACurveThatIsWrittenOutIsNotLookedInto) {
  const Outcome outcome = Shows(Behind(1, odd::CertificateWith(odd::ExplicitCurveKey())));
  ExpectTurnedAway(outcome, CertificateFlaw::kKeyKind);
  EXPECT_EQ(outcome.alert, SSL_AD_DECODE_ERROR);
}

TEST_P(TlsEngineGate, TenCertificatesAreTakenAndElevenAreNot) {
  const std::string other = odd::CertificateWith(odd::Ed25519Key());
  const Outcome ten = Shows(Behind(identity::kShownCertificatesMax - 1, other));
  EXPECT_TRUE(ten.done);
  EXPECT_EQ(ten.ruri, kRuri);
  ExpectTurnedAway(Shows(Behind(identity::kShownCertificatesMax, other)), CertificateFlaw::kCount);
}

TEST_P(TlsEngineGate, ALongRsaKeyIsNotLookedInto) {
  EXPECT_TRUE(Shows(Behind(1, odd::CertificateWith(odd::RsaKey(4096, 64)))).done);
  ExpectTurnedAway(Shows(Behind(1, odd::CertificateWith(odd::RsaKey(4097, 17)))),
                   CertificateFlaw::kKeySize);
}

TEST_P(TlsEngineGate, MoreThan32KiBAreNotRead) {
  odd::Parts parts;
  parts.key = odd::Ed25519Key();
  parts.extensions = odd::Extension("\x2A", std::string(identity::kShownBytesMax, 'x'));
  ExpectTurnedAway(Shows(Behind(1, odd::CertificateOf(parts))), CertificateFlaw::kBytes);
}

TEST_P(TlsEngineGate, AGatewaysCertificateNames256Robots) {
  CertificateSpec spec;
  spec.units = {"gateway"};
  for (int i = 0; i < 256; ++i) {
    spec.uris.push_back("rcan://fleet.example.com/manufacturer/model/robots/" +
                        std::to_string(1000 + i));
  }
  MemoryTls::Options options = With(spec);
  options.version_max = GetParam();
  EXPECT_TRUE(Handshake(options).done);
}

INSTANTIATE_TEST_SUITE_P(Versions, TlsEngineGate,
                         ::testing::Values(TLS1_2_VERSION, TLS1_3_VERSION));

/// Every kind of key that the gate lets through is one that a robot can come with, by both
/// versions: OpenSSL holds a certificate's curve against the groups by TLS 1.2.
TEST_F(TlsEngineTest, RobotsComeWithEveryKindOfKey) {
  for (const auto minimum : {config::TlsVersion::k12, config::TlsVersion::k13}) {
    rules_ = RulesOf(minimum);
    for (const char* key : {"P-256", "P-384", "P-521", "RSA", "ED25519", "ED448"}) {
      CertificateSpec spec = RobotSpec(kRuri);
      spec.key = key;
      MemoryTls::Options options = With(spec);
      if (minimum == config::TlsVersion::k12) options.version_max = TLS1_2_VERSION;
      const Outcome outcome = Handshake(options);
      EXPECT_TRUE(outcome.done) << key << " by TLS " << options.version_max;
      EXPECT_EQ(outcome.ruri, kRuri);
    }
  }
}

/// TLS 1.3 has no signature by them: a client's library shows nothing, and we see no certificate
/// to name.
TEST_F(TlsEngineTest, ByTls13AKeyThatItDoesNotSignWithIsNotEvenShown) {
  for (const char* key : {"secp256k1", "brainpoolP256r1"}) {
    CertificateSpec spec = RobotSpec(kRuri);
    spec.key = key;
    const Outcome outcome = Handshake(With(spec));
    EXPECT_EQ(outcome.failure, Failure::kNoCertificate) << key;
    EXPECT_EQ(outcome.alert, SSL_AD_CERTIFICATE_REQUIRED) << key;
  }
}

TEST_F(TlsEngineTest, ByTls12SuchAKeyIsShownAndNotLookedInto) {
  rules_ = RulesOf(config::TlsVersion::k12);
  for (const char* key : {"secp256k1", "brainpoolP256r1"}) {
    CertificateSpec spec = RobotSpec(kRuri);
    spec.key = key;
    MemoryTls::Options options = With(spec);
    options.version_max = TLS1_2_VERSION;
    const Outcome outcome = Handshake(options);
    EXPECT_EQ(outcome.failure, Failure::kCertificate) << key;
    EXPECT_EQ(outcome.flaw, CertificateFlaw::kKeyKind) << key;
  }
}

TEST_F(TlsEngineTest, RobotsComeWithACompressedPoint) {
  for (const char* key : {"P-256", "P-384", "P-521"}) {
    CertificateSpec spec = RobotSpec(kRuri);
    spec.key = key;
    spec.compressed = true;
    EXPECT_TRUE(Handshake(With(spec)).done) << key;
  }
}

/// What comes once the handshake is over.
class TlsEngineLater : public TlsEngineTest {
 protected:
  void Meet(int version_max) {
    rules_ = RulesOf(config::TlsVersion::k12);
    auto context = TlsContext::Make(texts_, rules_);
    ASSERT_TRUE(context.ok()) << context.status();
    engine_.emplace(*context, method_, buffers_);
    MemoryTls::Options robot = Robot();
    robot.version_max = version_max;
    client_.emplace(robot);
    auto step = TlsEngine::Step::kMore;
    while (step == TlsEngine::Step::kMore) {
      said_ = client_->Step(buffers_.out);
      buffers_.out.clear();
      buffers_.in = said_;
      step = engine_->Handshake();
    }
    ASSERT_EQ(step, TlsEngine::Step::kDone);
    static_cast<void>(client_->Step(buffers_.out));
    buffers_.out.clear();
  }
  /// Each piece that the engine reads of that.
  std::vector<std::string> PiecesOf(std::string result) {
    said_ = std::move(result);
    buffers_.in = said_;
    std::vector<std::string> pieces;
    while (const auto piece = engine_->Read()) pieces.emplace_back(*piece);
    return pieces;
  }

  std::string said_;
  std::optional<TlsEngine> engine_;
  std::optional<MemoryTls> client_;
};

TEST_F(TlsEngineLater, EachRenewalOfKeysIsToldBeforeWhatFollowsIsRead) {
  ASSERT_NO_FATAL_FAILURE(Meet(TLS1_3_VERSION));
  std::string result = client_->Say("one");
  result += client_->RenewKeys();
  result += client_->RenewKeys();
  result += client_->Say("two");
  EXPECT_EQ(PiecesOf(result), (std::vector<std::string>{"one", "", "", "two"}));
  EXPECT_TRUE(buffers_.in.empty());
  EXPECT_FALSE(engine_->over());
}

TEST_F(TlsEngineLater, WhatFollowsARenewalThatIsOneTooManyIsNotRead) {
  ASSERT_NO_FATAL_FAILURE(Meet(TLS1_3_VERSION));
  const std::string one = client_->RenewKeys();
  said_ = one + client_->RenewKeys();
  buffers_.in = said_;
  EXPECT_EQ(engine_->Read(), "");
  EXPECT_EQ(buffers_.in.size(), said_.size() - one.size()) << "its own cost, and no more";
}

// So no Certificate message comes by TLS 1.2 after the first handshake.
TEST_F(TlsEngineLater, ASecondHandshakeIsRefusedAndTold) {
  ASSERT_NO_FATAL_FAILURE(Meet(TLS1_2_VERSION));
  EXPECT_EQ(PiecesOf(client_->Renegotiate()), std::vector<std::string>{""});
  EXPECT_FALSE(engine_->over());
  static_cast<void>(client_->Step(buffers_.out));
  EXPECT_EQ(client_->alert(), SSL_AD_NO_RENEGOTIATION);
}

TEST_F(TlsEngineTest, KeysAreAgreedOnByTheGroupsOfTheRulesAlone) {
  MemoryTls::Options options = Robot();
  for (const char* group : {"X25519", "P-256"}) {
    options.groups = group;
    EXPECT_TRUE(Handshake(options).done) << group;
  }
  for (const char* group : {"P-384", "P-521"}) {
    options.groups = group;
    EXPECT_EQ(Handshake(options).failure, Failure::kNothingShared) << group;
  }
  rules_.groups = "P-521:P-384";
  options.groups = "P-384";
  EXPECT_TRUE(Handshake(options).done);
  options.groups = "X25519";
  EXPECT_EQ(Handshake(options).failure, Failure::kNothingShared);
}

TEST_F(TlsEngineTest, AWeakKeyIsRefusedInTheLibrarysWords) {
  CertificateSpec spec = RobotSpec(kRuri);
  spec.key = "RSA-1024";
  const Outcome outcome = Handshake(With(spec));
  EXPECT_EQ(outcome.failure, Failure::kUntrusted);
  EXPECT_EQ(outcome.detail, "EE certificate key too weak");
}

TEST_F(TlsEngineTest, AnAuthorityWithTheNameOfOursIsNoneOfOurs) {
  const testing::TestAuthority other("test authority");
  const Outcome outcome = Handshake({.identity = other.Issue(RobotSpec(kRuri)), .behind = nullptr});
  EXPECT_EQ(outcome.failure, Failure::kUntrusted);
}

/// A robot that came in, and authorities that change afterwards.
class TlsEngineStay : public TlsEngineTest {
 protected:
  /// What the robot is told; empty: it stays.
  std::string Told(const transport::PemTexts& later) {
    const auto first = TlsContext::Make(texts_, rules_);
    const auto now = TlsContext::Make(later, rules_);
    EXPECT_TRUE(first.ok() && now.ok()) << first.status() << now.status();
    TlsEngine engine(*first, method_, buffers_);
    MemoryTls client(Robot());
    EXPECT_EQ(ShakeHands(engine, buffers_, client), TlsEngine::Step::kDone);
    buffers_.out.clear();
    buffers_.in = {};
    const TlsPeer peer = engine.Peer();
    EXPECT_TRUE(peer.identity.ok()) << peer.identity.status();
    return std::string(engine.JudgeAgain(**now, *peer.identity).message());
  }
  [[nodiscard]] identity::AuthorityRules Hall(const identity::Scope& fleets) const {
    identity::AuthorityRules rules;
    EXPECT_TRUE(
        rules.Add({"hall.pem", authority_.certificate()}, {.name = "hall", .fleets = fleets}).ok());
    return rules;
  }
  /// The authority's certificate with another serial number: the same name and key.
  [[nodiscard]] std::string Renewed() const {
    const auto read = identity::ReadCertificates({"ca.crt", authority_.certificate()});
    EXPECT_TRUE(read.ok()) << read.status();
    const identity::Certificate renewed(X509_dup(read->front().get()));
    EXPECT_EQ(ASN1_INTEGER_set(X509_get_serialNumber(renewed.get()), 77), 1);
    // From now on it is written anew.
    EXPECT_GT(i2d_re_X509_tbs(renewed.get(), nullptr), 0);
    const identity::Bio bio(BIO_new(BIO_s_mem()));
    EXPECT_EQ(PEM_write_bio_X509(bio.get(), renewed.get()), 1);
    char* text = nullptr;
    const long size = BIO_get_mem_data(bio.get(), &text);
    return {text, static_cast<std::size_t>(size)};
  }
  [[nodiscard]] transport::PemTexts With(const std::string& client_ca) const {
    transport::PemTexts texts = texts_;
    texts.client_ca = client_ca;
    return texts;
  }

  const testing::TestAuthority other_{"other"};
};

TEST_F(TlsEngineStay, OneOutsideTheNewEntryIsToldAsAtItsHandshake) {
  transport::PemTexts later = texts_;
  later.rules = Hall(identity::Scope::All());
  EXPECT_EQ(Told(later), "");
  later.rules = Hall(identity::Scope::Of({"north"}));
  EXPECT_THAT(Told(later), HasSubstr("its authority hall may not vouch for the fleet"));
}

TEST_F(TlsEngineStay, AnAuthorityThatHadAnEntryEndsItsRobotsAsItGoes) {
  texts_.rules = Hall(identity::Scope::All());
  transport::PemTexts later = With(other_.certificate());
  later.rules = {};
  EXPECT_EQ(Told(later), "client certificate: its authority is not trusted any more");
  later.client_ca += authority_.certificate();
  EXPECT_EQ(Told(later), "");
}

TEST_F(TlsEngineStay, OneThatHadNoneLetsItsStreamsGoOn) {
  EXPECT_EQ(Told(With(other_.certificate())), "");
}

TEST_F(TlsEngineStay, ARenewedAuthorityIsTheSame) {
  texts_.rules = Hall(identity::Scope::All());
  transport::PemTexts later = With(Renewed());
  later.rules = {};
  EXPECT_EQ(Told(later), "");
  ASSERT_TRUE(later.rules
                  .Add({"hall.pem", later.client_ca},
                       {.name = "hall", .fleets = identity::Scope::Of({"north"})})
                  .ok());
  EXPECT_THAT(Told(later), HasSubstr("its authority hall may not vouch for the fleet"));
}

TEST_F(TlsEngineTest, AServersCertificateMayBeOnACurveThatIsNoGroup) {
  CertificateSpec spec = testing::ServerSpec();
  spec.key = "P-384";
  const KeyPair server = authority_.Issue(spec);
  texts_.certificate = server.certificate;
  texts_.key = server.key;
  EXPECT_TRUE(Handshake(Robot()).done);
}

}  // namespace
}  // namespace uplink::front
