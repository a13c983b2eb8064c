#include "server/identity/authorities.h"

#include <algorithm>
#include <string>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/certificates.h"
#include "tests/support/der.h"
#include "tests/support/odd_certificates.h"

namespace uplink::identity {
namespace {

namespace odd = uplink::testing::odd;
using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::Not;

class AuthoritiesTest : public ::testing::Test {
 protected:
  /// The error message for the text; empty if it is good.
  static std::string ErrorOf(const std::string& text) {
    const absl::Status status = CheckAuthorities({"ca.crt", text});
    EXPECT_TRUE(status.ok() || absl::IsFailedPrecondition(status)) << status;
    return std::string(status.message());
  }
  static std::string With(std::string text, const std::string& from, const std::string& to) {
    return text.replace(text.find(from), from.size(), to);
  }

  const testing::TestAuthority one_{"one"};
  const testing::TestAuthority two_{"two"};
  const std::string first_ = one_.certificate();
  const std::string second_ = two_.certificate();
};

TEST_F(AuthoritiesTest, SeveralAreTaken) {
  EXPECT_EQ(ErrorOf(first_), "");
  EXPECT_EQ(ErrorOf(first_ + second_), "");
}

TEST_F(AuthoritiesTest, TextBetweenThemAndOtherBlocksCountForNothing) {
  const std::string key = one_.Issue(testing::ServerSpec()).key;
  EXPECT_EQ(ErrorOf("# the first\n=====\n" + first_ + "\n--- the END of one\n" + key + second_),
            "");
}

TEST_F(AuthoritiesTest, LinesMayEndAsOnWindows) {
  std::string text;
  for (const char c : first_ + second_) text += c == '\n' ? std::string("\r\n") : std::string(1, c);
  EXPECT_EQ(ErrorOf(text), "");
}

TEST_F(AuthoritiesTest, ABrokenOneIsNamedByItsNumberAndLine) {
  const std::string damaged = With(second_, "\nMII", "\nXXX");
  const auto lines = std::count(first_.begin(), first_.end(), '\n');
  EXPECT_THAT(ErrorOf(first_ + damaged + first_),
              AllOf(HasSubstr("ca.crt: PEM block 2, from line " + std::to_string(lines + 1)),
                    HasSubstr("is broken: it is no certificate that can be read")));
  EXPECT_THAT(ErrorOf(damaged), HasSubstr("PEM block 1, from line 1,"));
}

TEST_F(AuthoritiesTest, OneWithAKeyThatNoRobotMayHaveIsNamed) {
  const auto lines = std::count(first_.begin(), first_.end(), '\n');
  EXPECT_THAT(ErrorOf(first_ + odd::PemOf(odd::CertificateWith(odd::ExplicitCurveKey()))),
              HasSubstr("block 2, from line " + std::to_string(lines + 1) +
                        ", cannot be used: a key that is none of P-256"));
  EXPECT_THAT(ErrorOf(odd::PemOf(odd::CertificateWith(odd::RsaKey(4097, 17)))),
              HasSubstr("an RSA key of over 4,096 bits"));
  EXPECT_EQ(ErrorOf(odd::PemOf(odd::CertificateWith(odd::RsaKey(4096, 17)))), "");
}

TEST_F(AuthoritiesTest, OneWhoseRobotsAreAllTooWeakIsNamed) {
  EXPECT_THAT(ErrorOf(odd::PemOf(odd::CertificateWith(odd::RsaKey(1024, 17)))),
              HasSubstr("block 1, from line 1, cannot be used: its key is too weak: 80 bits of "
                        "security, and OpenSSL's security level 2 takes 112 and more"));
  EXPECT_EQ(ErrorOf(odd::PemOf(odd::CertificateWith(odd::RsaKey(2048, 17)))), "");
}

TEST_F(AuthoritiesTest, EveryOneWithoutAUseIsNamedWithWhatIsWrong) {
  const std::string text = first_ + odd::PemOf(odd::CertificateWith(odd::ExplicitCurveKey())) +
                           With(second_, "\nMII", "\nXXX") + first_ +
                           odd::PemOf(odd::CertificateWith(odd::RsaKey(4097, 17)));
  const auto line_of = [&text](std::size_t at) {
    return std::to_string(1 + std::count(text.begin(), text.begin() + static_cast<long>(at), '\n'));
  };
  const std::size_t second = text.find("-----BEGIN", 1);
  const std::size_t third = text.find("-----BEGIN", second + 1);
  const std::size_t last = text.rfind("-----BEGIN");
  EXPECT_EQ(ErrorOf(text),
            "ca.crt: PEM block 2, from line " + line_of(second) +
                ", cannot be used: a key that is none of P-256, P-384, P-521 (by name: written "
                "out they are none), Ed25519, Ed448, RSA and RSA-PSS; PEM block 3, from line " +
                line_of(third) +
                ", is broken: it is no certificate that can be read; PEM block 5, from line " +
                line_of(last) +
                ", cannot be used: an RSA key of over 4,096 bits, or with an exponent of over 64 "
                "bits");
}

TEST_F(AuthoritiesTest, ABrokenBlockHidesNoneBehindItAndIsNamedOnce) {
  const std::string bad = odd::PemOf(odd::CertificateWith(odd::RsaKey(4097, 17)));
  const std::string begin = "-----BEGIN CERTIFICATE-----\n";
  const std::string end = "-----END CERTIFICATE-----\n";
  for (const std::string& broken :
       {With(second_, begin, "----BEGIN CERTIFICATE-----\n"), With(second_, begin, ""),
        With(second_, end, ""), With(second_, end, "-----END CERTIFICATE----\n"),
        With(second_, end, "-----END KEY-----\n"), With(With(second_, begin, ""), end, ""),
        With(With(second_, begin, "-----begin certificate-----\n"), end,
             "-----end certificate-----\n"),
        With(With(second_, begin, "-----BEGIN CERT\n"), end, "-----END CERT\n"),
        second_.substr(0, 200) + "\n"}) {
    const std::string said = ErrorOf(broken + bad);
    EXPECT_THAT(said, HasSubstr("ca.crt: PEM block 1, from line 1, is broken")) << broken;
    EXPECT_THAT(said, HasSubstr("; PEM block 2, from line ")) << broken;
    EXPECT_THAT(said, HasSubstr(", cannot be used: an RSA key of over 4,096 bits")) << broken;
    EXPECT_THAT(said, Not(HasSubstr("PEM block 3"))) << broken;
    EXPECT_THAT(ErrorOf(bad + broken), HasSubstr("; PEM block 2, from line ")) << broken;
  }
}

TEST_F(AuthoritiesTest, EightAreNamedAndTheOthersCounted) {
  const std::string bad = odd::PemOf(odd::CertificateWith(odd::RsaKey(4097, 17)));
  std::string text;
  for (std::size_t i = 0; i < kRefusedNamedMax; ++i) text += bad;
  EXPECT_THAT(ErrorOf(text), AllOf(HasSubstr("PEM block 8"), Not(HasSubstr("more blocks"))));
  EXPECT_THAT(ErrorOf(text + bad + bad),
              AllOf(HasSubstr("PEM block 8"), Not(HasSubstr("PEM block 9")),
                    HasSubstr("; and 2 more blocks")));
}

TEST_F(AuthoritiesTest, OneWithARelativePointOfRevocationListsSaysWhatToIssue) {
  odd::Parts parts;
  parts.key = odd::Ed25519Key();
  const std::string attribute = testing::der::Sequence(
      testing::der::Oid(std::string("\x55\x04\x03", 3)) + testing::der::Element(0x0C, "a"));
  parts.extensions =
      odd::Extension(std::string("\x55\x1D\x1F", 3),
                     testing::der::Sequence(testing::der::Sequence(
                         testing::der::Element(0xA0, testing::der::Element(0xA1, attribute)))));
  EXPECT_EQ(ErrorOf(odd::PemOf(odd::CertificateOf(parts))),
            "ca.crt: PEM block 1, from line 1, cannot be used: a CRL distribution point relative "
            "to its issuer's name: issue it with the full name (a URI), or without the point");
}

TEST_F(AuthoritiesTest, OneWithNotesOnItsTrustIsTaken) {
  const std::string notes = testing::der::Sequence("");
  const std::string der = odd::DerOf(first_).front() + notes;
  EXPECT_EQ(ErrorOf(odd::PemOf(der, "TRUSTED CERTIFICATE")), "");
}

TEST_F(AuthoritiesTest, OneThatIsCutIsBroken) {
  const std::string cut = second_.substr(0, second_.size() / 2);
  EXPECT_THAT(ErrorOf(first_ + cut), AllOf(HasSubstr("block 2"), HasSubstr("has no end")));
  EXPECT_THAT(ErrorOf(cut + "\n" + first_), AllOf(HasSubstr("block 1"), HasSubstr("has no end")));
}

TEST_F(AuthoritiesTest, OneWhoseDashesAreDamagedIsNotPassedOver) {
  for (const char* begin : {"----BEGIN ", "-----BEGIN", " -----BEGIN ", "\xef\xbb\xbf-----BEGIN ",
                            "BEGIN ", "--BEGIN "}) {
    EXPECT_THAT(ErrorOf(first_ + With(second_, "-----BEGIN ", begin)), HasSubstr("block 2"))
        << begin;
  }
  EXPECT_THAT(ErrorOf(first_ + With(second_, "CERTIFICATE-----\n", "CERTIFICATE----\n")),
              HasSubstr("block 2"));
  EXPECT_THAT(ErrorOf(first_ + With(second_, "-----END ", "----END ")), HasSubstr("block 2"));
  EXPECT_THAT(ErrorOf(first_ + With(second_, "-----END CERT", "-----END KEY")),
              HasSubstr("block 2"));
  EXPECT_THAT(ErrorOf(first_ + "-----END CERTIFICATE-----\n"), HasSubstr("block 2"));
}

TEST_F(AuthoritiesTest, OneWhoseMarksAreWrittenOtherwiseIsNotPassedOver) {
  const std::string begin = "-----BEGIN CERTIFICATE-----";
  const std::string end = "-----END CERTIFICATE-----";
  for (const auto& [first, last] : std::vector<std::pair<std::string, std::string>>{
           {"----- BEGIN CERTIFICATE -----", "----- END CERTIFICATE -----"},
           {"-----begin certificate-----", "-----end certificate-----"},
           // With a dash of word processors.
           {"\u2013BEGIN CERTIFICATE\u2013", "\u2013END CERTIFICATE\u2013"},
           {"=====Begin X509 Certificate=====", "=====End X509 Certificate====="},
           {"-----BEGIN  CERTIFICATE-----", "-----END  CERTIFICATE-----"},
           {"-----BEGIN Certificate-----", "-----END Certificate-----"},
           {begin, "----- END CERTIFICATE -----"}}) {
    const std::string mangled = With(With(second_, begin, first), end, last);
    EXPECT_THAT(ErrorOf(first_ + mangled), HasSubstr("block 2")) << first;
    EXPECT_THAT(ErrorOf(mangled + first_), HasSubstr("block 1")) << first;
  }
}

TEST_F(AuthoritiesTest, OneWithoutMarksIsNotPassedOver) {
  const std::string bare =
      With(With(second_, "-----BEGIN CERTIFICATE-----\n", ""), "-----END CERTIFICATE-----\n", "");
  const auto lines = std::count(first_.begin(), first_.end(), '\n');
  EXPECT_THAT(ErrorOf(first_ + bare),
              AllOf(HasSubstr("block 2, from line " + std::to_string(lines + 1)),
                    HasSubstr("no line -----BEGIN CERTIFICATE----- stands before it")));
  EXPECT_THAT(ErrorOf(first_ + "  " + bare), HasSubstr("block 2"));
  EXPECT_THAT(ErrorOf(first_ + "-----BEGIN AUTHORITY\n" + bare), HasSubstr("block 2"));
}

TEST_F(AuthoritiesTest, LinesThatSpeakOfCertificatesAreComments) {
  EXPECT_EQ(ErrorOf("Certificate:\n    Data:\n        Version: 3 (0x2)\n"
                    "        Issuer: O = Friendly, CN = Front End Certificate Authority\n"
                    "            X509v3 Extended Key Usage: \n"
                    "subject=CN = Begin Certificates\n" +
                    first_ + "# the certificate ends in 2030\n# end of the first certificate\n" +
                    second_),
            "");
}

TEST_F(AuthoritiesTest, NoneAtAllIsAnError) {
  EXPECT_EQ(ErrorOf(""), "ca.crt: holds no PEM certificate; name the file that does");
  EXPECT_EQ(ErrorOf(one_.Issue(testing::ServerSpec()).key),
            "ca.crt: holds no PEM certificate; name the file that does");
}

}  // namespace
}  // namespace uplink::identity
