#include "server/config/reference.h"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <regex>

#include <gtest/gtest.h>

#include "server/config/settings.h"
#include "tests/unit/server/config/minimal.h"

namespace uplink::config {
namespace {

using ::uplink::config::testing::kMinimal;

std::string ReadFile(const std::string& path) {
  std::ifstream file(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

/// Leaves what the file should hold beside the test's other output, to copy from.
std::string WriteExpected(const std::string& name, const std::string& text) {
  const std::string path = ::testing::TempDir() + name;
  std::ofstream(path) << text;
  return "the settings table has changed: cp " + path + " over it";
}

// Tests start in the tree's top folder.
TEST(ReferenceTest, TheExampleFileIsThatOfTheSettingsTable) {
  const std::string expected = ExampleToml();
  EXPECT_TRUE(ReadFile("deploy/uplinkd.toml") == expected)
      << WriteExpected("uplinkd.toml", expected);
}

TEST(ReferenceTest, TheReferencePageHoldsTheTableOfTheSettings) {
  const std::string expected = SettingsTable();
  EXPECT_NE(ReadFile("docs/operate/configuration.md").find(expected), std::string::npos)
      << WriteExpected("settings_table.md", expected);
}

TEST(ReferenceTest, NeitherShowsSettingsThatHaveNoEffect) {
  for (const Setting& setting : Settings()) {
    const bool has_effect = setting.effect != Effect::kNone;
    EXPECT_EQ(SettingsTable().find("`" + FullKey(setting) + "`") != std::string::npos, has_effect)
        << FullKey(setting);
  }
  EXPECT_EQ(ExampleToml().find(":7444"), std::string::npos);
}

TEST(ReferenceTest, TheExampleFileReadsBackToTheDefaultsWhenUncommented) {
  const std::regex setting("(^|\n)# ([a-z0-9_.]+ = )");
  std::string text = std::regex_replace(ExampleToml(), setting, "$1$2");
  const std::regex file("\n(certificate|key|client_ca)_file = \"\"");
  text = std::regex_replace(text, file, "\n$1_file = \"x\"");
  const LoadResult result = ParseConfig(text, "example", {});
  for (const Problem& problem : result.problems) {
    ADD_FAILURE() << ToText(problem);
  }
  ASSERT_TRUE(result.ok());
  Config defaults;
  defaults.tls.certificate_file = defaults.tls.key_file = defaults.tls.client_ca_file = "x";
  EXPECT_EQ(PrintConfig(*result.config), PrintConfig(defaults));
}

}  // namespace
}  // namespace uplink::config
