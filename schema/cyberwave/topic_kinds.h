#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace uplink::cyberwave {

/// What we make of a message.
enum class MessageClass : std::uint8_t {
  /// Stored before it is acked.
  kDurable,
  /// The latest counts.
  kLive,
  /// Counted; of commands the last head is shown. Never stored.
  kObserved,
  /// Counted, with its bytes. Never stored.
  kMedia,
  /// Answered.
  kPing,
  /// Passed over.
  kOther,
};

/// Whether a message of that class may be kept as it came, and quoted: in a row, in a sentence, in
/// a log. Commands may hold credentials, signalling holds SDP and ICE, and media are what cameras
/// see. Pure.
[[nodiscard]] constexpr bool MayBeKept(MessageClass message_class) {
  switch (message_class) {
    case MessageClass::kDurable:
    case MessageClass::kLive:
    case MessageClass::kPing:
      return true;
    case MessageClass::kObserved:
    case MessageClass::kMedia:
    case MessageClass::kOther:
      return false;
  }
  return false;
}

/// The topics that we know.
enum class TopicKind : std::uint8_t {
  kPosition,
  kRotation,
  kScale,
  kJointUpdate,
  kMetrics,
  kEdgeHealth,
  kTelemetry,
  kNavigateStatus,
  kDriverLog,
  kEvent,
  kMissionStatus,
  kGps,
  kJointStates,
  kBatteryStatus,
  kCommand,
  kNavigateCommand,
  kWebrtcOffer,
  kWebrtcAnswer,
  kWebrtcCandidate,
  kDepth,
  kPointcloud,
  kEnvironment,
  kWorkflowRun,
  kPing,
  /// None of these.
  kOther,
};

/// The connection to the broker that asks for a topic, so that media delays no state and state no
/// commit.
enum class Connection : std::uint8_t {
  /// What is durable, and metrics, whose errors are.
  kDurable,
  kLive,
  kMedia,
};

/// One topic: `cyberwave/<scope>/<id>/<tail>`. A value; its texts live for ever.
struct TopicRow {
  TopicKind kind = TopicKind::kOther;
  std::string_view scope;
  /// `+`: any one level.
  std::string_view tail;
  MessageClass message_class = MessageClass::kOther;
  Connection connection = Connection::kDurable;
};

/// A row per kind but kOther, in their order. Source: the vendor's topic page and its clients.
[[nodiscard]] std::span<const TopicRow> TopicRows();

/// Scope and tail, for labels and logs: `twin/position`; `other`.
[[nodiscard]] std::string_view ToText(TopicKind kind);

/// The subscription filters of a connection under one prefix (prefix.h): one for each topic that it
/// reads, and no other. Pure.
[[nodiscard]] std::vector<std::string> Filters(std::string_view prefix, Connection connection);

}  // namespace uplink::cyberwave
