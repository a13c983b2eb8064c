#include "server/forward/rounds.h"

#include <algorithm>
#include <set>
#include <string>
#include <utility>

#include <pthread.h>

#include "server/forward/frames.h"
#include "server/forward/limits.h"

namespace uplink::forward {

SteadyTime::duration LookAgainAfter(std::size_t woken) {
  return std::clamp<SteadyTime::duration>(woken * kPauseForOne, kLookAgain, kLookAgainMax);
}

void Rounds::Start() {
  thread_ = std::jthread([this](const std::stop_token& stop) { Run(stop); });
  ::pthread_setname_np(thread_.native_handle(), "forward");
}

void Rounds::Stop() {
  thread_.request_stop();
  if (thread_.joinable()) thread_.join();
}

void Rounds::Wake() {
  {
    const std::lock_guard lock(mutex_);
    if (std::exchange(woken_, true)) return;
  }
  wake_.notify_one();
}

void Rounds::Run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const SteadyTime began = context_.clock.Steady();
    static_cast<void>(Round());
    std::unique_lock lock(mutex_);
    // A store that is away answers nobody sooner.
    const SteadyTime::duration most = kLookEvery;
    if (!wake_.wait_for(lock, stop, most, [this] { return woken_ && !failing_; })) continue;
    const SteadyTime next = began + LookAgainAfter(woken_streams_);
    wake_.wait_for(lock, stop, next - context_.clock.Steady(), [] { return false; });
    woken_ = false;
  }
}

absl::Status Rounds::Round() {
  woken_streams_ = 0;
  if (context_.clock_trust.vouched()) context_.forwards.Expire(context_.clock.System());
  WakeReceivers();
  absl::Status status = Look();
  WakeReceivers();
  Tell(status);
  return status;
}

void Rounds::WakeReceivers() { woken_streams_ += context_.forwards.WakeReceivers(); }

absl::Status Rounds::Look() {
  const bool again =
      context_.forwards.left_out() && context_.clock.Steady() - read_all_at_ >= kReadAllAgain;
  if (!positions_ || again) {
    if (absl::Status read = ReadAll(); !read.ok()) return read;
  }
  return FollowChanges();
}

absl::Status Rounds::ReadAll() {
  // Before the items: what is committed while they are read comes again as a change.
  auto positions = context_.items.Positions();
  if (!positions.ok()) return positions.status();
  read_all_at_ = context_.clock.Steady();
  context_.forwards.ForgetLeftOut();
  std::set<storage::ItemKey> present;
  std::optional<storage::ItemKey> after;
  while (true) {
    const auto page = context_.items.Page(after);
    if (!page.ok()) return page.status();
    for (const storage::SharedItem& item : page->items) {
      present.insert(item.Key());
      Put(item);
    }
    WakeReceivers();
    if (!page->more) break;
    after = page->items.back().Key();
  }
  for (const storage::ItemKey& key : context_.forwards.Keys()) {
    if (!present.contains(key)) context_.forwards.Remove(key);
  }
  positions_ = *std::move(positions);
  context_.probe.reads_of_all.Add();
  context_.forwards.SetWhole();
  WakeReceivers();
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
    if (absl::Status applied = Apply(changes->keys); !applied.ok()) return applied;
    positions_ = std::move(changes->positions);
    context_.probe.changes.Add(static_cast<std::int64_t>(changes->keys.size()));
    if (!changes->more) return absl::OkStatus();
  }
}

absl::Status Rounds::Apply(std::span<const storage::ItemKey> keys) {
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
        context_.forwards.Remove(key);
      } else {
        Put(*item->second);
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

void Rounds::Put(const storage::SharedItem& item) {
  const storage::ItemKey key = item.Key();
  if (Expired(item.expires_at_ms())) return context_.forwards.Remove(key);
  context_.forwards.Put(key, item.robot().fleet, item.expires_at_ms(),
                        [&](const nexus_command::CommandId& command) -> EncodedFrame {
                          auto frame = UpsertFrame(item, command);
                          if (frame.ok()) return *std::move(frame);
                          NoteUnreadable(key, frame.status());
                          return nullptr;
                        });
}

void Rounds::NoteUnreadable(const storage::ItemKey& key, const absl::Status& why) {
  context_.probe.unreadable.Add();
  context_.logger.Warn("forward_unreadable",
                       {{"robot", key.ruri}, {"id", key.id}, {"why", std::string(why.message())}});
}

void Rounds::Tell(const absl::Status& status) {
  const bool left_out = context_.forwards.left_out();
  if (left_out != std::exchange(told_left_out_, left_out)) {
    if (left_out) {
      context_.logger.Warn("forward_left_out", {{"bytes", context_.forwards.sum().bytes}});
    } else {
      context_.logger.Info("forward_complete_again", {});
    }
  }
  context_.probe.failing.Set(status.ok() ? 0 : 1);
  const std::lock_guard lock(mutex_);
  if (failing_ == !status.ok()) return;
  failing_ = !status.ok();
  if (failing_) {
    context_.logger.Warn("forward_fails", {{"why", std::string(status.message())}});
  } else {
    context_.logger.Info("forward_works_again", {});
  }
}

}  // namespace uplink::forward
