#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <list>
#include <string>
#include <string_view>

#include "schema/base/clock.h"
#include "server/http/source.h"

namespace uplink::http {

/// Connections of each listener that are kept for probes and scrapes.
inline constexpr std::size_t kMonitoringPlaces = 4;
/// A connection whose peer takes longer than this for an answer gives way to a further one.
inline constexpr std::chrono::seconds kSlowAnswer{1};
/// A connection that was accepted less than this ago may have sent a request that is not read yet:
/// a turn of the loop accepts up to kAcceptsPerTurn (limits.h), and takes a few milliseconds.
inline constexpr milliseconds kNotReadYet{100};

/// Watches of one caller, once half of those that may be open are: others still get in.
inline constexpr std::size_t kCrowdedWatchesOfCaller = 4;

/// A connection that holds a place.
class PlaceHolder {
 public:
  virtual ~PlaceHolder() = default;
  /// Ends the connection at once. It has left already.
  virtual void GiveWay() = 0;
};

/// The places of a listener's connections. The last kMonitoringPlaces of them answer probes and
/// scrapes alone, so that other clients cannot take them; and where all are taken, the connection
/// that has had no request under way for longest gives way to a further one, else the one whose
/// peer has taken its answer for longest, else the scrape that was asked for last: who scrapes
/// again and again is more likely to be that one than who does it every 15 s. A connection that has
/// just come gives way last, for a probe among many that come at once is not read yet.
///
/// A source may have a share of the places. Where it has all of that, its own connections alone
/// give way to its further one, so that it keeps no other source out. A proxy speaks for many, and
/// has no share.
///
/// Confined to one thread.
class Places final {
 public:
  /// What a connection does.
  enum class State : std::uint8_t {
    /// It was accepted, and no request of it is read yet.
    kNew,
    /// It waits for a request, or for the rest of one.
    kIdle,
    /// Its request is answered.
    kBusy,
    /// Its scrape is answered.
    kScraping,
    /// Its peer takes an answer.
    kAnswering,
    /// Its peer watches: it does not give way.
    kWatching,
  };
  struct Place {
    PlaceHolder* holder = nullptr;
    State state = State::kNew;
    SteadyTime since;
    Source source{};
    /// It answers probes and scrapes alone.
    bool monitoring_only = false;
    bool shares = true;
    /// Who watches by it (EventStream::caller), while it does.
    std::string watcher{};
  };
  using Handle = std::list<Place>::iterator;
  /// Whether a connection counts in its source's share.
  enum class Of : std::uint8_t { kSource, kProxy };

  /// `places`: over kMonitoringPlaces. `source_share`: places that one source has at most; 0: all.
  explicit Places(std::size_t places, std::size_t source_share = 0)
      : places_(places), source_share_(source_share) {}
  Places(const Places&) = delete;
  Places& operator=(const Places&) = delete;

  /// Whether there is a place for this source; if not, a connection gives way if one may.
  enum class Room : std::uint8_t { kFree, kGivenWay, kNone };
  [[nodiscard]] Room MakeRoom(const Source& source, SteadyTime now, Of of = Of::kSource);
  /// After MakeRoom found some.
  [[nodiscard]] Handle Take(PlaceHolder& holder, const Source& source, SteadyTime now,
                            Of of = Of::kSource);
  void Leave(Handle place);
  static void Note(Handle place, State state, SteadyTime now);
  /// Whether the connection should end with its answer, because over half of all places, or of its
  /// source's share, are taken: a peer that sends requests ahead would be answered without a pause
  /// in which it could give way. Never without shares.
  [[nodiscard]] bool Crowded(Handle place) const;
  /// The connection watches from now on, if it may: half of the places at most do, so that others
  /// are answered, and where half of those are taken this caller has fewer than
  /// kCrowdedWatchesOfCaller. An empty caller is not told from others.
  [[nodiscard]] bool Watch(Handle place, const std::string& caller, SteadyTime now);

 private:
  [[nodiscard]] bool MayWatch(std::string_view caller) const;
  [[nodiscard]] std::size_t TakenBy(const Source& source) const;

  const std::size_t places_;
  const std::size_t source_share_;
  /// Of those that are not for monitoring only.
  std::size_t others_ = 0;
  std::list<Place> taken_;
};

}  // namespace uplink::http
