#include "storage/connection.h"

#include <string>

#include <gtest/gtest.h>

#include "schema/base/utf8.h"
#include "storage/numbers.h"

namespace uplink::storage {
namespace {

using model::ConnectionEnd;

ConnectionItem Ended(ConnectionEnd why) {
  ConnectionItem item;
  item.ended = {.at = {}, .why = why, .code = {}, .detail = {}};
  return item;
}

TEST(Replaces, AnEndStaysUnlessOthersOnlyPresumedIt) {
  const ConnectionItem open;
  EXPECT_TRUE(Replaces(open, open));
  EXPECT_TRUE(Replaces(Ended(ConnectionEnd::kBroken), open));
  EXPECT_FALSE(Replaces(open, Ended(ConnectionEnd::kBroken)));
  EXPECT_FALSE(Replaces(Ended(ConnectionEnd::kOrderly), Ended(ConnectionEnd::kBroken)));
  EXPECT_TRUE(Replaces(Ended(ConnectionEnd::kOrderly), Ended(ConnectionEnd::kServerEnded)));
  EXPECT_FALSE(Replaces(open, Ended(ConnectionEnd::kServerEnded)));
}

TEST(Bounded, MakesEachTextFitForAStore) {
  ConnectionItem item = Ended(ConnectionEnd::kBroken);
  item.agent_version = std::string("a\0b\xFF", 4);
  item.address = std::string(2 * kConnectionTextMax, 'x');
  item.gateway = "CN=h\u00e4lle";
  item.ended->detail = std::string(2 * kConnectionDetailMax, 'y');
  item.ended->code = "\x1b[2J";
  const ConnectionItem bounded = Bounded(item);
  EXPECT_TRUE(IsCleanUtf8(bounded.agent_version));
  EXPECT_NE(bounded.agent_version, "");
  EXPECT_EQ(bounded.address.size(), kConnectionTextMax);
  EXPECT_EQ(bounded.gateway, item.gateway);
  EXPECT_EQ(bounded.ended->detail.size(), kConnectionDetailMax);
  EXPECT_EQ(CountControls(bounded.ended->code), 0U);
}

TEST(ConnectionEndOf, KnowsEachAndTakesOthersForBroken) {
  for (const ConnectionEnd end : model::kAllConnectionEnds) {
    EXPECT_EQ(ConnectionEndOf(static_cast<std::int64_t>(end)), end);
    EXPECT_EQ(model::ConnectionEndFromText(ToText(end)), end);
  }
  EXPECT_EQ(ConnectionEndOf(1'000), ConnectionEnd::kBroken);
}

}  // namespace
}  // namespace uplink::storage
