#include <set>
#include <string>
#include <string_view>
#include <vector>

#include <gtest/gtest.h>

#include "schema/base/clock.h"
#include "schema/base/doc_page.h"
#include "schema/base/utf8.h"
#include "schema/model/enum_text.h"
#include "schema/model/ids.h"
#include "schema/model/motion.h"
#include "schema/model/record.h"
#include "schema/model/rejection.h"
#include "schema/rules/path.h"

namespace uplink {
namespace {

using std::string_view_literals::operator""sv;

TEST(DocPageTest, APageIsNamedWithItsFolderOnAnInstalledHost) {
  EXPECT_EQ(DocPage("docs/a.md"), "docs/a.md in /usr/share/doc/uplinkd");
  EXPECT_EQ(DocPage("docs/a.md", "It fills"),
            "\"It fills\" of docs/a.md in /usr/share/doc/uplinkd");
}

TEST(BootClockTest, HasAllOfTheTimeThatTheMonotonicClockHas) {
  const SystemClock steady;
  const SystemBootClock boot;
  // A suspend of this machine in between would make the distance grow.
  const SteadyTime from = steady.Steady();
  const SteadyTime began = boot.Boot();
  EXPECT_GE(began, from) << "both count from the boot";
  const SteadyTime after = steady.Steady();
  while (steady.Steady() - after < milliseconds(2)) {
  }
  EXPECT_GE(boot.Boot() - began, milliseconds(2));
}

TEST(Utf8Test, TakesWellFormedText) {
  for (const std::string_view text :
       {""sv, "plain"sv, "\t\n\x7F"sv, "Ölkännchen"sv, "≤ 3 µV"sv, "🦊"sv, "\xC2\x80"sv,
        "\xDF\xBF"sv, "\xE0\xA0\x80"sv, "\xED\x9F\xBF"sv, "\xEE\x80\x80"sv, "\xEF\xBF\xBF"sv,
        "\xF0\x90\x80\x80"sv, "\xF4\x8F\xBF\xBF"sv}) {
    EXPECT_TRUE(IsCleanUtf8(text)) << PrintableUtf8(text, 64);
  }
}

TEST(Utf8Test, RefusesWhatIsNotUtf8) {
  for (const std::string_view text :
       {"\0"sv, "a\0b"sv, "\x80"sv, "\xBF"sv, "\xC0\x80"sv, "\xC1\xBF"sv, "\xC3"sv, "\xC3("sv,
        "\xE0\x9F\xBF"sv, "\xED\xA0\x80"sv, "\xED\xBF\xBF"sv, "\xE2\x82"sv, "\xF0\x8F\xBF\xBF"sv,
        "\xF4\x90\x80\x80"sv, "\xF5\x80\x80\x80"sv, "\xF0\x9F\xA6"sv, "\xFE"sv, "\xFF"sv}) {
    EXPECT_FALSE(IsCleanUtf8(text)) << PrintableUtf8(text, 64);
  }
}

TEST(Utf8Test, CountsControlCharactersOtherThanTabAndLineEnds) {
  EXPECT_EQ(CountControls(""), 0U);
  EXPECT_EQ(CountControls("\t\n\r plain Ölkännchen \u00A0🦊\uFFFD"), 0U);
  for (const std::string_view control : {"\x01"sv, "\x08"sv, "\x0B"sv, "\x0C"sv, "\x0E"sv, "\x1F"sv,
                                         "\x7F"sv, "\u0080"sv, "\u0085"sv, "\u009F"sv}) {
    // Wherever it stands in a block of eight, and behind one.
    for (std::size_t before = 0; before < 20; ++before) {
      const std::string text =
          std::string(before, 'x') + std::string(control) + std::string(before % 3 * 8, 'y');
      EXPECT_EQ(CountControls(text), 1U) << PrintableUtf8(text, 64);
      EXPECT_EQ(ReplaceControls(text, 1),
                std::string(before, 'x') + "\uFFFD" + std::string(before % 3 * 8, 'y'));
    }
  }
  EXPECT_EQ(CountControls("\0"sv), std::nullopt);
  EXPECT_EQ(CountControls("\x01\xFF"), std::nullopt);
}

TEST(Utf8Test, NeitherPrintableAsciiNorItsNeighboursAreControls) {
  for (int byte = 0x20; byte < 0x7F; ++byte) {
    EXPECT_EQ(CountControls(std::string(8, static_cast<char>(byte))), 0U) << byte;
  }
  for (int byte = 0x80; byte < 0x100; ++byte) {
    EXPECT_EQ(CountControls(std::string(8, static_cast<char>(byte))), std::nullopt) << byte;
  }
  EXPECT_EQ(CountControls(std::string(8, '\x1F')), 8U);
  EXPECT_EQ(CountControls(std::string(8, '\x7F')), 8U);
  EXPECT_EQ(CountControls("\u007E\u00A0"), 0U);
}

TEST(Utf8Test, ReplacesEachControlCharacterByItself) {
  EXPECT_EQ(ReplaceControls("\x01\x02", 2), "\uFFFD\uFFFD");
  EXPECT_EQ(ReplaceControls("a\u009Bb\tc\x7F🦊\x1B[0m\r\n", 3),
            "a\uFFFDb\tc\uFFFD🦊\uFFFD[0m\r\n");
  EXPECT_EQ(CountControls(ReplaceControls("\x01\u0080", 2)), 0U);
}

TEST(Utf8Test, CutsBetweenCodePoints) {
  EXPECT_EQ(Utf8Prefix("abc", 3), "abc");
  EXPECT_EQ(Utf8Prefix("abc", 2), "ab");
  EXPECT_EQ(Utf8Prefix("aü", 2), "a");
  EXPECT_EQ(Utf8Prefix("aü", 3), "aü");
  EXPECT_EQ(Utf8Prefix("🦊", 3), "");
  EXPECT_EQ(Utf8Prefix("abc", 0), "");
}

TEST(Utf8Test, ShowsForeignBytesAsHex) {
  EXPECT_EQ(PrintableUtf8("ä\xFF\n\0b"sv, 64), "ä\\xff\\x0a\\x00b");
  EXPECT_EQ(PrintableUtf8("\xFF\xFF", 7), "\\xff");
  EXPECT_EQ(PrintableUtf8("a\u009B2J\u0085", 64), "a\\xc2\\x9b2J\\xc2\\x85") << "controls of C1";
  EXPECT_EQ(PrintableUtf8("\u202Eb\u2066\u200F", 64),
            "\\xe2\\x80\\xaeb\\xe2\\x81\\xa6\\xe2\\x80\\x8f")
      << "marks of direction";
  EXPECT_EQ(PrintableUtf8("\u2028\u2029", 64), "\\xe2\\x80\\xa8\\xe2\\x80\\xa9") << "ends of line";
  EXPECT_EQ(PrintableUtf8("\u00A0\u2010\u2065\u00E9", 64), "\u00A0\u2010\u2065\u00E9");
  EXPECT_EQ(PrintableUtf8("aüb", 2), "a");
  for (std::size_t max = 0; max < 20; ++max) {
    const std::string shown = PrintableUtf8("ä\xFFü\x01🦊\xC3", max);
    EXPECT_LE(shown.size(), max);
    EXPECT_TRUE(IsCleanUtf8(shown));
  }
}

TEST(SessionIdTest, GoesThroughBytesAndHex) {
  EXPECT_FALSE(model::SessionId::FromBytes("short").has_value());
  const std::string whole = std::string("\x00\x01\x0F\x10\xFF", 5) + std::string(11, 'x');
  const auto id = model::SessionId::FromBytes(whole);
  ASSERT_TRUE(id.has_value());
  EXPECT_EQ(id->AsBytes(), whole);
  EXPECT_EQ(id->ToHex().substr(0, 12), "00010f10ff78");
  EXPECT_EQ(model::SessionId::FromHex(id->ToHex()), id);
}

TEST(SessionIdTest, RefusesEveryOtherLengthAndDigit) {
  for (const std::size_t bytes : {0U, 15U, 17U, 32U}) {
    EXPECT_FALSE(model::SessionId::FromBytes(std::string(bytes, 'x')).has_value());
  }
  EXPECT_FALSE(model::SessionId::FromHex(std::string(31, '0')).has_value());
  EXPECT_FALSE(model::SessionId::FromHex(std::string(33, '0')).has_value());
  EXPECT_FALSE(model::SessionId::FromHex(std::string(31, '0') + "A").has_value());
  EXPECT_FALSE(model::SessionId::FromHex(std::string(31, '0') + "g").has_value());
}

TEST(RejectReasonTest, HasADistinctTextThatComesBack) {
  std::set<std::string_view> texts;
  for (std::size_t i = 0; i < model::kRejectReasons; ++i) {
    const model::RejectReason reason = model::kAllRejectReasons[i];
    EXPECT_EQ(static_cast<std::size_t>(reason), i + 1);
    EXPECT_EQ(model::RejectReasonFromText(model::ToText(reason)), reason);
    texts.insert(model::ToText(reason));
  }
  EXPECT_EQ(texts.size(), model::kRejectReasons);
  EXPECT_EQ(model::ToText(model::RejectReason::kOutOfRange), "out_of_range");
  EXPECT_FALSE(model::RejectReasonFromText("unspecified").has_value());
}

TEST(VariantTest, NineOfSixteenAreDurable) {
  std::set<std::string_view> names;
  std::size_t durable = 0;
  for (std::size_t i = 0; i < model::kVariants; ++i) {
    const auto variant = static_cast<model::Variant>(i);
    names.insert(model::ToText(variant));
    durable += model::IsDurable(variant) ? 1U : 0U;
  }
  EXPECT_EQ(names.size(), model::kVariants);
  EXPECT_EQ(durable, 9U);
  EXPECT_EQ(model::ToText(model::VariantOf(model::Body(model::MotionTelemetry()))),
            "motionTelemetry");
}

TEST(SampledUnixMsTest, IsTheMessagesOwnTimeIfItHasOne) {
  EXPECT_EQ(model::SampledUnixMs(model::MotionTelemetry{.unix_time_ms = 7}), 7);
  EXPECT_EQ(model::SampledUnixMs(model::TelemetryExtras{.unix_time_ms = 8}), 8);
  EXPECT_EQ(model::SampledUnixMs(model::Fault{.unix_time_ms = 9}), 9);
  model::ObjectOp object;
  object.op = model::Object{.unix_time_ms = 10};
  EXPECT_EQ(model::SampledUnixMs(object), 10);
  EXPECT_EQ(model::SampledUnixMs(model::AgentInfo()), 0);
}

TEST(EnumTextTest, GoesThroughText) {
  using model::GpsFixType;
  EXPECT_EQ(model::EnumText(GpsFixType::kFixedRtk), "fixedRtk");
  EXPECT_EQ(model::EnumFromText<GpsFixType>("fixedRtk"), GpsFixType::kFixedRtk);
  EXPECT_EQ(model::EnumText(static_cast<GpsFixType>(8)), "unrecognized_8");
  EXPECT_EQ(model::EnumFromText<GpsFixType>("unrecognized_8"), static_cast<GpsFixType>(8));
  EXPECT_EQ(model::EnumFromText<GpsFixType>("unrecognized_65535"), static_cast<GpsFixType>(65'535));
  for (const std::string_view text : {"", "FixedRtk", "unrecognized_", "unrecognized_7",
                                      "unrecognized_-1", "unrecognized_65536", "unrecognized_8x"}) {
    EXPECT_FALSE(model::EnumFromText<GpsFixType>(text).has_value()) << text;
  }
}

TEST(PathTest, IsSpelledAsTheSurfaceSaysIt) {
  const schema::Path root;
  EXPECT_EQ(root.Text(), "");
  const schema::Path kv = root.Field("kv");
  const schema::Path item = kv.Item(3);
  EXPECT_EQ(item.Field("key").Text(), "kv[3].key");
  const schema::Path bare = root.Item(3);
  EXPECT_EQ(bare.Field("key").Text(), "[3].key");
  const schema::Path nested = item.Item(0);
  EXPECT_EQ(nested.Text(), "kv[3][0]");
}

}  // namespace
}  // namespace uplink
