#include "server/identity/public_key_gate.h"

#include <string>

#include <gtest/gtest.h>

#include "tests/support/der.h"
#include "tests/support/odd_certificates.h"

namespace uplink::identity {
namespace {

namespace der = uplink::testing::der;
namespace odd = uplink::testing::odd;
using odd::Curve;
using odd::Point;

const std::string kEcKey = der::Oid(std::string("\x2A\x86\x48\xCE\x3D\x02\x01", 7));
const std::string kP256 = der::Oid(std::string("\x2A\x86\x48\xCE\x3D\x03\x01\x07", 8));
const std::string kRsa = der::Oid(std::string("\x2A\x86\x48\x86\xF7\x0D\x01\x01\x01", 9));
const std::string kRsaPss = der::Oid(std::string("\x2A\x86\x48\x86\xF7\x0D\x01\x01\x0A", 9));
const std::string kEd25519 = der::Oid("\x2B\x65\x70");

/// Of the content of a whole SubjectPublicKeyInfo.
KeyFlaw FlawOf(const std::string& info) {
  DerReader reader({reinterpret_cast<const std::uint8_t*>(info.data()), info.size()});
  const auto content = reader.Take(DerTag::kSequence);
  return content && reader.empty() ? FlawOfKey(*content) : KeyFlaw::kMalformed;
}

TEST(KeyGate, TakesTheNamedCurvesInBothForms) {
  for (const Curve curve : {Curve::kP256, Curve::kP384, Curve::kP521}) {
    for (const Point form : {Point::kCompressed, Point::kUncompressed}) {
      EXPECT_EQ(FlawOf(odd::NamedCurveKey(curve, form)), KeyFlaw::kNone);
    }
  }
}

TEST(KeyGate, TakesEdwardsCurves) {
  EXPECT_EQ(FlawOf(odd::Ed25519Key()), KeyFlaw::kNone);
  EXPECT_EQ(FlawOf(odd::Ed448Key()), KeyFlaw::kNone);
  EXPECT_EQ(FlawOf(odd::KeyOf(kEd25519, std::string(31, 'x'))), KeyFlaw::kMalformed);
  EXPECT_EQ(FlawOf(odd::KeyOf(kEd25519, std::string(33, 'x'))), KeyFlaw::kMalformed);
  EXPECT_EQ(FlawOf(odd::KeyOf(kEd25519 + der::Null(), std::string(32, 'x'))), KeyFlaw::kMalformed);
}

TEST(KeyGate, ACurveThatIsWrittenOutIsNotTaken) {
  EXPECT_EQ(FlawOf(odd::ExplicitCurveKey()), KeyFlaw::kKind);
}

TEST(KeyGate, OtherCurvesAndKindsOfKeysAreNotTaken) {
  const std::string point = "\x04" + std::string(64, 'x');
  // secp256k1, a curve without a name, and parameters that come from the issuer.
  EXPECT_EQ(FlawOf(odd::KeyOf(kEcKey + der::Oid(std::string("\x2B\x81\x04\x00\x0A", 5)), point)),
            KeyFlaw::kKind);
  EXPECT_EQ(FlawOf(odd::KeyOf(kEcKey, point)), KeyFlaw::kKind);
  EXPECT_EQ(FlawOf(odd::KeyOf(kEcKey + der::Null(), point)), KeyFlaw::kKind);
  EXPECT_EQ(FlawOf(odd::KeyOf(kEcKey + kP256 + der::Null(), point)), KeyFlaw::kKind);
  // X25519, and DSA.
  EXPECT_EQ(FlawOf(odd::KeyOf(der::Oid("\x2B\x65\x6E"), std::string(32, 'x'))), KeyFlaw::kKind);
  EXPECT_EQ(FlawOf(odd::KeyOf(der::Oid(std::string("\x2A\x86\x48\xCE\x38\x04\x01", 7)),
                              der::Integer("\x05"))),
            KeyFlaw::kKind);
}

TEST(KeyGate, APointHasTheSizeOfItsCurveAndOneOfTwoForms) {
  const auto flaw = [](const std::string& point) {
    return FlawOf(odd::KeyOf(kEcKey + kP256, point));
  };
  EXPECT_EQ(flaw("\x04" + std::string(64, 'x')), KeyFlaw::kNone);
  EXPECT_EQ(flaw("\x04" + std::string(63, 'x')), KeyFlaw::kMalformed);
  EXPECT_EQ(flaw("\x04" + std::string(65, 'x')), KeyFlaw::kMalformed);
  EXPECT_EQ(flaw("\x02" + std::string(32, 'x')), KeyFlaw::kNone);
  EXPECT_EQ(flaw("\x03" + std::string(32, 'x')), KeyFlaw::kNone);
  EXPECT_EQ(flaw("\x03" + std::string(64, 'x')), KeyFlaw::kMalformed);
  EXPECT_EQ(flaw("\x06" + std::string(64, 'x')), KeyFlaw::kMalformed) << "the hybrid form";
  EXPECT_EQ(flaw(std::string(1, '\0')), KeyFlaw::kMalformed) << "infinity";
  EXPECT_EQ(flaw(""), KeyFlaw::kMalformed);
}

TEST(KeyGate, AnRsaKeyHasAtMost4096BitsAndAnExponentOfAtMost64) {
  for (const auto& key : {odd::RsaKey, odd::RsaPssKey}) {
    EXPECT_EQ(FlawOf(key(2048, 17)), KeyFlaw::kNone);
    EXPECT_EQ(FlawOf(key(kRsaBitsMax, kRsaExponentBitsMax)), KeyFlaw::kNone);
    EXPECT_EQ(FlawOf(key(kRsaBitsMax + 1, 17)), KeyFlaw::kSize);
    EXPECT_EQ(FlawOf(key(2048, kRsaExponentBitsMax + 1)), KeyFlaw::kSize);
    EXPECT_EQ(FlawOf(key(16'384, 16'384)), KeyFlaw::kSize);
  }
}

TEST(KeyGate, AnRsaKeyIsTwoPositiveNumbersInTheirShortestForm) {
  const auto flaw = [](const std::string& key) {
    return FlawOf(odd::KeyOf(kRsa + der::Null(), key));
  };
  const std::string three = der::Integer("\x03");
  const std::string modulus = der::Integer(std::string(256, '\x7F'));
  EXPECT_EQ(flaw(der::Sequence(modulus + three)), KeyFlaw::kNone);
  EXPECT_EQ(flaw(der::Sequence(modulus + three) + der::Null()), KeyFlaw::kMalformed);
  EXPECT_EQ(flaw(der::Sequence(modulus + three + three)), KeyFlaw::kMalformed);
  EXPECT_EQ(flaw(der::Sequence(modulus)), KeyFlaw::kMalformed);
  for (const std::string& number :
       {std::string(1, '\0'), std::string(), std::string("\x80"), std::string("\x00\x03", 2)}) {
    EXPECT_EQ(flaw(der::Sequence(modulus + der::Element(0x02, number))), KeyFlaw::kMalformed);
    EXPECT_EQ(flaw(der::Sequence(der::Element(0x02, number) + three)), KeyFlaw::kMalformed);
  }
}

TEST(KeyGate, AnRsaKeyHasTheParametersOfItsKindAlone) {
  const std::string key =
      der::Sequence(der::Integer(std::string(256, '\x7F')) + der::Integer("\x03"));
  EXPECT_EQ(FlawOf(odd::KeyOf(kRsa, key)), KeyFlaw::kNone);
  EXPECT_EQ(FlawOf(odd::KeyOf(kRsa + der::Sequence(""), key)), KeyFlaw::kMalformed);
  EXPECT_EQ(FlawOf(odd::KeyOf(kRsa + der::Null() + der::Null(), key)), KeyFlaw::kMalformed);
  EXPECT_EQ(FlawOf(odd::KeyOf(kRsaPss + der::Sequence(""), key)), KeyFlaw::kNone);
  EXPECT_EQ(FlawOf(odd::KeyOf(kRsaPss + der::Sequence(std::string(128, '\x05')), key)),
            KeyFlaw::kNone);
  EXPECT_EQ(FlawOf(odd::KeyOf(kRsaPss + der::Sequence(std::string(129, '\x05')), key)),
            KeyFlaw::kMalformed);
  EXPECT_EQ(FlawOf(odd::KeyOf(kRsaPss + der::Null(), key)), KeyFlaw::kMalformed);
}

TEST(KeyGate, NothingStandsBehindAKeyAndAllItsBitsCount) {
  const std::string algorithm = der::Sequence(kEd25519);
  const std::string key(32, 'x');
  EXPECT_EQ(FlawOf(der::Sequence(algorithm + der::Bits(key))), KeyFlaw::kNone);
  EXPECT_EQ(FlawOf(der::Sequence(algorithm + der::Bits(key) + der::Null())), KeyFlaw::kMalformed);
  EXPECT_EQ(FlawOf(der::Sequence(algorithm + der::Element(0x03, "\x01" + key))),
            KeyFlaw::kMalformed);
  EXPECT_EQ(FlawOf(der::Sequence(algorithm + der::Element(0x03, ""))), KeyFlaw::kMalformed);
  EXPECT_EQ(FlawOf(der::Sequence(algorithm)), KeyFlaw::kMalformed);
  EXPECT_EQ(FlawOf(der::Sequence("")), KeyFlaw::kMalformed);
}

}  // namespace
}  // namespace uplink::identity
