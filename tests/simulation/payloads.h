#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>

namespace uplink::simulation {

/// What a modelled agent sends.
enum class Content : std::uint8_t {
  kFault,
  kEvent,
  kMotion,
  /// A fault without an id.
  kBadDurable,
  /// A motion message with a truncated payload.
  kBadLive,
  /// A fault that the store refuses for good, where it can be told to.
  kRefused,
  /// An Uplink without content.
  kEmpty,
  /// A fault with a long text, of a greedy agent.
  kLarge,
  /// The first of what robots may share: kSpatials of them.
  kSpatial,
};

/// What is said of a shape or an object.
enum class Spatial : std::uint8_t {
  kDeleted,
  kForRobot,
  kForUser,
  kForFleet,
  /// The same, elsewhere.
  kForFleetMoved,
  kForWorld,
  /// These are over while a run lasts; the later one only in longer ones.
  kForFleetExpiring,
  kForWorldExpiring,
};
inline constexpr std::size_t kSpatialKinds = 8;
/// Each robot has as many shapes, and objects of the same ids.
inline constexpr std::size_t kSpatialIds = 2;
inline constexpr std::size_t kSpatialItems = 2 * kSpatialIds;
inline constexpr std::size_t kSpatials = kSpatialItems * kSpatialKinds;
inline constexpr std::size_t kContents = static_cast<std::size_t>(Content::kSpatial) + kSpatials;

/// What is said of one of a robot's items; `item` is below kSpatialItems.
[[nodiscard]] constexpr Content SpatialOf(std::size_t item, Spatial spatial) {
  return static_cast<Content>(static_cast<std::size_t>(Content::kSpatial) + item * kSpatialKinds +
                              static_cast<std::size_t>(spatial));
}

/// The item that a shape or an object names; below kSpatialItems. Only of these.
[[nodiscard]] constexpr std::size_t ItemOf(Content content) {
  return (static_cast<std::size_t>(content) - static_cast<std::size_t>(Content::kSpatial)) /
         kSpatialKinds;
}

/// True where the server may find that it had expired when it came: then nothing is stored.
[[nodiscard]] constexpr bool MayExpire(Content content) {
  if (content < Content::kSpatial) return false;
  const std::size_t number =
      static_cast<std::size_t>(content) - static_cast<std::size_t>(Content::kSpatial);
  return static_cast<Spatial>(number % kSpatialKinds) >= Spatial::kForFleetExpiring;
}

/// True where the agent must keep the message until an Ack's through_seq.
[[nodiscard]] constexpr bool KeptUntilSettled(Content content) {
  return content != Content::kMotion && content != Content::kBadLive;
}

/// True where the server must reject the message when it judges it.
[[nodiscard]] constexpr bool RejectedAtJudgement(Content content) {
  return content == Content::kBadDurable || content == Content::kBadLive ||
         content == Content::kEmpty;
}

/// The serialized payloads, made once. Immutable.
class Payloads final {
 public:
  Payloads();
  [[nodiscard]] const std::string& Of(Content content) const {
    return bytes_[static_cast<std::size_t>(content)];
  }

 private:
  void SetSpatials();

  std::array<std::string, kContents> bytes_;
};

/// The faultId that marks a record for the store's refusal.
inline constexpr char kRefusedFaultId[] = "REFUSE-ME";

}  // namespace uplink::simulation
