#include "server/run/from_config.h"

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/broker/limits.h"
#include "server/config/settings.h"
#include "server/transport/descriptors.h"

namespace uplink::run {
namespace {

using ::testing::Pair;

TEST(FromConfig, EverySettingOfASessionReachesIt) {
  config::Config config;
  config.limits.payload_bytes_max = 101;
  config.limits.message_bytes_max = 102;
  config.limits.batch_uplinks_max = 103;
  config.limits.extras_items_max = 104;
  config.limits.in_flight_uplinks_max = 105;
  config.limits.frame_bytes_max = 106;
  config.limits.ack_interval = milliseconds(107);
  config.limits.session_idle = milliseconds(108);
  config.drain.timeout = milliseconds(109);
  const session::SessionLimits session = SessionLimitsOf(config, "1.2.3");
  EXPECT_EQ(session.payload_bytes_max, 101U);
  EXPECT_EQ(session.message_bytes_max, 102U);
  EXPECT_EQ(session.batch_uplinks_max, 103U);
  EXPECT_EQ(session.extras_items_max, 104U);
  EXPECT_EQ(session.in_flight_uplinks_max, 105U);
  EXPECT_EQ(session.frame_bytes_max, 106U);
  EXPECT_EQ(session.ack_interval, milliseconds(107));
  EXPECT_EQ(session.session_idle, milliseconds(108));
  EXPECT_EQ(session.drain_timeout, milliseconds(109));
  EXPECT_EQ(session.server_version, "1.2.3");
  const schema::JudgeLimits judge = JudgeLimitsOf(config.limits);
  EXPECT_EQ(judge.payload_bytes_max, 101U);
  EXPECT_EQ(judge.message_bytes_max, 102U);
  EXPECT_EQ(judge.extras_items_max, 104U);
}

TEST(FromConfig, JournalAndPresenceGetTheirs) {
  config::JournalConfig journal;
  journal.bytes_max = 1;
  journal.records_max = 2;
  journal.batch_records_max = 3;
  journal.robot_share = 4;
  EXPECT_EQ(JournalLimitsOf(journal).bytes_max, 1U);
  EXPECT_EQ(JournalLimitsOf(journal).records_max, 2U);
  EXPECT_EQ(JournalLimitsOf(journal).batch_records_max, 3U);
  EXPECT_EQ(JournalLimitsOf(journal).robot_share, 4U);
  config::PresenceConfig presence;
  presence.timeout = milliseconds(4);
  presence.startup_grace = milliseconds(5);
  EXPECT_EQ(PresenceLimitsOf(presence).timeout, milliseconds(4));
  EXPECT_EQ(PresenceLimitsOf(presence).startup_grace, milliseconds(5));
  config::Config config;
  config.presence = presence;
  config.cyberwave.presence_timeout = milliseconds(6);
  EXPECT_EQ(TwinPresenceLimitsOf(config).timeout, milliseconds(6));
  EXPECT_EQ(TwinPresenceLimitsOf(config).startup_grace, milliseconds(5));
}

config::Config WithBroker() {
  config::Config config;
  config::MqttConfig& mqtt = config.mqtt;
  mqtt.url = "mqtts://broker.example.org";
  mqtt.username = "user";
  mqtt.password_file = "password";
  mqtt.ca_file = "ca.crt";
  mqtt.client_certificate_file = "c.crt";
  mqtt.client_key_file = "c.key";
  mqtt.version = config::MqttVersion::k311;
  mqtt.client_id = "core";
  mqtt.session_expiry = std::chrono::hours(2);
  mqtt.keepalive = milliseconds(7'999);
  mqtt.unacked_max = 8;
  config.cyberwave.presence_timeout = std::chrono::minutes(2);
  return config;
}

TEST(FromConfig, EverySettingOfABrokerReachesItsClients) {
  using enum cyberwave::Connection;
  for (const cyberwave::Connection connection : {kDurable, kLive, kMedia}) {
    const mqtt::ClientSettings client = ClientSettingsOf(WithBroker(), connection);
    EXPECT_EQ(client.url, (mqtt::Url{true, "broker.example.org", 8883}));
    EXPECT_EQ(client.username, "user");
    EXPECT_EQ(client.password_file, "password");
    EXPECT_EQ(client.ca_file, "ca.crt");
    EXPECT_EQ(client.certificate_file, "c.crt");
    EXPECT_EQ(client.key_file, "c.key");
    EXPECT_EQ(client.version, mqtt::Version::k311);
    EXPECT_EQ(client.session_expiry, std::chrono::hours(2));
    EXPECT_EQ(client.keepalive, std::chrono::seconds(7));
    EXPECT_EQ(client.waits.ping, mqtt::Waits().ping);
    EXPECT_EQ(client.unacked_max, 8U);
    EXPECT_EQ(client.payload_bytes_max, 65'536U);
    EXPECT_EQ(client.announced_packet_bytes_max, 0U) << "a broker drops what is larger unseen";
    EXPECT_FALSE(client.expect_session);
  }
  EXPECT_EQ(ClientSettingsOf(WithBroker(), kDurable).client_id, "core");
  EXPECT_EQ(ClientSettingsOf(WithBroker(), kLive).client_id, "core-live");
  EXPECT_EQ(ClientSettingsOf(WithBroker(), kMedia).client_id, "core-media");
  EXPECT_TRUE(ClientSettingsOf(WithBroker(), kDurable).kept_session);
  EXPECT_FALSE(ClientSettingsOf(WithBroker(), kLive).kept_session);
  EXPECT_FALSE(ClientSettingsOf(WithBroker(), kMedia).kept_session);
}

TEST(FromConfig, ABrokerThatSaysNothingIsFoundOutBeforeATwinWouldBe) {
  config::Config config = WithBroker();
  config.mqtt.keepalive = std::chrono::seconds(60);
  const auto pings = [&config](milliseconds timeout) {
    config.cyberwave.presence_timeout = timeout;
    const mqtt::ClientSettings client = ClientSettingsOf(config, cyberwave::Connection::kLive);
    return std::pair<milliseconds, milliseconds>(client.keepalive, client.waits.ping);
  };
  EXPECT_THAT(pings(std::chrono::seconds(5)), Pair(milliseconds(1'000), milliseconds(1'000)));
  EXPECT_THAT(pings(milliseconds(7'999)), Pair(milliseconds(1'000), milliseconds(1'000)));
  EXPECT_THAT(pings(std::chrono::seconds(20)), Pair(milliseconds(5'000), milliseconds(5'000)));
  EXPECT_THAT(pings(std::chrono::hours(1)), Pair(std::chrono::minutes(1), mqtt::Waits().ping));
}

TEST(FromConfig, NoTimeoutOfATwinIsTooShortToFindOutThatWeDoNotHear) {
  const auto setting = std::ranges::find_if(config::Settings(), [](const config::Setting& each) {
    return config::FullKey(each) == "cyberwave.presence_timeout";
  });
  ASSERT_NE(setting, config::Settings().end());
  const milliseconds least(static_cast<std::int64_t>(setting->min));
  config::Config config = WithBroker();
  config.cyberwave.presence_timeout = least;
  const mqtt::ClientSettings client = ClientSettingsOf(config, cyberwave::Connection::kDurable);
  // A ping and its answer, and a sweep of each of the two who look every second.
  const milliseconds looks = std::chrono::seconds(2);
  EXPECT_LE(client.keepalive + client.waits.ping + looks, least);
  EXPECT_LE(broker::kTickLate + std::chrono::seconds(1), least);
}

// Only keys of the configuration: no value that it allows makes a start fail.
TEST(FromConfig, AClientCanWorkByEachBoundOfItsSettings) {
  for (const config::Setting& setting : config::Settings()) {
    if (setting.section != "mqtt" && setting.section != "cyberwave") continue;
    for (const std::uint64_t bound : {setting.min, setting.max}) {
      config::Config config = WithBroker();
      config.mqtt.client_id.assign(config::kMqttClientIdBytesMax, 'c');
      config.mqtt.username.assign(config::kMqttUsernameBytesMax, 'u');
      if (setting.kind == config::Kind::kCount) setting.set(config, bound);
      if (setting.kind == config::Kind::kDuration) {
        setting.set(config, milliseconds(static_cast<std::int64_t>(bound)));
      }
      for (const auto connection :
           {cyberwave::Connection::kDurable, cyberwave::Connection::kMedia}) {
        const absl::Status good = mqtt::CheckSettings(ClientSettingsOf(config, connection));
        EXPECT_TRUE(good.ok()) << config::FullKey(setting) << ": " << good;
      }
    }
  }
  config::Config plain;
  plain.mqtt.url = "mqtt://b";
  EXPECT_EQ(ClientSettingsOf(plain, cyberwave::Connection::kLive).version, mqtt::Version::k5);
}

TEST(FromConfig, MessagesOfTwinsAreJudgedByPrefixesAndJointsThatSlide) {
  config::CyberwaveConfig cyberwave;
  cyberwave.topic_prefixes = {"", "site/"};
  cyberwave.prismatic_joints = {"lift", "gripper"};
  const cyberwave::JudgeTerms terms = JudgeTermsOf(cyberwave);
  EXPECT_EQ(terms.prefixes, (std::vector<std::string>{"", "site/"}));
  EXPECT_EQ(terms.prismatic_joints, (cyberwave::Names{"gripper", "lift"}));
}

TEST(FromConfig, EveryRateReachesItsVariant) {
  config::Config config;
  config.limits.durable_records_rate = 1;
  config.limits.durable_records_burst = 2;
  config.limits.durable_bytes_rate = 3;
  config.limits.durable_bytes_burst = 4;
  config::RatesConfig& rates = config.rates;
  rates.telemetry = 5;
  rates.telemetry_burst = 6;
  using enum model::Variant;
  const std::vector<std::tuple<model::Variant, std::size_t*, std::size_t*>> all = {
      {kShape, &rates.shape, &rates.shape_burst},
      {kObject, &rates.object, &rates.object_burst},
      {kUiCapabilities, &rates.ui_capabilities, &rates.ui_capabilities_burst},
      {kCurrentSettings, &rates.current_settings, &rates.current_settings_burst},
      {kAgentInfo, &rates.agent_info, &rates.agent_info_burst},
      {kSystemHealth, &rates.system_health, &rates.system_health_burst},
      {kUsageTelemetry, &rates.usage_telemetry, &rates.usage_telemetry_burst},
      {kConsumableStatus, &rates.consumable_status, &rates.consumable_status_burst},
      {kSpatialDirectiveStatus, &rates.spatial_directive_status,
       &rates.spatial_directive_status_burst}};
  std::size_t number = 10;
  for (const auto& [variant, rate, burst] : all) {
    *rate = number++;
    *burst = number++;
  }
  const ingest::Allowance allowance = AllowanceOf(config);
  EXPECT_EQ(allowance.flow.records, (limits::BucketSize{1, 2}));
  EXPECT_EQ(allowance.flow.bytes, (limits::BucketSize{3, 4}));
  EXPECT_EQ(allowance.telemetry, (limits::BucketSize{5, 6}));
  std::size_t limited = 0;
  for (const limits::BucketSize& size : allowance.rates) limited += size.rate > 0 ? 1 : 0;
  EXPECT_EQ(limited, all.size()) << "no other variant has a rate";
  number = 10;
  for (const auto& [variant, rate, burst] : all) {
    const auto& size = allowance.rates[static_cast<std::size_t>(variant)];
    EXPECT_EQ(size, (limits::BucketSize{number, number + 1})) << model::ToText(variant);
    number += 2;
  }
}

TEST(FromConfig, LiveStateGetsAQuarterOfTheMemoryAndAGibibyteAtMost) {
  config::LimitsConfig limits;
  const std::size_t gib = 1024 * config::kMiB;
  EXPECT_EQ(LiveBytesMaxOf(limits, 512 * config::kMiB), 128 * config::kMiB);
  EXPECT_EQ(LiveBytesMaxOf(limits, 4 * gib), gib);
  EXPECT_EQ(LiveBytesMaxOf(limits, 64 * gib), gib);
  EXPECT_EQ(LiveBytesMaxOf(limits, 0), gib) << "the memory is not known";
  limits.live_bytes_max = 3 * gib;
  EXPECT_EQ(LiveBytesMaxOf(limits, 4 * gib), 3 * gib);
}

TEST(FromConfig, TheListenerOfMetricsHasConnectionsOfItsOwn) {
  config::Config config;
  config.http.connections_max = 1000;
  EXPECT_EQ(HttpConnectionsMaxOf(config), (http::ConnectionsMax{1000, 0}));
  config.listen.metrics = {"::", 9090};
  EXPECT_EQ(HttpConnectionsMaxOf(config), (http::ConnectionsMax{1000, 32}));
  EXPECT_EQ(RelayOptionsOf(config, 1000).descriptors_reserved, 1160U);
}

// The same numbers as doctor's (DescriptorsCheck.TheNeedIsThatOfThePage).
TEST(FromConfig, TheRelayWantsTheDescriptorsOfThePage) {
  config::Config config;
  EXPECT_EQ(transport::DescriptorsWanted(RelayOptionsOf(config, 0)), 46'144U);
  config.listen.proxy_protocol_from = {*config::Network::Parse("10.0.0.0/8")};
  config.http.connections_max += 100;
  EXPECT_EQ(transport::DescriptorsWanted(RelayOptionsOf(config, 0)), 47'268U);
  config.listen.metrics = {"0.0.0.0", 9464};
  EXPECT_EQ(transport::DescriptorsWanted(RelayOptionsOf(config, 0)), 47'300U);
}

TEST(FromConfig, TheListenerForOperatorsAsksForNoCertificateAndHasItsOwnPartOfTheDescriptors) {
  config::Config config;
  config.listen.fleet = {"127.0.0.1", 7444};
  config.tls.client_ca_file = "robots.crt";
  const std::size_t alone = RelayOptionsOf(config::Config(), 0).descriptors_reserved;
  EXPECT_EQ(RelayOptionsOf(config, 0).descriptors_reserved, alone + config::kFleetDescriptors);
  config.identity.authorities = "authorities";
  EXPECT_FALSE(std::get<transport::PemFiles>(FleetOptionsOf(config, 0).key_material).entries_alone);
  config.tls.operator_ca_file = "operators.crt";
  const transport::RelayOptions options = FleetOptionsOf(config, 0);
  EXPECT_EQ(options.address.port, 7444);
  EXPECT_FALSE(options.tls.certificate_required);
  EXPECT_FALSE(options.serves_relay);
  EXPECT_EQ(options.descriptors_max, config::kFleetDescriptors);
  const auto& files = std::get<transport::PemFiles>(options.key_material);
  EXPECT_EQ(files.client_ca, "operators.crt");
  EXPECT_EQ(files.authorities, "authorities") << "an entry counts wherever the authority stands";
  EXPECT_TRUE(files.entries_alone);
  EXPECT_TRUE(RelayOptionsOf(config, 0).tls.certificate_required);
}

TEST(FromConfig, TheRelayGetsTwiceTheRobotsAndHalfTheMemory) {
  config::Config config;
  config.limits.robots_max = 10;
  config.listen.relay_threads = 3;
  config.http.connections_max = 1000;
  config.listen.proxy_protocol_from = {*config::Network::Parse("10.0.0.0/8")};
  config.limits.gateway_streams_max = 7;
  config.limits.connection_age_max = milliseconds(6);
  config.tls.certificate_file = "c";
  config.tls.key_file = "k";
  config.tls.client_ca_file = "a";
  const transport::RelayOptions options = RelayOptionsOf(config, 1000);
  EXPECT_EQ(options.streams_max, 20U);
  EXPECT_EQ(options.gateway_streams_max, 7U);
  EXPECT_EQ(options.descriptors_reserved, 1128U);
  EXPECT_EQ(options.memory_bytes_max, 500U);
  EXPECT_EQ(options.queues, 3U);
  EXPECT_EQ(options.proxy_protocol_from, config.listen.proxy_protocol_from);
  EXPECT_EQ(options.connection_age_max, milliseconds(6));
  EXPECT_EQ(options.address.port, config.listen.relay.port);
  const auto& files = std::get<transport::PemFiles>(options.key_material);
  EXPECT_EQ(files.certificate, "c");
  EXPECT_EQ(files.key, "k");
  EXPECT_EQ(files.client_ca, "a");
}

}  // namespace
}  // namespace uplink::run
