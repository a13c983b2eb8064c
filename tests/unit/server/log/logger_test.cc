#include "server/log/logger.h"

#include <limits>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/manual_clock.h"
#include "tests/unit/server/log/line_recorder.h"

namespace uplink::log {
namespace {

using ::testing::ElementsAre;
using ::testing::EndsWith;
using ::testing::IsEmpty;
using ::uplink::log::testing::RecordedLog;
using ::uplink::testing::ManualClock;

constexpr SystemTime kNoon = FromUnixMs(1'700'000'000'007);

TEST(LoggerTest, WritesTimeLevelEventAndFieldsAsText) {
  const ManualClock clock(kNoon);
  const RecordedLog log(clock, Format::kText, Level::kDebug);
  log.logger.Warn("store_away", {{"path", "/x"}, {"tries", 3}, {"held", true}});
  EXPECT_THAT(log.lines,
              ElementsAre("2023-11-14T22:13:20.007Z warn store_away path=/x tries=3 held=true"));
}

TEST(LoggerTest, QuotesTextValuesThatWouldNotReadBack) {
  const ManualClock clock(kNoon);
  const RecordedLog log(clock, Format::kText, Level::kDebug);
  log.logger.Info("e", {{"a", "two words"}, {"b", ""}, {"c", "x=y"}, {"d", "\"\\"}});
  EXPECT_THAT(log.lines, ElementsAre("2023-11-14T22:13:20.007Z info e a=\"two words\" b=\"\" "
                                     "c=\"x=y\" d=\"\\\"\\\\\""));
}

TEST(LoggerTest, WritesOneObjectALineAsJson) {
  const ManualClock clock(kNoon);
  const RecordedLog log(clock, Format::kJson, Level::kDebug);
  log.logger.Error("bad", {{"text", "a \"b\""}, {"count", 7U}, {"on", false}, {"ratio", 0.5}});
  EXPECT_THAT(log.lines, ElementsAre(R"({"time":"2023-11-14T22:13:20.007Z","level":"error",)"
                                     R"("event":"bad","text":"a \"b\"","count":7,"on":false,)"
                                     R"("ratio":0.5})"));
}

TEST(LoggerTest, ShowsForeignBytesAndControlCharactersAsHex) {
  const ManualClock clock(kNoon);
  const RecordedLog log(clock, Format::kText, Level::kDebug);
  log.logger.Info("e", {{"peer", std::string("a\nb\xff")}});
  EXPECT_THAT(log.lines, ElementsAre("2023-11-14T22:13:20.007Z info e peer=\"a\\x0ab\\xff\""))
      << "escaped once";
}

TEST(LoggerTest, ATextThatLooksLikeHexIsToldFromBytesShownSo) {
  const ManualClock clock(kNoon);
  const RecordedLog log(clock, Format::kText, Level::kDebug);
  log.logger.Info("e", {{"why", std::string("\\x0a\n\"")}});
  EXPECT_THAT(log.lines, ElementsAre(R"(2023-11-14T22:13:20.007Z info e why="\\x0a\x0a\"")"));
}

TEST(LoggerTest, CutsALongValueAtItsBound) {
  EXPECT_EQ(Field("k", std::string(Field::kValueBytesMax, 'x')).text().size(),
            Field::kValueBytesMax);
  EXPECT_EQ(Field("k", std::string(Field::kValueBytesMax + 1, 'x')).text().size(),
            Field::kValueBytesMax);
}

TEST(LoggerTest, CutsNoCodePointOfAText) {
  const std::string most(Field::kValueBytesMax - 1, 'x');
  EXPECT_EQ(Field("k", most + "\u00b5").text(), most);
  EXPECT_EQ(Field("k", most + "\U0001F98A").text(), most);
  EXPECT_EQ(Field("k", most + "y\u00b5").text(), most + "y");
  // Bytes that are no text are cut, too.
  EXPECT_LE(Field("k", std::string(Field::kValueBytesMax + 9, '\x80')).text().size(),
            Field::kValueBytesMax);
}

TEST(LoggerTest, JsonHasControlCharactersByItsOwnEscapes) {
  const ManualClock clock(kNoon);
  const RecordedLog log(clock, Format::kJson, Level::kDebug);
  log.logger.Info("e", {{"why", std::string("a\tb\nc\rd\x01"
                                            "e\x7f\xff\\x09\"")}});
  EXPECT_THAT(log.lines,
              ElementsAre(R"({"time":"2023-11-14T22:13:20.007Z","level":"info","event":"e",)"
                          R"("why":"a\tb\nc\rd\u0001e\u007f\\xff\\x09\""})"));
}

TEST(LoggerTest, KeepsBackWhatIsBelowItsLevel) {
  const ManualClock clock(kNoon);
  const RecordedLog log(clock, Format::kText, Level::kWarn);
  log.logger.Debug("d");
  log.logger.Info("i");
  EXPECT_THAT(log.lines, IsEmpty());
  log.logger.Warn("w");
  log.logger.Error("e");
  EXPECT_EQ(log.lines.size(), 2U);
}

TEST(LoggerTest, ShowsNumbersThatJsonLacksAsNull) {
  EXPECT_EQ(Field("k", std::numeric_limits<double>::quiet_NaN()).text(), "null");
  EXPECT_EQ(Field("k", std::numeric_limits<double>::infinity()).text(), "null");
}

TEST(LoggerTest, QuietLeavesOutInfoAndLetsWarningsWait) {
  const ManualClock clock(kNoon);
  RecordedLog log(clock, Format::kText, Level::kDebug);
  log.logger.SetQuiet(Quiet::kWarnings);
  log.logger.Info("a");
  log.logger.Warn("b");
  log.logger.WritePlain("c");
  EXPECT_THAT(log.lines, ElementsAre("c"));
  log.logger.SetQuiet(Quiet::kInfo);
  log.logger.Debug("d");
  log.logger.Warn("e");
  log.logger.SetQuiet(Quiet::kNone);
  log.logger.Info("f");
  EXPECT_THAT(log.lines,
              ElementsAre("c", EndsWith(" warn b"), EndsWith(" warn e"), EndsWith(" info f")));
}

TEST(LoggerTest, AnErrorGoesAtOnceAfterTheWarningsThatWaited) {
  const ManualClock clock(kNoon);
  RecordedLog log(clock, Format::kText, Level::kInfo);
  log.logger.SetQuiet(Quiet::kWarnings);
  log.logger.Warn("a");
  log.logger.Error("b");
  log.logger.Warn("c");
  EXPECT_THAT(log.lines,
              ElementsAre(EndsWith(" warn a"), EndsWith(" error b"), EndsWith(" warn c")));
}

TEST(LoggerTest, SoManyWarningsWaitAndNoMore) {
  const ManualClock clock(kNoon);
  RecordedLog log(clock, Format::kText, Level::kInfo);
  log.logger.SetQuiet(Quiet::kWarnings);
  for (std::size_t i = 0; i < HeldLines::kLinesMax; ++i) log.logger.Warn("a");
  EXPECT_THAT(log.lines, IsEmpty());
  log.logger.Warn("b");
  ASSERT_EQ(log.lines.size(), HeldLines::kLinesMax + 1);
  EXPECT_THAT(log.lines.back(), EndsWith(" warn b"));
}

}  // namespace
}  // namespace uplink::log
