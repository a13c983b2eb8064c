#include "server/front/call/unfinished.h"

#include <algorithm>

#include "server/front/call/message_reader.h"

namespace uplink::front {
namespace {

/// The share of the transport's memory that unfinished messages may take.
constexpr std::size_t kUnfinishedPart = 4;
/// The memory of a message that grows is doubled each time.
constexpr std::size_t kGrowth = 2;

}  // namespace

Unfinished::Limits UnfinishedLimitsFor(std::size_t memory_bytes_max, std::size_t frame_bytes_max) {
  const std::size_t part = memory_bytes_max == 0
                               ? kUnfinishedBytesMax
                               : std::min(kUnfinishedBytesMax, memory_bytes_max / kUnfinishedPart);
  const std::size_t one = kGrowth * (kPrefixBytes + frame_bytes_max);
  return {.bytes_max = std::max(part, one), .share_max = one};
}

void Unfinished::Set(const loop::StreamRef& call, const KeyDigest& key, std::uint64_t message,
                     std::size_t bytes, SteadyTime now) {
  loop::StreamRef chosen;
  {
    const std::lock_guard lock(mutex_);
    Note({call.inbox, call.stream}, key, message, bytes, now);
    if (!over() || chosen_) return;
    chosen_ = Choose();
    if (chosen_) chosen = {chosen_->first, chosen_->second};
  }
  // It may belong to another connection and another thread.
  chosen.Wake();
}

void Unfinished::Note(const CallId& call, const KeyDigest& key, std::uint64_t message,
                      std::size_t bytes, SteadyTime now) {
  const auto found = entries_.find(call);
  if (found != entries_.end() && bytes > 0 && found->second.message == message) {
    Entry& entry = found->second;
    Holder& holder = holders_.at(entry.key);
    holder.bytes = holder.bytes - entry.bytes + bytes;
    bytes_ = bytes_ - entry.bytes + bytes;
    entry.bytes = bytes;
  } else {
    if (found != entries_.end()) Remove(call);
    if (bytes > 0) {
      entries_.emplace(call, Entry{key, now, message, bytes});
      Holder& holder = holders_[key];
      holder.bytes += bytes;
      holder.calls.emplace(now, call);
      bytes_ += bytes;
    }
  }
  probe_.unfinished_bytes.Set(static_cast<std::int64_t>(bytes_));
}

void Unfinished::Remove(const CallId& call) {
  const auto entry = entries_.find(call);
  const auto holder = holders_.find(entry->second.key);
  bytes_ -= entry->second.bytes;
  holder->second.bytes -= entry->second.bytes;
  holder->second.calls.erase({entry->second.began, call});
  if (holder->second.calls.empty()) holders_.erase(holder);
  entries_.erase(entry);
  if (chosen_ == call) chosen_.reset();
}

std::optional<Unfinished::CallId> Unfinished::Choose() const {
  const Holder* most = nullptr;
  const Holder* slowest = nullptr;
  for (const auto& [key, holder] : holders_) {
    if (most == nullptr || holder.bytes > most->bytes) most = &holder;
    if (slowest == nullptr || *holder.calls.begin() < *slowest->calls.begin()) slowest = &holder;
  }
  if (most == nullptr) return std::nullopt;
  return (most->bytes > limits_.share_max ? most : slowest)->calls.begin()->second;
}

bool Unfinished::MustEnd(const loop::StreamRef& call) const {
  const std::lock_guard lock(mutex_);
  return chosen_ == CallId{call.inbox, call.stream};
}

}  // namespace uplink::front
