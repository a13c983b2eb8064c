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
  /// Of the places, those of handshakes that wait for our own CPU since they have not begun: with
  /// more of them the order in which they begin would be that of the threads' inboxes.
  std::size_t unbegun_max = std::numeric_limits<std::size_t>::max();
};

/// How much is known of a source.
enum class Rank : std::uint8_t {
  kStranger,
  /// A robot streams from there, or did lately (KnownSources).
  kKnown,
};

/// While known sources and strangers wait, every 4th place goes to a stranger, as long as strangers
/// hold less than a 4th of the places: slow ones would gather there else. Of those that may wait,
/// strangers keep a 4th too.
inline constexpr std::size_t kStrangersEvery = 4;

/// Which unproven connection may begin its handshake next.
///
/// Known sources come before strangers (kStrangersEvery). Among sources of a rank, those that are
/// within the rate of handshakes (HandshakeRates) come first, among these the one with the fewest
/// handshakes under way, among equals the one that was served, or came, least recently; within a
/// source, the connection that came first. A source may use every place that nobody else wants.
///
/// Limits:  HandshakeLimits, for everything that is kept; each call is O(log of it).
/// Thread:  confined to the acceptor's.
class HandshakeQueue final {
 public:
  explicit HandshakeQueue(const HandshakeLimits& limits);
  HandshakeQueue(const HandshakeQueue&) = delete;
  HandshakeQueue& operator=(const HandshakeQueue&) = delete;

  /// A connection waits from now on; no other one in here has its id. The rank is its source's from
  /// now on. Past waiting_max somebody is refused for it: the answer says who, and that one is no
  /// longer in here. It is the newest connection of the source that has the most waiting, among
  /// strangers while these have more than a 4th of waiting_max or nobody else waits, else among
  /// known sources. It may be the newcomer.
  [[nodiscard]] std::optional<std::uint64_t> Arrive(std::uint64_t id, const SourceAddress& address,
                                                    Rank rank, SteadyTime now);

  /// Whose handshake is to begin now; nothing if no place is free or nobody waits.
  [[nodiscard]] std::optional<std::uint64_t> Next(SteadyTime now);

  /// The handshake has begun: it waits for its peer from now on. Once for each of Next's.
  void Began(std::uint64_t id);

  /// The connection's handshake is over, whatever came of it, or the connection is gone while it
  /// waited. An unknown id is none of ours.
  void Ended(std::uint64_t id);

  /// Whose handshake should be cut short, so that half-open ones of one source keep nobody out: if
  /// all places are taken and Next would serve a source that has less than its fair share, the
  /// longest one under way of the source that has the most, if that has more than its share. A fair
  /// share is under_way_max divided by the sources that have or want a place, at least 1. Once the
  /// answered one has Ended, Next serves the source that was short. The caller spares a handshake
  /// that has only just begun.
  [[nodiscard]] std::optional<std::uint64_t> ToGiveWay() const;

  /// Somebody waits for a place, and not for our CPU alone: handshakes get less time.
  [[nodiscard]] bool pressed() const {
    return waiting() > 0 && under_way() >= limits_.under_way_max;
  }
  [[nodiscard]] std::size_t waiting() const;
  [[nodiscard]] std::size_t under_way() const;
  /// That have a connection in here.
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
    /// The event_ at which it was served last, or else came.
    std::uint64_t served = 0;
    /// It is over the rate, and as far as we know until then.
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
    /// Those that have a connection waiting, in the order in which they are served.
    std::set<Source*, FewestUnderWay> in_turn;
    /// The same, the first to be refused first.
    std::set<Source*, MostWaiting> crowds;
  };

  [[nodiscard]] Ranked& Of(Rank rank) { return ranks_[static_cast<std::size_t>(rank)]; }
  [[nodiscard]] const Ranked& Of(Rank rank) const { return ranks_[static_cast<std::size_t>(rank)]; }
  /// Takes the source out of whatever is ordered by what it has, so that it may change.
  void Unlist(Source& source);
  /// Puts it back; forgets it if it has nothing.
  void List(Source& source);
  /// Whom Next serves if strangers hold so many places; null if nobody waits.
  [[nodiscard]] Source* InTurn(std::size_t strangers_under_way) const;
  [[nodiscard]] std::uint64_t ToRefuse() const;
  /// Brings it up to date whether the source is over the rate; it is unlisted.
  void Rate(Source& source, SteadyTime now);
  /// The same of all that wait and are within the rate again.
  void RateAgain(SteadyTime now);

  const HandshakeLimits limits_;
  /// Counts arrivals and beginnings, so that both have an order.
  std::uint64_t event_ = 0;
  /// Places that known sources got since a stranger got one.
  std::uint64_t known_in_a_row_ = 0;
  std::size_t unbegun_ = 0;
  HandshakeRates rates_;
  /// Those that wait and are over the rate, by when they are within it again.
  std::set<std::pair<SteadyTime, Source*>> over_;
  std::array<Ranked, 2> ranks_;
  /// Those that have a handshake under way.
  std::set<Source*, MostUnderWay> holders_;
  /// Ordered, not hashed: sources choose their addresses, and an order has no bad case.
  std::map<SourceAddress, Source> sources_;
  std::unordered_map<std::uint64_t, Connections::iterator> connections_;
};

}  // namespace uplink::front
