#include "server/front/door/handshake_rates.h"

#include <algorithm>

namespace uplink::front {
namespace {

/// What one handshake uses up.
constexpr std::chrono::milliseconds kEach{1000 / kHandshakesPerSecond};
constexpr std::chrono::milliseconds kBurst = kEach * kHandshakesAtOnce;

}  // namespace

void HandshakeRates::Note(const SourceAddress& source, SteadyTime now) {
  if (const auto found = by_source_.find(source); found != by_source_.end()) {
    Entry& entry = *found->second;
    // Handshakes over the rate, which nobody else wanted, are not held against it for longer.
    entry.idle_at = std::min(std::max(entry.idle_at, now) + kEach, now + kBurst + kEach);
    entries_.splice(entries_.begin(), entries_, found->second);
  } else {
    if (entries_.size() >= kRatedSourcesMax) ForgetLast();
    entries_.push_front({.source = source, .idle_at = now + kEach});
    by_source_.emplace(source, entries_.begin());
  }
  while (entries_.back().idle_at <= now) ForgetLast();
}

SteadyTime HandshakeRates::WithinAt(const SourceAddress& source, SteadyTime now) const {
  const auto found = by_source_.find(source);
  return found == by_source_.end() ? now : found->second->idle_at - kBurst + kEach;
}

void HandshakeRates::ForgetLast() {
  by_source_.erase(entries_.back().source);
  entries_.pop_back();
}

}  // namespace uplink::front
