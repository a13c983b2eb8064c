#include "server/http/credentials.h"

#include <gtest/gtest.h>

namespace uplink::http {
namespace {

TEST(BearerToken, IsWhatFollowsTheScheme) {
  for (const char* header : {"Bearer abc", "bearer abc", "BEARER   abc"}) {
    EXPECT_EQ(BearerToken(header), "abc") << header;
  }
  EXPECT_EQ(BearerToken("Bearer"), "");
  EXPECT_EQ(BearerToken("Bearer "), "");
  EXPECT_EQ(BearerToken("Bearer a, Bearer b"), "a, Bearer b") << "two headers are no token";
}

TEST(BearerToken, OtherSchemesShowNothing) {
  for (const char* header : {"", "Basic YTpi", "Bearerabc", " Bearer abc", "abc"}) {
    EXPECT_FALSE(BearerToken(header)) << header;
  }
}

TEST(HasToken, FindsAParameterThatIsCalledSo) {
  for (const char* query : {"token=x", "access_token=x", "token", "a=b&token=", "TOKEN=x",
                            "%74oken=x", "fleet=a&access%5Ftoken=x&b", "token&token"}) {
    EXPECT_TRUE(HasToken(query)) << query;
  }
}

TEST(HasToken, LooksAtNoOtherParameter) {
  for (const char* query :
       {"", "pageToken=x", "tokens=x", "fleet=token", "a=token=x", "&&", "tok%ZZen"}) {
    EXPECT_FALSE(HasToken(query)) << query;
  }
}

}  // namespace
}  // namespace uplink::http
