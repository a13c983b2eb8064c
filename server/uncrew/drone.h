#pragma once

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
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
#include "server/robot/calls.h"
#include "server/robot/commit_client.h"
#include "server/robot/live_total.h"
#include "server/uncrew/answer.h"
#include "server/uncrew/drone_claim.h"
#include "server/uncrew/judged_sample.h"
#include "server/uncrew/live_samples.h"
#include "server/uncrew/stored_samples.h"
#include "server/uncrew/waiting_samples.h"
#include "storage/samples.h"

namespace uplink::uncrew {

/// One drone as its calls see it: its live samples, what the store remembers of it, and its samples
/// that wait for the store. A call offers its sample again each time that it is woken, until there
/// is an answer.
///
/// The lock is held while a sample goes to the journal, so the journal has a drone's samples in the
/// order in which they were judged.
///
/// Thread: thread-safe.
class Drone final : public robot::ClaimClient, public robot::CallsLive {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    /// Counts settled samples: a page of the source's.
    metrics::Ledger& ledger;
    journal::Journal& journal;
    /// The total in which its live samples count.
    std::shared_ptr<robot::LiveTotal> live_total;
    /// Drawn for this object; only keys of quarantine use it.
    model::SessionId session;
  };
  Drone(const Context& context, fleet::RobotPtr robot);
  ~Drone() override;
  Drone(const Drone&) = delete;
  Drone& operator=(const Drone&) = delete;

  /// Sets the speaker at each call; `moved`: as Fleet::Admission has it. If the fleet changed, a
  /// new claim tells the store. False if the robot is of another fleet, and the claim does not move
  /// it.
  [[nodiscard]] bool SetSpeaker(const fleet::Claim& claim, const fleet::Entry& entry, bool moved);
  /// A call begins; Leave must follow. False if there are kCallsInFlightMax already.
  [[nodiscard]] bool Enter(SystemTime now);
  void Leave() { calls_.fetch_sub(1); }

  struct Offered {
    enum class Is : std::uint8_t {
      kAnswer,
      /// It waits for its commit: `ticket` gets the result, and the caller is woken.
      kWaits,
      /// Nothing was done: the store has not answered the claim yet. The caller is woken then.
      kUnclaimed,
      /// Nothing was done: the call must offer it again soon.
      kNoRoom,
      /// The store has the robot in another fleet.
      kOtherFleet,
      /// An operator blocked the robot.
      kBlocked,
      /// It came before the store was read, and is not registered.
      kNotRegistered,
    };
    Is is = Is::kAnswer;
    /// With kAnswer: the answer. With kWaits: the answer once it is committed.
    Answer answer{};
    TicketRef ticket{};
  };
  [[nodiscard]] Offered Offer(ingest::Port& port, const Sample& sample, loop::StreamRef caller);
  /// The state of a sample that waits.
  [[nodiscard]] Ticket Look(const TicketRef& ticket) const {
    const std::lock_guard lock(mutex_);
    return *ticket;
  }
  /// The call waits no more.
  void Forget(const TicketRef& ticket, loop::StreamRef caller) {
    const std::lock_guard lock(mutex_);
    std::erase(unclaimed_, caller);
    if (ticket != nullptr) std::erase(ticket->callers, caller);
  }

  [[nodiscard]] const fleet::RobotPtr& robot() const { return robot_; }
  [[nodiscard]] const std::string& ruri() const { return robot_->ruri(); }
  /// It has no call, no waiting sample and no open claim.
  [[nodiscard]] bool idle() const {
    const std::lock_guard lock(mutex_);
    return calls_.load() == 0 && waiting_.empty() && !claim_.is_asked();
  }
  [[nodiscard]] SystemTime called_at() const { return FromUnixMs(called_at_ms_.load()); }
  /// Calls `look` with its live samples, under the lock: it must be short. Samples that it sent to
  /// another server are not here.
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
  loop::StreamRef OnDoubted() override;
  [[nodiscard]] std::uint64_t generation() const override { return generation_.load(); }
  // robot::CallsLive
  [[nodiscard]] std::size_t live_bytes() const override {
    const std::lock_guard lock(mutex_);
    return live_.bytes();
  }
  std::size_t DropLive() override;

 private:
  /// Counts samples that no longer wait, and wakes their calls. Call it without the lock.
  loop::StreamRef Tell(const WaitingSamples::Settling& settling);
  // Under the lock.
  [[nodiscard]] ingest::Line line();
  void ClaimIfDue(SteadyTime now);
  [[nodiscard]] Offered Take(ingest::Port& port, const Sample& sample, loop::StreamRef caller);
  [[nodiscard]] Offered AwaitClaim(loop::StreamRef caller) {
    if (std::ranges::find(unclaimed_, caller) == unclaimed_.end()) unclaimed_.push_back(caller);
    return {.is = Offered::Is::kUnclaimed};
  }
  [[nodiscard]] Offered OfferLive(ingest::Port& port, const Sample& sample);
  [[nodiscard]] Offered OfferDurable(ingest::Port& port, const Sample& sample,
                                     loop::StreamRef caller);
  [[nodiscard]] Offered OfferRecords(ingest::Port& port, const Sample& sample,
                                     const storage::SampleRef& mark, loop::StreamRef caller);
  /// Settles a sample whose content is already stored; if that still waits, so does the answer.
  [[nodiscard]] Offered SettleUnchanged(ingest::Port& port, const Sample& sample,
                                        loop::StreamRef caller);
  /// Delays an answer that rests on memory until the store says that the claim still holds: another
  /// server may have stored since, or the store may be an older copy.
  [[nodiscard]] Offered AskStore(Answer answer, loop::StreamRef caller);
  /// Needs no room: the journal has at most one question of each drone at a time.
  void AppendQuestionIfDue();
  /// Counts a sample that only gets this answer.
  [[nodiscard]] Offered Settle(ingest::Port& port, const Sample& sample, metrics::Became became) {
    port.Count(sample.arrival(), became);
    port.Publish();
    return {.answer = {.outcome = OutcomeOf(became)}};
  }
  [[nodiscard]] Offered Wait(const TicketRef& ticket, Answer answer, loop::StreamRef caller) {
    ticket->callers.push_back(caller);
    return {.is = Offered::Is::kWaits, .answer = std::move(answer), .ticket = ticket};
  }

  const Context context_;
  const fleet::RobotPtr robot_;
  std::atomic<std::size_t> calls_{0};
  std::atomic<std::int64_t> called_at_ms_{0};
  std::atomic<std::uint64_t> generation_{1};

  mutable std::mutex mutex_;
  LiveSamples live_;
  robot::LiveShare share_;
  StoredSamples stored_;
  WaitingSamples waiting_;
  limits::TokenBucket rate_;
  DroneClaim claim_;
  /// Calls that wait for the claim; each once.
  std::vector<loop::StreamRef> unclaimed_;
};

}  // namespace uplink::uncrew
