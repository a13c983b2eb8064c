#include "server/front/door/place.h"

#include <utility>

namespace uplink::front {
namespace {

/// How often the table of keys is told that a connection is alive: its order needs no more.
constexpr std::chrono::seconds kNoteHeardEvery{5};

}  // namespace

bool Place::Take() {
  taken_ = book_.Enter();
  return taken_;
}

std::optional<std::uint64_t> Place::Count(const TlsPeer& peer, const Origin& origin,
                                          SteadyTime now) {
  KeyTable& keys = book_.keys();
  noted_at_ = now;
  const auto evicted =
      keys.Add(peer.key, connection_,
               peer.SharesItsKey() ? kGatewayConnectionsMax : kRobotConnectionsMax, now);
  if (!evicted || book_.evictions().Note(peer.key, now) < kEvictionsFlagged) return evicted;
  book_.Tell("connections_contested", "contested",
             "one certificate opens connections again and again", origin, now);
  return evicted;
}

std::optional<std::uint64_t> Place::CountAs(const KeyDigest& caller, const Origin& origin,
                                            SteadyTime now) {
  if (!taken_) return std::nullopt;
  const auto evicted = book_.keys().Move(connection_, caller, kGatewayConnectionsMax);
  if (!evicted || book_.evictions().Note(caller, now) < kEvictionsFlagged) return evicted;
  book_.Tell("connections_contested", "contested", "one token opens connections again and again",
             origin, now);
  return evicted;
}

void Place::NoteHeard(SteadyTime now) {
  if (!taken_ || now < noted_at_ + kNoteHeardEvery) return;
  noted_at_ = now;
  book_.keys().NoteHeard(connection_, now);
}

void Place::SetStreams(std::size_t streams) {
  if (taken_) book_.keys().SetStreams(connection_, streams);
}

bool Place::Linger(const std::optional<KeyDigest>& key) {
  if (taken_ && book_.keys().Has(connection_)) {
    SetStreams(0);
    return true;
  }
  Leave();
  lingers_as_ = key;
  lingers_ = book_.lingers().Begin(key);
  return lingers_;
}

void Place::Leave() {
  if (std::exchange(lingers_, false)) book_.lingers().End(lingers_as_);
  if (!std::exchange(taken_, false)) return;
  book_.keys().Remove(connection_);
  book_.Leave();
}

}  // namespace uplink::front
