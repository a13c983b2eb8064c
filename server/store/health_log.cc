#include "server/store/health_log.h"

#include <chrono>
#include <string>
#include <utility>

#include <fmt/format.h>

namespace uplink::store {
namespace {

/// A store's clock that differs by more is worth a line.
constexpr std::chrono::seconds kClockOffsetLogged{5};

}  // namespace

HealthLog::HealthLog(Sources sources, const log::Logger& logger)
    : sources_(std::move(sources)), logger_(logger) {}

void HealthLog::LookAtFacts() {
  const storage::StoreFacts facts = sources_.facts();
  if (facts.unsafe && !said_unsafe_) {
    logger_.Warn("store_unsafe", {{"why", "fsync is off: what is acked may be lost"}});
  }
  said_unsafe_ = facts.unsafe;
  const bool differs =
      facts.clock_offset > kClockOffsetLogged || -facts.clock_offset > kClockOffsetLogged;
  if (differs && !said_clock_) {
    logger_.Warn("store_clock_differs", {{"offset_ms", facts.clock_offset.count()}});
  }
  said_clock_ = differs;
}

void HealthLog::LookAtSnapshot(const storage::StoreFacts& facts) {
  if (facts.old_snapshot() == said_snapshot_) return;
  said_snapshot_ = facts.old_snapshot();
  if (said_snapshot_) {
    logger_.Warn("store_old_snapshot",
                 {{"why",
                   "another connection reads an old state: the database keeps dead rows,"
                   " or its WAL, for it"},
                  {"age_ms", facts.oldest_snapshot.count()}});
  } else {
    logger_.Info("store_old_snapshot_gone", {});
  }
}

void HealthLog::LookAtWentBack() const {
  for (const journal::WentBack& shard : sources_.went_back()) {
    logger_.Warn("store_went_back",
                 {{"why", "after a reconnect the database lacks commits that it had confirmed"},
                  {"shard", shard.shard},
                  {"robots", shard.robots},
                  {"named", fmt::format("{}", fmt::join(shard.named, " "))}});
  }
}

void HealthLog::Look() {
  LookAtFacts();
  LookAtWentBack();
  LookAtSnapshot(sources_.facts());
  LogChange(retention_, sources_.retention());
  LogChange(checkpoints_, sources_.checkpoints());
  LogChange(store_, sources_.store());
}

void HealthLog::LogChange(Condition& condition, const absl::Status& status) const {
  if (status.ok() == condition.works) return;
  condition.works = status.ok();
  if (condition.works) {
    logger_.Info(condition.works_again, {});
  } else {
    logger_.Warn(condition.fails, {{"why", std::string(status.message())}});
  }
}

}  // namespace uplink::store
