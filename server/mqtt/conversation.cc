#include "server/mqtt/conversation.h"

#include <algorithm>
#include <limits>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "server/mqtt/encode.h"
#include "server/mqtt/limits.h"
#include "server/mqtt/reason_codes.h"

namespace uplink::mqtt {
namespace {

/// Our PUBLISH is never larger than this beside its fields.
constexpr std::size_t kFrameBytes = 32;

}  // namespace

Conversation::Conversation(const Context& context, Beginning beginning)
    : context_(context),
      connection_(beginning.connection),
      had_session_(beginning.had_session),
      wire_(context.settings.version, context.settings.payload_bytes_max),
      unacked_(beginning.connection, context.settings.unacked_max),
      outbox_(kQueueBytesMax),
      exchange_(context.settings.version, context.subscriptions, context.probe,
                context.settings.waits.refused),
      keepalive_(context.settings.keepalive, context.settings.waits.ping, context.clock.Steady()),
      asked_at_(context.clock.Steady()),
      heard_at_(context.clock.Steady()),
      packet_bytes_max_(std::numeric_limits<std::uint32_t>::max()) {
  outbox_.Add(ConnectBytes(beginning));
}

Conversation::~Conversation() {
  // Gauges of a connection end with it.
  context_.probe.unacked.Set(0);
  context_.probe.stopped_by_window.Set(0);
  context_.probe.stopped_by_output.Set(0);
  if (accepted_at_) context_.probe.connected.Set(0);
}

std::string Conversation::ConnectBytes(Beginning& beginning) const {
  const ClientSettings& settings = context_.settings;
  Connect connect{.version = settings.version,
                  .client_id = settings.client_id,
                  .clean = !settings.kept_session,
                  .keepalive_seconds = static_cast<std::uint16_t>(settings.keepalive.count()),
                  .password = std::move(beginning.password),
                  .receive_maximum = static_cast<std::uint16_t>(settings.unacked_max)};
  if (!settings.username.empty()) connect.username = settings.username;
  if (settings.kept_session) {
    connect.session_expiry_seconds = static_cast<std::uint32_t>(settings.session_expiry.count());
  }
  if (settings.announced_packet_bytes_max > 0) {
    connect.packet_bytes_max = settings.announced_packet_bytes_max;
  }
  return EncodeConnect(connect);
}

void Conversation::NoteHeard() {
  heard_at_ = context_.clock.Steady();
  keepalive_.NoteHeard(heard_at_);
}

std::size_t Conversation::Take(std::string_view bytes) {
  const std::size_t size = bytes.size();
  while (!end_ && reading()) {
    const Wire::Step step = wire_.Take(bytes);
    bytes.remove_prefix(step.taken);
    if (std::holds_alternative<Wire::More>(step.found)) break;
    if (const auto* fault = std::get_if<Fault>(&step.found)) {
      Finish(fault->reason, fault->text);
    } else if (const auto* opened = std::get_if<Wire::Opened>(&step.found)) {
      at_qos1_ = opened->is_qos1;
    } else {
      at_qos1_ = false;
      TakePacket(std::get<Packet>(step.found));
    }
  }
  FollowReading();
  return size - bytes.size();
}

void Conversation::TakePacket(const Packet& packet) {
  if (!accepted_at_ && !std::holds_alternative<Connack>(packet)) {
    return Finish(EndReason::kUnexpectedPacket, "a packet before CONNACK");
  }
  std::visit([this](const auto& each) { Handle(each); }, packet);
}

void Conversation::Handle(const Connack& connack) {
  const Version version = context_.settings.version;
  if (accepted_at_) return Finish(EndReason::kUnexpectedPacket, "a second CONNACK");
  asked_at_.reset();
  if (connack.code != 0) {
    return Finish(EndReason::kRefused,
                  "the broker refuses: " + ConnackText(version, connack.code, connack.reason));
  }
  if (connack.session_present && !context_.settings.kept_session) {
    return Finish(EndReason::kUnexpectedAnswer, "a session goes on, though we asked for none");
  }
  Accept(connack);
}

void Conversation::Accept(const Connack& connack) {
  accepted_at_ = context_.clock.Steady();
  context_.probe.accepted.Add();
  context_.probe.connected.Set(1);
  if (connack.packet_bytes_max) packet_bytes_max_ = *connack.packet_bytes_max;
  if (connack.server_keepalive_seconds) {
    keepalive_.SetInterval(std::chrono::seconds(*connack.server_keepalive_seconds));
  }
  const bool lost = context_.settings.kept_session && had_session_ && !connack.session_present;
  context_.subscriptions.Begin(connack.session_present);
  context_.listener.OnConnected({connection_, connack.session_present, lost});
  TellOfSession(connack, lost);
  AskOn();
}

void Conversation::TellOfSession(const Connack& connack, bool lost) {
  if (lost) {
    context_.probe.sessions_lost.Add();
    context_.listener.OnTrouble(
        {Trouble::Kind::kSessionLost,
         "the broker lost the session: what it held for us does not come again"});
  }
  const auto kept = connack.session_expiry_seconds;
  const auto asked = context_.settings.session_expiry.count();
  if (!context_.settings.kept_session || !kept || *kept >= asked) return;
  context_.probe.sessions_short.Add();
  context_.listener.OnTrouble({Trouble::Kind::kSessionShort,
                               "the broker keeps the session for " + std::to_string(*kept) +
                                   " s, and not for the " + std::to_string(asked) +
                                   " s of mqtt.session_expiry: a longer absence loses messages"});
}

void Conversation::Handle(const mqtt::Publish& message) {
  ClientProbe& probe = context_.probe;
  probe.messages[static_cast<std::size_t>(message.qos)].Add();
  probe.payload_bytes.Add(static_cast<std::int64_t>(message.payload_bytes));
  if (message.dup) probe.dups.Add();
  if (message.retained) probe.retained.Add();
  if (!message.payload) probe.oversized.Add();
  if (message.bad_topic) probe.bad_topics.Add();
  if (message.qos == Qos::kAtMostOnce) {
    return context_.listener.OnMessage({.publish = message});
  }
  const Unacked::Delivery delivery = unacked_.Add(message.id, message.dup);
  if (delivery.again) probe.redelivered.Add();
  if (!delivery.handle) probe.crossed.Add();
  probe.unacked.Set(static_cast<std::int64_t>(unacked_.size()));
  context_.listener.OnMessage({message, delivery.handle, delivery.again});
}

void Conversation::Handle(const Suback& answer) {
  const auto found = exchange_.Answered(answer);
  if (const auto* fault = std::get_if<Fault>(&found)) return Finish(fault->reason, fault->text);
  for (const Subscriptions::Lack& lack : std::get<std::vector<Subscriptions::Lack>>(found)) {
    context_.listener.OnTrouble(
        {IsRefused(lack) ? Trouble::Kind::kFilterRefused : Trouble::Kind::kLowerQos,
         LackText(lack)});
  }
  AskOn();
}

void Conversation::Handle(const Unsuback& answer) {
  if (const auto fault = exchange_.Answered(answer)) return Finish(fault->reason, fault->text);
  AskOn();
}

void Conversation::Handle(const Pingresp& /*answer*/) { keepalive_.Ponged(); }

void Conversation::Handle(const Disconnect& farewell) {
  const bool taken = farewell.code == kSessionTakenOver;
  Finish(taken ? EndReason::kIdTaken : EndReason::kDisconnected,
         "the broker disconnects: " + ReasonText(farewell.code, farewell.reason));
}

void Conversation::AskOn() {
  asked_at_.reset();
  Ask();
  if (asked_at_ || subscribed_) return;
  subscribed_ = true;
  context_.listener.OnSubscribed();
}

void Conversation::Ask() {
  if (!accepted_at_ || asked_at_ || end_) return;
  const SteadyTime now = context_.clock.Steady();
  outbox_.Add(exchange_.Next(now));
  if (!exchange_.waiting()) return;
  subscribed_ = false;
  asked_at_ = now;
}

void Conversation::StopReading() {
  stopped_by_core_ = true;
  FollowReading();
}

void Conversation::ReadAgain() {
  stopped_by_core_ = false;
  FollowReading();
}

void Conversation::FollowReading() {
  const bool shut = window_is_shut();
  if (shut && context_.probe.stopped_by_window.value() == 0) context_.probe.window_stops.Add();
  context_.probe.stopped_by_window.Set(shut ? 1 : 0);
  context_.probe.stopped_by_output.Set(outbox_.full() ? 1 : 0);
  if (reading() == was_reading_) return;
  was_reading_ = reading();
  if (!was_reading_) return keepalive_.StopReading();
  // Bytes that came meanwhile were not read, so every wait begins anew.
  heard_at_ = context_.clock.Steady();
  keepalive_.ReadAgain(heard_at_);
}

void Conversation::Release(const AckHandle& handle) {
  if (handle.connection != connection_) return context_.probe.releases_late.Add();
  for (const PacketId id : unacked_.Release(handle)) {
    outbox_.Add(EncodePuback(id));
    context_.probe.pubacks.Add();
  }
  context_.probe.unacked.Set(static_cast<std::int64_t>(unacked_.size()));
  FollowReading();
}

bool Conversation::Publish(const Outgoing& message) {
  const std::size_t bytes =
      message.topic.size() + message.payload.size() + message.correlation.size() + kFrameBytes;
  const bool sayable = !message.topic.empty() && message.topic.size() <= kFieldBytesMax &&
                       message.correlation.size() <= kFieldBytesMax;
  const bool sent = accepted_at_ && !end_ && sayable && bytes <= packet_bytes_max_ &&
                    outbox_.AddIfRoom(EncodePublish(context_.settings.version, message));
  (sent ? context_.probe.published : context_.probe.publishes_dropped).Add();
  return sent;
}

std::string Conversation::TakeOutput() {
  if (outbox_.writing() || !outbox_.waiting()) return {};
  wrote_at_ = context_.clock.Steady();
  keepalive_.Sent(wrote_at_);
  return outbox_.Take();
}

SteadyTime Conversation::AnswerLateAt() const {
  if (!asked_at_ || !reading()) return SteadyTime::max();
  return std::max(*asked_at_, heard_at_) + context_.settings.waits.answer;
}

SteadyTime Conversation::WriteLateAt() const {
  return outbox_.writing() ? wrote_at_ + context_.settings.waits.write : SteadyTime::max();
}

SteadyTime Conversation::Next() const {
  SteadyTime next = std::min(AnswerLateAt(), WriteLateAt());
  if (accepted_at_) next = std::min(next, keepalive_.Next());
  const auto retry_at = exchange_.retry_at();
  return retry_at && !exchange_.waiting() ? std::min(next, *retry_at) : next;
}

void Conversation::Tick() {
  const SteadyTime now = context_.clock.Steady();
  if (now >= WriteLateAt()) {
    return Finish(EndReason::kWriteStalled, "the broker does not take what we write");
  }
  if (now >= AnswerLateAt()) {
    return Finish(EndReason::kTimeout,
                  accepted_at_ ? "no answer to what we subscribed to" : "no CONNACK");
  }
  if (!accepted_at_) return;
  switch (keepalive_.At(now)) {
    case Keepalive::Due::kNothing:
      break;
    case Keepalive::Due::kPing:
      outbox_.Add(EncodePingreq());
      keepalive_.Pinged(now);
      break;
    case Keepalive::Due::kLate:
      return Finish(EndReason::kPingLate, "no PINGRESP, and nothing else");
  }
  const auto retry_at = exchange_.retry_at();
  if (retry_at && now >= *retry_at && !exchange_.waiting()) {
    exchange_.Retry();
    Ask();
  }
}

void Conversation::Finish(EndReason reason, std::string text) {
  if (!end_) end_ = End{reason, std::move(text)};
}

}  // namespace uplink::mqtt
