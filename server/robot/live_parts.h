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

/// One reading of extras, with its own time, or else its message's.
struct Extra {
  model::Value value;
  std::int64_t sampled_at_ms = 0;
  /// When it arrived since the server's start; the epoch if it was restored.
  SteadyTime arrived{};
};

/// For a reading, which is kept without its key; the checkpoint writes the key too.
[[nodiscard]] inline ItemBytes BytesOfItem(const std::string& key, const Extra& extra) {
  const std::size_t content = sizeof(extra) + model::HeldBytes(key) + model::HeldBytes(extra.value);
  return {.content = content, .held = content + kPlaceBytes};
}

/// What is held of one message: the message, or the readings of extras.
template <typename Message>
struct ValueOf {
  using Type = Message;
};
template <>
struct ValueOf<model::TelemetryExtras> {
  using Type = Extra;
};

/// The type of a part: the latest message, or the latest of each key.
template <typename Message, std::size_t kKeysMax>
using PartOf = std::conditional_t<kKeysMax == 1, std::optional<Message>,
                                  KeyedPart<typename ValueOf<Message>::Type, kKeysMax>>;

/// The latest of each live kind (storage/live_parts.h), in the order of the stream; robots' clocks
/// do not matter. A value.
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
  /// Small enough to copy at each look at a robot: a message without keys, except RCAN's state,
  /// which holds many joints.
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

/// The part that a live message changes; empty for durable kinds.
[[nodiscard]] std::optional<storage::LivePart> PartOfVariant(model::Variant variant);

/// A set of live parts, by storage::LivePart.
using LivePartSet = std::bitset<storage::kLivePartKinds>;

/// Puts one live body into the parts; returns the number of evicted keys. A body of a durable kind
/// is our bug.
std::size_t PutInto(LiveParts& parts, model::Body&& body, SteadyTime arrived = {});

/// Memory of one part beside the robot's own; 0 if it is empty.
[[nodiscard]] std::size_t HeldBytes(const LiveParts& parts, storage::LivePart part);

}  // namespace uplink::robot
