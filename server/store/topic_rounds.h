#pragma once

#include <atomic>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "server/broker/lease_view.h"
#include "server/log/logger.h"
#include "server/loop/rounds.h"
#include "server/store/lease_judge.h"
#include "storage/reader.h"
#include "storage/topic_leases.h"

namespace uplink::store {

/// How often the lease of our topics is checked, unless LookSoon asks for it sooner.
inline constexpr std::chrono::seconds kTopicLookEvery{2};
/// The same while its holder is not judged yet.
inline constexpr milliseconds kUnjudgedLookEvery{100};
/// While the store cannot be asked, a lease of ours counts for so long: less than another process
/// needs to find us silent (kSilentMax).
inline constexpr std::chrono::seconds kLeaseTrusted{20};

/// Takes the lease of our topics when it is free, checks that it is still ours, and tells the
/// broker's reader.
///
/// Errors:  of the store: the next look tries again, and tells nothing.
/// Thread:  constructed, started and stopped by main; looks on a thread of its own. LeaseView's
///          functions from any.
class TopicRounds final : public broker::LeaseView {
 public:
  /// The references outlive it.
  struct Context {
    const Clock& clock;
    log::Logger& logger;
    storage::Reader& reader;
    /// This process.
    storage::ProcessId process{};
    std::string client_id;
    std::vector<std::string> prefixes;
    /// The verdict on a process with a lease; empty: not judged yet.
    std::function<std::optional<LeaseJudge::Verdict>(const storage::ProcessId& process)> judge;
    /// These are called on the thread of the looks.
    std::function<void(broker::Grant grant)> taken;
    std::function<void()> lost;
    std::function<void(broker::Remembered remembered)> reread;
    /// The store was connected to anew, and may have lost something.
    std::function<void()> reconnected;
  };
  TopicRounds(std::unique_ptr<storage::TopicLeases> leases, Context context);
  TopicRounds(const TopicRounds&) = delete;
  TopicRounds& operator=(const TopicRounds&) = delete;

  void Start() { rounds_.Start(); }
  /// Ends the looks. Idempotent.
  void Stop() { rounds_.Stop(); }
  /// Ends the looks and gives up the lease, so that another process gets it at once.
  void Leave();
  /// One look, on the caller's thread: before Start, or instead of it.
  void Look();

  [[nodiscard]] bool MayConnect(SteadyTime since) const override;
  void LookSoon() override { rounds_.Wake(); }
  void RereadSoon(std::uint64_t asked) override;
  [[nodiscard]] bool failing() const override { return failing_.load(); }
  [[nodiscard]] std::string held_by() const override;

 private:
  [[nodiscard]] absl::Status TryLook(SteadyTime began);
  [[nodiscard]] storage::TakeRequest RequestNow(const std::vector<storage::TopicLease>& leases);
  [[nodiscard]] absl::Status Take(const std::vector<storage::TopicLease>& leases, SteadyTime began);
  [[nodiscard]] absl::StatusOr<broker::FaultsByRobot> ReadFaults();
  [[nodiscard]] absl::Status RereadIfAsked();
  void NoteHeldBy(std::string name);
  void NoteOutcome(const absl::Status& status);

  const std::unique_ptr<storage::TopicLeases> leases_;
  const Context context_;
  /// The epoch of our lease; empty if it is not ours.
  std::optional<storage::Epoch> epoch_;
  std::string told_held_by_;
  /// TopicLeases::connections at the last look.
  std::uint64_t connections_ = 0;
  /// At the last look their holder was not judged yet.
  bool unjudged_ = false;
  /// When the last look that found the lease ours began, and when the last failed one did.
  std::atomic<SteadyTime> confirmed_{SteadyTime()};
  std::atomic<SteadyTime> failed_{SteadyTime()};
  std::atomic<bool> failing_{false};
  mutable std::mutex mutex_;
  std::string held_by_;
  /// The reread that was asked for and not answered yet.
  std::optional<std::uint64_t> reread_;
  loop::Rounds rounds_;
};

}  // namespace uplink::store
