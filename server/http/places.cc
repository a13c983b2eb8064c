#include "server/http/places.h"

#include <algorithm>

namespace uplink::http {
namespace {

/// Smaller numbers give way first.
int RankOf(const Places::Place& place, SteadyTime now) {
  switch (place.state) {
    case Places::State::kIdle:
      return 0;
    case Places::State::kAnswering:
      return 1;
    case Places::State::kScraping:
      return 2;
    case Places::State::kNew:
      return now - place.since > kNotReadYet ? 0 : 3;
    case Places::State::kBusy:
    case Places::State::kWatching:
      break;
  }
  return 4;
}

/// Whether `b`, which took its place later, gives way before `a`.
bool GivesWayBefore(const Places::Place& b, const Places::Place& a, SteadyTime now) {
  const int rank_b = RankOf(b, now);
  const int rank_a = RankOf(a, now);
  if (rank_b != rank_a) return rank_b < rank_a;
  return b.state == Places::State::kScraping ? b.since >= a.since : b.since < a.since;
}

bool MayGiveWay(const Places::Place& place, SteadyTime now) {
  switch (place.state) {
    case Places::State::kNew:
    case Places::State::kIdle:
    case Places::State::kScraping:
      return true;
    case Places::State::kBusy:
    case Places::State::kWatching:
      return false;
    case Places::State::kAnswering:
      return now - place.since > kSlowAnswer;
  }
  return false;
}

}  // namespace

Places::Room Places::MakeRoom(const Source& source, SteadyTime now, Of of) {
  const bool has_its_share =
      source_share_ > 0 && of == Of::kSource && TakenBy(source) >= source_share_;
  if (!has_its_share && taken_.size() < places_) return Room::kFree;
  Handle first = taken_.end();
  for (Handle place = taken_.begin(); place != taken_.end(); ++place) {
    if (has_its_share && place->source != source) continue;
    if (!MayGiveWay(*place, now)) continue;
    if (first == taken_.end() || GivesWayBefore(*place, *first, now)) first = place;
  }
  if (first == taken_.end()) return Room::kNone;
  PlaceHolder* holder = first->holder;
  Leave(first);
  holder->GiveWay();
  return Room::kGivenWay;
}

Places::Handle Places::Take(PlaceHolder& holder, const Source& source, SteadyTime now, Of of) {
  const bool monitoring_only = others_ + kMonitoringPlaces >= places_;
  if (!monitoring_only) ++others_;
  return taken_.insert(taken_.end(), {.holder = &holder,
                                      .state = State::kNew,
                                      .since = now,
                                      .source = source,
                                      .monitoring_only = monitoring_only,
                                      .shares = of == Of::kSource});
}

void Places::Leave(Handle place) {
  if (!place->monitoring_only) --others_;
  taken_.erase(place);
}

void Places::Note(Handle place, State state, SteadyTime now) {
  place->state = state;
  place->since = now;
}

bool Places::Crowded(Handle place) const {
  if (source_share_ == 0 || !place->shares) return false;
  return 2 * taken_.size() > places_ || 2 * TakenBy(place->source) > source_share_;
}

bool Places::Watch(Handle place, const std::string& caller, SteadyTime now) {
  if (!MayWatch(caller)) return false;
  Note(place, State::kWatching, now);
  place->watcher = caller;
  return true;
}

bool Places::MayWatch(std::string_view caller) const {
  std::size_t watching = 0;
  std::size_t own = 0;
  for (const Place& place : taken_) {
    if (place.state != State::kWatching) continue;
    ++watching;
    if (place.watcher == caller) ++own;
  }
  if (2 * (watching + 1) > places_) return false;
  const bool crowded = 4 * watching >= places_;
  return !crowded || caller.empty() || own < kCrowdedWatchesOfCaller;
}

std::size_t Places::TakenBy(const Source& source) const {
  return static_cast<std::size_t>(
      std::count_if(taken_.begin(), taken_.end(),
                    [&source](const Place& place) { return place.source == source; }));
}

}  // namespace uplink::http
