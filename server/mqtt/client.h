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

/// A subscriber: one connection to a broker, made anew whenever it ends. It gives messages to its
/// listener and acks those at QoS 1 when they are released, in the order in which they came.
///
/// Errors:  what the broker and the network do wrong ends a connection, for a reason with a name
///          (EndReason); none of it ends the client.
/// Limits:  limits.h, and those of the settings.
/// Thread:  confined to that of its links; status() any.
class Client final : private LinkEvents, private ConversationEvents {
 public:
  /// What it works with; all of it outlives the client.
  struct Parts {
    ClientListener& listener;
    ClientProbe& probe;
    const Clock& clock;
    /// Evenly drawn numbers, for the pauses.
    std::function<std::uint64_t()> random;
    MakeLink make_link;
    /// The same for all clients of the process.
    ConnectionNumbers& numbers;
    /// Asked before each connection, and again each kGatePause until it may be made; empty: always.
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
  /// Says farewell and ends. A kept session stays with the broker.
  void Stop();

  /// What is subscribed to from now on; `gone`: topics that a broker may hold from before our
  /// start, and that are wanted no more.
  ///
  /// Errors: those of CheckFilters; nothing changes.
  [[nodiscard]] absl::Status SetFilters(const std::vector<Filter>& filters,
                                        const std::vector<std::string>& gone = {});

  /// The message is settled: its PUBACK goes out once those before it have. A handle of an older
  /// connection, of another client, or one that was released, does nothing.
  void Release(const AckHandle& handle) { Release(std::span(&handle, 1)); }
  /// All of them, whose PUBACKs are one write where they can be.
  void Release(std::span<const AckHandle> handles);

  /// Sends a message at QoS 0, not retained. False, and counted, if it was dropped: nobody is
  /// connected, kQueueBytesMax wait already, or the broker takes no such size.
  bool Publish(const Outgoing& message);

  /// Reads nothing until ReadAgain, over connections too; meanwhile a late PINGRESP is no failure.
  void StopReading();
  void ReadAgain();

  /// Ends the connection that is up, and makes another as after any end. Not within a call of the
  /// listener.
  void ConnectAnew(const End& end) {
    if (phase_ == Phase::kUp && !settling_) Ended(end);
  }

  /// Bytes that came from the broker and were not read yet (Link::unread). Its own thread.
  [[nodiscard]] std::size_t unread() const { return link_ == nullptr ? 0 : link_->unread(); }
  /// How long the oldest ping has no answer, though other bytes may come: so far behind is what
  /// comes. Its own thread.
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
  /// Lets the conversation work, then reads, writes and waits as it wants.
  void Settle();
  void Ended(const End& end);
  /// Ends the link and what was said over it.
  void Part(std::string farewell);
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
  /// When the pause, or the step of opening, is over.
  SteadyTime due_{};
  /// When the link wakes us.
  SteadyTime armed_ = SteadyTime::max();
  std::uint64_t connection_ = 0;
  std::optional<std::string> password_;
  bool had_session_;
  bool stopped_reading_ = false;
  /// Within the conversation, which must not be ended there.
  bool settling_ = false;
  bool reading_ = false;
  /// Of the link's input, what was taken.
  std::size_t taken_ = 0;
  std::shared_ptr<Link> link_;
  std::unique_ptr<Conversation> conversation_;
};

}  // namespace uplink::mqtt
