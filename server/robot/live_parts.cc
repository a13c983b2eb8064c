#include "server/robot/live_parts.h"

#include <array>
#include <string>
#include <type_traits>
#include <utility>
#include <variant>

#include "schema/base/check.h"

namespace uplink::robot {
namespace {

/// The part that such a message changes; empty for durable kinds.
template <typename Message>
constexpr std::optional<storage::LivePart> PartOfMessage() {
#define UPLINK_PART(Part, column, view, Brings, keys_max) \
  if (std::is_same_v<Message, model::Brings>) return storage::LivePart::k##Part;
  UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
  return std::nullopt;
}

template <std::size_t... kVariant>
constexpr auto PartsByVariant(std::index_sequence<kVariant...> /*variants*/) {
  return std::array{PartOfMessage<std::variant_alternative_t<kVariant, model::Body>>()...};
}

constexpr auto kPartOfVariant = PartsByVariant(std::make_index_sequence<model::kVariants>());

/// One overload per way in which a message enters its part.
struct Into {
  SteadyTime arrived;

  template <typename Message>
  std::size_t operator()(std::optional<Message>& part, Message&& message) const {
    part = std::forward<Message>(message);
    return 0;
  }
  std::size_t operator()(std::optional<model::StatusTelemetry>& part,
                         model::StatusTelemetry&& message) const {
    // A copy: the text goes into the previous one's memory, and the message keeps its own for reuse
    // (schema::Judge::Reuse).
    part = std::as_const(message);
    return 0;
  }
  template <typename Message, std::size_t kMax>
  std::size_t operator()(KeyedPart<Message, kMax>& part, Message&& message) const {
    std::string key = KeyOf(message);
    return part.Put(std::move(key), std::forward<Message>(message));
  }
  template <std::size_t kMax>
  std::size_t operator()(KeyedPart<Extra, kMax>& part, model::TelemetryExtras&& message) const {
    std::size_t evicted = 0;
    for (model::SensorReading& reading : message.kv) {
      const std::int64_t sampled = reading.unix_time_ms.value_or(message.unix_time_ms);
      evicted += part.Put(
          std::move(reading.key),
          {.value = std::move(reading.value), .sampled_at_ms = sampled, .arrived = arrived});
    }
    return evicted;
  }
};

// One overload per type of part.
template <typename Message>
std::size_t PartBytes(const std::optional<Message>& part) {
  return part ? model::HeldBytes(*part) : 0;
}

template <typename Value, std::size_t kMax>
std::size_t PartBytes(const KeyedPart<Value, kMax>& part) {
  return part.held_bytes();
}

}  // namespace

std::optional<storage::LivePart> PartOfVariant(model::Variant variant) {
  return kPartOfVariant[static_cast<std::size_t>(variant)];
}

std::size_t PutInto(LiveParts& parts, model::Body&& body, SteadyTime arrived) {
  return std::visit(
      [&parts, arrived]<typename Message>(Message&& message) -> std::size_t {
#define UPLINK_PART(Part, column, view, Brings, keys_max)               \
  if constexpr (std::is_same_v<std::decay_t<Message>, model::Brings>) { \
    return Into{arrived}(parts.column, std::forward<Message>(message)); \
  }
        UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
        UPLINK_CHECK(PartOfMessage<std::decay_t<Message>>().has_value(),
                     "only live kinds are applied");
        return 0;
      },
      std::move(body));
}

std::size_t HeldBytes(const LiveParts& parts, storage::LivePart part) {
  std::size_t held = 0;
  ForEachPart(
      [&]<typename Tag>(Tag /*row*/, const auto& each) {
        if (Tag::kLivePart == part) held = PartBytes(each);
      },
      parts);
  return held;
}

}  // namespace uplink::robot
