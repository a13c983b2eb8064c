#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "server/mqtt/keepalive.h"
#include "server/mqtt/listener.h"
#include "server/mqtt/outbox.h"
#include "server/mqtt/packets.h"
#include "server/mqtt/probe.h"
#include "server/mqtt/settings.h"
#include "server/mqtt/subscribe_exchange.h"
#include "server/mqtt/subscriptions.h"
#include "server/mqtt/unacked.h"
#include "server/mqtt/wire.h"

namespace uplink::mqtt {

/// The protocol of one connection, from CONNECT on: bytes in, bytes out, and when it wants to be
/// called. It has no socket and no timer. It never fails: it ends, with a reason.
///
/// Limits:  those of Wire, Unacked, Outbox and Subscriptions.
/// Thread:  confined to its client's.
class Conversation final {
 public:
  /// The parts that it uses; all of them outlive it.
  struct Context {
    const ClientSettings& settings;
    Subscriptions& subscriptions;
    ConversationEvents& listener;
    ClientProbe& probe;
    const Clock& clock;
  };
  struct Beginning {
    std::uint64_t connection = 0;
    std::optional<std::string> password;
    /// The broker should have a session of ours.
    bool had_session = false;
  };
  Conversation(const Context& context, Beginning beginning);
  ~Conversation();
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  /// New bytes came; give them to Take.
  void NoteHeard();
  /// Takes bytes and calls the listener, until the bytes are used up, reading must stop or the
  /// connection ends. Returns how many it took. Call it again when reading() is true again, even
  /// without bytes.
  [[nodiscard]] std::size_t Take(std::string_view bytes);
  [[nodiscard]] bool reading() const {
    return !stopped_by_core_ && !window_is_shut() && !outbox_.full();
  }

  void StopReading();
  void ReadAgain();
  void Release(const AckHandle& handle);
  /// False if it was dropped.
  bool Publish(const Outgoing& message);
  /// Takes no more bytes.
  void Leave() { Finish(EndReason::kStopped, {}); }
  /// The subscriptions may have something to ask.
  void Ask();

  /// Does what is due.
  void Tick();
  [[nodiscard]] SteadyTime Next() const;
  /// How long the oldest ping has had no answer.
  [[nodiscard]] SteadyTime::duration ping_waited() const {
    return keepalive_.Waited(context_.clock.Steady());
  }

  /// The bytes to write now, one write at a time; empty if there are none or a write is under way.
  [[nodiscard]] std::string TakeOutput();
  void Written() { outbox_.Written(); }
  /// The bytes that wait to be written, at the end of the connection.
  [[nodiscard]] std::string TakeRest() { return outbox_.Take(); }

  /// Why it ended; empty until then.
  [[nodiscard]] const std::optional<End>& end() const { return end_; }
  /// When the broker accepted us.
  [[nodiscard]] std::optional<SteadyTime> accepted_at() const { return accepted_at_; }
  [[nodiscard]] bool subscribed() const { return subscribed_; }

 private:
  [[nodiscard]] bool window_is_shut() const { return at_qos1_ && unacked_.full(); }
  [[nodiscard]] std::string ConnectBytes(Beginning& beginning) const;

  void TakePacket(const Packet& packet);
  void Handle(const Connack& connack);
  void Handle(const mqtt::Publish& message);
  void Handle(const Suback& answer);
  void Handle(const Unsuback& answer);
  void Handle(const Pingresp& answer);
  void Handle(const Disconnect& farewell);
  void Accept(const Connack& connack);
  /// Reports where the session is not as it was asked for.
  void TellOfSession(const Connack& connack, bool lost);
  /// After an answer: asks the next question, or reports that all were answered.
  void AskOn();
  /// Reading stopped, or began again.
  void FollowReading();
  [[nodiscard]] SteadyTime AnswerLateAt() const;
  [[nodiscard]] SteadyTime WriteLateAt() const;
  void Finish(EndReason reason, std::string text);

  const Context context_;
  const std::uint64_t connection_;
  const bool had_session_;
  Wire wire_;
  Unacked unacked_;
  Outbox outbox_;
  SubscribeExchange exchange_;
  Keepalive keepalive_;

  std::optional<SteadyTime> accepted_at_;
  bool subscribed_ = false;
  /// A PUBLISH at QoS 1 begins, whether or not the window has room for it.
  bool at_qos1_ = false;
  bool stopped_by_core_ = false;
  bool was_reading_ = true;
  /// Since when a CONNACK, SUBACK or UNSUBACK is awaited; empty if none is.
  std::optional<SteadyTime> asked_at_;
  SteadyTime heard_at_;
  SteadyTime wrote_at_{};
  /// The broker's limit for our packets.
  std::uint32_t packet_bytes_max_;
  std::optional<End> end_;
};

}  // namespace uplink::mqtt
