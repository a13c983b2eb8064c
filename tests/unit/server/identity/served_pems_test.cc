#include "server/identity/served_pems.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/certificates.h"

namespace uplink::identity {
namespace {

using ::testing::HasSubstr;

class ServedPemsTest : public ::testing::Test {
 protected:
  [[nodiscard]] ServedPems Of(const std::string& certificate, const std::string& client_ca) const {
    auto served = ServedPemsOf({"server.crt", certificate}, {"ca.crt", client_ca});
    EXPECT_TRUE(served.ok()) << served.status();
    return served.ok() ? *served : ServedPems();
  }

  testing::TestAuthority ours_;
  testing::TestAuthority other_{"other authority"};
  const std::string server_ = ours_.Issue(testing::ServerSpec()).certificate;
};

TEST_F(ServedPemsTest, CountsTheAuthoritiesAndKnowsTheFileByItsText) {
  const ServedPems one = Of(server_, ours_.certificate());
  const ServedPems two = Of(server_, ours_.certificate() + "other\n" + other_.certificate());
  EXPECT_EQ(one.authorities, 1U);
  EXPECT_EQ(two.authorities, 2U);
  EXPECT_NE(one.client_ca_sha256, two.client_ca_sha256);
  EXPECT_EQ(one.certificate_sha256, two.certificate_sha256);
  EXPECT_NE(one, two);
  EXPECT_EQ(one, Of(server_, ours_.certificate()));
}

TEST_F(ServedPemsTest, TellsAnotherCertificateOfTheSameAuthorityAndDay) {
  const ServedPems renewed =
      Of(ours_.Issue(testing::ServerSpec()).certificate, ours_.certificate());
  EXPECT_NE(renewed.certificate_sha256, Of(server_, ours_.certificate()).certificate_sha256);
}

TEST_F(ServedPemsTest, GivesTheDigestThatSha256sumGives) {
  EXPECT_EQ(Of(server_, "").client_ca_sha256,
            "e3b0c44298fc1c149afbf4c8996fb92427ae41e4649b934ca495991b7852b855");
  EXPECT_EQ(Of(server_, "").authorities, 0U);
}

TEST_F(ServedPemsTest, NamesATextWithoutACertificate) {
  const auto served = ServedPemsOf({"server.crt", "nothing"}, {"ca.crt", ours_.certificate()});
  EXPECT_THAT(std::string(served.status().message()), HasSubstr("server.crt"));
}

}  // namespace
}  // namespace uplink::identity
