#pragma once

#include <array>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <string_view>

#include "metrics/catalogue.h"
#include "server/config/config.h"
#include "server/limits/token_bucket.h"

/// How much one sender may send, in one table: docs/operate/limits.md is checked against it.
namespace uplink::limits {

enum class PolicyId : std::uint8_t {
  kRecordsOfRobot,
  kBytesOfRobot,
  kRejectsOfRobot,
  kStreamsOfRobot,
  kTakeoversOfRobot,
  kForwardedBytesOfRobot,
  kLiveSamplesOfDrone,
  kMessagesOfTwin,
  kLogLinesOfTwin,
  kFaultChangesOfTwin,
  kBytesOfId,
  kRejectsOfStranger,
  kRecordsOfScope,
  kBytesOfScope,
  kPongsOfName,
  kPongs,
  kHandshakesOfSource,
  kFailedProofsOfSource,
  kCommandsOfCaller,
  kCommands,
  kAdminCommands,
};

/// One sender's share of something. A value.
struct Policy {
  PolicyId id;
  /// What is counted, in the plural: text for the log.
  std::string_view of;
  /// Who has a share each.
  std::string_view whose;
  /// `most` in each `per`; up to `at_once` together after a pause.
  std::uint64_t most = 0;
  std::uint64_t at_once = 0;
  std::chrono::seconds per{1};
  /// How many senders are remembered at a time. 0: the count is part of the state that is held of
  /// each, and their number has its own bound.
  std::size_t keys_max = 0;
  /// The metric that counts what went over.
  metrics::MetricId shown;
  /// The setting whose default this is; empty if no setting changes it.
  std::string_view key{};

  /// For a policy whose `per` is a second.
  [[nodiscard]] constexpr BucketSize bucket() const { return {.rate = most, .burst = at_once}; }
};

/// Ids of a broker's topics that have a budget of their own: more than there may be twins by
/// default.
inline constexpr std::size_t kBudgetsMax = 32'768;

// clang-format off
inline constexpr auto kPolicies = std::to_array<Policy>({
    {.id = PolicyId::kRecordsOfRobot, .of = "messages to store", .whose = "a robot",
     .most = config::LimitsConfig().durable_records_rate,
     .at_once = config::LimitsConfig().durable_records_burst,
     .shown = metrics::MetricId::kHeldBackByTotal, .key = "limits.durable_records_rate"},
    {.id = PolicyId::kBytesOfRobot, .of = "bytes to store", .whose = "a robot",
     .most = config::LimitsConfig().durable_bytes_rate,
     .at_once = config::LimitsConfig().durable_bytes_burst,
     .shown = metrics::MetricId::kHeldBackByTotal, .key = "limits.durable_bytes_rate"},
    // Over all its streams. Messages over their rate have a bucket of the same size.
    {.id = PolicyId::kRejectsOfRobot, .of = "rejected messages", .whose = "a robot", .most = 1'000,
     .at_once = 1'000, .shown = metrics::MetricId::kHeldBackByTotal},
    {.id = PolicyId::kStreamsOfRobot, .of = "streams", .whose = "a robot", .most = 10,
     .at_once = 10, .per = std::chrono::seconds(60), .shown = metrics::MetricId::kStreamDelays},
    {.id = PolicyId::kTakeoversOfRobot, .of = "takeovers", .whose = "a robot", .most = 10,
     .at_once = 10, .per = std::chrono::seconds(60), .shown = metrics::MetricId::kContested},
    // To all receivers together: half of a gigabit network. 2,000 receivers of 50 changes per
    // second, 250 bytes each, take less than half of that.
    {.id = PolicyId::kForwardedBytesOfRobot, .of = "forwarded bytes", .whose = "a robot",
     .most = 64 * config::kMiB, .at_once = 256 * config::kMiB,
     .shown = metrics::MetricId::kForwardPaced},
    {.id = PolicyId::kLiveSamplesOfDrone, .of = "live samples", .whose = "a drone", .most = 100,
     .at_once = 200, .shown = metrics::MetricId::kAvatarPublishes},
    // A twin's simulated robot counts as the twin.
    {.id = PolicyId::kMessagesOfTwin, .of = "messages", .whose = "a twin", .most = 1'000,
     .at_once = 5'000, .shown = metrics::MetricId::kMqttRejects},
    {.id = PolicyId::kLogLinesOfTwin, .of = "lines of logs", .whose = "a twin", .most = 50,
     .at_once = 2'000, .shown = metrics::MetricId::kMqttRejects},
    // One message of half a kilobyte may change 128 faults: one twin alone could keep the store
    // busy. As many as log lines.
    {.id = PolicyId::kFaultChangesOfTwin, .of = "faults that metrics change", .whose = "a twin",
     .most = 50, .at_once = 2'000, .shown = metrics::MetricId::kMqttRejects},
    // Payloads that we parse: 65 of the largest per second, which take a fortieth of a core. A
    // camera's are not parsed.
    {.id = PolicyId::kBytesOfId, .of = "bytes at QoS 0", .whose = "an id in topics",
     .most = 4 * config::kMiB, .at_once = 32 * config::kMiB, .keys_max = kBudgetsMax,
     .shown = metrics::MetricId::kMqttRejects},
    // For instance of a twin that was never heard. Those of all ids share one place in the journal
    // and one quarantine. At 50 per second each, thousands of ids do not fill that place while the
    // store takes them.
    {.id = PolicyId::kRejectsOfStranger, .of = "rejected messages of no robot",
     .whose = "an id in topics", .most = 50, .at_once = 2'000, .keys_max = kBudgetsMax,
     .shown = metrics::MetricId::kMqttRejects},
    // A scope is no robot and has no flow of its own.
    {.id = PolicyId::kRecordsOfScope, .of = "messages to store", .whose = "an environment or run",
     .most = config::LimitsConfig().durable_records_rate,
     .at_once = config::LimitsConfig().durable_records_burst, .keys_max = kBudgetsMax,
     .shown = metrics::MetricId::kMqttRejects},
    {.id = PolicyId::kBytesOfScope, .of = "bytes to store", .whose = "an environment or run",
     .most = config::LimitsConfig().durable_bytes_rate,
     .at_once = config::LimitsConfig().durable_bytes_burst, .keys_max = kBudgetsMax,
     .shown = metrics::MetricId::kMqttRejects},
    // Names that got a pong within the last second always have room: see kPongs.
    {.id = PolicyId::kPongsOfName, .of = "pongs", .whose = "a name in pings", .most = 10,
     .at_once = 10, .keys_max = 2'048, .shown = metrics::MetricId::kMqttPongsWithheld},
    {.id = PolicyId::kPongs, .of = "pongs", .whose = "all names together", .most = 1'000,
     .at_once = 1'000, .shown = metrics::MetricId::kMqttPongsWithheld},
    // Bounds a source to its share. A site of 40 robots behind one address reconnects without a
    // wait.
    {.id = PolicyId::kHandshakesOfSource, .of = "handshakes", .whose = "a source address",
     .most = 20, .at_once = 40, .keys_max = 8'192, .shown = metrics::MetricId::kHandshakesWaiting},
    // A good proof passes all the same, so a source that is forgotten gains only the other answer.
    {.id = PolicyId::kFailedProofsOfSource, .of = "wrong tokens and certificates",
     .whose = "a source address", .most = 10, .at_once = 10, .per = std::chrono::seconds(60),
     .keys_max = 4'096, .shown = metrics::MetricId::kHttpDenied},
    // Each takes the store for a moment, for which robots' messages wait.
    {.id = PolicyId::kCommandsOfCaller, .of = "commands about robots", .whose = "a caller",
     .most = 5, .at_once = 20, .keys_max = 2'048, .shown = metrics::MetricId::kHttpDenied},
    {.id = PolicyId::kCommands, .of = "commands about robots", .whose = "all callers together",
     .most = 20, .at_once = 40, .shown = metrics::MetricId::kHttpDenied},
    // A script that revokes a hundred certificates does so at once.
    {.id = PolicyId::kAdminCommands, .of = "commands about certificates, and reloads",
     .whose = "all callers together", .most = 10, .at_once = 200,
     .shown = metrics::MetricId::kHttpDenied},
});
// clang-format on

[[nodiscard]] constexpr const Policy& PolicyOf(PolicyId id) {
  return kPolicies[static_cast<std::size_t>(id)];
}

}  // namespace uplink::limits
