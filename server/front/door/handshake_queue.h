#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <list>
#include <map>
#include <optional>
#include <set>
#include <unordered_map>
#include <utility>

#include "schema/base/clock.h"
#include "server/front/door/handshake_rates.h"
#include "server/front/door/source_address.h"

namespace uplink::front {

/// All over 0.
struct HandshakeLimits {
  /// Handshakes at once: the places.
  std::size_t under_way_max = 0;
  /// Connections that wait for a place.
  std::size_t waiting_max = 0;
  /// Places whose handshake has not begun and so waits for our CPU alone. With more of them, the
  /// threads' inboxes would set the order in which handshakes begin.
  std::size_t unbegun_max = std::numeric_limits<std::size_t>::max();
};

/// How much is known of a source.
enum class Rank : std::uint8_t {
  kStranger,
  /// A robot streams from there, or did lately (KnownSources).
  kKnown,
};

/// While known sources and strangers wait, every 4th place goes to a stranger, as long as strangers
/// hold less than a 4th of the places; otherwise slow strangers would fill them all. Strangers also
/// keep a 4th of the waiting list.
inline constexpr std::size_t kStrangersEvery = 4;

/// Which unproven connection may begin its handshake next.
///
/// Known sources come before strangers (kStrangersEvery). Among sources of a rank, those within the
/// rate of handshakes (HandshakeRates) come first; then the one with the fewest handshakes under
/// way; then the one that was served, or came, least recently. Within a source, the oldest
/// connection comes first. A source may use every place that no other wants.
///
/// Limits:  HandshakeLimits, for everything that it keeps; each call is O(log of that).
/// Thread:  confined to the acceptor's.
class HandshakeQueue final {
 public:
  explicit HandshakeQueue(const HandshakeLimits& limits);
  HandshakeQueue(const HandshakeQueue&) = delete;
  HandshakeQueue& operator=(const HandshakeQueue&) = delete;

  /// Adds a waiting connection with an unused id; its source has this rank from now on. Past
  /// waiting_max the result is the connection to refuse, which is removed and may be the newcomer:
  /// the newest one of the source with the most waiting. That source is a stranger while strangers
  /// have more than a 4th of waiting_max or only strangers wait; otherwise it is a known one.
  [[nodiscard]] std::optional<std::uint64_t> Arrive(std::uint64_t id, const SourceAddress& address,
                                                    Rank rank, SteadyTime now);

  /// The connection whose handshake begins now; empty if no place is free or none waits.
  [[nodiscard]] std::optional<std::uint64_t> Next(SteadyTime now);

  /// The handshake has begun, and waits for its peer from now on. Call it once for each result of
  /// Next.
  void Began(std::uint64_t id);

  /// The connection's handshake has ended, or the connection has gone while it waited. Unknown ids
  /// are ignored.
  void Ended(std::uint64_t id);

  /// The handshake to cut, so that half-open ones of one source keep no other source out: the
  /// oldest of the source with the most. Empty unless all places are taken, Next would serve a
  /// source below its fair share, and that source is above its own. A fair share is under_way_max
  /// divided by the sources that have or want a place, at least 1. Once the handshake has Ended,
  /// Next serves the source that was short. The caller spares a handshake that has only just begun.
  [[nodiscard]] std::optional<std::uint64_t> ChooseToCut() const;

  /// A connection waits for a place, not just for our CPU: handshakes get less time.
  [[nodiscard]] bool pressed() const {
    return waiting() > 0 && under_way() >= limits_.under_way_max;
  }
  [[nodiscard]] std::size_t waiting() const;
  [[nodiscard]] std::size_t under_way() const;
  /// Sources that have a connection here.
  [[nodiscard]] std::size_t sources() const { return sources_.size(); }

 private:
  struct Source;
  struct Connection {
    std::uint64_t id = 0;
    Source* source = nullptr;
    bool under_way = false;
    bool begun = false;
    /// The event_ at which it came, or began.
    std::uint64_t since = 0;
  };
  using Connections = std::list<Connection>;
  struct Source {
    SourceAddress address;
    Rank rank = Rank::kStranger;
    /// The event_ at which it was last served, or came.
    std::uint64_t served = 0;
    /// It is over the rate, and when it will be within it again.
    bool over = false;
    SteadyTime within_at{};
    /// Both from the oldest to the newest.
    Connections waiting;
    Connections under_way;
  };

  struct FewestUnderWay {
    bool operator()(const Source* left, const Source* right) const;
  };
  struct MostWaiting {
    bool operator()(const Source* left, const Source* right) const;
  };
  struct MostUnderWay {
    bool operator()(const Source* left, const Source* right) const;
  };
  /// The sources of a rank.
  struct Ranked {
    std::size_t waiting = 0;
    std::size_t under_way = 0;
    /// Sources with a waiting connection, in the order in which they are served.
    std::set<Source*, FewestUnderWay> in_turn;
    /// The same sources, in the order in which they are refused.
    std::set<Source*, MostWaiting> crowds;
  };

  [[nodiscard]] Ranked& Of(Rank rank) { return ranks_[static_cast<std::size_t>(rank)]; }
  [[nodiscard]] const Ranked& Of(Rank rank) const { return ranks_[static_cast<std::size_t>(rank)]; }
  /// Removes the source from all ordered sets, so that it may change.
  void Unlist(Source& source);
  /// Puts it back; forgets it if it has no connection.
  void List(Source& source);
  /// The source that Next serves if strangers hold so many places; null if none waits.
  [[nodiscard]] Source* InTurn(std::size_t strangers_under_way) const;
  [[nodiscard]] std::uint64_t ChooseToRefuse() const;
  /// Updates whether the source, which is unlisted, is over the rate.
  void Rate(Source& source, SteadyTime now);
  /// The same for all waiting sources that are within the rate again.
  void RateAgain(SteadyTime now);

  const HandshakeLimits limits_;
  /// Counts arrivals and beginnings, so that both have an order.
  std::uint64_t event_ = 0;
  /// Places that known sources got since a stranger got one.
  std::uint64_t known_in_a_row_ = 0;
  std::size_t unbegun_ = 0;
  HandshakeRates rates_;
  /// Waiting sources over the rate, by when they are within it again.
  std::set<std::pair<SteadyTime, Source*>> over_;
  std::array<Ranked, 2> ranks_;
  /// Sources with a handshake under way.
  std::set<Source*, MostUnderWay> holders_;
  /// Ordered, not hashed: sources choose their addresses, and could make a hash slow.
  std::map<SourceAddress, Source> sources_;
  std::unordered_map<std::uint64_t, Connections::iterator> connections_;
};

}  // namespace uplink::front
