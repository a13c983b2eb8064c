#include "tests/bench/fair/others.h"

#include <algorithm>
#include <utility>

#include <boost/asio/executor_work_guard.hpp>

namespace uplink::bench {
namespace {

constexpr std::size_t kConnectsAtOnce = 32;
constexpr milliseconds kTurn{100};
constexpr milliseconds kLook{20};
constexpr milliseconds kLate{100};
/// Of three messages one is an event: a robot sends it every other second, and a live one in each.
constexpr std::uint64_t kMessagesARound = 3;
constexpr double kMessagesPerSecond = 1.5;

}  // namespace

Others::~Others() {
  robots_.clear();
  world_.loop.io.restart();
  world_.loop.io.poll();
}

std::size_t Others::CountOpen() const {
  return static_cast<std::size_t>(
      std::ranges::count_if(robots_, [](const auto& robot) { return robot->open(); }));
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
    world_.loop.io.run_one_for(kLook);
    world_.loop.io.poll();
    for (const auto& robot : robots_) robot->Mend();
    open = CountOpen();
  }
  return open;
}

SteadyTime Others::Due() const {
  const std::chrono::duration<double> gap(
      1 / (kMessagesPerSecond * static_cast<double>(robots_.size())));
  return began_ + std::chrono::duration_cast<SteadyTime::duration>(gap * sent_);
}

void Others::SendWhatIsDue(SteadyTime now) {
  for (SteadyTime due = Due(); due <= now; due = Due()) {
    if (now - due > kLate && world_.tally != nullptr) ++world_.tally->late;
    if (++sent_ % kMessagesARound == 0) {
      robots_[next_event_++ % robots_.size()]->SendEvent();
    } else {
      robots_[next_live_++ % robots_.size()]->SendLive();
    }
  }
}

bool Others::Drive(milliseconds duration, const OnTurn& on_turn) {
  if (robots_.empty()) return false;
  boost::asio::io_context& io = world_.loop.io;
  const auto busy = boost::asio::make_work_guard(io);
  began_ = world_.clock.Steady();
  sent_ = 0;
  const SteadyTime end = began_ + duration;
  SteadyTime turn = began_;
  io.restart();
  for (SteadyTime now = began_; now < end; now = world_.clock.Steady()) {
    SendWhatIsDue(now);
    if (now >= turn) {
      for (const auto& robot : robots_) robot->Mend();
      if (!on_turn()) return false;
      turn = now + kTurn;
    }
    io.run_one_until(std::min({Due(), turn, end}));
  }
  return true;
}

OthersTally Others::Measure(milliseconds duration, const OnTurn& on_turn) {
  OthersTally tally;
  const std::uint64_t window = ++windows_;
  world_.tally = &tally;
  world_.tallied_window = world_.window = window;
  bool going = Drive(duration, on_turn);
  world_.window = 0;
  const SteadyTime end = world_.clock.Steady() + kAckPatience;
  while (going && HasPending(window) && world_.clock.Steady() < end) {
    going = Drive(kTurn, on_turn);
  }
  for (const auto& robot : robots_) robot->GiveUp(window, tally);
  world_.tally = nullptr;
  return tally;
}

bool Others::HasPending(std::uint64_t window) const {
  return std::ranges::any_of(robots_, [&](const auto& robot) { return robot->HasPending(window); });
}

double Quantile(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  std::ranges::sort(values);
  const auto at = static_cast<std::size_t>(share * static_cast<double>(values.size()));
  return values[std::min(at, values.size() - 1)];
}

}  // namespace uplink::bench
