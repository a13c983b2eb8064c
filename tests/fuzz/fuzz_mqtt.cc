#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <variant>

#include "schema/base/check.h"
#include "server/mqtt/limits.h"
#include "server/mqtt/wire.h"

namespace uplink::mqtt {
namespace {

constexpr std::size_t kPayloadMax = 100;

/// What was found, so that two ways of cutting can be compared.
struct Found {
  std::string text;
  std::size_t taken = 0;
};

void Add(std::string& text, std::string_view field) {
  text += std::to_string(field.size());
  text += ':';
  text.append(field);
  text += ' ';
}

void Add(std::string& text, const Packet& packet) {
  text += std::to_string(packet.index()) + ' ';
  if (const auto* message = std::get_if<Publish>(&packet)) {
    UPLINK_CHECK(message->topic.size() <= kFieldBytesMax, "bounded");
    UPLINK_CHECK(!message->topic.empty() || message->bad_topic, "a topic, or told that it is none");
    UPLINK_CHECK((message->id != 0) == (message->qos == Qos::kAtLeastOnce), "an id at QoS 1");
    const bool wanted = !message->head_unread && message->payload_bytes <= kPayloadMax;
    UPLINK_CHECK(message->payload.has_value() == wanted,
                 "a payload within the bound, and no other");
    UPLINK_CHECK(!message->payload || message->payload->size() == message->payload_bytes, "whole");
    UPLINK_CHECK(message->correlation.size() <= kCorrelationBytesMax, "bounded");
    Add(text, message->topic);
    Add(text, message->payload.value_or("-"));
    Add(text, message->correlation);
    text += std::to_string(message->id) + ' ' + std::to_string(message->payload_bytes) +
            (message->dup ? " dup" : "") + (message->retained ? " retained" : "") +
            (message->has_response_topic ? " response" : "") + (message->bad_topic ? " bad" : "") +
            (message->head_unread ? " headless" : "");
  } else if (const auto* connack = std::get_if<Connack>(&packet)) {
    Add(text, connack->reason);
    text += std::to_string(connack->code) + (connack->session_present ? " present" : "");
  } else if (const auto* suback = std::get_if<Suback>(&packet)) {
    Add(text, suback->codes);
  } else if (const auto* unsuback = std::get_if<Unsuback>(&packet)) {
    Add(text, unsuback->codes);
  } else if (const auto* farewell = std::get_if<Disconnect>(&packet)) {
    Add(text, farewell->reason);
  }
  text += '\n';
}

enum class After : std::uint8_t { kGoesOn, kNeedsMore, kBroken };

/// Takes the next thing from the bytes that are there, and shortens them.
After TakeOne(Wire& wire, std::string_view& next, Found& found) {
  const Wire::Step step = wire.Take(next);
  UPLINK_CHECK(step.taken <= next.size(), "no more is taken than there is");
  UPLINK_CHECK(wire.kept_bytes() <= kHeadBytesMax + kPayloadMax + kAnswerBytesMax, "bounded");
  next.remove_prefix(step.taken);
  found.taken += step.taken;
  if (std::holds_alternative<Wire::More>(step.found)) {
    UPLINK_CHECK(next.empty(), "More means that all was taken");
    return After::kNeedsMore;
  }
  if (const auto* packet = std::get_if<Packet>(&step.found)) Add(found.text, *packet);
  const auto* const fault = std::get_if<Fault>(&step.found);
  if (fault == nullptr) return After::kGoesOn;
  found.text += Name(fault->reason);
  return After::kBroken;
}

/// Gives the bytes to a reader, so many at once. A copy of each piece, of exactly its size, so that
/// a sanitizer sees a read past it.
Found ReadIn(Version version, std::string_view bytes, std::size_t piece) {
  Wire wire(version, kPayloadMax);
  Found found;
  After after = After::kNeedsMore;
  while (after != After::kBroken && found.taken < bytes.size()) {
    const std::string copy(bytes.substr(found.taken, piece));
    std::string_view next = copy;
    do {
      after = TakeOne(wire, next, found);
    } while (after == After::kGoesOn);
  }
  return found;
}

}  // namespace

void CheckCuts(Version version, std::string_view bytes, std::size_t cut) {
  const Found whole = ReadIn(version, bytes, bytes.size() + 1);
  for (const std::size_t piece : {std::size_t{1}, cut}) {
    UPLINK_CHECK(ReadIn(version, bytes, piece).text == whole.text, "the same however it is cut");
  }
}

}  // namespace uplink::mqtt

/// However the bytes of a broker are cut, the same is found in them. The first byte says by which
/// version, and one of the cuts.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  if (size == 0) return 0;
  using uplink::mqtt::Version;
  const Version version = (data[0] & 1U) == 0 ? Version::k311 : Version::k5;
  const std::size_t cut = std::size_t{1} + (data[0] >> 1U);
  const std::string_view bytes(reinterpret_cast<const char*>(data) + 1, size - 1);
  uplink::mqtt::CheckCuts(version, bytes, cut);
  return 0;
}
