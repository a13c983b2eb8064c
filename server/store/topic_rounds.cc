#include "server/store/topic_rounds.h"

#include <algorithm>
#include <utility>

#include "server/broker/limits.h"
#include "server/cyberwave/metric_faults.h"

namespace uplink::store {

TopicRounds::TopicRounds(std::unique_ptr<storage::TopicLeases> leases, Context context)
    : leases_(std::move(leases)),
      context_(std::move(context)),
      rounds_("topics", [this](const auto& /*stop*/) -> loop::Next {
        Look();
        return {.within = unjudged_ ? kUnjudgedLookEvery : milliseconds(kTopicLookEvery)};
      }) {}

void TopicRounds::Leave() {
  Stop();
  if (!epoch_) return;
  epoch_.reset();
  if (const absl::Status released = leases_->Release(context_.client_id); !released.ok()) {
    context_.logger.Warn("topics_not_released", {{"why", std::string(released.message())}});
  }
}

void TopicRounds::Look() {
  const SteadyTime began = context_.clock.Steady();
  unjudged_ = false;
  const absl::Status looked = TryLook(began);
  if (!looked.ok()) failed_.store(began);
  NoteOutcome(looked);
}

absl::Status TopicRounds::TryLook(SteadyTime began) {
  const auto leases = leases_->Read();
  if (!leases.ok()) return leases.status();
  const std::uint64_t before = std::exchange(connections_, leases_->connections());
  // First, so that no connection to the broker is made before.
  if (epoch_ && connections_ != before) context_.reconnected();
  const auto ours = std::ranges::find_if(*leases, [&](const storage::TopicLease& lease) {
    return lease.client_id == context_.client_id && lease.holder == context_.process &&
           !lease.released;
  });
  if (epoch_ && ours != leases->end() && ours->epoch == *epoch_) {
    confirmed_.store(began);
    return RereadIfAsked();
  }
  if (epoch_) {
    epoch_.reset();
    context_.logger.Warn("topics_lost", {{"client_id", context_.client_id}});
    context_.lost();
  }
  return Take(*leases, began);
}

absl::Status TopicRounds::RereadIfAsked() {
  std::optional<std::uint64_t> asked;
  {
    const std::lock_guard lock(mutex_);
    asked = reread_;
  }
  if (!asked) return absl::OkStatus();
  auto memory = leases_->MemoryOf(context_.client_id);
  if (!memory.ok()) return memory.status();
  auto faults = ReadFaults();
  if (!faults.ok()) return faults.status();
  {
    const std::lock_guard lock(mutex_);
    if (reread_ == asked) reread_.reset();
  }
  context_.reread({.asked = *asked, .memory = *std::move(memory), .faults = *std::move(faults)});
  return absl::OkStatus();
}

storage::TakeRequest TopicRounds::RequestNow(const std::vector<storage::TopicLease>& leases) {
  storage::TakeRequest request{.client_id = context_.client_id,
                               .prefixes = context_.prefixes,
                               .at = context_.clock.System(),
                               .unacked_max = broker::kRememberedWindow};
  std::string held_by;
  for (const storage::TopicLease& lease : leases) {
    if (lease.holder == context_.process || !storage::Overlaps(lease, request)) continue;
    const auto verdict = context_.judge(lease.holder);
    if (!verdict) unjudged_ = true;
    if (verdict && verdict->over != Over::kNo) {
      request.over.push_back({.process = lease.holder, .lease_counter = verdict->counter});
    } else {
      held_by = verdict ? verdict->name : std::string("another server");
    }
  }
  NoteHeldBy(std::move(held_by));
  return request;
}

absl::Status TopicRounds::Take(const std::vector<storage::TopicLease>& leases, SteadyTime began) {
  const storage::TakeRequest request = RequestNow(leases);
  if (!held_by().empty()) return absl::OkStatus();
  const auto epoch = leases_->Take(request);
  if (!epoch.ok()) return epoch.status();
  // Another process was faster; the next look shows which.
  if (!*epoch) return absl::OkStatus();
  // Nothing is read until both are here, so after a failure the lease is taken again.
  auto memory = leases_->MemoryOf(context_.client_id);
  if (!memory.ok()) return memory.status();
  auto faults = ReadFaults();
  if (!faults.ok()) return faults.status();
  epoch_ = **epoch;
  confirmed_.store(began);
  context_.logger.Info("topics_taken",
                       {{"client_id", context_.client_id}, {"deliveries", memory->known.size()}});
  context_.taken({.hold = std::make_shared<const storage::TopicHold>(
                      storage::TopicHold{.client_id = context_.client_id,
                                         .epoch = *epoch_,
                                         .unacked_max = broker::kRememberedWindow}),
                  .memory = *std::move(memory),
                  .faults = *std::move(faults)});
  return absl::OkStatus();
}

absl::StatusOr<broker::FaultsByRobot> TopicRounds::ReadFaults() {
  broker::FaultsByRobot faults;
  // Of any fleet: the twins' fleet may have been another one.
  storage::FaultsQuery query{.rows = {}, .source = std::string(cyberwave::kMetricFaultSource)};
  query.rows.page_size = storage::kPageSizeMax;
  while (true) {
    const auto page = context_.reader.FaultsActive(query);
    if (!page.ok()) return page.status();
    for (const storage::FaultRow& row : page->rows) {
      faults[row.robot.ruri].push_back(row.fault.fault_id);
    }
    if (page->next_token.empty()) return faults;
    query.rows.page_token = page->next_token;
  }
}

void TopicRounds::NoteHeldBy(std::string name) {
  if (name != told_held_by_ && !name.empty()) {
    context_.logger.Info("topics_elsewhere", {{"holder", name}});
  }
  told_held_by_ = name;
  const std::lock_guard lock(mutex_);
  held_by_ = std::move(name);
}

void TopicRounds::NoteOutcome(const absl::Status& status) {
  if (failing_.exchange(!status.ok()) == !status.ok()) return;
  if (status.ok()) {
    context_.logger.Info("topics_work_again", {});
  } else {
    context_.logger.Warn("topics_fail", {{"why", std::string(status.message())}});
  }
}

bool TopicRounds::MayConnect(SteadyTime since) const {
  const SteadyTime confirmed = confirmed_.load();
  if (confirmed == SteadyTime()) return false;
  if (confirmed >= since) return true;
  return failed_.load() >= since && context_.clock.Steady() - confirmed < kLeaseTrusted;
}

void TopicRounds::RereadSoon(std::uint64_t asked) {
  {
    const std::lock_guard lock(mutex_);
    reread_ = asked;
  }
  rounds_.Wake();
}

std::string TopicRounds::held_by() const {
  const std::lock_guard lock(mutex_);
  return held_by_;
}

}  // namespace uplink::store
