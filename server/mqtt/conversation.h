#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "server/mqtt/asking.h"
#include "server/mqtt/keepalive.h"
#include "server/mqtt/listener.h"
#include "server/mqtt/outbox.h"
#include "server/mqtt/packets.h"
#include "server/mqtt/probe.h"
#include "server/mqtt/settings.h"
#include "server/mqtt/subscriptions.h"
#include "server/mqtt/unacked.h"
#include "server/mqtt/wire.h"

namespace uplink::mqtt {

/// What one connection says and hears, from CONNECT on: bytes in, bytes out, and when it wants to
/// be called. It has no socket and no timer, and it never fails: it ends, and says why.
///
/// Limits:  those of Wire, Unacked, Outbox and Subscriptions.
/// Thread:  confined to its client's.
class Conversation final {
 public:
  /// What it works with; all of it outlives it.
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
    /// The broker ought to have a session of ours.
    bool had_session = false;
  };
  Conversation(const Context& context, Beginning beginning);
  ~Conversation();
  Conversation(const Conversation&) = delete;
  Conversation& operator=(const Conversation&) = delete;

  /// New bytes came; Take is to be given them.
  void NoteHeard();
  /// Takes bytes and tells the listener, until they are used up, reading is to stop or the
  /// connection ends. Returns how many it took. It is to be called again when reading() is true
  /// again, even with no bytes.
  [[nodiscard]] std::size_t Take(std::string_view bytes);
  [[nodiscard]] bool reading() const {
    return !stopped_by_core_ && !window_is_shut() && !outbox_.full();
  }

  void StopReading();
  void ReadAgain();
  void Release(const AckHandle& handle);
  /// False: it was dropped.
  bool Publish(const Outgoing& message);
  /// Takes no more bytes.
  void Leave() { Finish(EndReason::kStopped, {}); }
  /// The subscriptions may have something to ask.
  void Ask();

  /// Does what is due.
  void Tick();
  [[nodiscard]] SteadyTime Next() const;
  /// How long the oldest ping has no answer.
  [[nodiscard]] SteadyTime::duration ping_waited() const {
    return keepalive_.Waited(context_.clock.Steady());
  }

  /// All that is to be written now; one write at a time. Empty: nothing, or one is under way.
  [[nodiscard]] std::string TakeOutput();
  void Written() { outbox_.Written(); }
  /// What waits to be written, at the end of the connection.
  [[nodiscard]] std::string TakeRest() { return outbox_.Take(); }

  /// Why it ended; nothing as long as it did not.
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
  /// Tells what of the session is not as it was asked for.
  void TellOfSession(const Connack& connack, bool lost);
  /// After an answer: asks on, or tells that all was answered.
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
  Asking asking_;
  Keepalive keepalive_;

  std::optional<SteadyTime> accepted_at_;
  bool subscribed_ = false;
  /// A PUBLISH at QoS 1 begins, which the window has room for or not.
  bool at_qos1_ = false;
  bool stopped_by_core_ = false;
  bool was_reading_ = true;
  /// Since when a CONNACK, SUBACK or UNSUBACK is waited for; nothing if none is.
  std::optional<SteadyTime> asked_at_;
  SteadyTime heard_at_;
  SteadyTime wrote_at_{};
  /// Of our packets, as the broker says.
  std::uint32_t packet_bytes_max_;
  std::optional<End> end_;
};

}  // namespace uplink::mqtt
