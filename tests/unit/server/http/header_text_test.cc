#include "server/http/header_text.h"

#include <gtest/gtest.h>

namespace uplink::http {
namespace {

TEST(ImfFixdate, IsTheExampleOfTheStandard) {
  EXPECT_EQ(ImfFixdate(FromUnixMs(784'111'777'000)), "Sun, 06 Nov 1994 08:49:37 GMT");
  EXPECT_EQ(ImfFixdate(FromUnixMs(784'111'777'999)), "Sun, 06 Nov 1994 08:49:37 GMT");
  EXPECT_EQ(ImfFixdate(FromUnixMs(784'111'778'000)), "Sun, 06 Nov 1994 08:49:38 GMT");
}

TEST(ImfFixdate, KnowsTheEndsOfItsYears) {
  EXPECT_EQ(ImfFixdate(FromUnixMs(0)), "Thu, 01 Jan 1970 00:00:00 GMT");
  EXPECT_EQ(ImfFixdate(FromUnixMs(1'709'164'800'000)), "Thu, 29 Feb 2024 00:00:00 GMT");
  EXPECT_EQ(ImfFixdate(FromUnixMs(253'402'300'799'999)), "Fri, 31 Dec 9999 23:59:59 GMT");
  EXPECT_EQ(ImfFixdate(FromUnixMs(-1)), "Wed, 31 Dec 1969 23:59:59 GMT");
}

}  // namespace
}  // namespace uplink::http
