#include "server/view/page_token.h"

#include <gtest/gtest.h>

#include "schema/model/ids.h"

namespace uplink::view {
namespace {

TEST(PageToken, GivesBackAnyRuri) {
  for (const std::string& ruri :
       {std::string("rcan://a/b/c/d?x=1&y=%2f"), std::string("\xff\x00z", 3),
        std::string(model::kRuriBytesMax, 'r')}) {
    EXPECT_EQ(RuriFromToken(RobotsToken(ruri)), ruri);
  }
}

TEST(PageToken, RefusesWhatItDidNotMake) {
  const std::string too_long = RobotsToken(std::string(model::kRuriBytesMax + 1, 'r'));
  for (const std::string& token : {std::string(), std::string("r."), std::string("r.4"),
                                   std::string("r.4g"), std::string("x.41"), too_long}) {
    EXPECT_EQ(RuriFromToken(token), std::nullopt) << token;
  }
}

}  // namespace
}  // namespace uplink::view
