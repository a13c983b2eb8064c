#include "server/identity/certificate_gate.h"

#include <memory>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <openssl/x509v3.h>

#include "tests/support/certificates.h"
#include "tests/support/der.h"
#include "tests/support/odd_certificates.h"

namespace uplink::identity {
namespace {

namespace der = uplink::testing::der;
namespace odd = uplink::testing::odd;
using uplink::testing::CertificateSpec;
using uplink::testing::RobotSpec;
using uplink::testing::TestAuthority;

const std::string kNames("\x55\x1D\x11", 3);
/// A name of a host, in a subjectAltName.
const std::string kHost = der::Element(0x82, "a");

Bytes BytesOf(const std::string& text) {
  return {reinterpret_cast<const std::uint8_t*>(text.data()), text.size()};
}

CertificateFlaw FlawOf(const std::string& certificate) {
  return FlawOfCertificate(BytesOf(certificate));
}

odd::Parts Good() {
  odd::Parts parts;
  parts.key = odd::Ed25519Key();
  return parts;
}

std::string GoodCertificate() { return odd::CertificateOf(Good()); }

CertificateFlaw FlawOf12(const std::vector<std::string>& certificates) {
  return FlawOfMessage(MessageForm::kTls12, BytesOf(odd::MessageOf12(certificates)));
}

CertificateFlaw FlawOf13(const std::vector<std::string>& certificates) {
  return FlawOfMessage(MessageForm::kTls13, BytesOf(odd::MessageOf13(certificates)));
}

std::string Times(std::size_t count, const std::string& text) {
  std::string all;
  for (std::size_t i = 0; i < count; ++i) all += text;
  return all;
}

/// A robot's names in one extension, beside `others`.
std::string WithNames(std::size_t count) {
  odd::Parts parts = Good();
  parts.extensions = odd::Extension(kNames, der::Sequence(Times(count, kHost)));
  return odd::CertificateOf(parts);
}

TEST(CertificateGate, TakesRealCertificates) {
  const TestAuthority authority;
  EXPECT_EQ(FlawOf(odd::DerOf(authority.certificate()).front()), CertificateFlaw::kNone);
  const auto robot = authority.Issue(RobotSpec("rcan://x.local/robots/1", "fleet"));
  EXPECT_EQ(FlawOf(odd::DerOf(robot.certificate).front()), CertificateFlaw::kNone);
  const auto server = authority.Issue(testing::ServerSpec());
  EXPECT_EQ(FlawOf(odd::DerOf(server.certificate).front()), CertificateFlaw::kNone);
}

TEST(CertificateGate, TakesAGatewaysWith256RobotsInItsChain) {
  const TestAuthority root("a root");
  const TestAuthority authority("an authority", root);
  CertificateSpec spec;
  spec.units = {"gateway"};
  spec.organizations = {std::string(64, 'f')};
  for (int i = 0; i < 256; ++i) {
    spec.uris.push_back("rcan://fleet.example.com/manufacturer/model/robots/" +
                        std::to_string(1000 + i));
  }
  const std::vector<std::string> chain = {odd::DerOf(authority.Issue(spec).certificate).front(),
                                          odd::DerOf(authority.certificate()).front(),
                                          odd::DerOf(root.certificate()).front()};
  EXPECT_EQ(FlawOf12(chain), CertificateFlaw::kNone);
  EXPECT_EQ(FlawOf13(chain), CertificateFlaw::kNone);
}

TEST(CertificateGate, JudgesTheKey) {
  EXPECT_EQ(FlawOf(odd::CertificateWith(odd::RsaKey(4096, 64))), CertificateFlaw::kNone);
  EXPECT_EQ(FlawOf(odd::CertificateWith(odd::RsaKey(4097, 17))), CertificateFlaw::kKeySize);
  EXPECT_EQ(FlawOf(odd::CertificateWith(odd::ExplicitCurveKey())), CertificateFlaw::kKeyKind);
  EXPECT_EQ(FlawOf(odd::CertificateWith(der::Sequence(""))), CertificateFlaw::kMalformed);
}

TEST(CertificateGate, TakesTheOptionalPartsInTheirOrder) {
  odd::Parts parts = Good();
  parts.version.clear();
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kNone) << "version 1";
  const std::string issuer_id = der::Element(0x81, std::string("\0x", 2));
  const std::string subject_id = der::Element(0x82, std::string("\0x", 2));
  const std::string extensions =
      der::Element(0xA3, der::Sequence(odd::Extension(kNames, der::Sequence(kHost))));
  parts.tail = issuer_id + subject_id + extensions;
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kNone);
  parts.tail = subject_id + issuer_id;
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kMalformed);
  parts.tail = extensions + extensions;
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kMalformed);
  parts.tail = extensions + parts.key;
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kMalformed);
}

TEST(CertificateGate, ACertificateThatEndsTooSoonOrTooLateIsMalformed) {
  const std::string good = GoodCertificate();
  for (std::size_t size = 0; size < good.size(); ++size) {
    EXPECT_EQ(FlawOf(good.substr(0, size)), CertificateFlaw::kMalformed) << size;
  }
  EXPECT_EQ(FlawOf(good), CertificateFlaw::kNone);
  EXPECT_EQ(FlawOf(good + std::string(1, '\0')), CertificateFlaw::kMalformed);
}

/// A byte of a key's length or tag that changes must not make the gate see another key than
/// OpenSSL: whatever is still taken has the key's own kind at its place.
TEST(CertificateGate, NoChangedByteOfAnExplicitCurveMakesItPass) {
  const std::string bad = odd::CertificateWith(odd::ExplicitCurveKey());
  for (std::size_t at = 0; at < bad.size(); ++at) {
    for (const int change : {1, 0x20, 0x80}) {
      std::string changed = bad;
      changed[at] = static_cast<char>(changed[at] ^ change);
      EXPECT_NE(FlawOf(changed), CertificateFlaw::kNone) << at;
    }
  }
}

TEST(CertificateGate, ElementsOfNamesAndExtensionsAreCounted) {
  // Subject and issuer have 4 each, the extension 3, its list 1.
  constexpr std::size_t kOthers = 4 + 4 + 3 + 1;
  EXPECT_EQ(FlawOf(WithNames(kShownElementsMax - kOthers)), CertificateFlaw::kNone);
  EXPECT_EQ(FlawOf(WithNames(kShownElementsMax - kOthers + 1)), CertificateFlaw::kElements);

  odd::Parts parts = Good();
  parts.extensions = Times(kShownElementsMax / 3, odd::Extension("\x2A", ""));
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kElements);

  parts = Good();
  const std::string attribute =
      der::Sequence(der::Oid(std::string("\x55\x04\x03", 3)) + der::Element(0x0C, "a"));
  parts.subject = der::Sequence(der::Set(Times(kShownElementsMax / 3, attribute)));
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kElements);
}

TEST(CertificateGate, AValueThatIsNoDerCountsAsTheMostThatItCouldBe) {
  odd::Parts parts = Good();
  parts.extensions = odd::Extension("\x2A", "no element of DER");
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kNone);
  // An indefinite length, which DER has not and OpenSSL takes.
  const std::string many = std::string("\x30\x80", 2) + Times(10'000, kHost) + std::string(2, '\0');
  parts.extensions = odd::Extension(kNames, many);
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kElements);
}

const std::string kCrlPoints("\x55\x1D\x1F", 3);

CertificateFlaw FlawWithPoints(const std::string& points) {
  odd::Parts parts = Good();
  parts.extensions = odd::Extension(kCrlPoints, points);
  return FlawOf(odd::CertificateOf(parts));
}

TEST(CertificateGate, PointsOfRevocationListsAreNamedInFull) {
  const std::string list = der::Element(0x86, "http://ca.example.org/list");
  const std::string in_full = der::Element(0xA0, der::Element(0xA0, list));
  const std::string reasons = der::Element(0x81, std::string("\x00\x80", 2));
  const std::string issuer = der::Element(0xA2, list);
  EXPECT_EQ(FlawWithPoints(der::Sequence(der::Sequence(in_full))), CertificateFlaw::kNone);
  EXPECT_EQ(FlawWithPoints(
                der::Sequence(der::Sequence(in_full + reasons + issuer) + der::Sequence(issuer))),
            CertificateFlaw::kNone);
}

/// OpenSSL copies the issuer's name for each of them, before it knows who signed.
TEST(CertificateGate, APointThatIsRelativeToItsIssuerIsAFlawOfItsOwn) {
  const std::string attribute =
      der::Sequence(der::Oid(std::string("\x55\x04\x03", 3)) + der::Element(0x0C, "a"));
  for (const std::uint8_t relative : {std::uint8_t{0xA1}, std::uint8_t{0x81}}) {
    const std::string name = der::Element(0xA0, der::Element(relative, attribute));
    EXPECT_EQ(FlawWithPoints(der::Sequence(der::Sequence(name))), CertificateFlaw::kRelativePoint);
  }
  // OpenSSL takes each of these lists without the bit that says that it is one.
  const std::string name = der::Element(0xA0, der::Element(0xA1, attribute));
  EXPECT_EQ(FlawWithPoints(der::Element(0x10, der::Sequence(name))), CertificateFlaw::kMalformed);
  EXPECT_EQ(FlawWithPoints(der::Sequence(der::Element(0x10, name))), CertificateFlaw::kMalformed);
}

TEST(CertificateGate, AListThatHidesItsElementsCountsAsTheMostThatItCouldBe) {
  odd::Parts parts = Good();
  const std::string names = Times(kShownElementsMax, kHost);
  parts.extensions = odd::Extension(kNames, der::Element(0x10, names));
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kElements);
  // A list of a context.
  parts.extensions = odd::Extension("\x2A", der::Sequence(der::Element(0x80, names)));
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kElements);
}

const std::string kConstraints("\x55\x1D\x1E", 3);
const std::string kAuthorityKey("\x55\x1D\x23", 3);

/// OpenSSL reads both as lists; GateAgainstOpenSsl holds that it does.
TEST(CertificateGate, HiddenListsThatOpenSslReadsCountAsTheMostThatTheyCouldBe) {
  const std::string names = Times(kShownElementsMax, kHost);
  const std::string subtrees = Times(kShownElementsMax / 2, der::Sequence(kHost));
  odd::Parts parts = Good();
  for (const std::uint8_t tag : {std::uint8_t{0x80}, std::uint8_t{0x81}}) {
    parts.extensions = odd::Extension(kConstraints, der::Sequence(der::Element(tag, subtrees)));
    EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kElements);
  }
  parts.extensions = odd::Extension(kAuthorityKey, der::Sequence(der::Element(0x81, names)));
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kElements);
}

TEST(CertificateGate, ANameIsOneElementHoweverLongItIs) {
  const TestAuthority authority;
  CertificateSpec spec = testing::ServerSpec();
  for (int i = 0; i < 90; ++i) {
    spec.dns_names.push_back("host-" + std::to_string(100 + i) + "." + std::string(24, 'x') +
                             ".example.com");
    ASSERT_EQ(spec.dns_names.back().size(), 45U);
  }
  EXPECT_EQ(FlawOf(odd::DerOf(authority.Issue(spec).certificate).front()), CertificateFlaw::kNone);
  // As an authority has them that may sign for these names alone, or names its own issuer.
  const std::string host = der::Element(0x82, std::string(45, 'x'));
  odd::Parts parts = Good();
  parts.extensions =
      odd::Extension(kConstraints,
                     der::Sequence(der::Element(0xA0, Times(90, der::Sequence(host))))) +
      odd::Extension(kAuthorityKey, der::Sequence(der::Element(0xA1, Times(90, host))));
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kNone);
}

/// What OpenSSL reads in a certificate with this extension, which it must be able to.
template <typename Value>
std::unique_ptr<Value, void (*)(Value*)> ReadByOpenSsl(const std::string& certificate, int nid,
                                                       void (*release)(Value*)) {
  const auto* bytes = reinterpret_cast<const unsigned char*>(certificate.data());
  X509* read = d2i_X509(nullptr, &bytes, static_cast<long>(certificate.size()));
  EXPECT_NE(read, nullptr);
  auto* value = static_cast<Value*>(X509_get_ext_d2i(read, nid, nullptr, nullptr));
  X509_free(read);
  return {value, release};
}

TEST(GateAgainstOpenSsl, ListsOfAContextNeedNoBitThatSaysSo) {
  odd::Parts parts = Good();
  parts.extensions =
      odd::Extension(kConstraints, der::Sequence(der::Element(0x80, der::Sequence(kHost))));
  const auto constraints =
      ReadByOpenSsl(odd::CertificateOf(parts), NID_name_constraints, NAME_CONSTRAINTS_free);
  ASSERT_NE(constraints, nullptr);
  EXPECT_EQ(sk_GENERAL_SUBTREE_num(constraints->permittedSubtrees), 1);
  parts.extensions = odd::Extension(kAuthorityKey, der::Sequence(der::Element(0x81, kHost)));
  const auto key =
      ReadByOpenSsl(odd::CertificateOf(parts), NID_authority_key_identifier, AUTHORITY_KEYID_free);
  ASSERT_NE(key, nullptr);
  EXPECT_EQ(sk_GENERAL_NAME_num(key->issuer), 1);
}

/// Whatever a name's tag is: OpenSSL makes no list of it unless the tag says that it is one.
TEST(GateAgainstOpenSsl, ANameIsOneElement) {
  for (int tag = 0x80; tag <= 0x9E; ++tag) {
    odd::Parts parts = Good();
    const std::string name = der::Element(static_cast<std::uint8_t>(tag), kHost + kHost);
    parts.extensions = odd::Extension(kNames, der::Sequence(name));
    const auto names =
        ReadByOpenSsl(odd::CertificateOf(parts), NID_subject_alt_name, GENERAL_NAMES_free);
    // A text, an address or an identifier.
    const bool is_one = tag == 0x81 || tag == 0x82 || tag == 0x86 || tag == 0x87 || tag == 0x88;
    EXPECT_EQ(names != nullptr, is_one) << tag;
    EXPECT_EQ(sk_GENERAL_NAME_num(names.get()), is_one ? 1 : -1) << tag;
  }
}

/// OpenSSL takes another name's value as it stands, whatever lies in it, and goes on behind it.
TEST(CertificateGate, AnElementThatClaimsToGoOnBehindTheOneAroundItHidesNone) {
  const std::string names = Times(kShownElementsMax, kHost);
  ASSERT_LT(names.size(), 0x10000U);
  const std::string claims{0x04, static_cast<char>(0x82), static_cast<char>(names.size() >> 8U),
                           static_cast<char>(names.size() & 0xFFU)};
  const std::string other =
      der::Element(0xA0, der::Oid("\x2A") + der::Element(0xA0, der::Sequence(claims)));
  odd::Parts parts = Good();
  parts.extensions = odd::Extension(kNames, der::Sequence(other + names));
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kElements);
  parts.extensions = odd::Extension(kNames, der::Sequence(other + kHost));
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kNone);
}

TEST(CertificateGate, ElementsThatLieDeepCountAsTheMostThatTheyCouldBe) {
  const auto nested = [](std::size_t depth, std::string content) {
    for (std::size_t i = 0; i < depth; ++i) content = der::Sequence(content);
    return content;
  };
  // An element of 100 bytes.
  const std::string long_one = der::Element(0x0C, std::string(98, 'a'));
  odd::Parts parts = Good();
  const std::string shallow = Times(50, nested(15, long_one));
  parts.extensions = odd::Extension("\x2A", shallow);
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kNone) << "16 elements each";
  parts.extensions = odd::Extension("\x2A", Times(50, nested(16, long_one)));
  EXPECT_EQ(FlawOf(odd::CertificateOf(parts)), CertificateFlaw::kElements) << "and 50 behind";
}

TEST(CertificateGate, ElementsOfAllCertificatesOfAMessageAreCountedTogether) {
  const std::string half = WithNames(kShownElementsMax / 2);
  EXPECT_EQ(FlawOf13({half}), CertificateFlaw::kNone);
  EXPECT_EQ(FlawOf13({half, half}), CertificateFlaw::kElements);
}

TEST(CertificateGate, AMessageHasAtMostTenCertificates) {
  const std::vector<std::string> most(kShownCertificatesMax, GoodCertificate());
  const std::vector<std::string> more(kShownCertificatesMax + 1, GoodCertificate());
  EXPECT_EQ(FlawOf12(most), CertificateFlaw::kNone);
  EXPECT_EQ(FlawOf13(most), CertificateFlaw::kNone);
  EXPECT_EQ(FlawOf12(more), CertificateFlaw::kCount);
  EXPECT_EQ(FlawOf13(more), CertificateFlaw::kCount);
}

TEST(CertificateGate, AMessageHasAtMost32KiB) {
  const auto message_of = [](std::size_t filler) {
    odd::Parts parts = Good();
    parts.extensions = odd::Extension("\x2A", der::Octets(std::string(filler, 'x')));
    return odd::MessageOf13({odd::CertificateOf(parts)});
  };
  const std::size_t frame = message_of(30'000).size() - 30'000;
  const std::string most = message_of(kShownBytesMax - frame);
  ASSERT_EQ(most.size(), kShownBytesMax);
  EXPECT_EQ(FlawOfMessage(MessageForm::kTls13, BytesOf(most)), CertificateFlaw::kNone);
  const std::string more = message_of(kShownBytesMax - frame + 1);
  EXPECT_EQ(FlawOfMessage(MessageForm::kTls13, BytesOf(more)), CertificateFlaw::kBytes);
}

TEST(CertificateGate, AMessageWithoutCertificatesHasNoFlaw) {
  EXPECT_EQ(FlawOf12({}), CertificateFlaw::kNone);
  EXPECT_EQ(FlawOf13({}), CertificateFlaw::kNone);
}

TEST(CertificateGate, EveryCertificateOfAMessageIsJudged) {
  const std::string bad = odd::CertificateWith(odd::ExplicitCurveKey());
  for (std::size_t at = 0; at < kShownCertificatesMax; ++at) {
    std::vector<std::string> certificates(kShownCertificatesMax, GoodCertificate());
    certificates[at] = bad;
    EXPECT_EQ(FlawOf12(certificates), CertificateFlaw::kKeyKind) << at;
    EXPECT_EQ(FlawOf13(certificates), CertificateFlaw::kKeyKind) << at;
  }
}

TEST(CertificateGate, AMessageThatEndsTooSoonOrTooLateIsMalformed) {
  for (const MessageForm form : {MessageForm::kTls12, MessageForm::kTls13}) {
    const std::vector<std::string> one = {GoodCertificate()};
    const std::string good =
        form == MessageForm::kTls12 ? odd::MessageOf12(one) : odd::MessageOf13(one);
    for (std::size_t size = 0; size < good.size(); ++size) {
      EXPECT_EQ(FlawOfMessage(form, BytesOf(good.substr(0, size))), CertificateFlaw::kMalformed);
    }
    EXPECT_EQ(FlawOfMessage(form, BytesOf(good + "x")), CertificateFlaw::kMalformed);
  }
}

TEST(CertificateGate, AMessageOf13HasNoContextAndNoExtensions) {
  const std::string list = odd::MessageOf13({GoodCertificate()}).substr(1);
  EXPECT_EQ(FlawOfMessage(MessageForm::kTls13, BytesOf(std::string(1, '\0') + list)),
            CertificateFlaw::kNone);
  EXPECT_EQ(FlawOfMessage(MessageForm::kTls13, BytesOf("\x01x" + list)),
            CertificateFlaw::kMalformed);
  const std::string good = GoodCertificate();
  const auto length = [](std::size_t size) {
    return std::string{'\0', static_cast<char>(size >> 8U), static_cast<char>(size)};
  };
  const std::string entry = length(good.size()) + good + std::string("\0\4\0\5\0\0", 6);
  EXPECT_EQ(FlawOfMessage(MessageForm::kTls13,
                          BytesOf(std::string(1, '\0') + length(entry.size()) + entry)),
            CertificateFlaw::kMalformed);
}

TEST(CertificateGate, EveryFlawHasItsText) {
  EXPECT_EQ(TextOf(CertificateFlaw::kNone), "");
  EXPECT_EQ(TextOf(CertificateFlaw::kCount), "more than 10 certificates");
  EXPECT_EQ(TextOf(CertificateFlaw::kBytes), "more than 32 KiB of certificates");
  EXPECT_EQ(TextOf(CertificateFlaw::kRelativePoint),
            "a CRL distribution point relative to its issuer's name: issue it with the full name "
            "(a URI), or without the point");
}

}  // namespace
}  // namespace uplink::identity
