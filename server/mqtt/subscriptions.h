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

/// The subscriptions that a client wants, and those that the broker is known to hold. Outlives the
/// connections. Pure.
///
/// A broker's session keeps filters. So when a session resumes, only filters that are not known to
/// be held are asked for: new or changed ones, those without an answer, refused ones, and after our
/// own start all.
///
/// Limits:  kFiltersMax, checked by the caller; kFiltersPerAsk in a packet, one packet at a time;
///          kGoneMax, past which old filters stay with the broker, and their messages come in vain.
/// Thread:  confined to its client's.
class Subscriptions final {
 public:
  /// Topics to unsubscribe from.
  static constexpr std::size_t kGoneMax = 2 * kFiltersMax;

  /// Sets the wanted filters, and unwanted topics that a broker may hold from before our start.
  /// Filters that were wanted before and are missing now are given up.
  void Want(const std::vector<Filter>& wanted, const std::vector<std::string>& gone);

  /// A connection was accepted, or ended.
  void Begin(bool session_present);
  void End();

  struct Ask {
    /// Otherwise to unsubscribe.
    bool subscribe = true;
    std::vector<Filter> filters;
  };
  /// The next request; empty while an answer is awaited, or if everything was asked.
  [[nodiscard]] std::optional<Ask> Next();
  /// Filters whose answer is awaited.
  [[nodiscard]] std::size_t asked() const { return asked_.size(); }
  [[nodiscard]] bool asked_to_subscribe() const { return subscribing_; }

  /// The broker's answer for a filter that it does not serve as asked.
  struct Lack {
    Filter filter;
    /// 128 and more: refused; otherwise the lower QoS.
    std::uint8_t code = 0;
  };
  /// Takes a SUBACK. It needs one code per asked filter, each a QoS up to the one asked for or a
  /// refusal; otherwise the result is empty.
  [[nodiscard]] std::optional<std::vector<Lack>> Answered(std::string_view codes);
  /// Takes an UNSUBACK. Topics that it refuses are not held.
  void Unsubscribed();

  /// Asks again for refused filters.
  void RetryRefused();

  /// Everything was answered.
  [[nodiscard]] bool settled() const;
  [[nodiscard]] std::size_t refused() const { return Count(State::kRefused); }
  /// Held at a lower QoS than was asked for.
  [[nodiscard]] std::size_t lower() const { return Count(State::kLower); }

 private:
  enum class State : std::uint8_t { kNotAsked, kAsked, kHeld, kLower, kRefused };
  struct Entry {
    Qos qos = Qos::kAtMostOnce;
    State state = State::kNotAsked;
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
