#include "tools/uplinkctl/show/columns.h"

#include <gtest/gtest.h>

#include "schema/base/rfc3339.h"
#include "tools/uplinkctl/show/rows.h"

namespace uplink::ctl {
namespace {

const SystemTime kNow = *FromRfc3339("2026-05-01T12:30:00Z");

class ColumnsTest : public ::testing::Test {
 protected:
  [[nodiscard]] Cell Of(const Column& column, const char* json) const {
    return CellOf(column, boost::json::parse(json).get_object(), {kNow, names_});
  }
  [[nodiscard]] std::string Text(const Column& column, const char* json) const {
    return Of(column, json).text;
  }

  ShortNames names_ = {{"rcan://a/b/c/1/r1", "r1"}};
};

TEST_F(ColumnsTest, AMemberIsShownByItsKind) {
  EXPECT_EQ(Text({"", "a.b"}, R"({"a":{"b":"x"}})"), "x");
  EXPECT_EQ(Text({"", "a.b"}, R"({"a":"x"})"), "");
  EXPECT_EQ(Text({"", "at", Kind::kAge}, R"({"at":"2026-05-01T12:00:00Z"})"), "30 min");
  EXPECT_EQ(Text({"", "at", Kind::kTime}, R"({"at":"2026-05-01T12:00:00.250Z"})"),
            "2026-05-01 12:00:00Z");
  EXPECT_EQ(Text({"", "a,b", Kind::kLength},
                 R"({"a":"2026-05-01T12:00:00Z","b":"2026-05-01T12:00:09Z"})"),
            "9 s");
  EXPECT_EQ(Text({"", "a,b", Kind::kLength}, R"({"a":"2026-05-01T12:00:00Z"})"), "30 min");
  EXPECT_EQ(Text({"", "n", Kind::kNumber}, R"({"n":"1234567"})"), "1,234,567");
  EXPECT_EQ(Text({"", "n", Kind::kNumber}, R"({"n":12.5})"), "12.5");
  EXPECT_EQ(Text({"", "n", Kind::kRate}, R"({"n":2.04})"), "2.0");
  EXPECT_EQ(Text({"", "n", Kind::kHundredths}, R"({"n":4210})"), "42 %");
  EXPECT_EQ(Text({"", "n", Kind::kBytes}, R"({"n":"1536"})"), "1.5 KiB");
  EXPECT_EQ(Text({"", "y", Kind::kYes}, R"({"y":true})"), "yes");
  EXPECT_EQ(Text({"", "y", Kind::kYes}, R"({"y":false})"), "");
  EXPECT_EQ(Text({"", "l", Kind::kList}, R"({"l":["a","b"]})"), "a, b");
  EXPECT_EQ(Text({"", "l", Kind::kList}, R"({"l":{"1.2":"4","_other":"1"}})"), "1.2 4, _other 1");
  EXPECT_EQ(Text({"", "p", Kind::kPlace}, R"({"p":{"latitude":52.5,"longitude":13.4}})"),
            "52.50000, 13.40000");
  EXPECT_EQ(Text({"", "p", Kind::kPlace}, R"({"p":{"x":1,"y":-2.5}})"), "x 1.00, y -2.50 m");
  EXPECT_EQ(Text({"", "r", Kind::kRobot}, R"({"r":"rcan://a/b/c/1/r1"})"), "r1");
  EXPECT_EQ(Text({"", "r", Kind::kRobot}, R"({"r":""})"), "-");
  EXPECT_EQ(Text({"", "d"}, R"({"d":{"by":"ann"}})"), R"({"by":"ann"})");
}

TEST_F(ColumnsTest, WordsAndLowBatteriesHaveATone) {
  EXPECT_EQ(Of({"", "w", Kind::kWord}, R"({"w":"offline"})").tone, Tone::kBad);
  EXPECT_EQ(Of({"", "w", Kind::kWord}, R"({"w":"online"})").tone, Tone::kGood);
  EXPECT_EQ(Of({"", "w", Kind::kWord}, R"({"w":"other"})").tone, Tone::kPlain);
  EXPECT_EQ(Of({"", "p", Kind::kPercent}, R"({"p":19.9})").tone, Tone::kBad);
  EXPECT_EQ(Of({"", "p", Kind::kPercent}, R"({"p":20})").tone, Tone::kWarning);
  EXPECT_EQ(Of({"", "p", Kind::kPercent}, R"({"p":40})").text, "40 %");
}

TEST_F(ColumnsTest, WhatARobotWroteStaysOnItsLine) {
  EXPECT_EQ(Text({"", "m"}, R"({"m":"a\nb\u001b[31m"})"), "a b [31m");
}

TEST(Sizes, HaveTheUnitThatFits) {
  EXPECT_EQ(SizeText(0), "0 B");
  EXPECT_EQ(SizeText(1023), "1023 B");
  EXPECT_EQ(SizeText(1024), "1.0 KiB");
  EXPECT_EQ(SizeText(5.0 * 1024 * 1024 * 1024), "5.0 GiB");
}

TEST(Rows, CsvHasEachMemberOnceAsTheServerWroteIt) {
  const Columns columns = {{"TIME", "at", Kind::kTime},
                           {"AGO", "at", Kind::kAge},
                           {"ROBOT", "ruri", Kind::kRobot},
                           {"LASTED", "at,endedAt", Kind::kLength},
                           {"MESSAGE", "message"}};
  const auto rows = boost::json::parse(
      R"([{"at":"2026-05-01T12:00:00Z","ruri":"rcan://a/b/c/1/r1","message":"a, b"}])");
  EXPECT_EQ(CsvOf(columns, rows.get_array(), true),
            "at,ruri,endedAt,message\n2026-05-01T12:00:00Z,rcan://a/b/c/1/r1,,\"a, b\"\n");
}

TEST(Rows, FieldsOfAnObjectHavePointsInTheirNamesAndAges) {
  const auto object = boost::json::parse(
      R"({"ruri":"rcan://a","battery":{"percent":12},"seen":"2026-05-01T12:00:00Z","none":"","l":[]})");
  EXPECT_EQ(FieldsOf(object.get_object(), {kNow, {}}),
            "ruri             rcan://a\n"
            "battery.percent  12\n"
            "seen             2026-05-01T12:00:00Z (30 min ago)\n");
  EXPECT_EQ(FieldsCsvOf(object.get_object()),
            "field,value\nruri,rcan://a\nbattery.percent,12\nseen,2026-05-01T12:00:00Z\n");
}

}  // namespace
}  // namespace uplink::ctl
