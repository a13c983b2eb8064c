#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "schema/base/clock.h"

namespace uplink::synthetic {

/// How a message is settled (protocol: Kinds), as its agent knows it.
enum class Keeping : std::uint8_t { kLive, kDurable };
enum class Content : std::uint8_t { kRoverNexus, kRcanRobotState, kNone };

/// A message that the agent wants delivered. A value.
struct Outgoing {
  Keeping keeping = Keeping::kLive;
  Content content = Content::kRoverNexus;
  std::string payload;
  /// The caller's own mark; comes back when the message is settled.
  std::uint64_t tag = 0;
  /// When it was to be sent.
  SteadyTime due{};
  /// What the message is the latest of (a shape's or an object's id, settings): only the latest is
  /// sent of those that wait. Empty: each one counts.
  std::string latest_of{};
};

/// Live messages that wait for a number; past it the oldest gives way (it was never numbered).
inline constexpr std::size_t kLiveWaitingMax = 256;
/// Durable messages that wait for a number; past it Offer refuses.
inline constexpr std::size_t kDurableWaitingMax = 100'000;

/// Messages that were not sent. A value.
struct Unsent {
  std::size_t messages = 0;
  /// When the one that waits longest was to be sent; empty if none waits.
  std::optional<SteadyTime> since{};

  void Add(std::size_t more, SteadyTime due) {
    messages += more;
    since = std::min(since.value_or(due), due);
  }
};

/// The messages of an agent that have no number yet, the one that waits longest first; and those
/// that may be offered anew only later.
///
/// Thread: confined to one thread.
class SendQueue final {
 public:
  /// Takes a message; false if too many durable ones wait. One that is the latest of something
  /// takes the place of those of the same that wait.
  bool Offer(Outgoing message);
  /// Takes a durable message that joins the others at `when` (AdmitLater), unless a newer one of
  /// the same waits.
  void OfferLater(Outgoing message, SteadyTime when);
  /// Those whose time has come join the others.
  void AdmitLater(SteadyTime now);
  /// What waits is due at `due`, whenever it was offered.
  void DueAt(SteadyTime due);

  /// The message that waits longest; null if none waits.
  [[nodiscard]] const Outgoing* Next();
  /// Takes that message out; one must wait.
  [[nodiscard]] Outgoing TakeNext();

  /// How many durable messages more Offer takes now.
  [[nodiscard]] std::size_t durable_room() const {
    return kDurableWaitingMax - std::min(durable_waiting(), kDurableWaitingMax);
  }
  /// All of them, those that may be offered only later included.
  [[nodiscard]] Unsent unsent() const;
  /// Messages that may be sent now.
  [[nodiscard]] std::size_t waiting() const { return live_.size() + durable_waiting(); }
  [[nodiscard]] bool holds_durable() const { return durable_waiting() > 0 || !later_.empty(); }
  [[nodiscard]] bool empty() const { return waiting() == 0 && later_.empty(); }
  /// When the live messages that gave way to newer ones since the last call were due.
  [[nodiscard]] std::vector<SteadyTime> TakeGaveWay() { return std::exchange(gave_way_due_, {}); }
  /// Tags of the durable messages that gave way to later ones of the same since the last call.
  [[nodiscard]] std::vector<std::uint64_t> TakeReplaced() { return std::exchange(replaced_, {}); }
  /// This one gave way, too: a later one of the same was sent.
  void Replace(const Outgoing& message) { replaced_.push_back(message.tag); }

 private:
  struct Waiting {
    std::uint64_t ticket = 0;
    Outgoing message;
    /// It gave way to a later one, and is passed over.
    bool replaced = false;
  };
  void PushDurable(Outgoing message);
  /// What waits and is the latest of that gives way.
  void ReplaceAll(const std::string& latest_of);
  /// Takes those that gave way from the front of the durable ones.
  void DropReplaced();

  /// The queue whose front waits longest; null if nothing waits.
  [[nodiscard]] std::deque<Waiting>* Longest();

  [[nodiscard]] std::size_t durable_waiting() const { return durable_.size() - durable_replaced_; }

  /// In the order of their tickets, across both.
  std::deque<Waiting> live_;
  std::deque<Waiting> durable_;
  /// How many of durable_ gave way.
  std::size_t durable_replaced_ = 0;
  /// Those of durable_ that are the latest of something; a deque's elements stay where they are.
  std::map<std::string, Waiting*> latest_;
  std::uint64_t next_ticket_ = 0;
  /// By the time at which they may be sent anew.
  std::multimap<SteadyTime, Outgoing> later_;
  std::vector<SteadyTime> gave_way_due_;
  std::vector<std::uint64_t> replaced_;
};

}  // namespace uplink::synthetic
