#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/uncrew/judge.h"
#include "server/fleet/claim.h"
#include "server/fleet/fleet.h"
#include "server/ingest/port.h"
#include "server/journal/journal.h"
#include "server/limits/token_bucket.h"
#include "server/robot/commit_client.h"
#include "server/uncrew/answer.h"
#include "server/uncrew/drone_claim.h"
#include "server/uncrew/judged_sample.h"
#include "server/uncrew/live_samples.h"
#include "server/uncrew/stored_samples.h"
#include "server/uncrew/waiting_samples.h"
#include "storage/samples.h"

namespace uplink::uncrew {

/// One drone as its calls see it: what it says now, what the store remembers of it, and what of it
/// waits for the store. A sample is offered again each time that its call is woken, until there is
/// an answer.
///
/// The lock is held while a sample goes to the journal, which so has a drone's samples in the order
/// in which they were judged.
///
/// Thread: thread-safe.
class Drone final : public robot::ClaimClient {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    /// For what is settled: a page of the source's.
    metrics::Ledger& ledger;
    journal::Journal& journal;
    /// Drawn for this life of the drone: for keys of quarantine alone.
    model::SessionId session;
  };
  Drone(const Context& context, fleet::RobotPtr robot);
  ~Drone() override;
  Drone(const Drone&) = delete;
  Drone& operator=(const Drone&) = delete;

  /// As whom its calls speak, of each call: another fleet than before is told to the store by a new
  /// claim. False if the robot is of another fleet, and the certificate may not move it.
  [[nodiscard]] bool SetSpeaker(const fleet::Claim& claim);
  /// A call begins; false if there are kCallsInFlightMax. Leave must follow.
  [[nodiscard]] bool Enter(SystemTime now);
  void Leave() { calls_.fetch_sub(1); }

  struct Offered {
    enum class Is : std::uint8_t {
      kAnswer,
      /// For its commit: `ticket` has what comes of it, and the caller is woken.
      kWaits,
      /// Nothing was done: the store did not answer the claim. The caller is woken.
      kUnclaimed,
      /// Nothing was done: it is offered again soon.
      kNoRoom,
      /// The store has the robot in another fleet.
      kOtherFleet,
    };
    Is is = Is::kAnswer;
    /// Of kAnswer; of kWaits what to say once it is committed.
    Answer answer{};
    TicketRef ticket{};
  };
  [[nodiscard]] Offered Offer(ingest::Port& port, const Sample& sample, loop::StreamRef caller);
  /// What came of a sample that waits.
  [[nodiscard]] Ticket Look(const TicketRef& ticket) const {
    const std::lock_guard lock(mutex_);
    return *ticket;
  }
  /// The store was connected to anew, and may be an older copy: nothing that is remembered of it
  /// counts any more. The journal tells of it before anything more is committed.
  void NoteStoreReconnected();
  /// The call waits no more.
  void Forget(const TicketRef& ticket, loop::StreamRef caller);

  [[nodiscard]] const fleet::RobotPtr& robot() const { return robot_; }
  [[nodiscard]] const std::string& ruri() const { return robot_->ruri(); }
  /// No call of it is here, and nothing waits.
  [[nodiscard]] bool idle() const;
  [[nodiscard]] SystemTime called_at() const { return FromUnixMs(called_at_ms_.load()); }
  /// Calls `look` with what it says, under the lock: short. What another server has of it is not
  /// here.
  template <typename Look>
  void LookAt(Look look) const {
    const std::lock_guard lock(mutex_);
    look(live_);
  }

  // robot::ClaimClient
  loop::StreamRef OnClaimed(const storage::ClaimResult& result) override;
  loop::StreamRef OnSettled(std::span<const robot::Settled> settled,
                            metrics::Ledger& ledger) override;
  loop::StreamRef OnFenced(metrics::Ledger& ledger) override;
  [[nodiscard]] std::uint64_t generation() const override { return generation_.load(); }

 private:
  /// What waits no more is counted, and its calls are woken. Without the lock.
  loop::StreamRef Tell(const WaitingSamples::Settling& settling);
  // Under the lock.
  [[nodiscard]] ingest::Line line();
  void ClaimIfDue(SteadyTime now);
  [[nodiscard]] Offered AwaitClaim(loop::StreamRef caller);
  [[nodiscard]] Offered OfferLive(ingest::Port& port, const Sample& sample);
  [[nodiscard]] Offered OfferDurable(ingest::Port& port, const Sample& sample,
                                     loop::StreamRef caller);
  [[nodiscard]] Offered OfferRecords(ingest::Port& port, const Sample& sample,
                                     const storage::SampleRef& mark, loop::StreamRef caller);
  /// What it says is known: of a set that waits, the answer waits, too.
  [[nodiscard]] Offered SaysTheSame(ingest::Port& port, const Sample& sample,
                                    loop::StreamRef caller);
  /// An answer that rests on what is remembered of the store goes out once the store says that the
  /// claim holds: another server may have stored since, or the store is an older copy by now.
  [[nodiscard]] Offered AskStore(const Sample& sample, Answer answer, loop::StreamRef caller);
  /// Tells the robot what waits since.
  void AddWaitingSince(const robot::JournalUse& before);
  /// Counts a sample that comes to nothing more than this answer.
  [[nodiscard]] Offered Settle(ingest::Port& port, const Sample& sample, metrics::Became became);
  [[nodiscard]] Offered Wait(const TicketRef& ticket, Answer answer, loop::StreamRef caller);

  const Context context_;
  const fleet::RobotPtr robot_;
  std::atomic<std::size_t> calls_{0};
  std::atomic<std::int64_t> called_at_ms_{0};
  std::atomic<std::uint64_t> generation_{1};

  mutable std::mutex mutex_;
  LiveSamples live_;
  StoredSamples stored_;
  WaitingSamples waiting_;
  limits::TokenBucket rate_;
  DroneClaim claim_;
  /// Calls that wait for the claim; each once.
  std::vector<loop::StreamRef> unclaimed_;
};

}  // namespace uplink::uncrew
