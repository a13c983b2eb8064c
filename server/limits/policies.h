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
};

/// One sender's share of something. A value.
struct Policy {
  PolicyId id;
  /// What is counted, in the plural, as the log says it.
  std::string_view of;
  /// Of whom each has a share of its own.
  std::string_view whose;
  /// So many per `per`, and after a pause `at_once`.
  std::uint64_t most = 0;
  std::uint64_t at_once = 0;
  std::chrono::seconds per{1};
  /// Those whose use is remembered at a time; 0: it is part of what is held of each, whose number
  /// has a bound of its own.
  std::size_t keys_max = 0;
  /// Shows what went over.
  metrics::MetricId shown;
  /// The key that may change it, of which this is the default; empty: none.
  std::string_view key{};

  /// Of one whose `per` is a second.
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
    // Over all its streams; the same of those that are over their rate.
    {.id = PolicyId::kRejectsOfRobot, .of = "rejected messages", .whose = "a robot", .most = 1'000,
     .at_once = 1'000, .shown = metrics::MetricId::kHeldBackByTotal},
    {.id = PolicyId::kStreamsOfRobot, .of = "streams", .whose = "a robot", .most = 10,
     .at_once = 10, .per = std::chrono::seconds(60), .shown = metrics::MetricId::kStreamDelays},
    {.id = PolicyId::kTakeoversOfRobot, .of = "takeovers", .whose = "a robot", .most = 10,
     .at_once = 10, .per = std::chrono::seconds(60), .shown = metrics::MetricId::kContested},
    // To all receivers together: half of a gigabit network. 2,000 receivers of 50 changes per
    // second, 250 bytes each, take a half of it.
    {.id = PolicyId::kForwardedBytesOfRobot, .of = "forwarded bytes", .whose = "a robot",
     .most = 64 * config::kMiB, .at_once = 256 * config::kMiB,
     .shown = metrics::MetricId::kForwardPaced},
    {.id = PolicyId::kLiveSamplesOfDrone, .of = "live samples", .whose = "a drone", .most = 100,
     .at_once = 200, .shown = metrics::MetricId::kAvatarPublishes},
    // Of a twin its simulated robot is a part.
    {.id = PolicyId::kMessagesOfTwin, .of = "messages", .whose = "a twin", .most = 1'000,
     .at_once = 5'000, .shown = metrics::MetricId::kMqttRejects},
    {.id = PolicyId::kLogLinesOfTwin, .of = "lines of logs", .whose = "a twin", .most = 50,
     .at_once = 2'000, .shown = metrics::MetricId::kMqttRejects},
    // One message of half a kilobyte may change 128, and one twin would keep the store busy with
    // nothing else. As many as log lines.
    {.id = PolicyId::kFaultChangesOfTwin, .of = "faults that metrics change", .whose = "a twin",
     .most = 50, .at_once = 2'000, .shown = metrics::MetricId::kMqttRejects},
    // What we look into: 65 of the largest payloads in a second, which take a fortieth of a core. A
    // camera's are not looked into.
    {.id = PolicyId::kBytesOfId, .of = "bytes at QoS 0", .whose = "an id in topics",
     .most = 4 * config::kMiB, .at_once = 32 * config::kMiB, .keys_max = kBudgetsMax,
     .shown = metrics::MetricId::kMqttRejects},
    // Such as those of a twin that was never heard. They stand for all ids in one place of the
    // journal, and in one quarantine: with 50 per second of each, thousands of ids do not fill what
    // that place may have while the store takes them.
    {.id = PolicyId::kRejectsOfStranger, .of = "rejected messages of no robot",
     .whose = "an id in topics", .most = 50, .at_once = 2'000, .keys_max = kBudgetsMax,
     .shown = metrics::MetricId::kMqttRejects},
    // It is no robot, and has no flow of one.
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
    // A source that wants no more than its part: a site of 40 robots behind one address comes back
    // without a wait.
    {.id = PolicyId::kHandshakesOfSource, .of = "handshakes", .whose = "a source address",
     .most = 20, .at_once = 40, .keys_max = 8'192, .shown = metrics::MetricId::kHandshakesWaiting},
});
// clang-format on

[[nodiscard]] constexpr const Policy& PolicyOf(PolicyId id) {
  return kPolicies[static_cast<std::size_t>(id)];
}

}  // namespace uplink::limits
