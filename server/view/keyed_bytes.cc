#include "server/view/keyed_bytes.h"

#include <optional>
#include <string>
#include <variant>

namespace uplink::view {
namespace {

/// About how many bytes an item holds beside its texts.
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

std::size_t KeyedBytes(const robot::LiveParts& parts) {
  std::size_t bytes = 0;
  robot::ForEachPart([&](auto /*row*/, const auto& part) { bytes += PartBytes(part); }, parts);
  return bytes;
}

}  // namespace uplink::view
