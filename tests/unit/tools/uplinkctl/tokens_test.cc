#include <filesystem>
#include <fstream>
#include <set>
#include <thread>
#include <vector>

#include <fmt/core.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>
#include <unistd.h>

#include "schema/base/file_text.h"
#include "tests/support/temp_folder.h"
#include "tools/uplinkctl/tokens/change.h"
#include "tools/uplinkctl/tokens/request.h"

namespace uplink::ctl {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using ::testing::StartsWith;

constexpr SystemTime kNow = FromUnixMs(1'800'000'000'999);
constexpr std::size_t kBytesMax = identity::kTokensFileBytesMax;

class TokensTest : public ::testing::Test {
 protected:
  /// Adds a token, and returns its text.
  std::string Add(const TokenRequest& request = {.fleets = {"north"}}) {
    auto entry = EntryOf(request, kNow);
    EXPECT_TRUE(entry.ok()) << entry.status();
    const auto token = AddToken(path_, *entry);
    EXPECT_TRUE(token.ok()) << token.status();
    id_ = entry->id;
    return token.value_or(std::string());
  }
  [[nodiscard]] identity::TokenTable Table() const {
    const auto read = identity::ReadTokenFile(path_);
    EXPECT_TRUE(read.ok()) << read.status();
    return read.ok() ? read->table : identity::TokenTable();
  }
  [[nodiscard]] std::string Text() const { return ReadFileText(path_, kBytesMax).text; }
  void Write(const std::string& text) const { std::ofstream(path_) << text; }
  [[nodiscard]] struct stat Facts() const {
    struct stat info {};
    EXPECT_EQ(::stat(path_.c_str(), &info), 0);
    return info;
  }

  uplink::testing::TempFolder folder_;
  const std::string path_ = folder_.File("tokens");
  /// Of the token that was added last.
  std::string id_;
};

std::string FlawOf(const TokenRequest& request) {
  const absl::Status status = EntryOf(request, kNow).status();
  EXPECT_TRUE(status.ok() || absl::IsInvalidArgument(status)) << status;
  return std::string(status.message());
}

TEST_F(TokensTest, AnEntrySaysWhatWasAskedFor) {
  const auto entry = EntryOf(
      {.role = "operator", .fleets = {"south", "north"}, .expires = "90d", .note = "ann"}, kNow);
  ASSERT_TRUE(entry.ok()) << entry.status();
  EXPECT_EQ(entry->role, identity::Role::kOperator);
  EXPECT_EQ(entry->scope, identity::Scope::Of({"north", "south"}));
  EXPECT_EQ(entry->created, FromUnixMs(1'800'000'000'000)) << "whole seconds";
  EXPECT_EQ(entry->expires, FromUnixMs(1'800'000'000'000) + std::chrono::days(90));
  EXPECT_EQ(entry->note, "ann");
  EXPECT_EQ(EntryOf({.fleets = {"*"}, .expires = "never"}, kNow)->expires, std::nullopt);
  EXPECT_TRUE(EntryOf({.fleets = {"*"}}, kNow)->scope.all());
}

TEST_F(TokensTest, NamesTheFlagThatIsWrong) {
  EXPECT_THAT(FlawOf({.role = "robot", .fleets = {"a"}}), StartsWith("--role must be"));
  EXPECT_THAT(FlawOf({}), StartsWith("--fleet is required"));
  EXPECT_THAT(FlawOf({.fleets = {"a", "*"}}), StartsWith("--fleet * means all"));
  EXPECT_THAT(FlawOf({.fleets = {""}}), StartsWith("--fleet \"\" is empty"));
  EXPECT_THAT(FlawOf({.fleets = {"a\xff"}}), HasSubstr("is no text in UTF-8"));
  std::vector<std::string> many(33);
  for (std::size_t i = 0; i < many.size(); ++i) many[i] = fmt::format("f{}", i);
  EXPECT_THAT(FlawOf({.fleets = many}), StartsWith("--fleet is given 33 times"));
  many.pop_back();
  EXPECT_EQ(FlawOf({.fleets = many}), "");
  EXPECT_THAT(FlawOf({.fleets = {"a"}, .note = "a\nb"}), StartsWith("--note holds a control"));
  for (const char* const bad : {"", "0", "90", "500ms", "3651d", "Never", "-1d"}) {
    EXPECT_THAT(FlawOf({.fleets = {"a"}, .expires = bad}), StartsWith("--expires \"")) << bad;
  }
  EXPECT_EQ(FlawOf({.fleets = {"a"}, .expires = "3650d"}), "");
}

TEST_F(TokensTest, ATokenIsAddedByItsHashAlone) {
  const std::string token = Add();
  EXPECT_EQ(Table().Find(token, kNow).finding, identity::TokenTable::Finding::kValid);
  EXPECT_THAT(token, StartsWith("uplinkd_"));
  EXPECT_THAT(Text(), Not(HasSubstr(token.substr(identity::kTokenPrefix.size()))));
  EXPECT_EQ(Facts().st_mode & 07777U, 0640U);
}

TEST_F(TokensTest, WhatElseTheFileHoldsStays) {
  Write("# of hall 7\r\n\n# no line end");
  const std::string first = Add();
  EXPECT_THAT(Text(), StartsWith("# of hall 7\r\n\n# no line end\n{"));
  const std::string before = Text();
  const std::string second = Add();
  ASSERT_TRUE(RevokeToken(path_, id_).ok());
  EXPECT_EQ(Text(), before);
  EXPECT_EQ(Table().Find(second, kNow).finding, identity::TokenTable::Finding::kUnknown);
  EXPECT_EQ(Table().Find(first, kNow).finding, identity::TokenTable::Finding::kValid);
}

TEST_F(TokensTest, OnlyATokenThatIsThereIsRevoked) {
  Add();
  const std::string before = Text();
  for (const std::string& other : {std::string(), id_.substr(1), id_ + "0", std::string("x")}) {
    EXPECT_TRUE(absl::IsNotFound(RevokeToken(path_, other))) << other;
  }
  EXPECT_EQ(Text(), before);
  ASSERT_TRUE(RevokeToken(path_, id_).ok());
  EXPECT_THAT(Table().entries(), IsEmpty());
  std::filesystem::remove(path_);
  EXPECT_TRUE(absl::IsFailedPrecondition(RevokeToken(path_, id_))) << "no file is made";
  EXPECT_FALSE(std::filesystem::exists(path_));
}

TEST_F(TokensTest, KeepsTheModeOfTheFile) {
  for (const mode_t mode : {0600U, 0440U, 0644U}) {
    Write("");
    ASSERT_EQ(::chmod(path_.c_str(), mode), 0);
    Add();
    EXPECT_EQ(Facts().st_mode & 07777U, mode);
    EXPECT_EQ(Facts().st_uid, ::geteuid());
    std::filesystem::remove(path_);
  }
}

TEST_F(TokensTest, KeepsTheOwnerOfTheFile) {
  if (::geteuid() != 0) return;  // who is not root can give no file away
  Write("");
  ASSERT_EQ(::chown(path_.c_str(), 12345, 23456), 0);
  Add();
  EXPECT_EQ(Facts().st_uid, 12345U);
  EXPECT_EQ(Facts().st_gid, 23456U);
}

TEST_F(TokensTest, ALinkStaysOne) {
  std::filesystem::create_directory(folder_.File("real"));
  std::ofstream(folder_.File("real/t")) << "# here\n";
  std::filesystem::create_symlink("real/t", path_);
  Add();
  EXPECT_TRUE(std::filesystem::is_symlink(path_));
  EXPECT_THAT(ReadFileText(folder_.File("real/t"), kBytesMax).text, StartsWith("# here\n{"));
}

TEST_F(TokensTest, ABrokenFileStaysAsItIs) {
  Write("{\"id\":\n");
  auto entry = EntryOf({.fleets = {"a"}}, kNow);
  ASSERT_TRUE(entry.ok());
  EXPECT_THAT(std::string(AddToken(path_, *entry).status().message()), HasSubstr("line 1: is no"));
  EXPECT_FALSE(RevokeToken(path_, "00000000").ok());
  EXPECT_EQ(Text(), "{\"id\":\n");
}

TEST_F(TokensTest, AFileThatEverybodyMayWriteIsNotTrusted) {
  Write("");
  ASSERT_EQ(::chmod(path_.c_str(), 0666), 0);
  auto entry = EntryOf({.fleets = {"a"}}, kNow);
  ASSERT_TRUE(entry.ok());
  EXPECT_THAT(std::string(AddToken(path_, *entry).status().message()),
              HasSubstr("everybody on this machine may write"));
}

TEST_F(TokensTest, WhatTheServerWouldNotReadIsNotWritten) {
  Write("# old\n");
  const auto spoil = [](const identity::ReadTokens& read) {
    return absl::StatusOr<std::string>(read.text + "spoilt\n");
  };
  EXPECT_FALSE(ChangeTokens(path_, Missing::kIsAnError, spoil).ok());
  EXPECT_EQ(Text(), "# old\n");
}

TEST_F(TokensTest, AFolderThatIsNotThereIsNamed) {
  auto entry = EntryOf({.fleets = {"a"}}, kNow);
  ASSERT_TRUE(entry.ok());
  const auto made = AddToken(folder_.File("gone/tokens"), *entry);
  EXPECT_THAT(std::string(made.status().message()), AllOf(HasSubstr("gone"), HasSubstr("No such")));
}

TEST_F(TokensTest, ChangesAtOnceLoseNone) {
  constexpr int kThreads = 8;
  constexpr int kEach = 5;
  std::vector<std::thread> threads;
  threads.reserve(kThreads);
  for (int i = 0; i < kThreads; ++i) {
    threads.emplace_back([this] {
      for (int n = 0; n < kEach; ++n) {
        auto entry = EntryOf({.fleets = {"north"}}, kNow);
        EXPECT_TRUE(entry.ok() && AddToken(path_, *entry).ok());
      }
    });
  }
  for (std::thread& thread : threads) thread.join();
  EXPECT_EQ(Table().entries().size(), static_cast<std::size_t>(kThreads * kEach));
  std::set<std::string> names;
  for (const auto& each : std::filesystem::directory_iterator(folder_.path())) {
    names.insert(each.path().filename().string());
  }
  EXPECT_EQ(names, std::set<std::string>{"tokens"}) << "nothing is left aside";
}

TEST_F(TokensTest, TheFileIsThatOfTheFlagOrOfTheConfiguration) {
  EXPECT_EQ(TokensFileOf("/x/tokens", "", {}).value_or(""), "/x/tokens");
  const std::string config = folder_.File("u.toml");
  std::ofstream(config) << "[http]\ntokens_file = \"/y/tokens\"\n";
  EXPECT_EQ(TokensFileOf("", config, {}).value_or(""), "/y/tokens")
      << "what else is missing there is no matter of tokens";
  EXPECT_EQ(TokensFileOf("", config, {{"UPLINKD_HTTP_TOKENS_FILE", "/z"}}).value_or(""), "/z");
  std::ofstream(config) << "";
  EXPECT_THAT(std::string(TokensFileOf("", config, {}).status().message()),
              HasSubstr("names no http.tokens_file; set that, or"));
  EXPECT_TRUE(absl::IsInvalidArgument(TokensFileOf("", folder_.File("gone"), {}).status()));
}

}  // namespace
}  // namespace uplink::ctl
