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
  /// It is live, and its content is held now.
  kApplied,
  /// It is live, and all its content is older than what its session said last.
  kSuperseded,
  /// It was counted: a command, signalling, media, or setpoints alone.
  kObserved,
  /// It makes records, which must be stored before it is acked.
  kStored,
  /// It is rejected (Judgement::rejection()), and leaves only its sign of life.
  kRejected,
  /// It is a ping, which the broker's reader answers, or of another topic.
  kIgnored,
};

/// What became of one message, with its records. A value.
struct Applied {
  Outcome outcome = Outcome::kIgnored;
  /// In their order, at most kRecordsOfMessageMax; none unless the outcome is kStored.
  std::vector<DurableRecord> records;
  /// Fields that passed judgement and have no room here, as Judgement::dropped: the first ones, and
  /// how many there are.
  std::vector<model::DroppedField> dropped;
  std::size_t without_room = 0;
};

/// The live state of one robot of a twin, made from its messages one by one. It does not judge,
/// wait or store.
///
/// Limits:  limits.h; kTwinBytesMax in all.
/// Thread:  confined to its owner's lock.
class TwinState final {
 public:
  explicit TwinState(const model::cyberwave::Uuid& twin) { parts_.twin = twin; }

  /// The most records that Apply makes of the message, at most kRecordsOfMessageMax: 0 for nearly
  /// all live messages.
  [[nodiscard]] std::size_t RecordsAtMost(const Judgement& judgement) const;

  /// Applies one judged message of this robot (whose.h says whose it is). It makes records only
  /// once, so the caller needs room for RecordsAtMost before, and must store them. A message
  /// without a time of its own counts by its arrival.
  [[nodiscard]] Applied Apply(Judgement&& judgement, const Arrival& arrival);

  /// As MetricFaults::Restore.
  void RestoreFaults(const std::vector<std::string>& fault_ids) { faults_.Restore(fault_ids); }

  /// Drops one table; later values are held again.
  void DropTable(TwinTable table);

  [[nodiscard]] const TwinParts& parts() const { return parts_; }
  [[nodiscard]] const MetricFaults& faults() const { return faults_; }
  /// Keys that were evicted because their table was full.
  [[nodiscard]] std::uint64_t keys_evicted() const { return keys_evicted_; }
  /// Bytes in memory, its own size included: at most kTwinBytesMax. Goes through all parts.
  [[nodiscard]] std::size_t held_bytes() const;

 private:
  /// Applies one body: an overload for each kind.
  struct Applier;

  TwinParts parts_;
  /// Metrics have one time for all of their categories.
  SessionTimes metrics_times_;
  MetricFaults faults_;
  std::uint64_t keys_evicted_ = 0;
};

/// Applies a message of no twin's robot (RobotOf): an environment or a workflow run makes one
/// record. Pure.
[[nodiscard]] Applied ApplyToNoRobot(Judgement&& judgement);

}  // namespace uplink::cyberwave
