#include "tests/bench/hostile/victim.h"

#include <algorithm>
#include <chrono>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>

namespace uplink::bench {
namespace {

constexpr milliseconds kBetweenMessages{50};
constexpr milliseconds kTurn{20};
constexpr milliseconds kLate{100};

}  // namespace

Victim::Victim(link::Loop& loop, const Clock& clock, link::LinkOptions link,
               std::vector<link::Identity> identities)
    : world_{.loop = loop, .clock = clock, .link = std::move(link)} {
  for (link::Identity& identity : identities) {
    robots_.push_back(std::make_unique<OtherRobot>(world_, std::move(identity), robots_.size()));
  }
}

Victim::~Victim() {
  robots_.clear();
  world_.loop.io.restart();
  world_.loop.io.poll();
}

void Victim::Turn() {
  const auto busy = boost::asio::make_work_guard(world_.loop.io);
  world_.loop.io.restart();
  world_.loop.io.run_one_for(kTurn);
  Mend();
}

void Victim::Mend() {
  for (const auto& robot : robots_) robot->Mend();
}

bool Victim::Connect(milliseconds patience) {
  const SteadyTime end = world_.clock.Steady() + patience;
  const auto all_open = [this] {
    return std::ranges::all_of(robots_, [](const auto& robot) { return robot->open(); });
  };
  while (!all_open() && world_.clock.Steady() < end) Turn();
  return all_open();
}

OthersTally Victim::Measure(const OnTurn& on_turn) {
  OthersTally tally;
  const std::uint64_t window = ++windows_;
  world_.tally = &tally;
  world_.tallied_window = world_.window = window;
  const auto busy = boost::asio::make_work_guard(world_.loop.io);
  SteadyTime due = world_.clock.Steady();
  SteadyTime turn = due;
  const auto between = std::chrono::duration_cast<SteadyTime::duration>(kBetweenMessages) /
                       static_cast<std::int64_t>(robots_.size());
  std::size_t next = 0;
  for (SteadyTime now = due;; now = world_.clock.Steady()) {
    for (; due <= now; due += between) {
      if (now - due > kLate) ++tally.late;
      robots_[next++ % robots_.size()]->SendEvent();
    }
    if (now >= turn) {
      Mend();
      if (!on_turn()) break;
      turn = now + kTurn;
    }
    world_.loop.io.restart();
    world_.loop.io.run_one_until(std::min(due, turn));
  }
  world_.window = 0;
  const SteadyTime end = world_.clock.Steady() + kAckPatience;
  const auto pending = [&](const auto& robot) { return robot->HasPending(window); };
  while (std::ranges::any_of(robots_, pending) && world_.clock.Steady() < end) Turn();
  for (const auto& robot : robots_) robot->GiveUp(window, tally);
  world_.tally = nullptr;
  return tally;
}

}  // namespace uplink::bench
