#include "server/config/settings.h"

#include <set>

#include <gtest/gtest.h>

#include "server/config/load.h"
#include "server/config/value.h"

namespace uplink::config {
namespace {

TEST(SettingsTest, EveryKeyStandsOnceInAKnownSection) {
  std::set<std::string> keys;
  for (const Setting& setting : Settings()) {
    EXPECT_TRUE(keys.insert(FullKey(setting)).second) << FullKey(setting);
    bool known = false;
    for (const Section& section : Sections()) {
      known = known || section.name == setting.section;
    }
    EXPECT_TRUE(known) << FullKey(setting);
    EXPECT_FALSE(setting.text.empty()) << FullKey(setting);
  }
}

TEST(SettingsTest, EveryDefaultIsWithinItsOwnBounds) {
  const Config defaults;
  for (const Setting& setting : Settings()) {
    if (setting.secret || setting.kind == Kind::kList || setting.kind == Kind::kNetworks) {
      continue;  // shown masked; shown as TOML, read otherwise from the environment
    }
    std::string text = ValueText(setting, setting.get(defaults));
    if (text.front() == '"') {
      text = text.substr(1, text.size() - 2);
    }
    const Interpreted read = InterpretText(setting, text);
    ASSERT_TRUE(std::holds_alternative<Value>(read)) << FullKey(setting);
    EXPECT_EQ(std::get<Value>(read), setting.get(defaults)) << FullKey(setting);
  }
}

TEST(SettingsTest, EveryBoundIsTakenAndOnePastItIsNot) {
  for (const Setting& setting : Settings()) {
    if (setting.kind != Kind::kCount) {
      continue;
    }
    const auto taken = [&](std::uint64_t number) {
      return std::holds_alternative<Value>(
          InterpretInteger(setting, static_cast<std::int64_t>(number)));
    };
    EXPECT_TRUE(taken(setting.min)) << FullKey(setting);
    EXPECT_TRUE(taken(setting.max)) << FullKey(setting);
    EXPECT_FALSE(taken(setting.max + 1)) << FullKey(setting);
    EXPECT_EQ(taken(setting.min - 1), setting.min == 1 && !setting.zero.empty())
        << FullKey(setting);
  }
}

TEST(SettingsTest, EachMemberIsBoundToItsOwnKey) {
  // Setting one key changes that key's value and no other's.
  for (const Setting& changed : Settings()) {
    Config config;
    Value value = changed.get(config);
    if (auto* on = std::get_if<bool>(&value)) {
      *on = !*on;
    } else if (auto* number = std::get_if<std::uint64_t>(&value)) {
      ++*number;
    } else if (auto* duration = std::get_if<std::chrono::milliseconds>(&value)) {
      ++*duration;
    } else if (auto* text = std::get_if<std::string>(&value)) {
      *text += "x";
    } else if (auto* choice = std::get_if<Choice>(&value)) {
      choice->index = choice->index == 0 ? 1 : 0;
    } else if (auto* list = std::get_if<std::vector<std::string>>(&value)) {
      list->emplace_back("x");
    } else if (auto* networks = std::get_if<std::vector<Network>>(&value)) {
      networks->push_back(*Network::Parse("::1"));
    } else {
      ++std::get<ListenAddress>(value).port;
    }
    changed.set(config, value);
    const Config defaults;
    for (const Setting& other : Settings()) {
      EXPECT_EQ(other.get(config) == other.get(defaults), &other != &changed)
          << FullKey(changed) << " and " << FullKey(other);
    }
  }
}

TEST(SettingsTest, AnAddressIsEmptyOnlyWhereThatMeansSomething) {
  const Setting* const metrics = FindSetting("listen", "metrics");
  const Setting* const http = FindSetting("listen", "http");
  ASSERT_TRUE(metrics != nullptr && http != nullptr);
  const Interpreted none = InterpretText(*metrics, "");
  ASSERT_TRUE(std::holds_alternative<Value>(none));
  EXPECT_EQ(std::get<Value>(none), Value(ListenAddress()));
  EXPECT_EQ(ValueText(*metrics, std::get<Value>(none)), "\"\"");
  EXPECT_NE(AllowedText(*metrics).find("or \"\": no such listener"), std::string::npos);
  EXPECT_TRUE(std::holds_alternative<BadValue>(InterpretText(*http, "")));
  for (const char* const bad : {" ", "9090", ":9090", "uplink.example:9090", "[::]", "::1:9090"}) {
    EXPECT_TRUE(std::holds_alternative<BadValue>(InterpretText(*metrics, bad))) << bad;
  }
}

TEST(SettingsTest, AListenerIsASocketOnlyWhereThatIsServed) {
  const Setting* const relay = FindSetting("listen", "relay");
  const Setting* const http = FindSetting("listen", "http");
  ASSERT_TRUE(relay != nullptr && http != nullptr);
  const Interpreted socket = InterpretText(*http, "unix:/run/uplinkd/http.sock");
  ASSERT_TRUE(std::holds_alternative<Value>(socket));
  EXPECT_EQ(ValueText(*http, std::get<Value>(socket)), "\"unix:/run/uplinkd/http.sock\"");
  EXPECT_NE(AllowedText(*http).find("\"unix:\" and an absolute path"), std::string::npos);
  EXPECT_TRUE(std::holds_alternative<BadValue>(InterpretText(*relay, "unix:/run/r.sock")));
  EXPECT_EQ(AllowedText(*relay).find("unix"), std::string::npos);
}

TEST(SettingsTest, APasswordInAUrlIsMasked) {
  const Setting* const url = FindSetting("store", "url");
  ASSERT_NE(url, nullptr);
  EXPECT_EQ(ValueText(*url, Value(std::string("postgresql://me:pw@host/db"))),
            "\"postgresql://me:***@host/db\"");
  EXPECT_EQ(ValueText(*url, Value(std::string("sqlite:///a:b@c/d.db"))),
            "\"sqlite:///a:b@c/d.db\"");
}

TEST(SettingsTest, ASecretIsNotRepeatedInAProblem) {
  const Setting* const url = FindSetting("store", "url");
  ASSERT_NE(url, nullptr);
  const Interpreted read = InterpretText(*url, "pw\xff");
  ASSERT_TRUE(std::holds_alternative<BadValue>(read));
  EXPECT_EQ(std::get<BadValue>(read).text.find("pw"), std::string::npos);
}

TEST(SettingsTest, NamesTheEnvironmentVariable) {
  const Setting* const setting = FindSetting("limits", "robots_max");
  ASSERT_NE(setting, nullptr);
  EXPECT_EQ(EnvironmentName(*setting), "UPLINKD_LIMITS_ROBOTS_MAX");
}

}  // namespace
}  // namespace uplink::config
