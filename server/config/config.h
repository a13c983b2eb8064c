#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/rcan/series.h"
#include "schema/limits.h"
#include "server/config/address.h"
#include "server/config/http_config.h"
#include "server/config/identity_config.h"
#include "server/config/networks.h"
#include "server/config/output_config.h"
#include "storage/postgres/defaults.h"
#include "storage/store_rules.h"

namespace uplink::config {

using std::chrono::milliseconds;

inline constexpr std::size_t kKiB = 1024;
inline constexpr std::size_t kMiB = 1024 * kKiB;

/// Lowest TLS version that the relay listener accepts.
enum class TlsVersion : std::uint8_t { k12, k13 };
/// The version of MQTT that the broker is spoken to in.
enum class MqttVersion : std::uint8_t { k5, k311 };
/// What is done with Cyberwave's depth frames and point clouds: not asked for, or counted.
enum class CyberwaveMedia : std::uint8_t { kOff, kCount };

// The member initialisers below are the defaults, and nothing else in code states them again. What
// the schema and the storage bound themselves is taken from there; the rooms of the server take
// theirs from here. settings.cc binds each member to its key, bounds and text.

/// Descriptors of listen.fleet: some 160 connections, and those that wait for their handshake.
inline constexpr std::size_t kFleetDescriptors = 256;

struct ListenConfig {
  ListenAddress relay{"::", 7443};
  /// Threads of the relay; 0: one per core.
  std::size_t relay_threads = 0;
  /// Load balancers whose connections begin with a PROXY header.
  std::vector<Network> proxy_protocol_from;
  /// Operators' gRPC; no address: there is none.
  ListenAddress fleet;
  ListenAddress http{"127.0.0.1", 7480};
  /// Probes and scrapes for other machines; no address: on `http` alone.
  ListenAddress metrics;
};

struct TlsConfig {
  /// PEM files; checked by ValidateFiles, read by the listeners.
  std::string certificate_file;
  std::string key_file;
  std::string client_ca_file;
  /// Empty: client_ca_file. OperatorCaFile says which counts.
  std::string operator_ca_file;
  /// Lists of revoked certificates by the authorities of client_ca_file; empty: none.
  std::string client_crl_file;
  /// The same by the authorities of operators' certificates.
  std::string operator_crl_file;
  TlsVersion min_version = TlsVersion::k13;
  /// Groups for agreeing on keys, the best first; with TLS 1.2 ServedGroups has more.
  std::vector<std::string> groups{"X25519", "P-256"};
};

struct StoreConfig {
  /// `sqlite:///absolute/path`, whose path SqlitePath reads, or `postgresql://...`.
  std::string url = "sqlite:///var/lib/uplinkd/uplinkd.db";
  /// Apply missing migrations at start; without it a store that needs one refuses the start. Where
  /// it is not set: true for SQLite, false for PostgreSQL.
  bool migrate = true;
  /// PostgreSQL: a file whose first line is the password; empty: as libpq finds one.
  std::string password_file;
  /// PostgreSQL: connections that write; a robot is always on the same.
  std::size_t shards = 2;
  /// Operators' queries that read the store side by side.
  std::size_t readers = storage::postgres::kReadersDefault;
  /// PostgreSQL: how long a call may take, and a connect.
  milliseconds timeout = storage::postgres::kCallTimeoutDefault;
  /// PostgreSQL: accept a server with fsync = off.
  bool accept_unsafe = false;
  /// What the store's disk is to have free; zero: store::FreeMinOf.
  std::size_t free_min = 0;
  /// How often the live states that changed are written; zero: never.
  milliseconds checkpoint = std::chrono::seconds(5);
  /// How long histories are kept, and quarantine; zero: for ever.
  milliseconds retain_history = storage::StoreRules().retain_history;
  milliseconds retain_quarantine = storage::StoreRules().retain_quarantine;
  milliseconds retain_connections = storage::StoreRules().retain_connections;
  milliseconds retain_audit = storage::StoreRules().retain_audit;
};

struct JournalConfig {
  /// Payload bytes that wait for a commit; past either bound streams are held back.
  std::size_t bytes_max = 256 * kMiB;
  std::size_t records_max = 1'000'000;
  /// Records of one transaction: where the rows per second of PostgreSQL and SQLite level off
  /// (measured).
  std::size_t batch_records_max = 1000;
  /// One robot may have this fraction of its journal's bytes and records: a 32nd.
  std::size_t robot_share = 32;
};

struct LimitsConfig {
  std::size_t payload_bytes_max = schema::JudgeLimits().payload_bytes_max;
  std::size_t message_bytes_max = schema::JudgeLimits().message_bytes_max;
  std::size_t extras_items_max = schema::JudgeLimits().extras_items_max;
  std::size_t batch_uplinks_max = 256;
  std::size_t in_flight_uplinks_max = 4096;
  std::size_t frame_bytes_max = 1 * kMiB;
  milliseconds ack_interval = std::chrono::seconds(1);
  std::size_t robots_max = 20'000;
  /// Streams of one connection of a gateway: one per robot.
  std::size_t gateway_streams_max = 256;
  /// Live state of all robots and twins; zero: run::LiveBytesMaxOf.
  std::size_t live_bytes_max = 0;
  milliseconds session_idle = std::chrono::hours(1);
  /// Zero: connections are never ended for their age.
  milliseconds connection_age_max = std::chrono::hours(24);
  /// What one robot may have stored per second, and at once after a pause; zero rates: as much as
  /// it sends.
  std::size_t durable_records_rate = 200;
  std::size_t durable_records_burst = 20'000;
  std::size_t durable_bytes_rate = 1 * kMiB;
  std::size_t durable_bytes_burst = 64 * kMiB;
};

struct FleetConfig {
  /// Zero: never.
  milliseconds forget_after = std::chrono::days(30);
};

/// Messages of one robot per second, and at once after a pause, by variant (validation rules:
/// rates). A zero rate: as many as come.
struct RatesConfig {
  std::size_t shape = 50;
  std::size_t shape_burst = 2'000;
  std::size_t object = 50;
  std::size_t object_burst = 2'000;
  std::size_t ui_capabilities = 1;
  std::size_t ui_capabilities_burst = 20;
  std::size_t current_settings = 1;
  std::size_t current_settings_burst = 20;
  std::size_t agent_info = 1;
  std::size_t agent_info_burst = 20;
  std::size_t system_health = 20;
  std::size_t system_health_burst = 200;
  std::size_t usage_telemetry = 20;
  std::size_t usage_telemetry_burst = 200;
  std::size_t consumable_status = 20;
  std::size_t consumable_status_burst = 200;
  std::size_t spatial_directive_status = 20;
  std::size_t spatial_directive_status_burst = 200;
  /// Motion, status, extras and RCAN Robot State together; what is over it is superseded.
  std::size_t telemetry = 1'000;
  std::size_t telemetry_burst = 1'000;
};

struct PresenceConfig {
  milliseconds timeout = std::chrono::seconds(10);
  milliseconds startup_grace = std::chrono::minutes(2);
  milliseconds adopted_grace = std::chrono::hours(1);
  /// How long a robot counts as parked at most.
  milliseconds parked_max = std::chrono::hours(12);
  /// So many changes between online and offline within flap_window flag a robot.
  std::size_t flap_changes = 6;
  milliseconds flap_window = std::chrono::minutes(5);
};

struct ForwardConfig {
  /// Life of an object that names no expiry, from its arrival; zero: for ever.
  milliseconds object_ttl = storage::StoreRules().object_ttl;
};

struct RcanConfig {
  std::string subsystem{metrics::rcan::kSubsystemDefault};
  std::size_t series_max = 600'000;
  milliseconds series_ttl = std::chrono::minutes(10);
  /// Series of one robot.
  std::size_t robot_series_max = 512;
  /// New names per robot and hour, past its first robot_series_max.
  std::size_t robot_new_names_max = 64;
  /// Names of series without `rcan_`; empty: all.
  std::vector<std::string> fields;
  /// Empty: all.
  std::vector<std::string> fleets;
  /// Keys of extras; empty: none.
  std::vector<std::string> extras;
  bool counts_as_life = true;
};

/// What the connections but the first have behind mqtt.client_id.
inline constexpr std::string_view kMqttLiveSuffix = "-live";
inline constexpr std::string_view kMqttMediaSuffix = "-media";
/// Bytes of `mqtt.client_id`: the longest of a client is 256, and that has a suffix.
inline constexpr std::size_t kMqttClientIdBytesMax = 256 - kMqttMediaSuffix.size();
/// Bytes of `mqtt.username`.
inline constexpr std::size_t kMqttUsernameBytesMax = 1024;
/// Bytes of the file with its password.
inline constexpr std::size_t kMqttPasswordBytesMax = 4096;
/// Topic prefixes of one server.
inline constexpr std::size_t kTopicPrefixesMax = 8;

struct MqttConfig {
  /// `mqtts://host[:port]` or `mqtt://host[:port]` (broker_url.h); empty: there is no broker.
  std::string url;
  std::string username;
  /// Empty: no password.
  std::string password_file;
  /// Empty: the system's authorities.
  std::string ca_file;
  /// PEM; both or none.
  std::string client_certificate_file;
  std::string client_key_file;
  MqttVersion version = MqttVersion::k5;
  std::string client_id = "uplinkd";
  milliseconds session_expiry = std::chrono::hours(24);
  milliseconds keepalive = std::chrono::seconds(60);
  /// Messages at QoS 1 that wait for their PUBACK.
  std::size_t unacked_max = 1024;
};

struct CyberwaveConfig {
  /// 1 to kTopicPrefixesMax, each a good one (schema/cyberwave/prefix.h), no two the same.
  std::vector<std::string> topic_prefixes{""};
  CyberwaveMedia media = CyberwaveMedia::kOff;
  /// As presence.timeout, of twins.
  milliseconds presence_timeout = std::chrono::seconds(20);
  std::vector<std::string> prismatic_joints;
  /// Twins, as robots: at most limits.robots_max, and that where it is not set and would be more.
  std::size_t robots_max = 10'000;
  /// The fleet of every twin.
  std::string fleet = "cyberwave";
};

struct UncrewConfig {
  /// AvatarService is served to drones.
  bool avatar = false;
  /// After so long a durable sample that is not committed is answered UNAVAILABLE.
  milliseconds answer_within = std::chrono::seconds(5);
  /// A type without a new sample for so long has no series.
  milliseconds stale_after = std::chrono::seconds(10);
  /// The RURI of a drone by its id (identity/uav_ruri.h).
  std::string ruri_template = "rcan://local.rcan/uncrew/uav/{uav_id}";
};

struct ViewConfig {
  /// A watch shows each robot at most once in this time.
  milliseconds watch_interval{200};
};

struct DrainConfig {
  /// How long the drain may take after the signal (run::kExitWait is added until the exit); what is
  /// unsettled then is counted in a warning.
  milliseconds timeout = std::chrono::seconds(20);
};

/// Everything an operator can set. LoadConfig has checked every bound, so that users of a Config
/// need not. A value; shared between threads as `shared_ptr<const Config>`.
struct Config {
  ListenConfig listen;
  TlsConfig tls;
  IdentityConfig identity;
  StoreConfig store;
  JournalConfig journal;
  FleetConfig fleet;
  LimitsConfig limits;
  RatesConfig rates;
  PresenceConfig presence;
  ForwardConfig forward;
  RcanConfig rcan;
  MqttConfig mqtt;
  CyberwaveConfig cyberwave;
  UncrewConfig uncrew;
  HttpConfig http;
  ViewConfig view;
  MetricsConfig metrics;
  LogConfig log;
  DrainConfig drain;
};

/// The authorities that operators' certificates are verified by.
[[nodiscard]] const std::string& OperatorCaFile(const TlsConfig& tls);
/// The copy of who may not come in; empty: none is kept, because the store is a file of this
/// machine.
[[nodiscard]] std::string SavedListPath(const Config& config);
/// The file that `store.url` names; empty if it is not `sqlite:///absolute/path`.
[[nodiscard]] std::string SqlitePath(const StoreConfig& store);
/// True if `store.url` names a PostgreSQL server, rightly or not.
[[nodiscard]] bool IsPostgres(const StoreConfig& store);

}  // namespace uplink::config
