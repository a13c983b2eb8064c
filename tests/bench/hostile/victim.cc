#include "tests/bench/hostile/victim.h"

#include <utility>

#include <boost/asio/executor_work_guard.hpp>

namespace uplink::bench {
namespace {

constexpr milliseconds kBetweenMessages{50};
constexpr milliseconds kTurn{20};
constexpr milliseconds kLate{100};

}  // namespace

Victim::Victim(link::Loop& loop, const Clock& clock, link::LinkOptions link,
               link::Identity identity)
    : world_{.loop = loop, .clock = clock, .link = std::move(link)},
      robot_(std::make_unique<OtherRobot>(world_, std::move(identity), 0)) {}

Victim::~Victim() {
  robot_.reset();
  world_.loop.io.restart();
  world_.loop.io.poll();
}

void Victim::Turn() {
  const auto busy = boost::asio::make_work_guard(world_.loop.io);
  world_.loop.io.restart();
  world_.loop.io.run_one_for(kTurn);
  robot_->Mend();
}

bool Victim::Connect(milliseconds patience) {
  const SteadyTime end = world_.clock.Steady() + patience;
  while (!robot_->open() && world_.clock.Steady() < end) Turn();
  return robot_->open();
}

OthersTally Victim::Measure(const OnTurn& on_turn) {
  OthersTally tally;
  const std::uint64_t window = ++windows_;
  world_.tally = &tally;
  world_.tallied_window = world_.window = window;
  const auto busy = boost::asio::make_work_guard(world_.loop.io);
  SteadyTime due = world_.clock.Steady();
  SteadyTime turn = due;
  for (SteadyTime now = due;; now = world_.clock.Steady()) {
    for (; due <= now; due += kBetweenMessages) {
      if (now - due > kLate) ++tally.late;
      robot_->SendEvent();
    }
    if (now >= turn) {
      robot_->Mend();
      if (!on_turn()) break;
      turn = now + kTurn;
    }
    world_.loop.io.restart();
    world_.loop.io.run_one_until(std::min(due, turn));
  }
  world_.window = 0;
  const SteadyTime end = world_.clock.Steady() + kAckPatience;
  while (robot_->HasPending(window) && world_.clock.Steady() < end) Turn();
  robot_->GiveUp(window, tally);
  world_.tally = nullptr;
  return tally;
}

}  // namespace uplink::bench
