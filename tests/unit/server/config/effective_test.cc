#include "server/config/effective.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/config/load.h"
#include "tests/unit/server/config/minimal.h"

namespace uplink::config {
namespace {

using ::testing::HasSubstr;
using ::testing::Not;

const EffectiveKey* Find(const std::vector<EffectiveKey>& keys, const std::string& name) {
  for (const EffectiveKey& key : keys) {
    if (FullKey(*key.setting) == name) return &key;
  }
  return nullptr;
}

TEST(EffectiveKeys, SayWhereEachWasSet) {
  const LoadResult result = testing::ParseWith("[limits]\nrobots_max = 7\nsession_idle = \"90s\"\n",
                                               {{"UPLINKD_LIMITS_ROBOTS_MAX", "9"}});
  ASSERT_TRUE(result.ok());
  const auto keys = EffectiveKeys(*result.config, result.places);
  ASSERT_NE(Find(keys, "limits.robots_max"), nullptr);
  EXPECT_EQ(Find(keys, "limits.robots_max")->value, "9");
  EXPECT_EQ(Find(keys, "limits.robots_max")->place, kEnvironment);
  EXPECT_EQ(Find(keys, "limits.session_idle")->value, "\"90s\"");
  EXPECT_THAT(Find(keys, "limits.session_idle")->place, HasSubstr("u.toml:"));
  EXPECT_EQ(Find(keys, "presence.timeout")->place, "");
}

TEST(EffectiveKeys, MaskThePasswordsOfUrls) {
  Config config;
  config.store.url = "postgresql://user:geheim@db/x";
  config.mqtt.url = "mqtts://user:geheim@broker";
  for (const EffectiveKey& key : EffectiveKeys(config, {})) {
    EXPECT_THAT(key.value, Not(HasSubstr("geheim"))) << FullKey(*key.setting);
  }
}

TEST(EffectiveKeys, MaskWhatMayBeAPasswordWhereAStartRefusesIt) {
  for (const char* url :
       {"postgresql://u@h/d?password=geheim", "postgresql://u@h/d?sslPassword=geheim",
        "postgresql://u@h/d?pass%77ord=geheim", "host=h user=u password=geheim"}) {
    Config config;
    config.store.url = url;
    for (const EffectiveKey& key : EffectiveKeys(config, {})) {
      EXPECT_THAT(key.value, Not(HasSubstr("geheim"))) << url;
    }
  }
  Config config;
  config.store.url = "postgresql://u@h/d?sslmode=verify-full";
  EXPECT_EQ(Find(EffectiveKeys(config, {}), "store.url")->value,
            "\"postgresql://u@h/d?sslmode=verify-full\"");
}

TEST(InEffect, TakesOverOnlyWhatAReloadMayChange) {
  InEffect in_effect("u.toml", {}, {{"log.level", "u.toml:1"}, {"presence.timeout", "u.toml:2"}});
  EXPECT_EQ(in_effect.file(), "u.toml");
  Config read;
  read.log.level = LogLevel::kDebug;
  read.limits.robots_max = 3;
  in_effect.TakeOver(read, {{"rates.object", "u.toml:9"}});
  const auto keys = in_effect.Keys();
  EXPECT_EQ(Find(keys, "log.level")->value, "\"debug\"");
  EXPECT_EQ(Find(keys, "log.level")->place, "") << "the file names it no more";
  EXPECT_EQ(Find(keys, "rates.object")->place, "u.toml:9");
  EXPECT_EQ(Find(keys, "presence.timeout")->place, "u.toml:2");
  EXPECT_EQ(Find(keys, "limits.robots_max")->value, "20000");
}

}  // namespace
}  // namespace uplink::config
