#include "server/mqtt/subscriptions.h"

#include <algorithm>
#include <utility>

namespace uplink::mqtt {
namespace {

constexpr std::uint8_t kRefusal = 0x80;

}  // namespace

void Subscriptions::Want(const std::vector<Filter>& wanted, const std::vector<std::string>& gone) {
  std::map<std::string, Entry> next;
  for (const Filter& filter : wanted) {
    const auto old = wanted_.find(filter.topic);
    const bool same = old != wanted_.end() && old->second.qos == filter.qos;
    next.insert_or_assign(filter.topic, same ? old->second : Entry{.qos = filter.qos});
  }
  for (const auto& [topic, entry] : wanted_) {
    if (entry.state != State::kRefused) GiveUp(topic);
  }
  for (const std::string& topic : gone) GiveUp(topic);
  for (const auto& [topic, entry] : next) gone_.erase(topic);
  wanted_ = std::move(next);
}

void Subscriptions::Begin(bool session_present) {
  for (auto& [topic, entry] : wanted_) {
    const bool held = entry.state == State::kHeld || entry.state == State::kLower;
    if (!session_present || !held) entry.state = State::kNotAsked;
  }
  if (!session_present) gone_.clear();
  asked_.clear();
}

void Subscriptions::End() {
  for (const Filter& filter : asked_) {
    const auto found = wanted_.find(filter.topic);
    if (found != wanted_.end()) found->second.state = State::kNotAsked;
    // The broker may or may not have received it.
    if (!subscribing_ && found == wanted_.end()) GiveUp(filter.topic);
  }
  asked_.clear();
}

std::optional<Subscriptions::Ask> Subscriptions::Next() {
  if (!asked_.empty()) return std::nullopt;
  // Unwanted topics go first, since their messages cost.
  while (!gone_.empty() && asked_.size() < kFiltersPerAsk) {
    asked_.push_back({.topic = std::move(gone_.extract(gone_.begin()).value())});
  }
  subscribing_ = asked_.empty();
  if (!subscribing_) return Ask{false, asked_};
  for (auto& [topic, entry] : wanted_) {
    if (asked_.size() == kFiltersPerAsk) break;
    if (entry.state != State::kNotAsked) continue;
    entry.state = State::kAsked;
    asked_.push_back({topic, entry.qos});
  }
  if (asked_.empty()) return std::nullopt;
  return Ask{true, asked_};
}

std::optional<std::vector<Subscriptions::Lack>> Subscriptions::Answered(std::string_view codes) {
  if (!subscribing_ || codes.size() != asked_.size()) return std::nullopt;
  std::vector<Lack> lacks;
  for (std::size_t i = 0; i < codes.size(); ++i) {
    const auto code = static_cast<std::uint8_t>(codes[i]);
    const Filter& filter = asked_[i];
    const auto qos = static_cast<std::uint8_t>(filter.qos);
    if (code > qos && code < kRefusal) return std::nullopt;
    const State state = code >= kRefusal ? State::kRefused
                        : code < qos     ? State::kLower
                                         : State::kHeld;
    // It may have been given up or changed meanwhile.
    const auto found = wanted_.find(filter.topic);
    const bool current = found != wanted_.end() && found->second.state == State::kAsked;
    if (current) found->second.state = state;
    if (current && state != State::kHeld) lacks.push_back({filter, code});
  }
  asked_.clear();
  return lacks;
}

void Subscriptions::Unsubscribed() { asked_.clear(); }

void Subscriptions::RetryRefused() {
  for (auto& [topic, entry] : wanted_) {
    if (entry.state == State::kRefused) entry.state = State::kNotAsked;
  }
}

bool Subscriptions::settled() const {
  return asked_.empty() && gone_.empty() && Count(State::kNotAsked) == 0;
}

void Subscriptions::GiveUp(const std::string& topic) {
  if (gone_.size() < kGoneMax) gone_.insert(topic);
}

std::size_t Subscriptions::Count(State state) const {
  return static_cast<std::size_t>(std::ranges::count_if(
      wanted_, [state](const auto& each) { return each.second.state == state; }));
}

}  // namespace uplink::mqtt
