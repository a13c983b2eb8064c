#include "server/journal/shards.h"

#include <algorithm>
#include <functional>
#include <string>
#include <utility>

#include <fmt/format.h>

#include "schema/base/check.h"

namespace uplink::journal {

Shards::Shards(std::vector<Journal*> journals) : journals_(std::move(journals)) {
  UPLINK_CHECK(!journals_.empty(), "a server has a journal");
}

Journal& Shards::Of(std::string_view ruri) const {
  return *journals_[std::hash<std::string_view>{}(ruri) % journals_.size()];
}

std::size_t Shards::records() const {
  std::size_t sum = 0;
  for (const Journal* journal : journals_) sum += journal->records();
  return sum;
}

std::size_t Shards::bytes() const {
  std::size_t sum = 0;
  for (const Journal* journal : journals_) sum += journal->bytes();
  return sum;
}

std::size_t Shards::records_worst() const {
  std::size_t most = 0;
  for (const Journal* journal : journals_) most = std::max(most, journal->records());
  return most;
}

std::size_t Shards::bytes_worst() const {
  std::size_t most = 0;
  for (const Journal* journal : journals_) most = std::max(most, journal->bytes());
  return most;
}

milliseconds Shards::oldest(SteadyTime now) const {
  milliseconds oldest{0};
  for (const Journal* journal : journals_) oldest = std::max(oldest, journal->oldest(now));
  return oldest;
}

bool Shards::idle() const {
  return std::ranges::all_of(journals_, [](const Journal* journal) { return journal->idle(); });
}

absl::Status Shards::last_error() const {
  for (std::size_t shard = 0; shard < journals_.size(); ++shard) {
    absl::Status error = journals_[shard]->last_error();
    if (error.ok()) continue;
    if (journals_.size() == 1) return error;
    return {error.code(), fmt::format("shard {} of {}: {}", shard, journals_.size(),
                                      std::string(error.message()))};
  }
  return absl::OkStatus();
}

absl::Status Shards::checkpoint_error() const {
  for (const Journal* journal : journals_) {
    absl::Status error = journal->checkpoint_error();
    if (!error.ok()) return error;
  }
  return absl::OkStatus();
}

std::vector<WentBack> Shards::TakeWentBack() const {
  std::vector<WentBack> taken;
  for (std::size_t shard = 0; shard < journals_.size(); ++shard) {
    WentBack went_back = journals_[shard]->TakeWentBack();
    if (went_back.robots == 0) continue;
    went_back.shard = shard;
    taken.push_back(std::move(went_back));
  }
  return taken;
}

JournalLimits ShareOf(const JournalLimits& all, std::size_t shards) {
  JournalLimits share = all;
  share.bytes_max = std::max<std::size_t>(all.bytes_max / shards, 1);
  share.records_max = std::max<std::size_t>(all.records_max / shards, 1);
  share.connections_max = std::max<std::size_t>(all.connections_max / shards, 1);
  return share;
}

storage::ProcessId PresenceSessionOf(const storage::ProcessId& process, std::size_t shard) {
  storage::ProcessId session = process;
  session.back() = static_cast<std::uint8_t>(session.back() ^ shard);
  return session;
}

}  // namespace uplink::journal
