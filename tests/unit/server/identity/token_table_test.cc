#include "server/identity/token_table.h"

#include <set>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/identity/token_line.h"

namespace uplink::identity {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr SystemTime kNow = FromUnixMs(1'800'000'000'000);

std::array<std::uint8_t, kTokenRandomBytes> Random(std::uint8_t seed) {
  std::array<std::uint8_t, kTokenRandomBytes> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<std::uint8_t>(seed + 7 * i);
  }
  return bytes;
}

TokenEntry EntryOf(const NewToken& made) {
  return {.id = TokenIdOf(made.hash),
          .role = Role::kViewer,
          .scope = Scope::Of({"north"}),
          .created = kNow,
          .hash = made.hash};
}

/// The error of a file with this text; empty if there is none.
std::string FlawOf(const std::string& text) {
  const auto table = TokenTable::Parse(text, "tokens");
  EXPECT_TRUE(table.ok() || absl::IsInvalidArgument(table.status())) << table.status();
  return std::string(table.status().message());
}

/// The line of an entry with one text in it replaced.
std::string LineWith(std::string_view from, std::string_view to) {
  std::string line = LineOf(EntryOf(MakeToken(Random(1))));
  const std::size_t at = line.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return at == std::string::npos ? line : line.replace(at, from.size(), to);
}

TEST(MakeToken, IsThePrefixAndBase64Url) {
  // python3: base64.urlsafe_b64encode(bytes(32 * [255])), hashlib.sha256(token).hexdigest()
  std::array<std::uint8_t, kTokenRandomBytes> bytes{};
  bytes.fill(0xFF);
  EXPECT_EQ(MakeToken(bytes).token, "uplinkd_" + std::string(42, '_') + "8");
  bytes.fill(0);
  const NewToken zeros = MakeToken(bytes);
  EXPECT_EQ(zeros.token, "uplinkd_AAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAAA");
  EXPECT_EQ(TokenIdOf(zeros.hash), "fbd079b3");
  EXPECT_TRUE(HasHash(zeros.token, zeros.hash));
  EXPECT_FALSE(HasHash(zeros.token + "A", zeros.hash));
}

TEST(MakeToken, IsAnotherForOtherBytes) {
  std::set<std::string> tokens;
  for (std::uint8_t seed = 0; seed < 200; ++seed) tokens.insert(MakeToken(Random(seed)).token);
  EXPECT_EQ(tokens.size(), 200U);
}

TEST(TokenTable, ReadsBackWhatItWrote) {
  TokenEntry full = EntryOf(MakeToken(Random(1)));
  full.role = Role::kMetrics;
  full.scope = Scope::Of({"north", "s\"ü d"});
  full.expires = kNow + std::chrono::days(90);
  full.note = "Prometheus, hall \"7\"";
  TokenEntry least = EntryOf(MakeToken(Random(2)));
  least.role = Role::kAdmin;
  least.scope = Scope::All();
  const auto table =
      TokenTable::Parse("# tokens\n\n" + LineOf(full) + "\r\n  \n" + LineOf(least), "tokens");
  ASSERT_TRUE(table.ok()) << table.status();
  ASSERT_EQ(table->entries().size(), 2U);
  const TokenEntry& first = table->entries()[0];
  EXPECT_EQ(first.id, full.id);
  EXPECT_EQ(first.role, Role::kMetrics);
  EXPECT_EQ(first.scope, full.scope);
  EXPECT_EQ(first.expires, full.expires);
  EXPECT_EQ(first.created, kNow);
  EXPECT_EQ(first.note, full.note);
  EXPECT_EQ(first.hash, full.hash);
  const TokenEntry& second = table->entries()[1];
  EXPECT_TRUE(second.scope.all());
  EXPECT_EQ(second.expires, std::nullopt);
  EXPECT_EQ(second.note, "");
}

TEST(TokenTable, FindsATokenUntilItExpires) {
  const NewToken made = MakeToken(Random(1));
  TokenEntry entry = EntryOf(made);
  entry.expires = kNow;
  const auto table =
      TokenTable::Parse(LineOf(entry) + "\n" + LineOf(EntryOf(MakeToken(Random(2)))), "tokens");
  ASSERT_TRUE(table.ok()) << table.status();
  const auto valid = table->Find(made.token, kNow - milliseconds(1));
  EXPECT_EQ(valid.finding, TokenTable::Finding::kValid);
  EXPECT_EQ(valid.entry, &table->entries()[0]);
  const auto expired = table->Find(made.token, kNow);
  EXPECT_EQ(expired.finding, TokenTable::Finding::kExpired);
  EXPECT_EQ(expired.entry, &table->entries()[0]);
}

TEST(TokenTable, FindsNoOtherText) {
  const NewToken made = MakeToken(Random(1));
  const auto table = TokenTable::Parse(LineOf(EntryOf(made)), "tokens");
  ASSERT_TRUE(table.ok()) << table.status();
  const std::string hash = LineOf(EntryOf(made)).substr(LineOf(EntryOf(made)).size() - 66, 64);
  for (const std::string& other :
       {std::string(), made.token.substr(1), made.token + " ", made.token.substr(0, 50), hash,
        table->entries()[0].id, MakeToken(Random(3)).token}) {
    const auto found = table->Find(other, kNow);
    EXPECT_EQ(found.finding, TokenTable::Finding::kUnknown) << other;
    EXPECT_EQ(found.entry, nullptr);
  }
  EXPECT_EQ(TokenTable().Find(made.token, kNow).finding, TokenTable::Finding::kUnknown);
}

TEST(TokenTable, NamesTheLineAndWhatIsWrong) {
  EXPECT_EQ(FlawOf("\n{\n"), "tokens: line 2: is no JSON object of a token");
  for (const char* const text : {"[]", "1", "\"x\"", "{}}", "{\"id\":\"\xff\"}"}) {
    EXPECT_THAT(FlawOf(text), HasSubstr("line 1: is no JSON object")) << text;
  }
  EXPECT_THAT(FlawOf("{}"), HasSubstr("line 1: has no id"));
  EXPECT_THAT(FlawOf(LineWith("\"viewer\"", "\"owner\"")), HasSubstr("role \"owner\": it must be"));
  EXPECT_THAT(FlawOf(LineWith("\"viewer\"", "\"robot\"")), HasSubstr("role \"robot\""));
  EXPECT_THAT(FlawOf(LineWith("\"viewer\"", "1")), HasSubstr("role is no string"));
  EXPECT_THAT(FlawOf(LineWith("\"created\":\"2", "\"created\":\"x")), HasSubstr("created \"x0"));
  EXPECT_THAT(FlawOf(LineWith("\"created\"", "\"expire\"")),
              HasSubstr("expire is no member of a token"));
  EXPECT_THAT(FlawOf(LineWith("\"id\":\"", "\"id\":\"0")), HasSubstr("the first 8 digits"));
  EXPECT_THAT(FlawOf(LineWith("\"sha256\":\"", "\"sha256\":\"G")), HasSubstr("64 lower-case"));
}

TEST(TokenTable, AFlawRepeatsNoHash) {
  const std::string token = MakeToken(Random(1)).token;
  EXPECT_THAT(FlawOf(LineWith("\"sha256\":\"", "\"sha256\":\"" + token)), Not(HasSubstr(token)));
}

TEST(TokenTable, AScopeIsOfSomeFleetsOrOfAll) {
  const auto fleets = [](const std::string& list) { return FlawOf(LineWith("[\"north\"]", list)); };
  EXPECT_EQ(fleets(R"(["*"])"), "");
  EXPECT_EQ(fleets(R"(["a","b"])"), "");
  for (const char* const bad : {"[]", "\"north\"", "null", "{}"}) {
    EXPECT_THAT(fleets(bad), HasSubstr("a list of 1 to 32 names")) << bad;
  }
  EXPECT_THAT(fleets(R"(["a","*"])"), HasSubstr("must stand alone"));
  EXPECT_THAT(fleets(R"([""])"), HasSubstr("one is empty"));
  EXPECT_THAT(fleets("[1]"), HasSubstr("one is no string"));
  EXPECT_THAT(fleets(R"(["a\n"])"), HasSubstr("control character"));
  const auto many = [](std::size_t count) {
    std::string list = "[";
    for (std::size_t i = 0; i < count; ++i) list += fmt::format("{}\"f{}\"", i > 0 ? "," : "", i);
    return list + "]";
  };
  EXPECT_EQ(fleets(many(kScopeFleetsMax)), "");
  EXPECT_THAT(fleets(many(kScopeFleetsMax + 1)), HasSubstr("a list of 1 to 32 names"));
}

TEST(TokenTable, ATokenStandsOnce) {
  const std::string line = LineOf(EntryOf(MakeToken(Random(1))));
  EXPECT_THAT(FlawOf(line + "\n\n" + line),
              AllOf(StartsWith("tokens: line 3: id "), HasSubstr("line 1 has it too")));
}

TEST(TokenTable, HoldsSoManyTokensAndNotOneMore) {
  std::string text;
  std::array<std::uint8_t, kTokenRandomBytes> random{};
  for (std::size_t i = 0; i <= kTokensMax; ++i) {
    random[0] = static_cast<std::uint8_t>(i & 0xFFU);
    random[1] = static_cast<std::uint8_t>(i >> 8U);
    if (i == kTokensMax) {
      EXPECT_EQ(FlawOf(text), "");
    }
    text += LineOf(EntryOf(MakeToken(random))) + "\n";
  }
  EXPECT_EQ(FlawOf(text), "tokens: line 1001: there are more than 1000 tokens");
  EXPECT_THAT(FlawOf(std::string(kTokensFileBytesMax + 1, '\n')), HasSubstr("the limit is"));
}

TEST(TokenNote, IsShortPrintableText) {
  const auto note = [](const std::string& text) {
    return FlawOfTokenNote(text).value_or(std::string());
  };
  EXPECT_EQ(note(""), "");
  std::string longest;
  for (std::size_t i = 0; i < kTokenNoteMax; ++i) longest += "ü";
  EXPECT_EQ(note(longest), "");
  EXPECT_THAT(note(longest + "x"), HasSubstr("has 201 characters, the limit is 200"));
  EXPECT_THAT(note("a\nb"), HasSubstr("control"));
  EXPECT_THAT(note("a\xE2\x80\x8B"
                   "b"),
              HasSubstr("invisible"));
  EXPECT_THAT(note("\xff"), HasSubstr("UTF-8"));
  EXPECT_THAT(FlawOf(LineWith("\"sha256\"", "\"note\":\"a\\tb\",\"sha256\"")),
              HasSubstr("note holds a control"));
}

}  // namespace
}  // namespace uplink::identity
