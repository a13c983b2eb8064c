#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <set>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include "storage/batch.h"
#include "storage/commit_record.h"
#include "storage/postgres/link/connection.h"
#include "storage/postgres/write/delivery_rows.h"
#include "storage/postgres/write/drone_rows.h"
#include "storage/postgres/write/present_rows.h"
#include "storage/postgres/write/robot_connections.h"
#include "storage/postgres/write/table_rows.h"
#include "storage/presence.h"
#include "storage/present.h"
#include "storage/remember.h"
#include "storage/store_rules.h"
#include "storage/tables/lists.h"

namespace uplink::storage::postgres {

/// Places that one transaction has: an entry is its number times this, plus the place.
inline constexpr std::size_t kPlacesMax = std::size_t{1} << 20;

/// Everything that one batch writes, gathered per table: what was decided goes in, record by record
/// in order, and statements come out, each table touched once. The batch must outlive it.
class BatchRows final {
 public:
  explicit BatchRows(const StoreRules& rules) : rules_(rules) {}

  /// A good record, and its number.
  void Write(const CommitRecord& record, std::int32_t place);
  /// Its row of quarantine in its stead, and its number.
  void Reject(const CommitRecord& record, const model::Rejection& rejection,
              QuarantineDetail detail, std::int32_t place);
  /// The row of a range of limited numbers, and their last number.
  void Limit(const CommitRecord& record, const LimitedRange& range, std::int32_t place);
  void AddGap(const GapItem& gap, std::int32_t place);
  void AddConnection(const ConnectionItem& item, std::int32_t place) {
    connections_.Add(item, place);
  }
  /// What is remembered of samples of one type. The arguments must outlive this.
  void Keep(std::string_view ruri, const KnownSamples& samples) { drones_.Keep(ruri, samples); }
  /// What is remembered of messages that a broker delivered.
  void Remember(DeliveryChanges changes) { deliveries_ = std::move(changes); }
  /// A change of presence, and its number in `session`.
  void AddPresence(const PresenceItem& item, const model::SessionId& session, std::int32_t place);
  /// An expired shape or object that makes room for another. The views must outlive this.
  void Drop(const PresentKey& key);

  /// The statements, in an order in which they may run. The rows must not be used afterwards.
  [[nodiscard]] std::vector<StoreCall> TakeCalls() &&;

 private:
  struct KindWriter;
  struct Cursor {
    model::Seq seq = 0;
    SystemTime last_used;
  };
  /// The record's number; a sample's moves no cursor.
  void Raise(const CommitRecord& record);
  void Raise(std::string_view ruri, const model::SessionId& session, model::Seq seq,
             SystemTime used);
  void MoveCursors(std::vector<StoreCall>& calls) const;

  const StoreRules& rules_;
  AddedRows added_;
  /// The texts of mission reports.
  std::deque<std::string> report_texts_;
  PresentRows<model::Fault> faults_{PresentKind::kFault, rules_};
  PresentRows<model::ReportedShape> shapes_{PresentKind::kShape, rules_};
  PresentRows<model::Object> objects_{PresentKind::kObject, rules_};
  // The latest of its key: a batch writes each key once, in order of the keys.
  std::map<std::tuple<std::string_view, std::string_view, std::string_view>, MissionRun> runs_;
  std::map<std::pair<std::string_view, LatestKind>, LatestReport> latest_;
  std::vector<PresenceChange> presence_;
  std::map<std::string_view, PresenceChange> latest_presence_;
  std::map<std::tuple<std::string_view, model::SessionId, model::Seq>, Gap> gaps_;
  std::vector<Limited> limited_;
  ConnectionRows connections_;
  DeliveryChanges deliveries_;
  DroneRows drones_;
  std::map<std::pair<std::string_view, model::SessionId>, Cursor> cursors_;
  /// Robots for which a bound must be applied after the writes.
  std::set<std::string_view> robots_with_payloads_;
  std::set<std::string_view> robots_with_gaps_;
  /// With the latest arrival of a report that left its run open.
  std::map<std::string_view, SystemTime> robots_with_open_runs_;
};

}  // namespace uplink::storage::postgres
