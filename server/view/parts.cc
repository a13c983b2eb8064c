#include "server/view/parts.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <variant>

#include "server/robot/live_parts.h"

namespace uplink::view {
namespace {

/// The JSON name of each part's field in v1::Robot.
constexpr std::array<std::string_view, kParts> kNames = {"agentInfo", "settings", "uiCapabilities",
#define UPLINK_PART(Part, column, view, Message, keys_max) view,
                                                         UPLINK_LIVE_PARTS(UPLINK_PART)
#undef UPLINK_PART
                                                             "cyberwave",
                                                         "uncrew"};

/// About how many bytes an item takes besides its texts.
constexpr std::size_t kItemBytes = 256;

template <typename Value>
std::size_t BytesOf(const Value& /*item*/) {
  return kItemBytes;
}

std::size_t BytesOf(const robot::Extra& extra) {
  const auto* text = std::get_if<std::string>(&extra.value);
  return kItemBytes + (text == nullptr ? 0 : text->size());
}

template <typename Message>
std::size_t PartBytes(const std::optional<Message>& /*part*/) {
  return 0;
}

std::size_t PartBytes(const std::optional<model::StatusTelemetry>& part) {
  if (!part) return 0;
  std::size_t bytes = part->status ? part->status->size() : 0;
  if (!part->estop) return bytes;
  for (const std::string& id : part->estop->ids) bytes += sizeof(std::string) + id.size();
  return bytes;
}

std::size_t PartBytes(const std::optional<model::RcanState>& part) {
  if (!part) return 0;
  std::size_t bytes = part->joints.size() * sizeof(model::RcanJoint);
  for (const model::RcanJoint& joint : part->joints) bytes += joint.joint.size();
  return bytes;
}

template <typename Value, std::size_t kMax>
std::size_t PartBytes(const robot::KeyedPart<Value, kMax>& part) {
  std::size_t bytes = 0;
  for (const auto& [key, value] : part.items()) bytes += key.size() + BytesOf(value);
  return bytes;
}

}  // namespace

bool PartSet::AnyOf(std::size_t first, std::size_t count) const {
  for (std::size_t i = first; i < first + count; ++i) {
    if (bits_.test(i)) return true;
  }
  return false;
}

bool PartSet::AnyStored() const { return AnyOf(0, storage::kLatestKinds); }

bool PartSet::AnyLive() const { return AnyOf(storage::kLatestKinds, storage::kLivePartKinds); }

bool PartSet::AnyLarge() const {
  bool any = false;
  robot::ForEachPart([&]<typename Tag>(Tag /*row*/) {
    if constexpr (!Tag::kSmall) any = any || Has(ToPart(Tag::kLivePart));
  });
  return any;
}

std::optional<Part> PartFromText(std::string_view text) {
  const auto* const name = std::ranges::find(kNames, text);
  if (name == kNames.end()) return std::nullopt;
  return static_cast<Part>(name - kNames.begin());
}

std::size_t KeyedBytes(const robot::LiveParts& parts) {
  std::size_t bytes = 0;
  robot::ForEachPart([&](auto /*row*/, const auto& part) { bytes += PartBytes(part); }, parts);
  return bytes;
}

}  // namespace uplink::view
