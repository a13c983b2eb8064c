#include "server/config/broker_url.h"

#include <string>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace uplink::config {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

TEST(BrokerUrlTest, TakesSchemeHostAndPort) {
  EXPECT_EQ(*ParseBrokerUrl("mqtts://broker.example"), (BrokerUrl{true, "broker.example", 8883}));
  EXPECT_EQ(*ParseBrokerUrl("mqtt://broker.example/"), (BrokerUrl{false, "broker.example", 1883}));
  EXPECT_EQ(*ParseBrokerUrl("mqtts://10.0.0.1:1"), (BrokerUrl{true, "10.0.0.1", 1}));
  EXPECT_EQ(*ParseBrokerUrl("mqtts://[::1]:65535"), (BrokerUrl{true, "::1", 65'535}));
  EXPECT_EQ(*ParseBrokerUrl("mqtt://[fe80::1]"), (BrokerUrl{false, "fe80::1", 1883}));
  const std::string longest(kBrokerHostBytesMax, 'a');
  EXPECT_EQ(ParseBrokerUrl("mqtt://" + longest)->host, longest);
}

TEST(BrokerUrlTest, ShowsItselfAsItIsWritten) {
  for (const std::string text : {"mqtts://broker.example:8883", "mqtt://[::1]:1883"}) {
    EXPECT_EQ(ParseBrokerUrl(text)->Text(), text);
  }
}

TEST(BrokerUrlTest, SaysWhatIsWrong) {
  struct Case {
    std::string text;
    std::string says;
  };
  for (const Case& each : std::vector<Case>{
           {"", "neither mqtts:// nor mqtt://"},
           {"broker:1883", "neither mqtts:// nor mqtt://"},
           {"https://broker", "neither mqtts:// nor mqtt://"},
           {"MQTT://broker", "neither mqtts:// nor mqtt://"},
           {"mqtt://", "names no host"},
           {"mqtt://:1883", "names no host"},
           {"mqtt://a b", "characters that no name has"},
           {"mqtt://::1", "IPv6 address without"},
           {"mqtt://fe80::1", "IPv6 address without"},
           {"mqtt://[::1", "without its ]"},
           {"mqtt://[broker]", "no IPv6 address"},
           {"mqtt://[::1]1883", "something else than a port"},
           {"mqtt://broker:", "no port from 1 to 65535"},
           {"mqtt://broker:0", "no port from 1 to 65535"},
           {"mqtt://broker:65536", "no port from 1 to 65535"},
           {"mqtt://broker:-1", "no port from 1 to 65535"},
           {"mqtt://broker:18x", "no port from 1 to 65535"},
           {"mqtt://me:hunter2@broker", "mqtt.password_file"},
           {"mqtt://broker/path", "no path"},
           {"mqtt://broker?x=1", "no path"},
           {"mqtt://" + std::string(kBrokerHostBytesMax + 1, 'a'), "254 bytes, at most 253"},
       }) {
    const auto parsed = ParseBrokerUrl(each.text);
    ASSERT_FALSE(parsed.ok()) << each.text;
    EXPECT_THAT(std::string(parsed.status().message()), StartsWith("mqtt.url ")) << each.text;
    EXPECT_THAT(std::string(parsed.status().message()), HasSubstr(each.says)) << each.text;
    EXPECT_EQ(parsed.status().message().find("hunter2"), absl::string_view::npos);
  }
}

}  // namespace
}  // namespace uplink::config
