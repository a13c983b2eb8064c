#pragma once

#include <bitset>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <unordered_map>
#include <utility>

#include "schema/base/clock.h"
#include "schema/model/rcan.h"
#include "schema/model/record.h"
#include "server/robot/keyed_part.h"
#include "storage/live_parts.h"

namespace uplink::robot {

/// One reading of extras: the reading's own time, else its message's.
struct Extra {
  model::Value value;
  std::int64_t sampled_at_ms = 0;
  /// In this life of the server; the epoch if it was restored.
  SteadyTime arrived{};
};

/// A reading is kept without its key, which the checkpoint writes all the same.
[[nodiscard]] inline ItemBytes BytesOfItem(const std::string& key, const Extra& extra) {
  const std::size_t said = sizeof(extra) + model::HeldBytes(key) + model::HeldBytes(extra.value);
  return {.said = said, .held = said + kPlaceBytes};
}

/// What is held of one message: itself, but of extras their readings.
template <typename Message>
struct ValueOf {
  using Type = Message;
};
template <>
struct ValueOf<model::TelemetryExtras> {
  using Type = Extra;
};

/// A part as it is held: the latest message, or the latest of each key.
template <typename Message, std::size_t kKeysMax>
using PartOf = std::conditional_t<kKeysMax == 1, std::optional<Message>,
                                  KeyedPart<typename ValueOf<Message>::Type, kKeysMax>>;

/// The latest of each live kind (storage/live_parts.h), in stream order; no robot clock decides
/// anything. A value.
struct LiveParts {
// NOLINTNEXTLINE(bugprone-macro-parentheses): "column" is the name that is declared
#define UPLINK_PART(Part, column, view, Message, keys_max) PartOf<model::Message, keys_max> column;
  UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
};

/// A row of the table as a type.
template <storage::LivePart kPart, typename Body>
struct PartTag {
  static constexpr storage::LivePart kLivePart = kPart;
  static constexpr std::size_t kIndex = static_cast<std::size_t>(kPart);
  using Message = Body;
  /// Small enough to be copied wherever a robot is looked at: a message without a key. RCAN's state
  /// holds many joints.
  static constexpr bool kSmall =
      storage::RowOf(kPart).keys_max == 1 && !std::is_same_v<Body, model::RcanState>;
};

/// Calls `visit(tag, part...)` for each row of the table, in order: the tag is the row's PartTag,
/// then the part of each of `states`.
template <typename Visit, typename... States>
void ForEachPart(Visit visit, States&... states) {
#define UPLINK_PART(Part, column, view, Message, keys_max) \
  visit(PartTag<storage::LivePart::k##Part, model::Message>(), states.column...);
  UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
}

/// The part that a live message changes; nothing for durable kinds.
[[nodiscard]] std::optional<storage::LivePart> PartOfVariant(model::Variant variant);

/// Which live parts, by storage::LivePart.
using LivePartSet = std::bitset<storage::kLivePartKinds>;

/// Puts one live body into the parts; returns the number of keys that had to go. A body of a
/// durable kind is a mistake of ours.
std::size_t PutInto(LiveParts& parts, model::Body&& body, SteadyTime arrived = {});

/// Memory of one part beside the robot's own; nothing of one that is empty.
[[nodiscard]] std::size_t HeldBytes(const LiveParts& parts, storage::LivePart part);

}  // namespace uplink::robot
