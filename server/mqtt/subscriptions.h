#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "server/mqtt/limits.h"
#include "server/mqtt/packets.h"

namespace uplink::mqtt {

/// What a client is to be subscribed to, and what the broker is known to hold of it. Outlives the
/// connections. Pure.
///
/// A broker's session keeps filters; so after a connection whose session goes on only those are
/// asked for that are not known to be held: those that are new, that changed, whose answer did not
/// come, that were refused, and after our own start all of them.
///
/// Limits:  kFiltersMax by whoever sets them; kFiltersPerAsk in a packet, one packet at a time;
///          kGoneMax, past which filters stay with the broker, and their messages come for nothing.
/// Thread:  confined to its client's.
class Subscriptions final {
 public:
  /// Topics to unsubscribe from.
  static constexpr std::size_t kGoneMax = 2 * kFiltersMax;

  /// What is wanted from now on, and topics that are wanted no more though a broker may hold them
  /// from before our start. What was wanted and is not here is given up.
  void Want(const std::vector<Filter>& wanted, const std::vector<std::string>& gone);

  /// A connection was accepted, or ended.
  void Begin(bool session_present);
  void End();

  struct Ask {
    /// Else to unsubscribe.
    bool subscribe = true;
    std::vector<Filter> filters;
  };
  /// What is to be asked next; nothing while an answer is waited for, or if all is said.
  [[nodiscard]] std::optional<Ask> Next();
  /// Filters whose answer is waited for.
  [[nodiscard]] std::size_t asked() const { return asked_.size(); }
  [[nodiscard]] bool asked_to_subscribe() const { return subscribing_; }

  /// What the broker said of a filter that it does not serve as asked.
  struct Lack {
    Filter filter;
    /// 128 and more: refused; else the lower QoS.
    std::uint8_t code = 0;
  };
  /// A SUBACK with as many codes as were asked for, each a QoS up to the one asked for or a
  /// refusal; nothing if it is another one.
  [[nodiscard]] std::optional<std::vector<Lack>> Answered(std::string_view codes);
  /// An UNSUBACK. What it refuses nobody holds.
  void Unsubscribed();

  /// Asks again for what was refused.
  void RetryRefused();

  /// Everything was answered.
  [[nodiscard]] bool settled() const;
  [[nodiscard]] std::size_t refused() const { return Count(State::kRefused); }
  /// Held at a lower QoS than was asked for.
  [[nodiscard]] std::size_t lower() const { return Count(State::kLower); }

 private:
  enum class State : std::uint8_t { kUnsaid, kAsked, kHeld, kLower, kRefused };
  struct Entry {
    Qos qos = Qos::kAtMostOnce;
    State state = State::kUnsaid;
  };

  [[nodiscard]] std::size_t Count(State state) const;
  void GiveUp(const std::string& topic);

  std::map<std::string, Entry> wanted_;
  std::set<std::string> gone_;
  /// In the order of the packet.
  std::vector<Filter> asked_;
  bool subscribing_ = true;
};

}  // namespace uplink::mqtt
