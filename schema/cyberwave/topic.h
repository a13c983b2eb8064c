#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>

#include "schema/cyberwave/topic_kinds.h"
#include "schema/model/cyberwave/uuid.h"
#include "schema/model/rejection.h"

namespace uplink::cyberwave {

/// What stands between the prefix and the rest of every topic.
inline constexpr std::string_view kRoot = "cyberwave/";

/// Where a message was published. A value.
struct Topic {
  TopicKind kind = TopicKind::kOther;
  /// By the topic alone; what the message says may make it another one.
  MessageClass message_class = MessageClass::kOther;
  /// The configured one that it stands under; empty too for kOther.
  std::string prefix;
  /// Whether id and name were good; otherwise the message belongs to no robot.
  bool identified = false;
  /// The twin, the environment or the workflow run; not of a ping, nor of kOther.
  model::cyberwave::Uuid id;
  /// Of an environment its type; of a ping the name to answer under, as it came.
  std::string name;

  friend bool operator==(const Topic&, const Topic&) = default;
};

/// What reading a topic found. A value.
struct TopicReading {
  Topic topic;
  /// If it is one of ours whose id or name is not good.
  std::optional<model::Rejection> rejection;
};

/// Whether the topic names a twin.
[[nodiscard]] bool IsOfTwin(TopicKind kind);

/// Reads a topic under one of `prefixes`, of those that fit under the longest.
///
/// Errors:  a twin, environment or run that is no UUID, and an empty name, are MALFORMED; a name
///          that is too long TEXT_TOO_LONG. Every other topic is kOther.
/// Limits:  kIdBytesMax for a ping's name, kNameBytesMax for an environment's type.
/// Thread:  pure; any thread.
[[nodiscard]] TopicReading ParseTopic(std::string_view topic,
                                      std::span<const std::string> prefixes);

/// The topic as rows and logs may have it, from its reading `read`: as it was published; if it may
/// not be kept (MayBeKept), with a `?` for an id that is no UUID, which could be anything; `other`
/// for a topic that is none of ours. Pure.
[[nodiscard]] std::string KeptTopic(std::string_view topic, const Topic& read);

}  // namespace uplink::cyberwave
