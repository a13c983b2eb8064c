#pragma once

#include <cstddef>
#include <memory>
#include <string>
#include <string_view>

#include "schema/model/message_source.h"
#include "storage/deliveries.h"

namespace uplink::storage {

/// Bytes of a topic that are kept. A broker allows 65,535; those of the subscriptions have less
/// than this, but for a prefix that somebody chose to be so long.
inline constexpr std::size_t kTopicBytesMax = 1'024;
/// Bytes of a prefix of topics. Those that the configuration lets pass are shorter, since they
/// become part of a RURI (schema/cyberwave/prefix.h).
inline constexpr std::size_t kTopicPrefixBytesMax = 255;

/// Where a message came from that did not come by the relay. Immutable.
struct Origin {
  model::MessageSource source = model::MessageSource::kCyberwave;
  /// As it was published, fit for a column (OriginOf).
  std::string topic;
  /// The lease under which it came; null: it needs none. One that another took since fences it.
  TopicHoldRef hold{};
};

/// Shared by the records of a message; null: the relay.
using OriginRef = std::shared_ptr<const Origin>;

/// An origin whose topic is printable and has at most kTopicBytesMax bytes.
[[nodiscard]] OriginRef OriginOf(model::MessageSource source, std::string_view topic,
                                 TopicHoldRef hold = nullptr);

[[nodiscard]] inline model::MessageSource SourceOf(const OriginRef& origin) {
  return origin == nullptr ? model::MessageSource::kUplink : origin->source;
}
[[nodiscard]] inline std::string_view TopicOf(const OriginRef& origin) {
  return origin == nullptr ? std::string_view() : std::string_view(origin->topic);
}

/// Null if it needs no lease.
[[nodiscard]] inline const TopicHold* HoldOf(const OriginRef& origin) {
  return origin == nullptr ? nullptr : origin->hold.get();
}

/// What stands in a robot's place for messages that belong to none begins with this: no RURI does,
/// and so no certificate names it. It has a row and sessions as a robot has, is opened and held as
/// one, and is in no list of robots.
inline constexpr std::string_view kNoRobotPrefix = "cyberwave:";

/// Stands for the messages under a topic prefix, of at most kTopicPrefixBytesMax bytes, that belong
/// to no robot.
[[nodiscard]] std::string NoRobotOf(std::string_view topic_prefix);
[[nodiscard]] inline bool IsNoRobot(std::string_view ruri) {
  return ruri.starts_with(kNoRobotPrefix);
}
/// The opposite as SQL of either store, of a row with a column `ruri`.
inline constexpr std::string_view kOfARobotSql = "substr(ruri, 1, 10) <> 'cyberwave:'";
static_assert(kOfARobotSql.find(kNoRobotPrefix) != std::string_view::npos &&
              kNoRobotPrefix.size() == 10);

}  // namespace uplink::storage
