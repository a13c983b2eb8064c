#include "server/journal/journal.h"

#include <algorithm>
#include <utility>

#include "schema/base/check.h"

namespace uplink::journal {
namespace {

/// What a waiting record costs besides its payload and its body: the record, the queue's node.
constexpr std::size_t kRecordOverheadBytes = 512;
/// It holds the payload, for quarantine, and the decoded body, which is about as large.
constexpr std::size_t kPayloadCopies = 2;

double Seconds(SteadyTime::duration duration) {
  return std::chrono::duration<double>(duration).count();
}

}  // namespace

Journal::Journal(storage::Store& store, const JournalLimits& limits, const Clock& clock,
                 metrics::Ledger& ledger, JournalProbe& probe, const storage::ProcessId& process)
    : store_(store),
      limits_(limits),
      clock_(clock),
      ledger_(ledger),
      probe_(probe),
      batch_max_now_(limits.batch_records_max),
      sweep_due_(clock.Steady() + kSweepInterval),
      retain_due_(clock.Steady()) {
  batch_.presence_session = model::SessionId(process);
}

void Journal::Open(robot::CommitClient& client, std::uint64_t open_id,
                   storage::OpenRequest request) {
  {
    const std::lock_guard lock(mutex_);
    const auto queued = std::ranges::find(opens_, &client, &OpenEntry::client);
    if (queued != opens_.end()) {
      *queued = {.client = &client, .open_id = open_id, .request = std::move(request)};
      return;
    }
    opens_.push_back({.client = &client, .open_id = open_id, .request = std::move(request)});
    opens_waiting_.fetch_add(1);
  }
  work_.notify_one();
}

void Journal::Append(robot::CommitClient& client, std::uint64_t generation,
                     storage::CommitRecord record, SteadyTime arrived) {
  const std::size_t bytes = kPayloadCopies * record.payload.size() + kRecordOverheadBytes;
  Push({.client = &client,
        .generation = generation,
        .arrived = arrived,
        .bytes = bytes,
        .item = std::move(record)});
}

void Journal::AppendGap(robot::CommitClient& client, std::uint64_t generation,
                        storage::GapItem gap) {
  Push({.client = &client,
        .generation = generation,
        .arrived = clock_.Steady(),
        .bytes = kRecordOverheadBytes,
        .item = std::move(gap)});
}

void Journal::Push(Entry entry) {
  {
    const std::lock_guard lock(mutex_);
    records_.fetch_add(1);
    bytes_.fetch_add(entry.bytes);
    queue_.push_back(std::move(entry));
  }
  work_.notify_one();
}

void Journal::WhenRoom(robot::StreamRef stream) {
  {
    const std::lock_guard lock(mutex_);
    if (!HasRoom()) {
      if (std::ranges::find(waiting_for_room_, stream) == waiting_for_room_.end()) {
        waiting_for_room_.push_back(stream);
      }
      return;
    }
  }
  stream.Wake();
}

milliseconds Journal::oldest(SteadyTime now) const {
  const std::lock_guard lock(mutex_);
  std::optional<SteadyTime> oldest = batch_oldest_;
  if (!oldest && !queue_.empty()) oldest = queue_.front().arrived;
  return oldest ? std::chrono::duration_cast<milliseconds>(now - *oldest) : milliseconds(0);
}

absl::Status Journal::last_error() const {
  const std::lock_guard lock(mutex_);
  return last_error_.ok() ? duty_error_ : last_error_;
}

absl::Status Journal::retain_error() const {
  const std::lock_guard lock(mutex_);
  return retain_error_;
}

void Journal::WaitForWork(const std::stop_token& stop) {
  std::unique_lock lock(mutex_);
  const auto work = [this] {
    return !queue_.empty() || !opens_.empty() || !presence_.empty() || checkpoint_asked_.load();
  };
  SteadyTime due = clock_.Steady() + kSweepInterval;
  if (limits_.sweeps) due = std::min(due, sweep_due_);
  if (limits_.retains) due = std::min(due, retain_due_);
  if (live_ != nullptr) due = std::min(due, checkpoint_due_);
  const SteadyTime::duration left = due - clock_.Steady();
  work_.wait_for(lock, stop, std::max(left, SteadyTime::duration(0)), work);
}

Journal::Step Journal::Advance() {
  if (outcomes_) {
    TellOutcomes();
    return Step::kWorked;
  }
  // What waits goes between two duties, so that a long one that is followed by the next keeps no
  // robot waiting for more than itself; and before a checkpoint, of which there are many calls.
  const bool after_duty = std::exchange(after_duty_, false);
  std::optional<Step> done;
  if (!after_duty) done = AdvanceDuty();
  if (!done && std::exchange(after_work_, false)) done = AdvanceCheckpoint();
  if (!done) done = AdvanceWork();
  if (!done) done = AdvanceCheckpoint();
  if (!done && after_duty) done = AdvanceDuty();
  return done.value_or(Step::kIdle);
}

std::optional<Journal::Step> Journal::AdvanceWork() {
  after_work_ = true;
  // By turns, so that a storm of streams keeps no commit waiting, and no commit a Welcome.
  const bool batch_turn = std::exchange(batch_turn_, false);
  if (!batch_turn && GatherOpens()) return AdvanceOpens();
  if (GatherBatch()) return AdvanceCommit();
  if (batch_turn && GatherOpens()) return AdvanceOpens();
  after_work_ = false;
  return std::nullopt;
}

bool Journal::GatherOpens() {
  const std::lock_guard lock(mutex_);
  while (!opens_.empty() && opening_.size() < opens_max_now_) {
    OpenEntry entry = std::move(opens_.front());
    opens_.pop_front();
    const auto queued = std::ranges::find(opening_, entry.client, &OpenEntry::client);
    if (queued == opening_.end()) {
      opening_.push_back(std::move(entry));
    } else {
      *queued = std::move(entry);
      opens_waiting_.fetch_sub(1);
    }
  }
  batch_turn_ = !opening_.empty() && (!queue_.empty() || !presence_.empty() || HasBatch());
  return !opening_.empty();
}

Journal::Step Journal::AdvanceOpens() {
  std::vector<storage::OpenRequest> requests;
  requests.reserve(opening_.size());
  for (const OpenEntry& entry : opening_) requests.push_back(entry.request);
  const auto results = store_.OpenStreams(requests);
  NoteResult(results.status());
  if (!results.ok()) {
    NoteOpenFailure();
    return Step::kFailed;
  }
  NoteSuccess(open_failures_, opens_max_now_, kOpensPerCallMax);
  UPLINK_CHECK(results->size() == opening_.size(), "the store answers every OpenStream");
  const std::vector<OpenEntry> opened = std::exchange(opening_, {});
  for (std::size_t i = 0; i < opened.size(); ++i) TellOpened(opened[i], (*results)[i]);
  opens_waiting_.fetch_sub(opened.size());
  return Step::kWorked;
}

void Journal::TellOpened(const OpenEntry& open, const storage::OpenResult& result) {
  const auto [held, first] = held_since_.try_emplace(open.client, result.held_since);
  const bool interrupted = !first && held->second != result.held_since;
  held->second = result.held_since;
  const robot::StreamRef stream =
      interrupted ? open.client->OnFenced(ledger_) : open.client->OnOpened(open.open_id, result);
  stream.Wake();
}

bool Journal::MayCommit(const Entry& entry) const {
  // A robot's first OpenStream goes before its first records; what is void is only dropped.
  return held_since_.contains(entry.client) || entry.generation != entry.client->generation();
}

bool Journal::GatherBatch() {
  if (!HasBatch()) {
    const std::lock_guard lock(mutex_);
    TakePresence();
    std::size_t bytes = 0;
    while (!queue_.empty() && owners_.size() + gap_owners_.size() < batch_max_now_ &&
           bytes < limits_.batch_bytes_max && MayCommit(queue_.front())) {
      bytes += queue_.front().bytes;
      if (!batch_oldest_) batch_oldest_ = queue_.front().arrived;
      AddToBatch(std::move(queue_.front()));
      queue_.pop_front();
    }
  }
  return HasBatch();
}

void Journal::TakePresence() {
  if (presence_left_.empty()) {
    batch_.presence = presence_.Take(batch_max_now_);
    return;
  }
  const auto some = static_cast<std::ptrdiff_t>(std::min(presence_left_.size(), batch_max_now_));
  batch_.presence.assign(presence_left_.begin(), presence_left_.begin() + some);
  presence_left_.erase(presence_left_.begin(), presence_left_.begin() + some);
}

void Journal::AddToBatch(Entry entry) {
  const Owner owner{.client = entry.client,
                    .generation = entry.generation,
                    .arrived = entry.arrived,
                    .bytes = entry.bytes,
                    .tried = entry.tried};
  if (auto* record = std::get_if<storage::CommitRecord>(&entry.item)) {
    batch_.records.push_back(std::move(*record));
    owners_.push_back(owner);
  } else {
    batch_.gaps.push_back(std::move(std::get<storage::GapItem>(entry.item)));
    gap_owners_.push_back(owner);
  }
}

void Journal::DropVoid() {
  const auto is_void = [](const Owner& owner) {
    return owner.generation != owner.client->generation();
  };
  std::size_t dropped = 0;
  std::size_t bytes = 0;
  const auto drop_from = [&](auto& items, std::vector<Owner>& owners) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < owners.size(); ++i) {
      if (is_void(owners[i])) {
        ++dropped;
        bytes += owners[i].bytes;
        // Its robot's next stream may be held back for them.
        if (&owners == &gap_owners_) owners[i].client->OnGapsWritten(1).Wake();
        continue;
      }
      if (kept != i) {
        owners[kept] = owners[i];
        items[kept] = std::move(items[i]);
      }
      ++kept;
    }
    owners.resize(kept);
    items.erase(items.begin() + static_cast<std::ptrdiff_t>(kept), items.end());
  };
  drop_from(batch_.records, owners_);
  drop_from(batch_.gaps, gap_owners_);
  if (dropped > 0) Release(dropped, bytes);
}

Journal::Step Journal::AdvanceCommit() {
  DropVoid();
  // Nothing comes into a batch before its robot is held, and a hold that was lost made it void.
  for (std::size_t i = 0; i < owners_.size(); ++i) {
    batch_.records[i].held_since = held_since_.at(owners_[i].client);
  }
  for (std::size_t i = 0; i < gap_owners_.size(); ++i) {
    batch_.gaps[i].held_since = held_since_.at(gap_owners_[i].client);
  }
  const SteadyTime began = clock_.Steady();
  auto outcomes = store_.Commit(batch_);
  NoteResult(outcomes.status());
  if (!outcomes.ok()) {
    NoteCommitFailure();
    return Step::kFailed;
  }
  NoteSuccess(commit_failures_, batch_max_now_, limits_.batch_records_max);
  UPLINK_CHECK(outcomes->size() == owners_.size(), "the store answers every record");
  probe_.commit_seconds.Observe(Seconds(clock_.Steady() - began));
  probe_.commit_records.Observe(static_cast<double>(owners_.size()));
  CountPresence();
  outcomes_ = *std::move(outcomes);
  return Step::kWorked;
}

}  // namespace uplink::journal
