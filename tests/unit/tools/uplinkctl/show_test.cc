#include <gtest/gtest.h>

#include "schema/base/rfc3339.h"
#include "tools/uplinkctl/show/ages.h"
#include "tools/uplinkctl/show/csv.h"
#include "tools/uplinkctl/show/json_text.h"
#include "tools/uplinkctl/show/short_names.h"
#include "tools/uplinkctl/show/table.h"
#include "tools/uplinkctl/show/text_width.h"

namespace uplink::ctl {
namespace {

using std::chrono::days;
using std::chrono::hours;
using std::chrono::minutes;
using std::chrono::seconds;

const SystemTime kNow = *FromRfc3339("2026-05-01T12:30:00Z");

TEST(Ages, AreInTheUnitsThatPeopleUse) {
  EXPECT_EQ(AgeText(kNow, kNow), "now");
  EXPECT_EQ(AgeText(kNow - milliseconds(999), kNow), "now");
  EXPECT_EQ(AgeText(kNow - seconds(1), kNow), "1 s");
  EXPECT_EQ(AgeText(kNow - seconds(59), kNow), "59 s");
  EXPECT_EQ(AgeText(kNow - seconds(60), kNow), "1 min");
  EXPECT_EQ(AgeText(kNow - minutes(59), kNow), "59 min");
  EXPECT_EQ(AgeText(kNow - hours(3) - minutes(12), kNow), "3 h 12 min");
  EXPECT_EQ(AgeText(kNow - hours(47), kNow), "47 h");
  EXPECT_EQ(AgeText(kNow - days(2) - hours(4), kNow), "2 d 4 h");
  EXPECT_EQ(AgeText(kNow - days(14) - hours(4), kNow), "14 d");
  EXPECT_EQ(AgeText(kNow + days(90), kNow), "in 90 d");
  EXPECT_EQ(LengthText(milliseconds(300)), "0 s");
}

TEST(Ages, AMomentIsALengthBeforeNowATimeOfDayOrATime) {
  EXPECT_EQ(ParseMoment("2h", kNow), kNow - hours(2));
  EXPECT_EQ(ParseMoment("90s", kNow), kNow - seconds(90));
  EXPECT_EQ(ParseMoment("3d", kNow), kNow - days(3));
  EXPECT_EQ(ParseMoment("2026-05-01T12:00:00Z", kNow), kNow - minutes(30));
  EXPECT_EQ(ParseMoment("12:30Z", kNow), kNow);
  EXPECT_EQ(ParseMoment("12:31Z", kNow), kNow + minutes(1) - days(1));
  EXPECT_EQ(ParseMoment("22:00Z", kNow), *FromRfc3339("2026-04-30T22:00:00Z"));
  for (const char* wrong : {"", "2", "two hours", "24:00Z", "12:60Z", "22:00", "-1h", "1:000Z"}) {
    EXPECT_EQ(ParseMoment(wrong, kNow), std::nullopt) << wrong;
  }
}

TEST(TextWidth, CountsCellsAndNotBytes) {
  EXPECT_EQ(WidthOf(""), 0U);
  EXPECT_EQ(WidthOf("r17"), 3U);
  EXPECT_EQ(WidthOf("Tür"), 3U);
  EXPECT_EQ(WidthOf("ロボ"), 4U);
  EXPECT_EQ(WidthOf("e\u0301"), 1U);
  EXPECT_EQ(WidthOf("🤖"), 2U);
}

TEST(TextWidth, ACutTextEndsWithAMarkAndFits) {
  EXPECT_EQ(CutTo("brake", 5), "brake");
  EXPECT_EQ(CutTo("brakes", 5), "brak…");
  EXPECT_EQ(CutTo("ロボット", 5), "ロボ…");
  EXPECT_EQ(CutTo("ロボット", 4), "ロ…");
  EXPECT_EQ(CutTo("brake", 1), "…");
  EXPECT_EQ(CutTo("brake", 0), "");
}

TEST(Csv, QuotesWhatNeedsIt) {
  EXPECT_EQ(CsvLine({"a", "b"}), "a,b\n");
  EXPECT_EQ(CsvLine({"", ""}), ",\n");
  EXPECT_EQ(CsvLine({"a,b", "say \"no\"", " x"}), "\"a,b\",\"say \"\"no\"\"\",\" x\"\n");
}

TEST(Csv, ATextIsNoFormula) {
  EXPECT_EQ(CsvLine({"=1+1", "@SUM(1)", "+x", "-x"}), "'=1+1,'@SUM(1),'+x,'-x\n");
  EXPECT_EQ(CsvLine({"-3", "+4", "-1.5e3", "a=b"}), "-3,+4,-1.5e3,a=b\n");
}

TEST(Csv, ARecordStaysALine) {
  EXPECT_EQ(CsvLine({"two\nlines", "\x1b[31m"}), "two\\x0alines,\\x1b[31m\n");
}

TEST(JsonText, IsIndentedOrOnALine) {
  const auto value = boost::json::parse(R"({"a":[1,2.5,"x"],"b":{},"c":null,"d":[{"e":true}]})");
  EXPECT_EQ(LineJson(value), R"({"a":[1,2.5,"x"],"b":{},"c":null,"d":[{"e":true}]})");
  EXPECT_EQ(PrettyJson(value),
            "{\n  \"a\": [\n    1,\n    2.5,\n    \"x\"\n  ],\n  \"b\": {},\n  \"c\": null,\n"
            "  \"d\": [\n    {\n      \"e\": true\n    }\n  ]\n}");
}

TEST(JsonText, EscapesWhatATerminalWouldObeyAndReadsBackEqual) {
  const boost::json::value value = {
      {"message", "a\x1b[2J \x7f \u009b \u202e Tür 🤖 \U000E0001"}};
  const std::string text = LineJson(value);
  EXPECT_EQ(text.find('\x1b'), std::string::npos);
  EXPECT_EQ(text.find('\x7f'), std::string::npos);
  EXPECT_EQ(text.find("\u009b"), std::string::npos);
  EXPECT_NE(text.find("\\u202e"), std::string::npos);
  EXPECT_NE(text.find("Tür"), std::string::npos);
  EXPECT_EQ(boost::json::parse(text), value);
}

TEST(ShortNames, AreAsShortAsTheyAreUnique) {
  const ShortNames names = ShortNamesOf({"rcan://a/acme/rover/1.0/r1", "rcan://a/acme/rover/1.0/r2",
                                         "rcan://a/acme/arm/2.0/r2", "rcan://b/acme/rover/1.0/r3",
                                         "rcan://a/acme/rover/1.0/r3"});
  EXPECT_EQ(names.at("rcan://a/acme/rover/1.0/r1"), "r1");
  EXPECT_EQ(names.at("rcan://a/acme/rover/1.0/r2"), "1.0/r2");
  EXPECT_EQ(names.at("rcan://a/acme/arm/2.0/r2"), "2.0/r2");
  EXPECT_EQ(names.at("rcan://b/acme/rover/1.0/r3"), "rcan://b/acme/rover/1.0/r3");
}

Table Faults() {
  Table table({{"ROBOT", Fit::kKeep},
               {"DESCRIPTION", Fit::kShrink},
               {"COUNT", Fit::kKeep, true},
               {"SOURCE", Fit::kDrop},
               {"EMPTY", Fit::kDrop}});
  table.Add({{"r1"}, {"the brake of the left wheel is worn"}, {"7"}, {"brakes"}, {""}});
  table.Add({{"r17"}, {"hot"}, {"12"}, {"motor"}, {""}});
  return table;
}

TEST(Table, HasColumnsAsWideAsTheirTextsAndNoBlanksAtTheEnd) {
  EXPECT_EQ(Faults().Text({}),
            "ROBOT  DESCRIPTION                          COUNT  SOURCE\n"
            "r1     the brake of the left wheel is worn      7  brakes\n"
            "r17    hot                                     12  motor\n");
}

TEST(Table, FitsTheTerminalByDroppingThenCutting) {
  TableTerms terms;
  terms.columns = 49;
  EXPECT_EQ(Faults().Text(terms),
            "ROBOT  DESCRIPTION                          COUNT\n"
            "r1     the brake of the left wheel is worn      7\n"
            "r17    hot                                     12\n");
  terms.columns = 30;
  EXPECT_EQ(Faults().Text(terms),
            "ROBOT  DESCRIPTION       COUNT\n"
            "r1     the brake of th…      7\n"
            "r17    hot                  12\n");
  // Narrower than it can be.
  terms.columns = 5;
  EXPECT_EQ(Faults().Text(terms).substr(0, 27), "ROBOT  DESCRIPTI…  COUNT\n");
}

TEST(Table, PaintsWordsOnlyWhereColoursAreWanted) {
  Table table({{"PRESENCE"}});
  table.Add({{"offline", Tone::kBad}});
  EXPECT_EQ(table.Text({}).find('\x1b'), std::string::npos);
  TableTerms terms;
  terms.palette = Palette({.updates = true, .colours = true});
  terms.headings = false;
  EXPECT_EQ(table.Text(terms), "\x1b[1;31moffline\x1b[0m\n");
}

TEST(Table, OfNoRowsIsNothing) { EXPECT_EQ(Table({{"ROBOT"}}).Text({}), ""); }

}  // namespace
}  // namespace uplink::ctl
