#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/mqtt/conversation.h"
#include "server/mqtt/link.h"
#include "server/mqtt/listener.h"
#include "server/mqtt/probe.h"
#include "server/mqtt/reconnect.h"
#include "server/mqtt/settings.h"
#include "server/mqtt/status.h"
#include "server/mqtt/subscriptions.h"
#include "server/mqtt/unacked.h"

namespace uplink::mqtt {

/// A subscriber: one connection to a broker, made anew whenever it ends. It passes messages to its
/// listener, and acks those at QoS 1 once the listener releases them, in the order of arrival.
///
/// Errors:  faults of the broker and the network end a connection, for a named reason (EndReason),
///          never the client.
/// Limits:  limits.h, and those of the settings.
/// Thread:  confined to that of its links; status() from any.
class Client final : private LinkEvents, private ConversationEvents {
 public:
  /// The parts that it uses; all of them outlive the client.
  struct Parts {
    ClientListener& listener;
    ClientProbe& probe;
    const Clock& clock;
    /// Evenly drawn numbers, for the pauses.
    std::function<std::uint64_t()> random;
    MakeLink make_link;
    /// Shared by all clients of the process.
    ConnectionNumbers& numbers;
    /// Asked before each connection, and again each kGatePause until it returns true; empty:
    /// always.
    std::function<bool()> may_connect{};
  };
  /// Errors: those of CheckSettings.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<Client>> Create(ClientSettings settings,
                                                                      Parts parts);
  /// Stops.
  ~Client() override;
  Client(const Client&) = delete;
  Client& operator=(const Client&) = delete;

  /// Connects, from now on until Stop.
  void Start();
  /// Disconnects and ends. The broker keeps a kept session.
  void Stop();

  /// Sets the subscriptions; `gone`: topics that a broker may hold from before our start, and that
  /// are no longer wanted.
  ///
  /// Errors: those of CheckFilters; nothing changes.
  [[nodiscard]] absl::Status SetFilters(const std::vector<Filter>& filters,
                                        const std::vector<std::string>& gone = {});

  /// The message is settled: its PUBACK goes out after those before it. No effect for a handle of
  /// an older connection or another client, or one that was released.
  void Release(const AckHandle& handle) { Release(std::span(&handle, 1)); }
  /// Releases all of them, with their PUBACKs in one write if possible.
  void Release(std::span<const AckHandle> handles);

  /// Sends a message at QoS 0, not retained. False, and counted, if it was dropped: there is no
  /// connection, kQueueBytesMax already wait, or it is too large for the broker.
  bool Publish(const Outgoing& message);

  /// Stops reading until ReadAgain, also on later connections; meanwhile a late PINGRESP is no
  /// failure.
  void StopReading();
  void ReadAgain();

  /// Ends the open connection, and makes another as after any end. Not within a call of the
  /// listener.
  void ConnectAnew(const End& end) {
    if (phase_ == Phase::kUp && !settling_) Ended(end);
  }

  /// Unread bytes from the broker (Link::unread). Its own thread.
  [[nodiscard]] std::size_t unread() const { return link_ == nullptr ? 0 : link_->unread(); }
  /// How long the oldest ping has had no answer, even if other bytes come: so far behind are the
  /// messages that we read. Its own thread.
  [[nodiscard]] SteadyTime::duration ping_waited() const {
    return conversation_ == nullptr ? SteadyTime::duration::zero() : conversation_->ping_waited();
  }
  /// A snapshot. Thread: any.
  [[nodiscard]] ClientStatus status() const;

 private:
  enum class Phase : std::uint8_t { kStopped, kPausing, kOpening, kUp };

  Client(ClientSettings settings, Parts parts);

  void OnPhase(LinkPhase phase) override;
  void OnUp() override;
  void OnRead() override;
  void OnWritten() override;
  void OnDue() override;
  void OnDown(const End& end) override;

  // Of the conversation: noted, and passed on.
  void OnConnected(const Connected& connected) override;
  void OnSubscribed() override;
  void OnMessage(const Message& message) override { parts_.listener.OnMessage(message); }
  void OnTrouble(const Trouble& trouble) override;

  void Attempt();
  /// Lets the conversation work, then reads, writes and sets the timer as it wants.
  void Settle();
  void Ended(const End& end);
  /// Ends the link and its conversation.
  void CloseConnection(std::string farewell);
  void Arm();
  void Show(ClientState state);
  void NoteError(const std::string& text);

  const ClientSettings settings_;
  const Parts parts_;
  StatusBoard status_;
  Subscriptions subscriptions_;
  Reconnect reconnect_;

  Phase phase_ = Phase::kStopped;
  LinkPhase opening_ = LinkPhase::kResolving;
  /// When the pause, or the step of opening, ends.
  SteadyTime due_{};
  /// When the link wakes us.
  SteadyTime armed_ = SteadyTime::max();
  std::uint64_t connection_ = 0;
  std::optional<std::string> password_;
  bool had_session_;
  bool stopped_reading_ = false;
  /// Within the conversation, which must not end there.
  bool settling_ = false;
  bool reading_ = false;
  /// Bytes taken from the link's input.
  std::size_t taken_ = 0;
  std::shared_ptr<Link> link_;
  std::unique_ptr<Conversation> conversation_;
};

}  // namespace uplink::mqtt
