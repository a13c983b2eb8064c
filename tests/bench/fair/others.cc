#include "tests/bench/fair/others.h"

#include <algorithm>

#include <boost/asio/executor_work_guard.hpp>

namespace uplink::bench {
namespace {

constexpr std::size_t kConnectsAtOnce = 32;
constexpr milliseconds kTurn{20};
constexpr milliseconds kLate{100};

}  // namespace

Others::~Others() {
  robots_.clear();
  world_.loop.io.restart();
  world_.loop.io.poll();
}

void Others::Mend() {
  for (const auto& robot : robots_) robot->Mend();
}

std::size_t Others::Connect(const std::vector<link::Identity>& identities, std::size_t robots,
                            milliseconds patience) {
  const SteadyTime end = world_.clock.Steady() + patience;
  std::size_t open = 0;
  while (open < robots && world_.clock.Steady() < end) {
    while (robots_.size() < robots && robots_.size() - open < kConnectsAtOnce) {
      const std::size_t number = robots_.size();
      robots_.push_back(std::make_unique<OtherRobot>(world_, identities.at(number), number));
    }
    world_.loop.io.restart();
    world_.loop.io.run_one_for(kTurn);
    world_.loop.io.poll();
    Mend();
    open = static_cast<std::size_t>(
        std::ranges::count_if(robots_, [](const auto& robot) { return robot->open(); }));
  }
  return open;
}

SteadyTime Others::Due() const {
  const std::chrono::duration<double> gap(
      1 / (rhythm_.messages_per_second * static_cast<double>(robots_.size())));
  return began_ + std::chrono::duration_cast<SteadyTime::duration>(gap * sent_);
}

void Others::SendWhatIsDue(SteadyTime now) {
  for (SteadyTime due = Due(); due <= now; due = Due()) {
    if (now - due > kLate && world_.tally != nullptr) ++world_.tally->late;
    if (++sent_ % (rhythm_.live + 1) == 0) {
      robots_[next_event_++ % robots_.size()]->SendEvent();
    } else {
      robots_[next_live_++ % robots_.size()]->SendLive();
    }
  }
}

void Others::Drive(const OnTurn& on_turn) {
  if (robots_.empty()) return;
  boost::asio::io_context& io = world_.loop.io;
  const auto busy = boost::asio::make_work_guard(io);
  began_ = world_.clock.Steady();
  sent_ = 0;
  SteadyTime turn = began_;
  for (SteadyTime now = began_;; now = world_.clock.Steady()) {
    SendWhatIsDue(now);
    if (now >= turn) {
      Mend();
      if (!on_turn()) return;
      turn = now + kTurn;
    }
    io.restart();
    io.run_one_until(std::min(Due(), turn));
  }
}

OthersTally Others::Measure(const OnTurn& on_turn) {
  OthersTally tally;
  const std::uint64_t window = ++windows_;
  world_.tally = &tally;
  world_.tallied_window = world_.window = window;
  Drive(on_turn);
  world_.window = 0;
  const SteadyTime end = world_.clock.Steady() + kAckPatience;
  const auto waits = [this, end] {
    const auto pending = [](const auto& robot) { return robot->pending(); };
    return std::ranges::any_of(robots_, pending) && world_.clock.Steady() < end;
  };
  Drive([&] {
    static_cast<void>(on_turn());
    return waits();
  });
  for (const auto& robot : robots_) robot->GiveUp();
  world_.tally = nullptr;
  return tally;
}

}  // namespace uplink::bench
