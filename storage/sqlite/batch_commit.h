#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/batch.h"
#include "storage/commit_record.h"
#include "storage/decide.h"
#include "storage/identity.h"
#include "storage/outcome.h"
#include "storage/sqlite/batch_known.h"
#include "storage/sqlite/kind_writer.h"
#include "storage/store_rules.h"

namespace uplink::storage::sqlite {

class Database;
class StoreFiles;
struct Tables;

/// How the records of a batch stand to each other.
enum class Isolation : std::uint8_t {
  /// All in one: fast, and ends with kInvalidArgument where the database refuses a record.
  kTogether,
  /// A savepoint per record: one that the database refuses goes to quarantine, the rest stays.
  kEachAlone,
};

/// Who commits, by which rules, and into which files. All outlive it.
struct CommitTerms {
  const ProcessId& process;
  const StoreRules& rules;
  StoreFiles& files;
};

/// Writes one batch within the transaction that the caller has begun and will commit: each record
/// is decided (storage/decide.h) and written before the next is looked at. Made for one batch; the
/// batch must outlive it.
///
/// Thread: confined to the thread of its database.
class BatchCommit final {
 public:
  BatchCommit(Database& database, Tables& tables, const CommitTerms& terms, Isolation isolation)
      : database_(database),
        tables_(tables),
        files_(terms.files),
        isolation_(isolation),
        known_(tables, terms.process, next_entry_),
        decider_(known_, terms.rules),
        writer_(tables, next_entry_) {}

  [[nodiscard]] absl::StatusOr<std::vector<Outcome>> Write(const Batch& batch);
  /// How many mission runs it closed for their bound.
  [[nodiscard]] std::size_t runs_closed() const { return runs_closed_; }
  /// The number of the store's next entry once this is committed. After Write.
  [[nodiscard]] EntryNumber next_entry() const { return next_entry_; }

 private:
  using Refusal = std::optional<model::Rejection>;

  absl::StatusOr<Outcome> WriteOne(const CommitRecord& record);
  /// Writes a good record, if the bounds let it pass.
  absl::StatusOr<Refusal> WriteRecord(const CommitRecord& record);
  /// The same behind a savepoint.
  absl::StatusOr<Refusal> WriteAlone(const CommitRecord& record);
  absl::Status WriteRejection(const CommitRecord& record, const model::Rejection& rejection);
  absl::Status WriteGap(const GapItem& gap);
  /// Of a robot that has a row.
  absl::Status WriteConnection(const ConnectionItem& item);
  /// Writes the changes of presence that are new, and moves the cursor of their session. Adds the
  /// outcome of each.
  absl::Status WritePresence(const Batch& batch, std::vector<Outcome>& outcomes);
  /// Of the processes' sessions, the least recently used over their bound go.
  absl::Status TrimServerSessions(const model::SessionId& present);
  /// What is remembered of a drone's samples of one type.
  absl::Status WriteSamples(std::string_view ruri, const KnownSamples& samples);
  /// Cursors, memories of samples, and the bounds that are kept by what goes.
  absl::Status Finish();

  Database& database_;
  Tables& tables_;
  StoreFiles& files_;
  const Isolation isolation_;
  EntryNumber next_entry_ = 0;
  BatchKnown known_;
  Decider decider_;
  KindWriter writer_;
  std::size_t runs_closed_ = 0;
};

}  // namespace uplink::storage::sqlite
