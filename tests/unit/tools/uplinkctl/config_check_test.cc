#include "tools/uplinkctl/doctor/config_check.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::ctl {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr const char* kFile = "/etc/uplinkd/uplinkd.toml";

Finding FindingOf(const config::Problem& problem) {
  config::LoadResult result;
  result.problems.push_back(problem);
  const Findings findings = ConfigFindings(result, kFile, "uplinkd");
  EXPECT_EQ(findings.size(), 1U);
  return findings.front();
}

TEST(ConfigCheck, AGoodFileIsSaidToBe) {
  EXPECT_THAT(ConfigFindings({}, kFile, "uplinkd"),
              ElementsAre(Ok("configuration", "/etc/uplinkd/uplinkd.toml is good")));
}

TEST(ConfigCheck, AnUnknownKeyIsNamedWithItsLine) {
  const config::LoadResult read =
      config::ParseConfig("[limits]\nno_such_thing = 1\n", "a.toml", config::Environment());
  const Findings findings = ConfigFindings(read, kFile, "uplinkd");
  EXPECT_EQ(ToText(findings.front()),
            "error    limits.no_such_thing: a.toml:2: unknown key; delete it, or take one of "
            "docs/operate/configuration.md in /usr/share/doc/uplinkd");
  EXPECT_TRUE(KeysAtFault(read).contains("limits.no_such_thing"));
}

TEST(ConfigCheck, AnUnknownKeyThatIsLikeAnotherNamesThat) {
  const config::LoadResult read =
      config::ParseConfig("[limits]\nrobot_max = 1\n", "a.toml", config::Environment());
  EXPECT_EQ(ToText(ConfigFindings(read, kFile, "uplinkd").front()),
            "error    limits.robot_max: a.toml:2: unknown key; did you mean limits.robots_max? "
            "docs/operate/configuration.md in /usr/share/doc/uplinkd has all keys");
}

TEST(ConfigCheck, ATextWithoutARemedyGetsOne) {
  const config::LoadResult read =
      config::ParseConfig("[limits]\nrobots_max = \"many\"\n", "a.toml", config::Environment());
  EXPECT_THAT(ToText(ConfigFindings(read, kFile, "uplinkd").front()),
              HasSubstr("; correct it, then run this again"));
}

TEST(ConfigCheck, ARemedyIsGivenOnce) {
  EXPECT_EQ(FindingOf({"/a.key", "tls.key_file", "cannot be read: gone; make the file"}).remedy,
            "");
  EXPECT_EQ(
      ToText(FindingOf(
          {"/a.key", "tls.key_file", "cannot be read: Permission denied; let this user read it"})),
      "error    tls.key_file: /a.key: cannot be read: Permission denied; let the user uplinkd "
      "read it, and enter its folders (chgrp, chmod)");
}

TEST(ConfigCheck, AFileIsNamedOnce) {
  EXPECT_EQ(FindingOf({"/a.key", "tls.key_file", "/a.key: is empty"}).what, "/a.key: is empty");
  EXPECT_EQ(FindingOf({"/a.key", "tls.key_file", "it is empty"}).what, "/a.key: it is empty");
}

TEST(ConfigCheck, AReadableSecretIsAWarningWithItsCommand) {
  config::LoadResult result;
  result.notes.push_back(
      {{"/a.key", "tls.key_file", "everybody may read /a.key"}, "secret_readable"});
  const Findings findings = ConfigFindings(result, kFile, "uplinkd");
  EXPECT_EQ(findings.front(),
            Warning("tls.key_file", "everybody may read /a.key", "run chmod o-r /a.key"));
}

}  // namespace
}  // namespace uplink::ctl
