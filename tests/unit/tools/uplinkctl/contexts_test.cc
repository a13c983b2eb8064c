#include "tools/uplinkctl/ask/contexts.h"

#include <array>
#include <fstream>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include "tests/support/temp_folder.h"
#include "tools/uplinkctl/ask/server_choice.h"

namespace uplink::ctl {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

TEST(Contexts, TheFileIsBelowTheUsersConfiguration) {
  const std::array<const char*, 3> both = {"XDG_CONFIG_HOME=/c", "HOME=/somewhere/ann", nullptr};
  EXPECT_EQ(ContextsFile(both.data()), "/c/uplinkctl/config.toml");
  const std::array<const char*, 2> home = {"HOME=/somewhere/ann", nullptr};
  EXPECT_EQ(ContextsFile(home.data()), "/somewhere/ann/.config/uplinkctl/config.toml");
  const std::array<const char*, 2> relative = {"XDG_CONFIG_HOME=c", nullptr};
  EXPECT_EQ(ContextsFile(relative.data()), "");
}

TEST(Contexts, WhatIsSavedIsReadBackAndIsItsOwnersAlone) {
  const testing::TempFolder folder;
  const std::string path = folder.File("a/b/config.toml");
  Contexts contexts;
  contexts.current = "hall";
  contexts.by_name["hall"] = {"http://192.0.2.7:7480"};
  contexts.by_name["yard-2"] = {"https://fleet.example.org/uplink",
                                {.ca_file = "/c/a \"b\\.crt",
                                 .certificate_file = "/c/ann.crt",
                                 .key_file = "/c/ann.key",
                                 .token_file = "/c/yard.token"}};
  ASSERT_TRUE(SaveContexts(contexts, path).ok());
  const auto read = LoadContexts(path);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->current, "hall");
  EXPECT_EQ(read->by_name.size(), 2U);
  EXPECT_EQ(read->by_name.at("yard-2").server, "https://fleet.example.org/uplink");
  EXPECT_EQ(read->by_name.at("yard-2").files, contexts.by_name["yard-2"].files);
  EXPECT_EQ(read->by_name.at("hall").files, AccessFiles());
  struct stat status {};
  ASSERT_EQ(::stat(path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0600U);
}

TEST(Contexts, NoFileIsNoContexts) {
  const auto read = LoadContexts("/nowhere/config.toml");
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_TRUE(read->by_name.empty());
}

TEST(Contexts, AFileThatIsNotGoodSaysWhere) {
  const std::array<std::pair<const char*, const char*>, 10> files = {{
      {"current = ", "f:1"},
      {"current = \"hall\"", "current is hall, which is none"},
      {"token = \"x\"", "token: unknown key"},
      {"[contexts.hall]\nserver = \"http://a:1\"\ntoken = \"x\"",
       "contexts.hall.token: unknown key"},
      {"[contexts.hall]", "contexts.hall.server"},
      {"[contexts.hall]\nserver = \"http://a:1\"\nca_file = \"/a\"", "asked without TLS"},
      {"[contexts.hall]\nserver = \"https://a:1\"\nkey_file = \"/a\"", "go together"},
      {"[contexts.hall]\nserver = \"http://a:1\"\ntoken_file = \"/a\\nb\"", "control character"},
      {"[contexts.\"a b\"]\nserver = \"http://a:1\"", "a name has letters"},
      {"[contexts.hall]\nserver = \"http://ann:pass-word@a:1\"", "neither user nor password"},
  }};
  for (const auto& [text, says] : files) {
    const auto read = ParseContexts(text, "f");
    ASSERT_FALSE(read.ok()) << text;
    EXPECT_TRUE(absl::IsInvalidArgument(read.status()));
    EXPECT_THAT(std::string(read.status().message()), HasSubstr(says));
    EXPECT_EQ(std::string(read.status().message()).find("pass-word"), std::string::npos);
  }
}

TEST(Contexts, PathsBecomeAbsolute) {
  const auto good = GoodContext({"http://a:1", {.token_file = "x/../hall.token"}}, "--server");
  ASSERT_TRUE(good.ok()) << good.status();
  EXPECT_TRUE(good->files.token_file.starts_with('/'));
  EXPECT_TRUE(good->files.token_file.ends_with("/hall.token"));
  EXPECT_THAT(good->files.token_file, Not(HasSubstr("..")));
}

class ServerChoiceTest : public ::testing::Test {
 protected:
  ServerChoiceTest() {
    sources_.contexts_file = folder_.File("contexts.toml");
    std::ofstream(sources_.contexts_file)
        << "current = \"hall\"\n[contexts.hall]\nserver = \"http://hall:1\"\n"
           "token_file = \"/hall.token\"\n"
           "[contexts.yard]\nserver = \"https://yard:2\"\n"
           "ca_file = \"/yard.crt\"\ntoken_file = \"/yard.token\"\n";
  }

  [[nodiscard]] std::string Address(const ServerFlags& flags) const {
    const auto choice = ChooseServer(flags, sources_);
    return choice.ok() ? choice->url.address : std::string(choice.status().message());
  }

  [[nodiscard]] std::string Token(const ServerFlags& flags) const {
    const auto choice = ChooseServer(flags, sources_);
    return choice.ok() ? choice->files.token_file : std::string(choice.status().message());
  }

  testing::TempFolder folder_;
  ServerSources sources_;
};

TEST_F(ServerChoiceTest, AFlagComesBeforeTheVariableAndThatBeforeTheContext) {
  EXPECT_EQ(Address({}), "hall:1");
  sources_.variable = "http://variable:3";
  EXPECT_EQ(Address({}), "variable:3");
  EXPECT_EQ(Address({.context = "yard"}), "yard:2");
  EXPECT_EQ(Address({.server = "http://flag:4"}), "flag:4");
  const std::string config = folder_.File("uplinkd.toml");
  std::ofstream(config) << "[listen]\nhttp = \"127.0.0.1:7481\"\n";
  EXPECT_EQ(Address({.config = config}), "127.0.0.1:7481");
}

TEST_F(ServerChoiceTest, AContextsFilesCountWhereItsServerIsAsked) {
  EXPECT_EQ(Token({}), "/hall.token");
  EXPECT_EQ(Token({.context = "yard"}), "/yard.token");
  EXPECT_EQ(ChooseServer({.context = "yard"}, sources_)->files.ca_file, "/yard.crt");
  EXPECT_EQ(Token({.server = "http://flag:4"}), "");
  const std::string config = folder_.File("uplinkd.toml");
  std::ofstream(config) << "[listen]\nhttp = \"127.0.0.1:7481\"\n";
  EXPECT_EQ(Token({.config = config}), "");
}

TEST_F(ServerChoiceTest, ATokensFlagComesBeforeTheVariableAndThatBeforeTheCurrentContext) {
  sources_.token_file = "/variable.token";
  EXPECT_EQ(Token({}), "/variable.token");
  EXPECT_EQ(Token({.server = "http://flag:4"}), "/variable.token");
  EXPECT_EQ(Token({.context = "yard"}), "/yard.token");
  EXPECT_EQ(Token({.context = "yard", .files = {.token_file = "/flag.token"}}), "/flag.token");
}

TEST_F(ServerChoiceTest, WithoutAnythingItIsThisMachine) {
  sources_.contexts_file = "";
  EXPECT_EQ(Address({}), "127.0.0.1:7480");
}

TEST_F(ServerChoiceTest, AContextThatIsNotThereNamesThoseThatAre) {
  EXPECT_EQ(Address({.context = "dock"}), "there is no context dock; there are: hall, yard");
  sources_.contexts_file = "";
  EXPECT_THAT(Address({.context = "dock"}), HasSubstr("uplinkctl contexts add"));
}

}  // namespace
}  // namespace uplink::ctl
