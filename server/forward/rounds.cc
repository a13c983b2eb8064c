#include "server/forward/rounds.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include "server/forward/frames.h"
#include "server/forward/limits.h"

namespace uplink::forward {

static_assert(kLookEvery + kLookAgainMax < std::chrono::seconds(2),
              "what another server committed is forwarded within two seconds");

SteadyTime::duration LookAgainAfter(std::size_t woken) {
  return std::clamp<SteadyTime::duration>(woken * kPauseForOne, kLookAgain, kLookAgainMax);
}

Rounds::Rounds(const Context& context)
    : context_(context),
      unreadable_(context.logger, context.probe),
      paces_(context.paces),
      left_out_(context.logger, "forward_left_out", "most_from"),
      paced_(context.logger, "forward_paced"),
      behind_(context.logger, "forward_receiver_behind", "most_from"),
      rounds_("forward", [this](const std::stop_token& stop) {
        stop_ = stop;
        const SteadyTime began = context_.clock.Steady();
        static_cast<void>(Round());
        return NextLook(began, context_.clock.Steady());
      }) {}

loop::Next Rounds::NextLook(SteadyTime began, SteadyTime now) {
  // A store that is away does not answer sooner when asked more often.
  if (failing_) return {.within = context_.look_every, .not_before = context_.look_every};
  const SteadyTime::duration again = LookAgainAfter(woken_streams_);
  loop::Next next{.within = context_.look_every, .not_before = began + again - now};
  if (const std::optional<SteadyTime> due = paces_.DueAt(now)) {
    next.within = std::clamp<SteadyTime::duration>(
        *due - now, again, std::max(context_.look_every, SteadyTime::duration(kLookAgainMax)));
  }
  return next;
}

absl::Status Rounds::Round() {
  woken_streams_ = 0;
  absl::Status status = Look();
  WakeReceivers();
  Tell(status);
  return status;
}

void Rounds::WakeReceivers() { woken_streams_ += context_.forwards.WakeReceivers(); }

absl::Status Rounds::Look() {
  if (!positions_) {
    // Expiries need no store.
    Expire();
    if (absl::Status read = ReadAll(); !read.ok()) return read;
  }
  if (absl::Status step = Step(); !step.ok()) return step;
  return LookAtLeftOut();
}

void Rounds::Expire() {
  if (context_.clock_trust.vouched()) context_.forwards.Expire(context_.clock.System());
  WakeReceivers();
}

absl::Status Rounds::Step() {
  Expire();
  if (absl::Status followed = FollowChanges(); !followed.ok()) return followed;
  return Apply(paces_.Due(context_.clock.Steady()), Paces::Turn::kWaited);
}

absl::Status Rounds::WalkPages(std::optional<storage::ItemKey> after, const Walk& walk) {
  while (true) {
    // Reading everything that fleets share may take seconds.
    if (stop_.stop_requested()) return absl::CancelledError("the server stops");
    const auto page = context_.items.Page(after);
    if (!page.ok()) return page.status();
    for (const storage::SharedItem& item : page->items) {
      if (!walk.take(item)) return absl::OkStatus();
    }
    WakeReceivers();
    if (!page->more) return absl::OkStatus();
    after = page->items.back().Key();
    if (absl::Status between = walk.between(); !between.ok()) return between;
  }
}

absl::Status Rounds::ReadAll() {
  // Read before the items: commits during the read come again as changes.
  auto positions = context_.items.Positions();
  if (!positions.ok()) return positions.status();
  context_.forwards.shares().BeginLookAtAll();
  paces_.ForgetAll();
  std::set<storage::ItemKey> present;
  absl::Status read = WalkPages(std::nullopt, {.take =
                                                   [&](const storage::SharedItem& item) {
                                                     present.insert(item.Key());
                                                     Put(item);
                                                     return true;
                                                   },
                                               .between =
                                                   [this] {
                                                     Expire();
                                                     return absl::OkStatus();
                                                   }});
  if (!read.ok()) return read;
  for (const storage::ItemKey& key : context_.forwards.Keys()) {
    if (!present.contains(key)) Remove(key);
  }
  unreadable_.KeepOnly([&](const storage::ItemKey& key) { return present.contains(key); });
  context_.forwards.shares().EndLook();
  positions_ = *std::move(positions);
  context_.probe.reads_of_all.Add();
  context_.forwards.SetWhole();
  WakeReceivers();
  return absl::OkStatus();
}

absl::Status Rounds::LookAtLeftOut() {
  if (!context_.forwards.left_out() ||
      !left_out_looks_.Take(context_.clock.Steady(), kLookAtLeftOutEvery)) {
    return absl::OkStatus();
  }
  // Each robot once: one that keeps giving room back would keep this thread busy for ever.
  for (const std::string& robot : context_.forwards.shares().DueForLook()) {
    if (absl::Status read = ReadRobot(robot); !read.ok()) return read;
    // Do not delay the others' items for one robot.
    if (absl::Status step = Step(); !step.ok()) return step;
  }
  return absl::OkStatus();
}

absl::Status Rounds::ReadRobot(const std::string& ruri) {
  context_.forwards.shares().BeginLook(ruri);
  for (const auto kind : storage::kItemKinds) {
    absl::Status read =
        WalkPages(storage::ItemKey{kind, ruri, ""}, {.take =
                                                         [&](const storage::SharedItem& item) {
                                                           const storage::ItemKey key = item.Key();
                                                           if (key.kind != kind || key.ruri != ruri)
                                                             return false;
                                                           PutPaced(item, Paces::Turn::kNew);
                                                           return true;
                                                         },
                                                     .between = [this] { return Step(); }});
    if (!read.ok()) {
      context_.forwards.shares().BreakOffLook();
      return read;
    }
  }
  context_.forwards.shares().EndLook();
  return absl::OkStatus();
}

absl::Status Rounds::FollowChanges() {
  while (true) {
    auto changes = context_.items.ChangesSince(*positions_);
    if (!changes.ok()) return changes.status();
    if (changes->trimmed) {
      context_.logger.Warn("forward_changes_missed", {});
      positions_.reset();
      return ReadAll();
    }
    if (absl::Status applied = Apply(changes->keys, Paces::Turn::kNew); !applied.ok())
      return applied;
    positions_ = std::move(changes->positions);
    context_.probe.changes.Add(static_cast<std::int64_t>(changes->keys.size()));
    if (changes->more) {
      Expire();
      continue;
    }
    context_.probe.followed_at_ms.Set(SteadyMs(context_.clock.Steady()));
    return absl::OkStatus();
  }
}

absl::Status Rounds::Apply(std::span<const storage::ItemKey> keys, Paces::Turn turn) {
  while (!keys.empty()) {
    const auto now = keys.first(std::min(keys.size(), kLookedUpMax));
    keys = keys.subspan(now.size());
    const auto items = context_.items.Of(now);
    if (!items.ok()) return items.status();
    std::map<storage::ItemKey, const storage::SharedItem*> present;
    for (const storage::SharedItem& item : *items) present.emplace(item.Key(), &item);
    for (const storage::ItemKey& key : now) {
      const auto item = present.find(key);
      if (item == present.end()) {
        Remove(key);
      } else {
        PutPaced(*item->second, turn);
      }
    }
    WakeReceivers();
  }
  return absl::OkStatus();
}

bool Rounds::Expired(std::int64_t expires_ms) const {
  return expires_ms != 0 && context_.clock_trust.vouched() &&
         expires_ms <= UnixMs(context_.clock.System());
}

void Rounds::Remove(const storage::ItemKey& key) {
  unreadable_.Forget(key);
  paces_.Forget(key);
  paces_.NoteForwarded(key.ruri, context_.forwards.Remove(key), context_.clock.Steady());
}

void Rounds::PutPaced(const storage::SharedItem& item, Paces::Turn turn) {
  const storage::ItemKey key = item.Key();
  if (paces_.Passes(key, turn, context_.clock.Steady())) return Put(item);
  // Until the item's new content follows, it expires as the store says.
  context_.forwards.Postpone(key, item.robot().fleet, item.expires_at_ms());
}

void Rounds::Put(const storage::SharedItem& item) {
  const storage::ItemKey key = item.Key();
  if (Expired(item.expires_at_ms())) return Remove(key);
  absl::Status unreadable;
  const std::size_t bytes =
      context_.forwards.Put(key,
                            {.fleet = item.robot().fleet,
                             .expires_ms = item.expires_at_ms(),
                             .least_bytes = LeastFrameBytes(item)},
                            [&](const nexus_command::CommandId& command) -> EncodedFrame {
                              auto frame = UpsertFrame(item, command);
                              if (frame.ok()) return *std::move(frame);
                              unreadable = frame.status();
                              return nullptr;
                            });
  paces_.NoteForwarded(key.ruri, bytes, context_.clock.Steady());
  if (unreadable.ok()) {
    unreadable_.Forget(key);
  } else {
    unreadable_.Note(key, unreadable);
  }
}

void Rounds::TellRobots() {
  const bool was_left_out = !left_out_.none();
  left_out_.Tell(context_.forwards.shares().robots_left_out());
  if (was_left_out && left_out_.none()) context_.logger.Info("forward_complete_again", {});
  context_.probe.paced_now.Set(static_cast<std::int64_t>(paces_.waiting()));
  paced_.Tell(paces_.robots());
  behind_.Tell(context_.forwards.TakeOverflowed());
}

void Rounds::Tell(const absl::Status& status) {
  TellRobots();
  if (stop_.stop_requested()) return;
  context_.probe.failing.Set(status.ok() ? 0 : 1);
  if (failing_ == !status.ok()) return;
  failing_ = !status.ok();
  if (failing_) {
    context_.logger.Warn("forward_fails", {{"why", std::string(status.message())}});
  } else {
    context_.logger.Info("forward_works_again", {});
  }
}

}  // namespace uplink::forward
