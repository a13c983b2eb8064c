#include "server/identity/session_tickets.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::identity {
namespace {

using ::testing::HasSubstr;

TEST(SessionTickets, AnEmptyConfigurationGetsTheWholeChain) {
  const auto text = WithoutSessionTickets("");
  ASSERT_TRUE(text.ok());
  EXPECT_EQ(*text,
            "openssl_conf = uplinkd_openssl\n"
            "\n[uplinkd_openssl]\nssl_conf = uplinkd_ssl\n"
            "[uplinkd_ssl]\nsystem_default = uplinkd_tls\n"
            "[uplinkd_tls]\nNumTickets = 0\n");
}

TEST(SessionTickets, DebiansOwnConfigurationKeepsItsSettings) {
  const std::string debian =
      "openssl_conf = default_conf\n[default_conf]\nssl_conf = ssl_sect\n"
      "[ssl_sect]\nsystem_default = system_default_sect\n"
      "[system_default_sect]\nMinProtocol = TLSv1.2\nCipherString = DEFAULT@SECLEVEL=2\n";
  const auto text = WithoutSessionTickets(debian);
  ASSERT_TRUE(text.ok());
  EXPECT_EQ(*text, debian + "\n[system_default_sect]\nNumTickets = 0\n");
}

TEST(SessionTickets, AChainThatEndsHalfWayIsCompleted) {
  const std::string half = "openssl_conf = mine\n[mine]\nproviders = some\n[some]\n";
  const auto text = WithoutSessionTickets(half);
  ASSERT_TRUE(text.ok());
  EXPECT_EQ(*text, half +
                       "\n[mine]\nssl_conf = uplinkd_ssl\n"
                       "[uplinkd_ssl]\nsystem_default = uplinkd_tls\n"
                       "[uplinkd_tls]\nNumTickets = 0\n");
}

TEST(SessionTickets, ANumberThatTheMachineSetsStays) {
  const std::string own =
      "openssl_conf = a\n[a]\nssl_conf = b\n[b]\nsystem_default = c\n[c]\nNumTickets = 1\n";
  const auto text = WithoutSessionTickets(own);
  ASSERT_TRUE(text.ok());
  EXPECT_EQ(*text, own);
}

TEST(SessionTickets, ATextThatIsNoConfigurationIsRefused) {
  const auto text = WithoutSessionTickets("[never closed\nopenssl_conf = a\n");
  ASSERT_FALSE(text.ok());
  EXPECT_THAT(std::string(text.status().message()), HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace uplink::identity
