#pragma once

#include <cstdint>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/sqlite/database.h"
#include "storage/sqlite/tables.h"
#include "storage/store.h"

namespace uplink::storage::sqlite {

/// How the records of a batch stand to each other.
enum class Isolation : std::uint8_t {
  /// All in one: fast, and ends with kInvalidArgument where the database refuses a record.
  kTogether,
  /// A savepoint a record: one that the database refuses goes to quarantine, the rest stays.
  kEachAlone,
};

/// Writes one batch within the transaction that the caller has begun and will commit. Made for one
/// batch; the batch must outlive it.
///
/// Thread: confined to the thread of its database.
class BatchCommit final {
 public:
  BatchCommit(Database& database, Tables& tables, const ProcessId& process, const StoreRules& rules,
              Isolation isolation)
      : database_(database),
        tables_(tables),
        process_(process),
        rules_(rules),
        isolation_(isolation) {}

  [[nodiscard]] absl::StatusOr<std::vector<Outcome>> Write(const Batch& batch);

 private:
  struct Session {
    model::SessionId id;
    SessionCursor row;
    SystemTime last_used;
    bool raised = false;
  };
  struct Robot {
    Epoch held_since = 0;
    std::vector<Session> sessions;
    /// Counted when the first new fault of the batch asks.
    std::optional<std::size_t> faults_active;
    /// Rows, expired ones included; counted when the first new id of the batch asks.
    std::optional<std::size_t> shapes;
    std::optional<std::size_t> objects;
    bool quarantined_payload = false;
    bool gaps = false;
  };

  struct KindWriter;

  absl::StatusOr<Robot*> FindRobot(const RobotRef& id, Epoch held_since, SystemTime at);
  absl::StatusOr<Session*> FindSession(Robot& robot, const CommitRecord& record);
  absl::StatusOr<Outcome> WriteOne(const CommitRecord& record);
  absl::StatusOr<Outcome> Earlier(const Session& session, const CommitRecord& record);
  absl::StatusOr<std::optional<model::Rejection>> WriteRecord(Robot& robot,
                                                              const CommitRecord& record);
  absl::StatusOr<std::optional<model::Rejection>> WriteAlone(Robot& robot,
                                                             const CommitRecord& record);
  absl::StatusOr<std::optional<model::Rejection>> WriteFault(Robot& robot,
                                                             const CommitRecord& record,
                                                             const model::Fault& fault);
  absl::Status WriteRejection(Robot& robot, const CommitRecord& record,
                              const model::Rejection& rejection);
  absl::Status WriteGap(const GapItem& gap);
  absl::Status WritePresence(const Batch& batch);
  absl::Status TrimServerSessions(const model::SessionId& present);
  absl::Status Finish();

  Database& database_;
  Tables& tables_;
  const ProcessId& process_;
  const StoreRules& rules_;
  const Isolation isolation_;
  EntryNumber next_entry_ = 0;
  std::unordered_map<std::string_view, Robot> robots_;
};

}  // namespace uplink::storage::sqlite
