#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <mutex>

#include "schema/base/clock.h"
#include "server/admin/shared_store.h"
#include "server/limits/key_counts.h"
#include "server/log/logger.h"
#include "storage/audit.h"

namespace uplink::admin {

/// Rows that wait for the store at most; the oldest go first, and a line tells how many.
inline constexpr std::size_t kAuditWaitingMax = 1'000;

/// Rows of what was refused per minute at most: who may ask may also ask in vain, again and again.
/// The next row after it says how many were left out.
inline constexpr int kRefusedPerMinuteMax = 100;
/// Of these, rows of one caller: it hides no other's.
inline constexpr std::size_t kRefusedOfCallerMax = 20;

/// What happened in this server that the audit tells: each is a log line `audit` at once, and a row
/// once the store takes it. Commands write the rows of what they change themselves, in the
/// transaction of the change.
///
/// Thread: thread-safe; Flush on one thread at a time.
class AuditTrail final {
 public:
  explicit AuditTrail(const log::Logger& logger) : logger_(logger) {}
  AuditTrail(const AuditTrail&) = delete;
  AuditTrail& operator=(const AuditTrail&) = delete;

  /// The line alone, of a row that the store has.
  void Tell(const storage::AuditRow& row) const;
  /// The line, and the row with the next Flush. Never waits.
  void Note(storage::AuditRow row);
  /// The same of what was refused, within kRefusedPerMinuteMax and kRefusedOfCallerMax.
  void NoteRefused(storage::AuditRow row);
  /// Writes what waits, until the store refuses one; that one stays. Waits for the store.
  void Flush(SharedStore& store);
  /// Rows that wait.
  [[nodiscard]] std::size_t waiting() const;

 private:
  const log::Logger& logger_;
  mutable std::mutex mutex_;
  std::deque<storage::AuditRow> waiting_;
  /// Rows that left the queue, written or lost; and those lost since the last line about them.
  std::uint64_t gone_ = 0;
  std::uint64_t lost_ = 0;
  /// When the minute began in which so many were noted as refused, and those left out since the
  /// last one that was noted.
  SystemTime minute_began_{};
  int refused_ = 0;
  limits::KeyCounts<std::string> refused_by_;
  std::uint64_t left_out_ = 0;
};

}  // namespace uplink::admin
