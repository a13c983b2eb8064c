#include <array>

#include "tests/bench/fair/bad_payloads.h"
#include "tests/bench/fair/misbehaviour.h"

namespace uplink::bench {
namespace {

/// Longer than a server may let a Hello wait.
constexpr milliseconds kWelcomeWait{12'000};

class TakeoverWar final : public Misbehaviour {
 public:
  explicit TakeoverWar(BadWorld& world) : world_(world) {}

  void Act() override;
  [[nodiscard]] bool at_work() const override { return world_.counts.welcomes > 1; }

 private:
  struct Side {
    BadSession session = NewBadSession();
    std::unique_ptr<BadStream> stream;
    bool sent = false;
  };
  void ActOn(Side& side);

  BadWorld& world_;
  std::array<Side, 2> sides_;
};

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

}  // namespace

std::unique_ptr<Misbehaviour> MakeTakeoverWar(BadWorld& world, const std::string& /*ruri*/) {
  return std::make_unique<TakeoverWar>(world);
}

}  // namespace uplink::bench
