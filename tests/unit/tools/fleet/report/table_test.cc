#include "tools/uplink-fleet/report/table.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::synthetic {
namespace {

using ::testing::HasSubstr;
using ::testing::IsEmpty;

const Palette kPlain({.updates = true, .colours = false});
const Palette kColoured({.updates = true, .colours = true});

TEST(TableTest, ColumnsAreAsWideAsTheirWidestCell) {
  Table table({"what", "fleet", "server", ""});
  table.Add({"robots online", "50", "50", "ok"});
  table.Add({"received", "", "1234567 = 1234567", "MISMATCH"});
  EXPECT_EQ(table.Text(kPlain),
            "what          | fleet |            server |\n"
            "--------------+-------+-------------------+---------\n"
            "robots online |    50 |                50 | ok\n"
            "received      |       | 1234567 = 1234567 | MISMATCH\n");
}

TEST(TableTest, AColourDoesNotShiftAColumn) {
  Table table({"a", "b", ""});
  table.Add({Cell("x", Cell::Tone::kBad), Cell("1", Cell::Tone::kGood), "ok"});
  table.Add({"long", "100", "ok"});
  EXPECT_THAT(table.Text(kPlain), HasSubstr("\nx    |   1 | ok\n"));
  EXPECT_THAT(table.Text(kColoured),
              HasSubstr("\n\x1b[1;31mx\x1b[0m    |   \x1b[32m1\x1b[0m | ok\n"));
}

TEST(TableTest, ANoteStandsBelowItsRowAndWidensNothing) {
  Table table({"a", "b"});
  table.Add({"x", "1"});
  table.AddNote("    a note that is longer than all columns");
  EXPECT_EQ(table.Text(kPlain),
            "a | b\n"
            "--+--\n"
            "x | 1\n"
            "    a note that is longer than all columns\n");
}

TEST(TableTest, MissingCellsAreEmptyAndSurplusOnesAreLeftOut) {
  Table table({"a", "b"});
  table.Add({"x"});
  table.Add({"y", "1", "2"});
  EXPECT_EQ(table.Text(kPlain), "a | b\n--+--\nx |\ny | 1\n");
}

TEST(TableTest, WithoutRowsItIsEmpty) { EXPECT_THAT(Table({"a", "b"}).Text(kPlain), IsEmpty()); }

}  // namespace
}  // namespace uplink::synthetic
