#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "schema/cyberwave/judge.h"
#include "schema/cyberwave/records.h"
#include "schema/model/rejection.h"
#include "server/cyberwave/metric_faults.h"
#include "server/cyberwave/twin_parts.h"

namespace uplink::cyberwave {

/// What became of one message.
enum class Outcome : std::uint8_t {
  /// It is live, and what it says is held now.
  kApplied,
  /// It is live, and all that it says is older than what its session said last.
  kSuperseded,
  /// It was counted: a command, signalling, media, or nothing but wanted values.
  kObserved,
  /// It makes records, which are to be stored before it is acked.
  kStored,
  /// It is not good, and leaves nothing but its sign of life: Judgement::rejection() says why.
  kRejected,
  /// A ping, which is for its reader to answer, or a message of another topic.
  kIgnored,
};

/// What became of one message, with what follows. A value.
struct Applied {
  Outcome outcome = Outcome::kIgnored;
  /// In their order, at most kRecordsOfMessageMax; none unless the outcome is kStored.
  std::vector<DurableRecord> records;
  /// What has no room here though judgement passed it, as Judgement::dropped: the first fields, and
  /// the number of all of them.
  std::vector<model::DroppedField> dropped;
  std::size_t without_room = 0;
};

/// The live state of one robot of a twin: what its messages, one after the other, come to. It
/// neither judges nor waits nor stores.
///
/// Limits:  limits.h; kTwinBytesMax in all.
/// Thread:  confined to its owner's lock.
class TwinState final {
 public:
  explicit TwinState(const model::cyberwave::Uuid& twin) { parts_.twin = twin; }

  /// How many records Apply makes of the message at most, kRecordsOfMessageMax or fewer: 0 of
  /// nearly all that is live.
  [[nodiscard]] std::size_t RecordsAtMost(const Judgement& judgement) const;

  /// Applies one judged message of this robot (whose.h says whose it is). What it makes is not made
  /// again, so the caller must have room for RecordsAtMost before, and have them stored. A message
  /// without an own time counts by its arrival.
  [[nodiscard]] Applied Apply(Judgement&& judgement, const Arrival& arrival);

  /// As MetricFaults::Restore.
  void RestoreFaults(const std::vector<std::string>& fault_ids) { faults_.Restore(fault_ids); }

  /// Lets go of one table. What comes next is held again.
  void DropTable(TwinTable table);

  [[nodiscard]] const TwinParts& parts() const { return parts_; }
  [[nodiscard]] const MetricFaults& faults() const { return faults_; }
  /// Keys that had to go because their table was full.
  [[nodiscard]] std::uint64_t keys_evicted() const { return keys_evicted_; }
  /// What it holds in memory, itself included: kTwinBytesMax or less. It goes through all parts.
  [[nodiscard]] std::size_t held_bytes() const;

 private:
  /// Applies one body: an overload for each kind of it.
  struct Applier;

  TwinParts parts_;
  /// Metrics have one time for all of their categories.
  SessionTimes metrics_times_;
  MetricFaults faults_;
  std::uint64_t keys_evicted_ = 0;
};

/// What becomes of a message that is of no twin's robot (RobotOf): an environment or a workflow run
/// makes one record. Pure.
[[nodiscard]] Applied ApplyToNoRobot(Judgement&& judgement);

}  // namespace uplink::cyberwave
