#pragma once

#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "storage/sqlite/open_beside.h"
#include "storage/sqlite/statement.h"
#include "storage/topic_leases.h"

namespace uplink::storage::sqlite {

/// Leases on topics in an SQLite file, written beside the store's writer. One process has the store
/// at a time; what others judged, and who was there before, counts all the same.
///
/// Errors:  of Open, as OpenBeside. Of the calls, as in TopicLeases.
/// Thread:  as in TopicLeases.
class SqliteTopicLeases final : public TopicLeases {
 public:
  /// The file must be there and migrated.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<SqliteTopicLeases>> Open(
      const std::string& path, const ProcessId& process, DamagePtr damage = nullptr);
  SqliteTopicLeases(const SqliteTopicLeases&) = delete;
  SqliteTopicLeases& operator=(const SqliteTopicLeases&) = delete;

  [[nodiscard]] absl::StatusOr<std::optional<Epoch>> Take(const TakeRequest& request) override;
  [[nodiscard]] absl::Status Release(std::string_view client_id) override;
  [[nodiscard]] absl::StatusOr<std::vector<TopicLease>> Read() override;
  [[nodiscard]] absl::StatusOr<DeliveryMemory> MemoryOf(std::string_view client_id) override;

 private:
  SqliteTopicLeases(Beside beside, const ProcessId& process)
      : beside_(std::move(beside)), process_(process) {}
  absl::Status Prepare();
  /// Runs `work` in a transaction of its own; all or nothing.
  template <typename Result, typename Work>
  absl::StatusOr<Result> InTransaction(const Work& work);
  absl::StatusOr<std::optional<Epoch>> TakeInTransaction(const TakeRequest& request);
  absl::StatusOr<Epoch> DrawEpoch();
  absl::Status End(const TopicLease& lease);
  absl::Status Hold(const TakeRequest& request);
  absl::Status NumberDeliveries(const TakeRequest& request);
  absl::StatusOr<DeliveryMemory> ReadMemory(std::string_view client_id);

  Beside beside_;
  const ProcessId process_;
  std::unique_ptr<Statement> begin_, commit_, read_, draw_epoch_, end_, take_, drop_prefixes_,
      add_prefix_, release_, insert_, drop_through_, drop_clients_, drop_deliveries_, deliveries_;
};

}  // namespace uplink::storage::sqlite
