#include "server/journal/writer_inbox.h"

#include <algorithm>
#include <mutex>
#include <utility>

namespace uplink::journal {

WriterInbox::TakenOpens WriterInbox::TakeOpens(std::vector<OpenEntry> taken, std::size_t most) {
  const std::lock_guard lock(inbox_.mutex_);
  TakenOpens all;
  all.opens = inbox_.opens_.MoveTo(std::move(taken), most);
  inbox_.opens_taken_ = !all.opens.empty();
  all.records_wait = inbox_.HasBatch();
  return all;
}

void WriterInbox::PutBackOpens(std::vector<OpenEntry> taken) {
  const std::lock_guard lock(inbox_.mutex_);
  inbox_.opens_.PutBack(std::move(taken));
}

std::vector<ClaimEntry> WriterInbox::TakeClaims(std::vector<ClaimEntry> taken, std::size_t most) {
  const std::lock_guard lock(inbox_.mutex_);
  return inbox_.claims_.MoveTo(std::move(taken), most);
}

void WriterInbox::PutBackClaims(std::vector<ClaimEntry> taken) {
  const std::lock_guard lock(inbox_.mutex_);
  inbox_.claims_.PutBack(std::move(taken));
}

std::vector<AdoptEntry> WriterInbox::TakeAdopts(std::size_t most) {
  const std::lock_guard lock(inbox_.mutex_);
  return inbox_.adopts_.TakeAdopts(most);
}

void WriterInbox::AdoptLater(AdoptEntry entry) {
  const std::lock_guard lock(inbox_.mutex_);
  inbox_.adopts_.Push(std::move(entry));
}

std::vector<LossEntry> WriterInbox::TakeLosses() {
  const std::lock_guard lock(inbox_.mutex_);
  return inbox_.adopts_.TakeLosses();
}

std::vector<LeaveEntry> WriterInbox::TakeLeaves() {
  const std::lock_guard lock(inbox_.mutex_);
  return inbox_.adopts_.TakeLeaves();
}

bool WriterInbox::PresenceWaits(const std::string& ruri) const {
  const std::lock_guard lock(inbox_.mutex_);
  return inbox_.presence_.waits(ruri);
}

void WriterInbox::HoldPresence(const std::string& ruri, storage::Epoch since,
                               const std::optional<storage::StoredPresence>& stored) {
  const std::lock_guard lock(inbox_.mutex_);
  inbox_.presence_.Hold(ruri, since, stored);
}

void WriterInbox::LosePresence(const std::string& ruri) {
  const std::lock_guard lock(inbox_.mutex_);
  inbox_.presence_.Lose(ruri);
}

bool WriterInbox::FollowPresence(const storage::RobotRef& robot,
                                 const std::optional<storage::StoredPresence>& stored,
                                 Reconnected to) {
  const std::lock_guard lock(inbox_.mutex_);
  return inbox_.presence_.Follow(robot, stored, to);
}

GatheredBatch WriterInbox::Fill(GatheredBatch batch, const BatchBounds& bounds,
                                const HeldRobots& held) {
  const std::lock_guard lock(inbox_.mutex_);
  batch.SetPresence(inbox_.presence_.Take(bounds.records_max));
  if (inbox_.ConnectionsMayGo()) {
    batch.SetConnections(
        inbox_.connections_.Take(std::min(bounds.records_max, kConnectionsPerCommitMax)));
  }
  batch.SetDeliveries(std::exchange(inbox_.deliveries_, {}));
  batch.SetCommitWaiters(std::exchange(inbox_.waiting_for_commit_, {}));
  const auto oldest = inbox_.queue_.MoveTo(batch, bounds, held);
  if (!inbox_.batch_oldest_) inbox_.batch_oldest_ = oldest;
  return batch;
}

void WriterInbox::PutBack(GatheredBatch::Rest rest) {
  const std::lock_guard lock(inbox_.mutex_);
  inbox_.queue_.PutBack(std::move(rest.entries));
  inbox_.presence_.PutBack(std::move(rest.presence));
  inbox_.connections_.PutBack(std::move(rest.connections));
}

void WriterInbox::Release(const Done& done) {
  std::vector<loop::StreamRef> wake;
  {
    const std::lock_guard lock(inbox_.mutex_);
    inbox_.records_.fetch_sub(done.records);
    inbox_.bytes_.fetch_sub(done.bytes);
    if (done.batch_ended) inbox_.batch_oldest_.reset();
    std::erase_if(inbox_.waiting_for_room_, [&](const Inbox::Waiter& waiter) {
      const bool room = inbox_.HasRoomFor(waiter.gateway.get());
      if (room) wake.push_back(waiter.stream);
      return room;
    });
  }
  for (const loop::StreamRef stream : wake) stream.Wake();
}

void WriterInbox::EndCheckpoint() {
  const std::lock_guard lock(inbox_.mutex_);
  inbox_.checkpoint_open_.store(inbox_.checkpoint_asked_.load());
}

void WriterInbox::WaitUntil(SteadyTime due, const std::stop_token& stop) {
  std::unique_lock lock(inbox_.mutex_);
  const auto work = [this] {
    return inbox_.HasBatch() || !inbox_.opens_.empty() || !inbox_.claims_.empty() ||
           !inbox_.adopts_.empty() || inbox_.checkpoint_asked_.load();
  };
  const SteadyTime::duration left = due - inbox_.clock_.Steady();
  inbox_.work_.wait_for(lock, stop, std::max(left, SteadyTime::duration(0)), work);
}

}  // namespace uplink::journal
