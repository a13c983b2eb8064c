#include "server/front/door/handshake_queue.h"

#include <algorithm>
#include <iterator>
#include <tuple>
#include <utility>

#include "schema/base/check.h"

namespace uplink::front {

HandshakeQueue::HandshakeQueue(const HandshakeLimits& limits) : limits_(limits) {
  UPLINK_CHECK(limits.under_way_max > 0 && limits.waiting_max > 0 && limits.unbegun_max > 0,
               "no handshake could begin");
}

std::optional<std::uint64_t> HandshakeQueue::Arrive(std::uint64_t id, const SourceAddress& address,
                                                    Rank rank, SteadyTime now) {
  UPLINK_CHECK(!connections_.contains(id), "two connections of one id");
  const auto [found, is_new] = sources_.try_emplace(address);
  Source& source = found->second;
  if (is_new) {
    source.address = address;
    source.served = ++event_;
  } else {
    Unlist(source);
  }
  source.rank = rank;
  Rate(source, now);
  source.waiting.push_back({.id = id, .source = &source, .since = ++event_});
  connections_.emplace(id, std::prev(source.waiting.end()));
  List(source);
  if (waiting() <= limits_.waiting_max) return std::nullopt;
  const std::uint64_t refused = ChooseToRefuse();
  Ended(refused);
  return refused;
}

std::optional<std::uint64_t> HandshakeQueue::Next(SteadyTime now) {
  if (under_way() >= limits_.under_way_max || unbegun_ >= limits_.unbegun_max) return std::nullopt;
  RateAgain(now);
  Source* const source = InTurn(Of(Rank::kStranger).under_way);
  if (source == nullptr) return std::nullopt;
  Unlist(*source);
  source->served = ++event_;
  Connection& first = source->waiting.front();
  first.under_way = true;
  ++unbegun_;
  first.since = event_;
  source->under_way.splice(source->under_way.end(), source->waiting, source->waiting.begin());
  known_in_a_row_ = source->rank == Rank::kKnown ? known_in_a_row_ + 1 : 0;
  rates_.Note(source->address, now);
  Rate(*source, now);
  List(*source);
  return first.id;
}

void HandshakeQueue::Began(std::uint64_t id) {
  const auto found = connections_.find(id);
  if (found == connections_.end() || !found->second->under_way) return;
  if (!std::exchange(found->second->begun, true)) --unbegun_;
}

void HandshakeQueue::Ended(std::uint64_t id) {
  const auto found = connections_.find(id);
  if (found == connections_.end()) return;
  const Connections::iterator connection = found->second;
  connections_.erase(found);
  Source& source = *connection->source;
  Unlist(source);
  if (connection->under_way && !connection->begun) --unbegun_;
  (connection->under_way ? source.under_way : source.waiting).erase(connection);
  List(source);
}

std::optional<std::uint64_t> HandshakeQueue::ChooseToCut() const {
  if (under_way() < limits_.under_way_max) return std::nullopt;
  const Source& holder = **holders_.begin();
  const std::size_t share = std::max<std::size_t>(1, limits_.under_way_max / sources_.size());
  if (holder.under_way.size() <= share) return std::nullopt;
  const std::size_t given_way = holder.rank == Rank::kStranger ? 1 : 0;
  const Source* const next = InTurn(Of(Rank::kStranger).under_way - given_way);
  if (next == nullptr || next->under_way.size() >= share) return std::nullopt;
  return holder.under_way.front().id;
}

std::size_t HandshakeQueue::waiting() const {
  return Of(Rank::kStranger).waiting + Of(Rank::kKnown).waiting;
}

std::size_t HandshakeQueue::under_way() const {
  return Of(Rank::kStranger).under_way + Of(Rank::kKnown).under_way;
}

void HandshakeQueue::Unlist(Source& source) {
  Ranked& rank = Of(source.rank);
  rank.waiting -= source.waiting.size();
  rank.under_way -= source.under_way.size();
  if (!source.waiting.empty()) {
    rank.in_turn.erase(&source);
    rank.crowds.erase(&source);
    over_.erase({source.within_at, &source});
  }
  if (!source.under_way.empty()) holders_.erase(&source);
}

void HandshakeQueue::List(Source& source) {
  if (source.waiting.empty() && source.under_way.empty()) {
    sources_.erase(sources_.find(source.address));
    return;
  }
  Ranked& rank = Of(source.rank);
  rank.waiting += source.waiting.size();
  rank.under_way += source.under_way.size();
  if (!source.waiting.empty()) {
    rank.in_turn.insert(&source);
    rank.crowds.insert(&source);
    if (source.over) over_.emplace(source.within_at, &source);
  }
  if (!source.under_way.empty()) holders_.insert(&source);
}

void HandshakeQueue::Rate(Source& source, SteadyTime now) {
  source.within_at = rates_.WithinAt(source.address, now);
  source.over = source.within_at > now;
}

void HandshakeQueue::RateAgain(SteadyTime now) {
  while (!over_.empty() && over_.begin()->first <= now) {
    Source& source = *over_.begin()->second;
    Unlist(source);
    Rate(source, now);
    List(source);
  }
}

HandshakeQueue::Source* HandshakeQueue::InTurn(std::size_t strangers_under_way) const {
  const Ranked& strangers = Of(Rank::kStranger);
  const Ranked& known = Of(Rank::kKnown);
  if (strangers.waiting == 0 && known.waiting == 0) return nullptr;
  if (strangers.waiting == 0) return *known.in_turn.begin();
  if (known.waiting == 0) return *strangers.in_turn.begin();
  const bool fourth = known_in_a_row_ + 1 >= kStrangersEvery;
  const bool have_room = strangers_under_way * kStrangersEvery < limits_.under_way_max;
  return fourth && have_room ? *strangers.in_turn.begin() : *known.in_turn.begin();
}

std::uint64_t HandshakeQueue::ChooseToRefuse() const {
  const Ranked& strangers = Of(Rank::kStranger);
  const Ranked& known = Of(Rank::kKnown);
  const bool too_many = strangers.waiting * kStrangersEvery > limits_.waiting_max;
  const Ranked& rank = known.waiting == 0 || too_many ? strangers : known;
  return (*rank.crowds.begin())->waiting.back().id;
}

bool HandshakeQueue::FewestUnderWay::operator()(const Source* left, const Source* right) const {
  return std::tuple(left->over, left->under_way.size(), left->served) <
         std::tuple(right->over, right->under_way.size(), right->served);
}

bool HandshakeQueue::MostWaiting::operator()(const Source* left, const Source* right) const {
  return std::tuple(left->waiting.size(), left->waiting.back().since) >
         std::tuple(right->waiting.size(), right->waiting.back().since);
}

bool HandshakeQueue::MostUnderWay::operator()(const Source* left, const Source* right) const {
  return std::tuple(left->under_way.size(), right->under_way.front().since) >
         std::tuple(right->under_way.size(), left->under_way.front().since);
}

}  // namespace uplink::front
