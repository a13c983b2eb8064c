#include "server/config/settings.h"

#include <array>
#include <type_traits>

namespace uplink::config {
namespace {

using std::string_view;

template <typename T>
Value ToValue(const T& member) {
  if constexpr (std::is_enum_v<T>) {
    return Choice{static_cast<std::size_t>(member)};
  } else if constexpr (std::is_same_v<T, std::size_t>) {
    return std::uint64_t{member};
  } else {
    return member;
  }
}

template <typename T>
void FromValue(const Value& value, T& member) {
  if constexpr (std::is_enum_v<T>) {
    member = static_cast<T>(std::get<Choice>(value).index);
  } else if constexpr (std::is_same_v<T, std::size_t>) {
    member = std::get<std::uint64_t>(value);
  } else {
    member = std::get<T>(value);
  }
}

template <auto kSection, auto kMember>
Value Get(const Config& config) {
  return ToValue((config.*kSection).*kMember);
}

template <auto kSection, auto kMember>
void Set(Config& config, const Value& value) {
  FromValue(value, (config.*kSection).*kMember);
}

// Binds a table row to its member: UPLINK_BIND(limits, LimitsConfig, robots_max).
#define UPLINK_BIND(section, type, member) \
  .get = Get<&Config::section, &type::member>, .set = Set<&Config::section, &type::member>

// A variant's two keys: its rate, and what may come at once.
#define UPLINK_RATE(name, variant)                                                                \
  {.section = "rates",                                                                            \
   .key = #name,                                                                                  \
   .kind = Kind::kCount,                                                                          \
   .min = 1,                                                                                      \
   .max = 1'000'000,                                                                              \
   .zero = "as many as come",                                                                     \
   .effect = Effect::kReload,                                                                     \
   .text = "Messages of " variant " that one robot may send per second.",                         \
   UPLINK_BIND(rates, RatesConfig, name)},                                                        \
  {                                                                                               \
    .section = "rates", .key = #name "_burst", .kind = Kind::kCount, .min = 1, .max = 10'000'000, \
    .effect = Effect::kReload,                                                                    \
    .text = "Messages of " variant " that one robot may send at once, after a pause.",            \
    UPLINK_BIND(rates, RatesConfig, name##_burst)                                                 \
  }

constexpr std::uint64_t kGiB = 1024 * kMiB;
constexpr std::uint64_t kSecond = 1000;
constexpr std::uint64_t kMinute = 60 * kSecond;
constexpr std::uint64_t kHour = 60 * kMinute;
constexpr std::uint64_t kDay = 24 * kHour;

/// Above the number of series that a robot has without a name of its own in the labels
/// (metrics/rcan/series.h): these always have room.
constexpr std::uint64_t kRobotSeriesMaxMin = 64;

constexpr std::array<string_view, 2> kTlsVersions = {"1.2", "1.3"};
constexpr std::array<string_view, 2> kRegistrations = {"open", "closed"};
constexpr std::array<string_view, 2> kGateways = {"any", "named"};
constexpr std::array<string_view, 2> kFleetMoves = {"follow", "refuse"};
constexpr std::array<string_view, 2> kMqttVersions = {"5", "3.1.1"};
constexpr std::array<string_view, 2> kCyberwaveMedia = {"off", "count"};
constexpr std::array<string_view, 2> kLogFormats = {"text", "json"};
constexpr std::array<string_view, 4> kLogLevels = {"debug", "info", "warn", "error"};

constexpr std::array<Section, 19> kSections = {{
    {"listen", "Where the server listens: literal addresses with a port; port 0 takes a free one."},
    {"tls", "PEM files of the relay listener. Relative paths start at the working directory."},
    {"identity", "Who may open a stream."},
    {"store", "Where durable records go."},
    {"journal", "The queue between sessions and the store. Past a bound, streams are held back."},
    {"fleet", "Which robots the server knows."},
    {"limits", "Bounds on what robots send and on what the server keeps of them."},
    {"rates",
     "How many messages of one robot are taken per second, by variant; what is over that "
     "is rejected as RATE_LIMITED, of telemetry superseded. Other variants have no such limit."},
    {"presence", "When a robot counts as online or offline."},
    {"forward", "What robots report for others: shapes and objects."},
    {"rcan", "RCAN Robot State and the robots' Prometheus series."},
    {"mqtt", "The broker of a fleet that speaks Cyberwave's MQTT topics."},
    {"cyberwave", "What is read from that broker, and what is made of it."},
    {"uncrew", "Drones that call AvatarService on listen.relay (Uncrew)."},
    {"http", "The listener of probes, metrics and JSON."},
    {"view", "How watches show robots."},
    {"metrics", "What /metrics shows of robots."},
    {"log", "Lines on standard error."},
    {"drain", "The way down after SIGTERM or SIGINT."},
}};

constexpr auto kSettings = std::to_array<Setting>({
    {.section = "listen",
     .key = "relay",
     .kind = Kind::kAddress,
     .text = "Robots: gRPC UplinkRelay, mutual TLS. [::] serves IPv4 and IPv6.",
     UPLINK_BIND(listen, ListenConfig, relay)},
    {.section = "listen",
     .key = "relay_threads",
     .kind = Kind::kCount,
     .min = 1,
     .max = 256,
     .zero = "one per core that the process may use",
     .text = "Threads of the relay; each stream stays on one. Measure before raising it.",
     UPLINK_BIND(listen, ListenConfig, relay_threads)},
    {.section = "listen",
     .key = "proxy_protocol_from",
     .kind = Kind::kNetworks,
     .text = "Load balancers before the relay whose connections begin with a PROXY protocol header "
             "of version 2: from them it is required, and the address that it names counts as the "
             "robot's; from others it is never read.",
     UPLINK_BIND(listen, ListenConfig, proxy_protocol_from)},
    {.section = "listen",
     .key = "fleet",
     .kind = Kind::kAddress,
     .empty = "no such listener",
     .text = "Operators: gRPC FleetView and FleetAdmin, reflection and health, always with TLS and "
             "the server's certificate. Callers show an operator's certificate, as "
             "tls.operator_ca_file signs, or a token of http.tokens_file in the metadata "
             "authorization.",
     UPLINK_BIND(listen, ListenConfig, fleet)},
    {.section = "listen",
     .key = "http",
     .kind = Kind::kAddress,
     .unix_socket = true,
     .text = "Probes, metrics and JSON. Other machines may reach it only where callers must show "
             "who they are: with http.tokens_file, or with http.tls and operators' certificates. "
             "Then all callers must, but those of the probes.",
     UPLINK_BIND(listen, ListenConfig, http)},
    {.section = "listen",
     .key = "metrics",
     .kind = Kind::kAddress,
     .empty = "no such listener",
     .text = "A further listener for probes and Prometheus on other machines: /livez, /readyz, "
             "/metrics and /metrics/robots alone, under any name, without TLS, and without "
             "authentication unless http.metrics_token_file is set. listen.http answers them all "
             "the same.",
     UPLINK_BIND(listen, ListenConfig, metrics)},

    {.section = "tls",
     .key = "certificate_file",
     .kind = Kind::kFile,
     .text = "The server's certificate chain, leaf first. Required.",
     UPLINK_BIND(tls, TlsConfig, certificate_file)},
    {.section = "tls",
     .key = "key_file",
     .kind = Kind::kFile,
     .text = "The private key of that certificate. Required.",
     UPLINK_BIND(tls, TlsConfig, key_file)},
    {.section = "tls",
     .key = "client_ca_file",
     .kind = Kind::kFile,
     .text = "The authorities that sign robots' certificates. Required.",
     UPLINK_BIND(tls, TlsConfig, client_ca_file)},
    {.section = "tls",
     .key = "operator_ca_file",
     .kind = Kind::kFile,
     .text = "The authorities that sign operators' certificates, which http.tls takes; empty: "
             "tls.client_ca_file.",
     UPLINK_BIND(tls, TlsConfig, operator_ca_file)},
    {.section = "tls",
     .key = "client_crl_file",
     .kind = Kind::kFile,
     .text = "Lists of revoked certificates (CRL) that authorities of tls.client_ca_file signed: "
             "one or more in PEM, or one in DER; read again each 5 s. A list counts for what the "
             "key that signed it has signed, also once its next update is over.",
     UPLINK_BIND(tls, TlsConfig, client_crl_file)},
    {.section = "tls",
     .key = "operator_crl_file",
     .kind = Kind::kFile,
     .text = "The same of the authorities that sign operators' certificates.",
     UPLINK_BIND(tls, TlsConfig, operator_crl_file)},
    {.section = "tls",
     .key = "min_version",
     .kind = Kind::kChoice,
     .choices = kTlsVersions,
     .text = "The lowest TLS version that the relay accepts.",
     UPLINK_BIND(tls, TlsConfig, min_version)},
    {.section = "tls",
     .key = "groups",
     .kind = Kind::kList,
     .allowed = "a list of one or more of \"X25519\", \"P-256\", \"P-384\" and \"P-521\"",
     .text =
         "The groups by which keys are agreed on. P-384 and P-521 cost the server several times "
         "the CPU of the others. While tls.min_version is \"1.2\", P-256, P-384 and P-521 are "
         "accepted behind these, because TLS 1.2 takes certificates on their curves only then.",
     UPLINK_BIND(tls, TlsConfig, groups)},

    {.section = "identity",
     .key = "registration",
     .kind = Kind::kChoice,
     .choices = kRegistrations,
     .effect = Effect::kReload,
     .text = "Which new robots come in. \"open\": every robot whose certificate an authority of "
             "tls.client_ca_file signed. \"closed\": only those that an operator added (`uplinkctl "
             "robots add`), twins and drones too; others are refused, and listed as candidates. "
             "Robots that the server knows already come in either way.",
     UPLINK_BIND(identity, IdentityConfig, registration)},
    {.section = "identity",
     .key = "gateways",
     .kind = Kind::kChoice,
     .choices = kGateways,
     .effect = Effect::kReload,
     .text = "\"named\": a gateway speaks only for the robots that its certificate names. \"any\": "
             "one whose certificate names no robots speaks for its whole fleet; the server warns "
             "of the first that does.",
     UPLINK_BIND(identity, IdentityConfig, gateways)},
    {.section = "identity",
     .key = "fleet_moves",
     .kind = Kind::kChoice,
     .choices = kFleetMoves,
     .effect = Effect::kReload,
     .text = "What a certificate does that names a known robot and another fleet. \"follow\": it "
             "moves the robot. \"refuse\": it is refused.",
     UPLINK_BIND(identity, IdentityConfig, fleet_moves)},
    {.section = "identity",
     .key = "authorities",
     .kind = Kind::kFile,
     .text = "A folder of authorities beside tls.client_ca_file, which is not required with it: of "
             "each NAME.pem, and NAME.toml with what it may vouch for: roles = [\"robot\"], fleets "
             "= [\"north\"] (one that is missing: all), and crl_file.",
     UPLINK_BIND(identity, IdentityConfig, authorities)},
    {.section = "identity",
     .key = "saved_list",
     .kind = Kind::kFile,
     .text = "A copy of who may not come in (revoked certificates and keys, blocked robots), which "
             "counts at a start while the database cannot be read; empty: access.list in the "
             "folder of the service's state ($STATE_DIRECTORY, else /var/lib/uplinkd) with "
             "PostgreSQL, none with SQLite.",
     UPLINK_BIND(identity, IdentityConfig, saved_list)},

    {.section = "store",
     .key = "url",
     .kind = Kind::kText,
     .secret = true,
     .text = "sqlite:/// and the absolute path of the database file, whose folder must exist; or "
             "postgresql://user@host:port/database?sslmode=verify-full, with libpq's parameters "
             "and without a password.",
     UPLINK_BIND(store, StoreConfig, url)},
    {.section = "store",
     .key = "migrate",
     .kind = Kind::kSwitch,
     .text = "Apply missing migrations at start; false: a store that lacks one refuses the start. "
             "With PostgreSQL it is false unless it is set: `uplinkctl store migrate` applies them "
             "as the schema's owner.",
     UPLINK_BIND(store, StoreConfig, migrate)},
    {.section = "store",
     .key = "password_file",
     .kind = Kind::kFile,
     .text = "PostgreSQL only: a file whose first line is the password, read at each connect; "
             "empty: ~/.pgpass, or the file that PGPASSFILE names.",
     UPLINK_BIND(store, StoreConfig, password_file)},
    {.section = "store",
     .key = "shards",
     .kind = Kind::kCount,
     .min = 1,
     .max = 16,
     .text = "PostgreSQL only: connections that write, each with its share of the journal; a robot "
             "is always on the same one. SQLite has one.",
     UPLINK_BIND(store, StoreConfig, shards)},
    {.section = "store",
     .key = "readers",
     .kind = Kind::kCount,
     .min = 1,
     .max = 16,
     .text = "Operators' queries that read the store side by side; the others wait.",
     UPLINK_BIND(store, StoreConfig, readers)},
    {.section = "store",
     .key = "timeout",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = 5 * kMinute,
     .text = "PostgreSQL only: how long a connect or a commit may take before the connection is "
             "given up and the same is tried again on a new one.",
     UPLINK_BIND(store, StoreConfig, timeout)},
    {.section = "store",
     .key = "accept_unsafe",
     .kind = Kind::kSwitch,
     .text =
         "PostgreSQL only: accept a server with fsync = off, which may lose acked messages when "
         "the power fails; `degraded` says so then.",
     UPLINK_BIND(store, StoreConfig, accept_unsafe)},
    {.section = "store",
     .key = "free_min",
     .kind = Kind::kBytes,
     .min = kMiB,
     .max = 64 * 1024 * kGiB,
     .zero = "5 % of the disk or 1 GiB, whichever is smaller",
     .text = "What the store's disk is to have free, at most half of the disk. Below that, robots "
             "that store over four times as much as the median are slowed down to the median's "
             "rate; below half of that nothing is stored. PostgreSQL: only where the server's "
             "folder can be seen.",
     UPLINK_BIND(store, StoreConfig, free_min)},
    {.section = "store",
     .key = "checkpoint",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = kHour,
     .zero = "never",
     .text = "How often the live states of the robots that changed are written, to be there after "
             "a restart.",
     UPLINK_BIND(store, StoreConfig, checkpoint)},
    {.section = "store",
     .key = "retention.history",
     .kind = Kind::kDuration,
     .min = kDay,
     .max = 10'000 * kDay,
     .zero = "for ever",
     .text = "How long rows of histories are kept (faults, events, messages, mission reports, "
             "presence changes), and closed mission runs; whole days, UTC.",
     UPLINK_BIND(store, StoreConfig, retain_history)},
    {.section = "store",
     .key = "retention.quarantine",
     .kind = Kind::kDuration,
     .min = kDay,
     .max = 10'000 * kDay,
     .zero = "for ever",
     .text = "How long quarantined payloads and gaps are kept.",
     UPLINK_BIND(store, StoreConfig, retain_quarantine)},
    {.section = "store",
     .key = "retention.connections",
     .kind = Kind::kDuration,
     .min = kDay,
     .max = 10'000 * kDay,
     .zero = "for ever",
     .text = "How long a robot's connections are kept after their end; at most the last 64 of a "
             "robot.",
     UPLINK_BIND(store, StoreConfig, retain_connections)},
    {.section = "store",
     .key = "retention.audit",
     .kind = Kind::kDuration,
     .min = kDay,
     .max = 10'000 * kDay,
     .zero = "for ever",
     .text = "How long is kept what operators and servers changed.",
     UPLINK_BIND(store, StoreConfig, retain_audit)},

    {.section = "journal",
     .key = "bytes_max",
     .kind = Kind::kBytes,
     .min = kKiB,
     .max = 64 * kGiB,
     .text = "Bytes of records that may wait for a commit.",
     UPLINK_BIND(journal, JournalConfig, bytes_max)},
    {.section = "journal",
     .key = "records_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 100'000'000,
     .text = "Records that may wait for a commit.",
     UPLINK_BIND(journal, JournalConfig, records_max)},
    {.section = "journal",
     .key = "batch_records_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 100'000,
     .text = "Records of one transaction; at most journal.records_max.",
     UPLINK_BIND(journal, JournalConfig, batch_records_max)},
    {.section = "journal",
     .key = "robot_share",
     .kind = Kind::kCount,
     .min = 1,
     .max = 100'000,
     .text = "One robot may have 1 / robot_share of the bytes and records of its journal's shard; "
             "at that, its stream is held back. One record always passes.",
     UPLINK_BIND(journal, JournalConfig, robot_share)},

    {.section = "fleet",
     .key = "forget_after",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = 3650 * kDay,
     .zero = "never",
     .text =
         "A robot without a stream for so long leaves memory, lists and series. The store keeps "
         "what it has of it, and it is there again when it speaks.",
     UPLINK_BIND(fleet, FleetConfig, forget_after)},

    {.section = "limits",
     .key = "payload_bytes_max",
     .kind = Kind::kBytes,
     .min = kKiB,
     .max = 16 * kMiB,
     .text = "A payload of shape, uiCapabilities or currentSettings; at most frame_bytes_max.",
     UPLINK_BIND(limits, LimitsConfig, payload_bytes_max)},
    {.section = "limits",
     .key = "message_bytes_max",
     .kind = Kind::kBytes,
     .min = kKiB,
     .max = 16 * kMiB,
     .text = "A payload of every other variant; at most payload_bytes_max.",
     UPLINK_BIND(limits, LimitsConfig, message_bytes_max)},
    {.section = "limits",
     .key = "extras_items_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 65'536,
     .text = "Readings of one telemetryExtras message.",
     UPLINK_BIND(limits, LimitsConfig, extras_items_max)},
    {.section = "limits",
     .key = "batch_uplinks_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 65'536,
     .text = "Messages of one UplinkBatch frame.",
     UPLINK_BIND(limits, LimitsConfig, batch_uplinks_max)},
    {.section = "limits",
     .key = "in_flight_uplinks_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 1'000'000,
     .text = "Durable messages of one robot that wait for a commit; at it, its stream is held "
             "back.",
     UPLINK_BIND(limits, LimitsConfig, in_flight_uplinks_max)},
    {.section = "limits",
     .key = "frame_bytes_max",
     .kind = Kind::kBytes,
     .min = 4 * kKiB,
     .max = 64 * kMiB,
     .text = "A whole encoded RelayRequest; a larger one ends the stream.",
     UPLINK_BIND(limits, LimitsConfig, frame_bytes_max)},
    {.section = "limits",
     .key = "ack_interval",
     .kind = Kind::kDuration,
     .min = 1,
     .max = kMinute,
     .text = "How long an Ack that only live messages move may wait. One that a commit releases "
             "is sent at once.",
     UPLINK_BIND(limits, LimitsConfig, ack_interval)},
    {.section = "limits",
     .key = "robots_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 1'000'000,
     .text =
         "Robots that the server holds state of; at it the one that was silent for longest, "
         "without a stream, leaves memory for one that speaks, and with none streams of further "
         "robots are refused.",
     UPLINK_BIND(limits, LimitsConfig, robots_max)},
    {.section = "limits",
     .key = "gateway_streams_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 4'096,
     .text = "Streams of one connection of a gateway, which has one per robot. All its connections "
             "together may have four times as many.",
     UPLINK_BIND(limits, LimitsConfig, gateway_streams_max)},
    {.section = "limits",
     .key = "live_bytes_max",
     .kind = Kind::kBytes,
     .min = kMiB,
     .max = 1024 * kGiB,
     .zero = "a quarter of the memory that the server may use, or 1 GiB, whichever is smaller",
     .text = "Memory of the live state of all robots and twins. Past it, the certificate whose "
             "robots hold most loses their largest parts. A twin's id counts as a certificate.",
     UPLINK_BIND(limits, LimitsConfig, live_bytes_max)},
    {.section = "limits",
     .key = "session_idle",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = 30 * kDay,
     .text = "How long a session is remembered after its last stream, once nothing of it waits.",
     UPLINK_BIND(limits, LimitsConfig, session_idle)},
    {.section = "limits",
     .key = "connection_age_max",
     .kind = Kind::kDuration,
     .min = 10 * kSecond,
     .max = 30 * kDay,
     .zero = "never",
     .text = "The age at which a connection is ended, with up to 10 s of grace, so that agents "
             "spread over servers again.",
     UPLINK_BIND(limits, LimitsConfig, connection_age_max)},
    {.section = "limits",
     .key = "durable_records_rate",
     .kind = Kind::kCount,
     .min = 1,
     .max = 1'000'000,
     .zero = "as many as it sends",
     .effect = Effect::kReload,
     .text = "Durable messages of one robot that are stored per second; past that and the burst "
             "its stream is held back, and nothing is lost; a twin's may be rejected.",
     UPLINK_BIND(limits, LimitsConfig, durable_records_rate)},
    {.section = "limits",
     .key = "durable_records_burst",
     .kind = Kind::kCount,
     .min = 1,
     .max = 100'000'000,
     .effect = Effect::kReload,
     .text = "Durable messages of one robot that are stored at once, after a pause.",
     UPLINK_BIND(limits, LimitsConfig, durable_records_burst)},
    {.section = "limits",
     .key = "durable_bytes_rate",
     .kind = Kind::kBytes,
     .min = kKiB,
     .max = 16 * kGiB,
     .zero = "as many as it sends",
     .effect = Effect::kReload,
     .text = "Bytes of one robot's durable messages that are stored per second, as they came or as "
             "they are kept, whichever is more; past that and the burst its stream is held back, "
             "and nothing is lost; a twin's may be rejected.",
     UPLINK_BIND(limits, LimitsConfig, durable_bytes_rate)},
    {.section = "limits",
     .key = "durable_bytes_burst",
     .kind = Kind::kBytes,
     .min = kKiB,
     .max = 64 * kGiB,
     .effect = Effect::kReload,
     .text = "Bytes of one robot's durable messages that are stored at once, after a pause.",
     UPLINK_BIND(limits, LimitsConfig, durable_bytes_burst)},

    UPLINK_RATE(shape, "shape"),
    UPLINK_RATE(object, "object"),
    UPLINK_RATE(ui_capabilities, "uiCapabilities"),
    UPLINK_RATE(current_settings, "currentSettings"),
    UPLINK_RATE(agent_info, "agentInfo"),
    UPLINK_RATE(system_health, "systemHealth"),
    UPLINK_RATE(usage_telemetry, "usageTelemetry"),
    UPLINK_RATE(consumable_status, "consumableStatus"),
    UPLINK_RATE(spatial_directive_status, "spatialDirectiveStatus"),
    UPLINK_RATE(telemetry, "motion, status, extras and RCAN Robot State together"),

    {.section = "presence",
     .key = "timeout",
     .kind = Kind::kDuration,
     .min = 100,
     .max = kHour,
     .text = "A robot is offline when its last sign of life is older.",
     UPLINK_BIND(presence, PresenceConfig, timeout)},
    {.section = "presence",
     .key = "startup_grace",
     .kind = Kind::kDuration,
     .min = 1,
     .max = kHour,
     .zero = "none",
     .text = "After a start, or a standstill of 15 s or longer, how long a robot that is not heard "
             "is unknown instead of offline.",
     UPLINK_BIND(presence, PresenceConfig, startup_grace)},
    {.section = "presence",
     .key = "adopted_grace",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = 7 * kDay,
     .text = "How long a robot that was adopted from another server is unknown instead of "
             "offline while it is not heard, where that server may live and be cut off from the "
             "store alone; and for how long after such a server's last renewal a robot here is so "
             "that has no stream, or whose peer answers no ping. One that stopped in order, or is "
             "known to have ended, has startup_grace.",
     UPLINK_BIND(presence, PresenceConfig, adopted_grace)},
    {.section = "presence",
     .key = "parked_max",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = 7 * kDay,
     .text = "How long alerts on missing robots skip a robot that said Goodbye, or whose twin's "
             "client said `disconnected`, at most.",
     UPLINK_BIND(presence, PresenceConfig, parked_max)},
    {.section = "presence",
     .key = "flap_changes",
     .kind = Kind::kCount,
     .min = 2,
     .max = 100,
     .text = "A robot that goes offline or comes back so often within flap_window is flapping.",
     UPLINK_BIND(presence, PresenceConfig, flap_changes)},
    {.section = "presence",
     .key = "flap_window",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = kDay,
     .text = "The time within which flap_changes counts.",
     UPLINK_BIND(presence, PresenceConfig, flap_window)},

    {.section = "forward",
     .key = "object_ttl",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = 365 * kDay,
     .zero = "for ever",
     .text = "Life of an object that names no expiry, counted from its arrival.",
     UPLINK_BIND(forward, ForwardConfig, object_ttl)},
    {.section = "rcan",
     .key = "subsystem",
     .kind = Kind::kText,
     .text = "The second word of the joints' series: lower-case letters, digits and underscores.",
     UPLINK_BIND(rcan, RcanConfig, subsystem)},
    {.section = "rcan",
     .key = "series_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 10'000'000,
     .text = "Series of one scrape of /metrics/robots; what does not fit is left out.",
     UPLINK_BIND(rcan, RcanConfig, series_max)},
    {.section = "rcan",
     .key = "series_ttl",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = 30 * kDay,
     .text = "How long the series of a robot stay after it went offline.",
     UPLINK_BIND(rcan, RcanConfig, series_ttl)},
    {.section = "rcan",
     .key = "robot_series_max",
     .kind = Kind::kCount,
     .min = kRobotSeriesMaxMin,
     .max = 10'000,
     .text = "Series of one robot; what a robot has beyond it is left out.",
     UPLINK_BIND(rcan, RcanConfig, robot_series_max)},
    {.section = "rcan",
     .key = "robot_new_names_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 1'000'000,
     .text = "New names of series (of joints, computers) per robot and hour, after its first "
             "rcan.robot_series_max.",
     UPLINK_BIND(rcan, RcanConfig, robot_new_names_max)},
    {.section = "rcan",
     .key = "fields",
     .kind = Kind::kList,
     .text = "The series that are written, such as \"robot_battery_pct\". Empty: all.",
     UPLINK_BIND(rcan, RcanConfig, fields)},
    {.section = "rcan",
     .key = "fleets",
     .kind = Kind::kList,
     .text = "The fleets whose robots are rendered. Empty: all.",
     UPLINK_BIND(rcan, RcanConfig, fleets)},
    {.section = "rcan",
     .key = "extras",
     .kind = Kind::kList,
     .text = "Keys of extras (numbers, booleans) shown as rcan_robot_extra. Empty: none.",
     UPLINK_BIND(rcan, RcanConfig, extras)},
    {.section = "rcan",
     .key = "counts_as_life",
     .kind = Kind::kSwitch,
     .text = "Whether an RCAN Robot State is a sign of life.",
     UPLINK_BIND(rcan, RcanConfig, counts_as_life)},

    {.section = "mqtt",
     .key = "url",
     .kind = Kind::kText,
     .allowed = "mqtts:// or mqtt://, a host and perhaps a port, or \"\"",
     .secret = true,
     .text = "The broker: mqtts://host:8883 with TLS, mqtt://host:1883 without; the ports may be "
             "left out. Without a user: mqtt.username is for that. Empty: there is no broker.",
     UPLINK_BIND(mqtt, MqttConfig, url)},
    {.section = "mqtt",
     .key = "username",
     .kind = Kind::kText,
     .text = "The user that the broker knows uplinkd as; empty: none.",
     UPLINK_BIND(mqtt, MqttConfig, username)},
    {.section = "mqtt",
     .key = "password_file",
     .kind = Kind::kFile,
     .text = "A file with that user's password, read at each connection; empty: no password.",
     UPLINK_BIND(mqtt, MqttConfig, password_file)},
    {.section = "mqtt",
     .key = "ca_file",
     .kind = Kind::kFile,
     .text = "The authorities that may vouch for the broker, PEM, read at each connection; empty: "
             "those of the system.",
     UPLINK_BIND(mqtt, MqttConfig, ca_file)},
    {.section = "mqtt",
     .key = "client_certificate_file",
     .kind = Kind::kFile,
     .text = "The certificate that uplinkd shows the broker, PEM, read at each connection; empty: "
             "none.",
     UPLINK_BIND(mqtt, MqttConfig, client_certificate_file)},
    {.section = "mqtt",
     .key = "client_key_file",
     .kind = Kind::kFile,
     .text = "The private key of that certificate.",
     UPLINK_BIND(mqtt, MqttConfig, client_key_file)},
    {.section = "mqtt",
     .key = "version",
     .kind = Kind::kChoice,
     .choices = kMqttVersions,
     .text = "The version of MQTT. With 3.1.1 the broker alone says how long it keeps a session "
             "and how many messages it sends before the first is acked.",
     UPLINK_BIND(mqtt, MqttConfig, version)},
    {.section = "mqtt",
     .key = "client_id",
     .kind = Kind::kText,
     .allowed = "1 to 250 bytes without control characters",
     .text = "The client id of the connection for what is stored; the broker keeps a session of "
             "this name while uplinkd is away. The connection for live state has it with -live, "
             "that for media with -media. Only servers on one store may have the same.",
     UPLINK_BIND(mqtt, MqttConfig, client_id)},
    {.section = "mqtt",
     .key = "session_expiry",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = 365 * kDay,
     .text = "How long the broker is asked to keep that session, and what comes for it, while "
             "uplinkd is away. MQTT 5 alone.",
     UPLINK_BIND(mqtt, MqttConfig, session_expiry)},
    {.section = "mqtt",
     .key = "keepalive",
     .kind = Kind::kDuration,
     .min = 5 * kSecond,
     .max = 18 * kHour,
     .text = "When nothing was sent for so long, the broker is asked whether it is there; after "
             "one and a half times that it takes uplinkd for gone. Whole seconds count. At most a "
             "quarter of cyberwave.presence_timeout is used.",
     UPLINK_BIND(mqtt, MqttConfig, keepalive)},
    {.section = "mqtt",
     .key = "unacked_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 32'767,
     .text = "Messages at QoS 1 that may wait for their commit and PUBACK; past it none is read. "
             "The broker is told by MQTT 5. Its own queue must be far larger.",
     UPLINK_BIND(mqtt, MqttConfig, unacked_max)},

    {.section = "cyberwave",
     .key = "topic_prefixes",
     .kind = Kind::kList,
     .allowed = "a list of 1 to 8 strings, each without wildcards and of at most 186 bytes when "
                "percent-encoded; [\"\"] for none",
     .empty_items = true,
     .text = "What stands directly before cyberwave/ in the topics that are read. Twins under "
             "different prefixes are different robots.",
     UPLINK_BIND(cyberwave, CyberwaveConfig, topic_prefixes)},
    {.section = "cyberwave",
     .key = "media",
     .kind = Kind::kChoice,
     .choices = kCyberwaveMedia,
     .text = "\"count\": depth frames and point clouds are subscribed to and counted, on a "
             "connection of their own; \"off\": they are not asked for.",
     UPLINK_BIND(cyberwave, CyberwaveConfig, media)},
    {.section = "cyberwave",
     .key = "presence_timeout",
     .kind = Kind::kDuration,
     .min = 5 * kSecond,
     .max = kHour,
     .text = "A twin is offline when its last sign of life is older, and unknown while the broker "
             "is not heard and that long after.",
     UPLINK_BIND(cyberwave, CyberwaveConfig, presence_timeout)},
    {.section = "cyberwave",
     .key = "prismatic_joints",
     .kind = Kind::kList,
     .text = "Names of joints that slide: their positions are metres instead of radians.",
     UPLINK_BIND(cyberwave, CyberwaveConfig, prismatic_joints)},
    {.section = "cyberwave",
     .key = "robots_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 1'000'000,
     .text = "Twins that the server holds state of, as robots of limits.robots_max, which it is "
             "at most; where it is not set, it is no more than that.",
     UPLINK_BIND(cyberwave, CyberwaveConfig, robots_max)},
    {.section = "cyberwave",
     .key = "fleet",
     .kind = Kind::kText,
     .allowed = "1 to 256 bytes without invisible characters, and not \"*\"",
     .text = "The fleet that twins are in.",
     UPLINK_BIND(cyberwave, CyberwaveConfig, fleet)},

    {.section = "uncrew",
     .key = "avatar",
     .kind = Kind::kSwitch,
     .text = "Whether AvatarService is served: drones publish telemetry, alerts and requests by "
             "unary calls, with the certificates of robots and gateways.",
     UPLINK_BIND(uncrew, UncrewConfig, avatar)},
    {.section = "uncrew",
     .key = "answer_within",
     .kind = Kind::kDuration,
     .min = 100,
     .max = kMinute,
     .text = "A sample that is stored before it is answered, and is not stored after so long, is "
             "answered UNAVAILABLE: the drone sends it again.",
     UPLINK_BIND(uncrew, UncrewConfig, answer_within)},
    {.section = "uncrew",
     .key = "stale_after",
     .kind = Kind::kDuration,
     .min = kSecond,
     .max = kHour,
     .text = "A type of telemetry without a new sample for so long has no series.",
     UPLINK_BIND(uncrew, UncrewConfig, stale_after)},
    {.section = "uncrew",
     .key = "ruri_template",
     .kind = Kind::kText,
     .allowed = "an RURI of at most 256 bytes with {uav_id} once, where a drone's id stands",
     .text = "The RURI of a drone by its id. A drone whose certificate names another RURI keeps "
             "that one.",
     UPLINK_BIND(uncrew, UncrewConfig, ruri_template)},

    {.section = "http",
     .key = "connections_max",
     .kind = Kind::kCount,
     .min = 8,
     .max = 10'000,
     .text = "Connections held at once. The last four answer probes and scrapes alone; past them "
             "the one that has been idle for longest gives way, and if none is, a further one is "
             "closed at accept.",
     UPLINK_BIND(http, HttpConfig, connections_max)},
    {.section = "http",
     .key = "hosts",
     .kind = Kind::kList,
     .effect = Effect::kReload,
     .text = "Names under which /api may be asked for, beside addresses and localhost, without a "
             "port: those that a proxy in front passes on as Host. Probes are answered under any "
             "name, and so are scrapes, unless http.hosts_cover_metrics is true.",
     UPLINK_BIND(http, HttpConfig, hosts)},
    {.section = "http",
     .key = "hosts_cover_metrics",
     .kind = Kind::kSwitch,
     .text = "Whether /metrics and /metrics/robots, too, may be asked for on listen.http under "
             "addresses, localhost and http.hosts alone. Then http.hosts needs the name by which "
             "Prometheus asks.",
     UPLINK_BIND(http, HttpConfig, hosts_cover_metrics)},
    {.section = "http",
     .key = "socket_mode",
     .kind = Kind::kText,
     .allowed = "three or four octal digits up to \"0777\"",
     .text = "The permissions of the socket, where listen.http is a path: who may write it may "
             "connect.",
     UPLINK_BIND(http, HttpConfig, socket_mode)},
    {.section = "http",
     .key = "tls.certificate_file",
     .kind = Kind::kFile,
     .text = "The certificate chain of listen.http, leaf first; set with http.tls.key_file. Then "
             "one port speaks TLS and, to http.plain_from, plain HTTP; operators may show a "
             "certificate that an authority of tls.operator_ca_file signed.",
     UPLINK_BIND(http, HttpConfig, tls_certificate_file)},
    {.section = "http",
     .key = "tls.key_file",
     .kind = Kind::kFile,
     .text = "The private key of that certificate.",
     UPLINK_BIND(http, HttpConfig, tls_key_file)},
    {.section = "http",
     .key = "plain_from",
     .kind = Kind::kNetworks,
     .text = "Who may speak plain HTTP to listen.http; others must speak TLS or are closed. Where "
             "this names more than a proxy's address, tokens cross that network readable. A Unix "
             "socket is always plain, and without http.tls loopback may always speak it.",
     UPLINK_BIND(http, HttpConfig, plain_from)},
    {.section = "http",
     .key = "tokens_file",
     .kind = Kind::kFile,
     .text = "The tokens by which people and programs may ask; `uplinkctl tokens` makes them. A "
             "change counts within 5 s. Once it is set, every caller of listen.http must show a "
             "token or an operator's certificate.",
     UPLINK_BIND(http, HttpConfig, tokens_file)},
    {.section = "http",
     .key = "metrics_token_file",
     .kind = Kind::kFile,
     .text = "A file whose first line is the token that scrapes on listen.metrics must show "
             "(Authorization: Bearer); empty: they show none.",
     UPLINK_BIND(http, HttpConfig, metrics_token_file)},
    {.section = "view",
     .key = "watch_interval",
     .kind = Kind::kDuration,
     .min = 50,
     .max = kMinute,
     .effect = Effect::kReload,
     .text = "A watch (/api/v1/watch) shows each robot at most once in this time, as it is then.",
     UPLINK_BIND(view, ViewConfig, watch_interval)},

    {.section = "metrics",
     .key = "fleets_max",
     .kind = Kind::kCount,
     .min = 1,
     .max = 1'000,
     .text = "Fleets that /metrics names; the robots of further ones count as fleet _other.",
     UPLINK_BIND(metrics, MetricsConfig, fleets_max)},
    {.section = "log",
     .key = "format",
     .kind = Kind::kChoice,
     .choices = kLogFormats,
     .text = "\"text\": event key=value; \"json\": one object per line.",
     UPLINK_BIND(log, LogConfig, format)},
    {.section = "log",
     .key = "level",
     .kind = Kind::kChoice,
     .choices = kLogLevels,
     .effect = Effect::kReload,
     .text = "The least severe line that is written. At debug each connection, stream, HTTP answer "
             "and slow commit has one.",
     UPLINK_BIND(log, LogConfig, level)},

    {.section = "drain",
     .key = "timeout",
     .kind = Kind::kDuration,
     .min = 100,
     .max = 10 * kMinute,
     .text = "How long the drain may take after the signal; the exit comes 7 s later at the "
             "latest. What is unsettled then is counted in a warning.",
     UPLINK_BIND(drain, DrainConfig, timeout)},
});

#undef UPLINK_BIND

}  // namespace

std::span<const Section> Sections() { return kSections; }

std::span<const Setting> Settings() { return kSettings; }

const Setting* FindSetting(std::string_view section, std::string_view key) {
  for (const Setting& setting : kSettings) {
    if (setting.section == section && setting.key == key) {
      return &setting;
    }
  }
  return nullptr;
}

}  // namespace uplink::config
