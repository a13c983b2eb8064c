#include "tools/uplink-fleet/report/live_table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::synthetic {
namespace {

using ::testing::ElementsAre;

const Palette kPlain({.updates = true, .colours = false});

LiveTable Example() { return {"robots send", {{"online", "50"}, {"messages received", "12345"}}}; }

TEST(LiveTableTest, NamesStandLeftAndValuesRight) {
  EXPECT_THAT(
      LinesOf(Example(), {}, kPlain),
      ElementsAre("robots send", "  online                50", "  messages received  12345"));
}

TEST(LiveTableTest, ALineStaysWithinTheTerminal) {
  EXPECT_THAT(LinesOf(Example(), {.columns = 11, .rows = 24}, kPlain),
              ElementsAre("robots sen", "  online  ", "  messages"))
      << "one column is left free";
  EXPECT_THAT(LinesOf(Example(), {.columns = 12, .rows = 24}, kPlain)[0], "robots send");
  EXPECT_THAT(LinesOf(Example(), {.columns = 1, .rows = 24}, kPlain)[0], "r");
}

TEST(LiveTableTest, LinesThatDoNotFitAreLeftOut) {
  EXPECT_EQ(LinesOf(Example(), {.columns = 80, .rows = 4}, kPlain).size(), 3U);
  EXPECT_EQ(LinesOf(Example(), {.columns = 80, .rows = 3}, kPlain).size(), 2U);
  EXPECT_EQ(LinesOf(Example(), {.columns = 80, .rows = 1}, kPlain).size(), 1U);
}

TEST(LiveTableTest, TheHeadingIsPaintedWithinItsWidth) {
  const Palette coloured({.updates = true, .colours = true});
  EXPECT_EQ(LinesOf(Example(), {.columns = 7, .rows = 24}, coloured)[0], "\x1b[1mrobots\x1b[0m");
}

TEST(LiveTableTest, EachTableIsPutOverTheOneBefore) {
  EXPECT_EQ(PutOver(0, {"a", "b"}), "\ra\x1b[K\nb\x1b[K\n\x1b[J");
  EXPECT_EQ(PutOver(2, {"c"}), "\r\x1b[2Ac\x1b[K\n\x1b[J");
  EXPECT_EQ(PutOver(1, {}), "\r\x1b[1A\x1b[J");
}

TEST(LiveTableTest, TheHeadingSaysHowLongIsLeftToSend) {
  EXPECT_EQ(SendingHeading("robots", 12, milliseconds(30'000)), "robots send: 12 of 30 s");
  EXPECT_EQ(SendingHeading("twins", 2, milliseconds(1'500)), "twins send: 2 of 2 s");
  EXPECT_EQ(SendingHeading("twins", 3, milliseconds(1'500)), "twins send: 2 of 2 s");
}

}  // namespace
}  // namespace uplink::synthetic
