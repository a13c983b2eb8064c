#include "tests/bench/fair/takeover_war.h"

#include "tests/bench/fair/bad_payloads.h"

namespace uplink::bench {
namespace {

/// Longer than a server may let a Hello wait.
constexpr milliseconds kWelcomeWait{12'000};

}  // namespace

void TakeoverWar::Act() {
  for (Side& side : sides_) ActOn(side);
}

void TakeoverWar::ActOn(Side& side) {
  if (side.stream != nullptr && side.stream->state() == BadStream::State::kOpen) {
    if (!side.sent) side.stream->Send({{GoodEvent(side.session.last_seq)}});
    side.sent = true;
    return;
  }
  side.sent = false;
  if (side.stream != nullptr && side.stream->reusable()) return side.stream->OpenAgain();
  const bool over = side.stream == nullptr || side.stream->state() == BadStream::State::kOver;
  const bool stuck = !over && world_.clock.Steady() - side.stream->since() > kWelcomeWait;
  if (stuck) side.stream->Cut();
  if (over || stuck) {
    side.stream = std::make_unique<BadStream>(world_, side.session, BadStream::Confirms::kAcks);
  }
}

}  // namespace uplink::bench
