#include "server/run/from_config.h"

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <string_view>

#include "schema/base/check.h"
#include "schema/cyberwave/limits.h"
#include "server/config/address.h"
#include "server/config/broker_url.h"
#include "server/mqtt/limits.h"
#include "storage/deliveries.h"
#include "storage/topic_leases.h"

namespace uplink::run {
namespace {

// What the configuration takes, a client takes.
static_assert(config::kMqttClientIdBytesMax + config::kMqttMediaSuffix.size() <=
              mqtt::kClientIdBytesMax);
static_assert(config::kMqttLiveSuffix.size() <= config::kMqttMediaSuffix.size());
static_assert(config::kMqttUsernameBytesMax <= mqtt::kUsernameBytesMax);
static_assert(config::kMqttPasswordBytesMax <= mqtt::kPasswordBytesMax);

// And the store remembers it.
static_assert(config::kMqttClientIdBytesMax <= storage::kClientIdBytesMax);
static_assert(config::kTopicPrefixesMax <= storage::kLeasePrefixesMax);

/// Streams of listen.fleet at once: watches, and those of health and reflection.
constexpr std::size_t kFleetStreamsMax = 2'048;
/// How long a certificate that was shown once counts, though its authority may be gone meanwhile.
constexpr std::chrono::minutes kFleetConnectionAgeMax{15};
/// The part of the process's memory that its incomplete requests may take four times over.
constexpr std::size_t kFleetMemoryPart = 16;

std::string_view SuffixOf(cyberwave::Connection connection) {
  switch (connection) {
    case cyberwave::Connection::kDurable:
      return "";
    case cyberwave::Connection::kLive:
      return config::kMqttLiveSuffix;
    case cyberwave::Connection::kMedia:
      return config::kMqttMediaSuffix;
  }
  CheckFailed(__FILE__, __LINE__, "connection", "a connection of unknown kind");
}

mqtt::Version VersionOf(config::MqttVersion version) {
  switch (version) {
    case config::MqttVersion::k5:
      return mqtt::Version::k5;
    case config::MqttVersion::k311:
      return mqtt::Version::k311;
  }
  CheckFailed(__FILE__, __LINE__, "version", "an unknown version of MQTT");
}

}  // namespace

journal::JournalLimits JournalLimitsOf(const config::JournalConfig& journal) {
  journal::JournalLimits limits;
  limits.bytes_max = journal.bytes_max;
  limits.records_max = journal.records_max;
  limits.batch_records_max = journal.batch_records_max;
  limits.robot_share = journal.robot_share;
  return limits;
}

robot::PresenceLimits PresenceLimitsOf(const config::PresenceConfig& presence) {
  return {.timeout = presence.timeout,
          .startup_grace = presence.startup_grace,
          .parked_max = presence.parked_max,
          .flaps = {.changes = presence.flap_changes, .window = presence.flap_window}};
}

robot::PresenceLimits TwinPresenceLimitsOf(const config::Config& config) {
  robot::PresenceLimits limits = PresenceLimitsOf(config.presence);
  limits.timeout = config.cyberwave.presence_timeout;
  return limits;
}

schema::JudgeLimits JudgeLimitsOf(const config::LimitsConfig& limits) {
  return {.payload_bytes_max = limits.payload_bytes_max,
          .message_bytes_max = limits.message_bytes_max,
          .extras_items_max = limits.extras_items_max};
}

fleet::EntryRules EntryRulesOf(const config::IdentityConfig& identity) {
  return {.only_registered = identity.registration == config::Registration::kClosed,
          .only_named = identity.gateways == config::Gateways::kNamed,
          .fleets_stay = identity.fleet_moves == config::FleetMoves::kRefuse};
}

ingest::Allowance AllowanceOf(const config::Config& config) {
  const config::LimitsConfig& limits = config.limits;
  const config::RatesConfig& rates = config.rates;
  ingest::Allowance allowance{
      .flow = {.records = {limits.durable_records_rate, limits.durable_records_burst},
               .bytes = {limits.durable_bytes_rate, limits.durable_bytes_burst}},
      .telemetry = {rates.telemetry, rates.telemetry_burst}};
  const auto set = [&allowance](model::Variant variant, std::size_t rate, std::size_t burst) {
    allowance.rates[static_cast<std::size_t>(variant)] = {rate, burst};
  };
  using enum model::Variant;
  set(kShape, rates.shape, rates.shape_burst);
  set(kObject, rates.object, rates.object_burst);
  set(kUiCapabilities, rates.ui_capabilities, rates.ui_capabilities_burst);
  set(kCurrentSettings, rates.current_settings, rates.current_settings_burst);
  set(kAgentInfo, rates.agent_info, rates.agent_info_burst);
  set(kSystemHealth, rates.system_health, rates.system_health_burst);
  set(kUsageTelemetry, rates.usage_telemetry, rates.usage_telemetry_burst);
  set(kConsumableStatus, rates.consumable_status, rates.consumable_status_burst);
  set(kSpatialDirectiveStatus, rates.spatial_directive_status,
      rates.spatial_directive_status_burst);
  return allowance;
}

session::SessionLimits SessionLimitsOf(const config::Config& config, const std::string& version) {
  // The configuration's bounds keep each of these far below 2^32.
  const config::LimitsConfig& limits = config.limits;
  return {.payload_bytes_max = static_cast<std::uint32_t>(limits.payload_bytes_max),
          .message_bytes_max = static_cast<std::uint32_t>(limits.message_bytes_max),
          .batch_uplinks_max = static_cast<std::uint32_t>(limits.batch_uplinks_max),
          .extras_items_max = static_cast<std::uint32_t>(limits.extras_items_max),
          .in_flight_uplinks_max = static_cast<std::uint32_t>(limits.in_flight_uplinks_max),
          .frame_bytes_max = static_cast<std::uint32_t>(limits.frame_bytes_max),
          .rcan_counts_as_life = config.rcan.counts_as_life,
          .ack_interval = limits.ack_interval,
          .session_idle = limits.session_idle,
          .drain_timeout = config.drain.timeout,
          .server_version = version};
}

std::size_t LiveBytesMaxOf(const config::LimitsConfig& limits, std::size_t memory_max) {
  constexpr std::size_t kMost = 1024 * config::kMiB;
  if (limits.live_bytes_max > 0) return limits.live_bytes_max;
  return memory_max == 0 ? kMost : std::min(kMost, memory_max / 4);
}

http::ConnectionsMax HttpConnectionsMaxOf(const config::Config& config) {
  const bool has_metrics = config::IsSet(config.listen.metrics);
  return {config.http.connections_max, has_metrics ? http::kMetricsLimits.connections_max : 0};
}

transport::RelayOptions RelayOptionsOf(const config::Config& config, std::size_t memory_max) {
  transport::RelayOptions options;
  options.address = config.listen.relay;
  options.key_material = transport::PemFiles{.certificate = config.tls.certificate_file,
                                             .key = config.tls.key_file,
                                             .client_ca = config.tls.client_ca_file,
                                             .authorities = config.identity.authorities};
  options.tls = {.minimum = config.tls.min_version, .groups = config::ServedGroups(config.tls)};
  options.queues = config.listen.relay_threads;
  options.proxy_protocol_from = config.listen.proxy_protocol_from;
  const http::ConnectionsMax http = HttpConnectionsMaxOf(config);
  options.descriptors_reserved =
      transport::DescriptorsReserved(std::accumulate(http.begin(), http.end(), std::size_t{0})) +
      (config::IsSet(config.listen.fleet) ? config::kFleetDescriptors : 0);
  options.streams_max = transport::kStreamsPerRobot * config.limits.robots_max;
  options.gateway_streams_max = config.limits.gateway_streams_max;
  options.connection_age_max = config.limits.connection_age_max;
  options.memory_bytes_max = memory_max / 2;
  return options;
}

transport::RelayOptions FleetOptionsOf(const config::Config& config, std::size_t memory_max) {
  transport::RelayOptions options;
  options.address = config.listen.fleet;
  options.key_material = transport::PemFiles{
      .certificate = config.tls.certificate_file,
      .key = config.tls.key_file,
      .client_ca = config::OperatorCaFile(config.tls),
      .authorities = config.identity.authorities,
      // Operators' own authorities stand alone; one that has an entry may do no more than that.
      .entries_alone = !config.tls.operator_ca_file.empty()};
  options.tls = {.minimum = config.tls.min_version,
                 .groups = config::ServedGroups(config.tls),
                 .certificate_required = false};
  // Answers are made elsewhere; one thread carries them.
  options.queues = 1;
  options.name = "fleet";
  options.serves_relay = false;
  options.descriptors_max = config::kFleetDescriptors;
  options.streams_max = kFleetStreamsMax;
  options.connection_age_max = kFleetConnectionAgeMax;
  options.memory_bytes_max = memory_max / kFleetMemoryPart;
  return options;
}

mqtt::ClientSettings ClientSettingsOf(const config::Config& config,
                                      cyberwave::Connection connection) {
  using std::chrono::duration_cast;
  using std::chrono::seconds;
  const config::MqttConfig& mqtt = config.mqtt;
  const auto url = config::ParseBrokerUrl(mqtt.url);
  UPLINK_CHECK(url.ok(), "the configuration was judged before");
  mqtt::ClientSettings settings;
  settings.url = *url;
  settings.version = VersionOf(mqtt.version);
  settings.client_id = mqtt.client_id;
  settings.client_id += SuffixOf(connection);
  settings.username = mqtt.username;
  settings.password_file = mqtt.password_file;
  settings.ca_file = mqtt.ca_file;
  settings.certificate_file = mqtt.client_certificate_file;
  settings.key_file = mqtt.client_key_file;
  settings.kept_session = connection == cyberwave::Connection::kDurable;
  settings.session_expiry = duration_cast<seconds>(mqtt.session_expiry);
  const seconds quarter =
      std::max(duration_cast<seconds>(config.cyberwave.presence_timeout / 4), mqtt::kKeepaliveMin);
  settings.keepalive = std::min(duration_cast<seconds>(mqtt.keepalive), quarter);
  settings.waits.ping = std::min(settings.waits.ping, milliseconds(quarter));
  settings.unacked_max = mqtt.unacked_max;
  settings.payload_bytes_max = cyberwave::kMessageBytesMax;
  return settings;
}

cyberwave::JudgeTerms JudgeTermsOf(const config::CyberwaveConfig& cyberwave) {
  return {
      .prefixes = cyberwave.topic_prefixes,
      .prismatic_joints = {cyberwave.prismatic_joints.begin(), cyberwave.prismatic_joints.end()}};
}

log::Level LogLevelOf(config::LogLevel level) {
  switch (level) {
    case config::LogLevel::kDebug:
      return log::Level::kDebug;
    case config::LogLevel::kInfo:
      return log::Level::kInfo;
    case config::LogLevel::kWarn:
      return log::Level::kWarn;
    case config::LogLevel::kError:
      return log::Level::kError;
  }
  return log::Level::kInfo;
}

log::Format LogFormatOf(config::LogFormat format) {
  switch (format) {
    case config::LogFormat::kText:
      return log::Format::kText;
    case config::LogFormat::kJson:
      return log::Format::kJson;
  }
  return log::Format::kText;
}

}  // namespace uplink::run
