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
  contexts.by_name["yard-2"] = {"http://fleet.example.org/uplink"};
  ASSERT_TRUE(SaveContexts(contexts, path).ok());
  const auto read = LoadContexts(path);
  ASSERT_TRUE(read.ok()) << read.status();
  EXPECT_EQ(read->current, "hall");
  EXPECT_EQ(read->by_name.size(), 2U);
  EXPECT_EQ(read->by_name.at("yard-2").server, "http://fleet.example.org/uplink");
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
  const std::array<std::pair<const char*, const char*>, 7> files = {{
      {"current = ", "f:1"},
      {"current = \"hall\"", "current is hall, which is none"},
      {"token = \"x\"", "token: unknown key"},
      {"[contexts.hall]\nserver = \"http://a:1\"\ntoken = \"x\"",
       "contexts.hall.token: unknown key"},
      {"[contexts.hall]", "contexts.hall.server"},
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

TEST(ServerUrl, HasAnAddressAndPerhapsAPath) {
  EXPECT_EQ(ParseServerUrl("http://a:1", "x")->address, "a:1");
  EXPECT_EQ(ParseServerUrl("http://a", "x")->address, "a:80");
  EXPECT_EQ(ParseServerUrl("http://[::1]:7480/", "x")->address, "[::1]:7480");
  EXPECT_EQ(ParseServerUrl("http://a/fleet/", "x")->prefix, "/fleet");
  for (const char* wrong :
       {"", "a:1", "http://", "http://a:1/?x", "http://a:1/b c", "http://u@a", "ftp://a"}) {
    EXPECT_TRUE(absl::IsInvalidArgument(ParseServerUrl(wrong, "x").status())) << wrong;
  }
  EXPECT_THAT(std::string(ParseServerUrl("https://a", "x").status().message()), HasSubstr("ssh"));
}

class ServerChoiceTest : public ::testing::Test {
 protected:
  ServerChoiceTest() {
    sources_.contexts_file = folder_.File("contexts.toml");
    std::ofstream(sources_.contexts_file)
        << "current = \"hall\"\n[contexts.hall]\nserver = \"http://hall:1\"\n"
           "[contexts.yard]\nserver = \"http://yard:2\"\n";
  }

  [[nodiscard]] std::string Address(const ServerFlags& flags) const {
    const auto choice = ChooseServer(flags, sources_);
    return choice.ok() ? choice->url.address : std::string(choice.status().message());
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
