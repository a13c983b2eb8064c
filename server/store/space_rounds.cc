#include "server/store/space_rounds.h"

#include <algorithm>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "server/store/space_judge.h"

namespace uplink::store {
namespace {

/// The heaviest, for people.
std::string TextOf(std::span<const fleet::HeavyWriters::Writer> writers) {
  std::string text;
  for (const auto& writer : writers.first(std::min(writers.size(), kHeaviestNamedMax))) {
    if (!text.empty()) text += ", ";
    text += fmt::format("{} {} bytes/h", writer.ruri, writer.bytes_per_hour);
  }
  return text;
}

}  // namespace

SpaceRounds::SpaceRounds(Context context)
    : context_(std::move(context)), sampled_(context_.clock.Steady()) {}

void SpaceRounds::Round() {
  const SpaceState before = now_.state;
  Judge();
  const bool changed = now_.state != before;
  const bool sampled = changed || context_.clock.Steady() - sampled_ >= kWritersEvery;
  // Also without a change, since new robots come.
  const bool applies = changed || now_.state != SpaceState::kEnough;
  if (sampled || applies) {
    const std::vector<fleet::RobotPtr> robots = context_.fleet.All();
    const std::size_t limited = now_.robots_limited;
    Writers named;
    if (sampled) named = Sample(robots, before == SpaceState::kStopped);
    if (applies) Apply(robots);
    if (changed) {
      Tell(limited);
    } else if (!named.empty()) {
      context_.logger.Warn("store_space_limits",
                           {{"robots", named.size()}, {"heaviest", TextOf(named)}});
    }
  }
  const std::lock_guard lock(mutex_);
  shown_ = now_;
}

SpaceView SpaceRounds::view() const {
  const std::lock_guard lock(mutex_);
  return shown_;
}

void SpaceRounds::Judge() {
  const auto space = context_.space();
  if (!space.ok()) return;
  now_.space = *space;
  now_.free_min = 0;
  if (now_.space) now_.free_min = FreeMinOf(context_.free_min, now_.space->total_bytes);
  const std::uint64_t free_bytes = now_.space ? now_.space->free_bytes : 0;
  now_.state = JudgeSpace({free_bytes, now_.free_min, now_.state});
}

SpaceRounds::Writers SpaceRounds::Sample(std::span<const fleet::RobotPtr> robots, bool stopped) {
  const SteadyTime now = context_.clock.Steady();
  const auto passed = std::chrono::duration_cast<milliseconds>(now - sampled_);
  sampled_ = now;
  writers_.Sample(robots, stopped ? milliseconds(0) : passed);
  Writers named;
  if (now_.state == SpaceState::kEnough) {
    writers_.Release();
  } else {
    named = writers_.Name();
  }
  now_.robots_limited = writers_.named();
  return named;
}

void SpaceRounds::Apply(std::span<const fleet::RobotPtr> robots) const {
  for (const fleet::RobotPtr& robot : robots) {
    std::optional<std::uint64_t> rate;
    if (now_.state == SpaceState::kStopped) {
      rate = 0;
    } else if (writers_.IsNamed(*robot)) {
      rate = writers_.rate();
    }
    robot->flow.LimitForDisk(rate);
  }
}

void SpaceRounds::Tell(std::size_t limited_before) const {
  const std::uint64_t free_bytes = now_.space ? now_.space->free_bytes : 0;
  // Slowed down or not, these robots fill the disk.
  const auto heaviest = [this] { return TextOf(writers_.Heaviest(kHeaviestNamedMax)); };
  switch (now_.state) {
    case SpaceState::kEnough:
      context_.logger.Info("store_space_enough",
                           {{"free_bytes", free_bytes}, {"robots_released", limited_before}});
      return;
    case SpaceState::kScarce:
      context_.logger.Warn("store_space_scarce", {{"free_bytes", free_bytes},
                                                  {"free_min_bytes", now_.free_min},
                                                  {"robots_limited", now_.robots_limited},
                                                  {"bytes_per_second", writers_.rate()},
                                                  {"heaviest", heaviest()}});
      return;
    case SpaceState::kStopped:
      context_.logger.Error("store_space_stopped", {{"free_bytes", free_bytes},
                                                    {"free_min_bytes", now_.free_min},
                                                    {"robots_limited", now_.robots_limited},
                                                    {"heaviest", heaviest()}});
      return;
  }
}

}  // namespace uplink::store
