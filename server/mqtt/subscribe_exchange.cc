#include "server/mqtt/subscribe_exchange.h"

#include <limits>

#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "server/mqtt/encode.h"
#include "server/mqtt/reason_codes.h"

namespace uplink::mqtt {
namespace {

constexpr std::uint8_t kRefusal = 0x80;

}  // namespace

std::string SubscribeExchange::Next(SteadyTime now) {
  if (waiting_) return {};
  probe_.filters_refused.Set(static_cast<std::int64_t>(subscriptions_.refused()));
  probe_.filters_lower.Set(static_cast<std::int64_t>(subscriptions_.lower()));
  const auto ask = subscriptions_.Next();
  if (!ask) {
    retry_at_.reset();
    if (subscriptions_.refused() > 0) retry_at_ = now + retry_;
    return {};
  }
  waiting_ = true;
  id_ = id_ == std::numeric_limits<PacketId>::max() ? PacketId{1} : static_cast<PacketId>(id_ + 1);
  if (ask->subscribe) return EncodeSubscribe(version_, id_, ask->filters);
  std::vector<std::string> topics;
  for (const Filter& filter : ask->filters) topics.push_back(filter.topic);
  return EncodeUnsubscribe(version_, id_, topics);
}

Decoded<std::vector<Subscriptions::Lack>> SubscribeExchange::Answered(const Suback& answer) {
  if (!waiting_ || answer.id != id_ || !subscriptions_.asked_to_subscribe()) {
    return Fault{EndReason::kUnexpectedAnswer, "a SUBACK to nothing that was asked"};
  }
  auto lacks = subscriptions_.Answered(answer.codes);
  if (!lacks) return Fault{EndReason::kUnexpectedAnswer, "a SUBACK that fits no SUBSCRIBE of ours"};
  waiting_ = false;
  for (const Subscriptions::Lack& lack : *lacks) {
    (IsRefused(lack) ? probe_.refusals : probe_.lower_grants).Add();
  }
  return *std::move(lacks);
}

std::optional<Fault> SubscribeExchange::Answered(const Unsuback& answer) {
  if (!waiting_ || answer.id != id_ || subscriptions_.asked_to_subscribe()) {
    return Fault{EndReason::kUnexpectedAnswer, "an UNSUBACK to nothing that was asked"};
  }
  waiting_ = false;
  subscriptions_.Unsubscribed();
  return std::nullopt;
}

void SubscribeExchange::Retry() {
  retry_at_.reset();
  subscriptions_.RetryRefused();
}

bool IsRefused(const Subscriptions::Lack& lack) { return lack.code >= kRefusal; }

std::string LackText(const Subscriptions::Lack& lack) {
  constexpr std::size_t kShownBytesMax = 128;
  const std::string topic = PrintableUtf8(lack.filter.topic, kShownBytesMax);
  if (!IsRefused(lack)) return fmt::format("the broker serves {} at QoS {} only", topic, lack.code);
  return fmt::format("the broker refuses {}: {}", topic, ReasonText(lack.code, {}));
}

}  // namespace uplink::mqtt
