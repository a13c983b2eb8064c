#include "server/robot/live_bytes.h"

#include <cstdint>
#include <span>
#include <string_view>
#include <utility>
#include <variant>
#include <vector>

#include "schema/encode.h"
#include "schema/json/text.h"
#include "schema/rcan/judge.h"

namespace uplink::robot {
namespace {

using storage::LivePart;

constexpr std::size_t kLengthBytes = 4;
constexpr unsigned kBitsPerByte = 8;

void Append(std::string& bytes, std::string_view message) {
  auto length = static_cast<std::uint32_t>(message.size());
  for (std::size_t i = 0; i < kLengthBytes; ++i) {
    bytes.push_back(static_cast<char>(length & 0xFFU));
    length >>= kBitsPerByte;
  }
  bytes.append(message);
}

std::uint32_t LengthAt(std::string_view bytes) {
  std::uint32_t length = 0;
  for (std::size_t i = kLengthBytes; i > 0; --i) {
    length = (length << kBitsPerByte) | static_cast<unsigned char>(bytes[i - 1]);
  }
  return length;
}

/// The messages in order, without those that no longer fit beside later ones.
std::string Joined(std::vector<std::string> latest_first) {
  std::size_t size = 0;
  std::erase_if(latest_first, [&size](const std::string& message) {
    const std::size_t more = kLengthBytes + message.size();
    if (size + more > kLivePartBytesMax) return true;
    size += more;
    return false;
  });
  std::string bytes;
  bytes.reserve(size);
  for (auto message = latest_first.rbegin(); message != latest_first.rend(); ++message) {
    Append(bytes, *message);
  }
  return bytes;
}

/// The message that `value` was taken from.
template <typename Value>
model::Body BodyOf(const std::string& /*key*/, const Value& value) {
  return value;
}

model::Body BodyOf(const std::string& key, const Extra& extra) {
  model::SensorReading reading;
  reading.key = key;
  reading.value = extra.value;
  model::TelemetryExtras body;
  body.unix_time_ms = extra.sampled_at_ms;
  body.kv.push_back(std::move(reading));
  return body;
}

// One overload per type of part.
template <typename Message>
std::string PartBytes(const std::optional<Message>& part, std::string_view /*ruri*/) {
  if (!part) return {};
  return Joined({schema::Encode(*part)});
}

std::string PartBytes(const std::optional<model::RcanState>& part, std::string_view ruri) {
  if (!part) return {};
  return Joined({json::Text(*part, ruri)});
}

template <typename Value, std::size_t kMax>
std::string PartBytes(const KeyedPart<Value, kMax>& part, std::string_view /*ruri*/) {
  std::vector<std::string> messages;
  messages.reserve(part.items().size());
  for (auto item = part.items().rbegin(); item != part.items().rend(); ++item) {
    messages.push_back(schema::Encode(BodyOf(item->first, item->second)));
  }
  return Joined(std::move(messages));
}

/// Judges one message of a part and puts it into `read`; false if the rules reject it.
bool TakeMessage(LivePart part, std::string_view message, std::string_view ruri,
                 schema::Judge& judge, LiveRead& read) {
  if (part == LivePart::kRcan) {
    schema::RcanJudgement judgement =
        schema::JudgeRcanState(message, ruri, kLivePartBytesMax, schema::TextForm::kAsKept);
    auto* state = std::get_if<model::RcanState>(&judgement.verdict);
    if (state == nullptr) return false;
    read.before.parts.rcan = std::move(*state);
    return true;
  }
  schema::Judgement judgement = judge.Payload(std::as_bytes(std::span(message)));
  auto* record = std::get_if<model::Record>(&judgement.verdict);
  if (record == nullptr || record->durable()) return false;
  PutInto(read.before.parts, std::move(*record).TakeBody());
  return true;
}

/// Puts the messages of a part into `read`.
void TakePart(LivePart part, std::string_view bytes, std::string_view ruri, schema::Judge& judge,
              LiveRead& read) {
  while (!bytes.empty()) {
    if (bytes.size() < kLengthBytes || bytes.size() - kLengthBytes < LengthAt(bytes)) {
      ++read.left_out;
      return;
    }
    const std::string_view message = bytes.substr(kLengthBytes, LengthAt(bytes));
    bytes.remove_prefix(kLengthBytes + message.size());
    if (!TakeMessage(part, message, ruri, judge, read)) ++read.left_out;
  }
}

}  // namespace

storage::LiveRow ToRow(std::string ruri, const LiveChanges& changes) {
  storage::LiveRow row;
  row.ruri = std::move(ruri);
  row.last_sign_of_life = changes.last_sign_of_life;
  row.clock_skew_ms = changes.clock_skew_ms;
  ForEachPart(
      [&]<typename Tag>(Tag /*row*/, const auto& part) {
        if (changes.changed.test(Tag::kIndex)) row.parts[Tag::kIndex] = PartBytes(part, row.ruri);
      },
      changes.parts);
  return row;
}

LiveRead FromRow(const storage::LiveRow& row, schema::Judge& judge) {
  LiveRead read;
  read.before.last_sign_of_life = row.last_sign_of_life;
  read.before.clock_skew_ms = row.clock_skew_ms;
  for (std::size_t kind = 0; kind < storage::kLivePartKinds; ++kind) {
    if (const auto& part = row.parts[kind]) {
      TakePart(static_cast<LivePart>(kind), *part, row.ruri, judge, read);
    }
  }
  return read;
}

schema::JudgeLimits JudgeLimitsOfLive() {
  schema::JudgeLimits limits;
  limits.payload_bytes_max = kLivePartBytesMax;
  limits.message_bytes_max = kLivePartBytesMax;
  limits.extras_items_max = 1;
  limits.texts = schema::TextForm::kAsKept;
  return limits;
}

}  // namespace uplink::robot
