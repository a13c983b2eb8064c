#pragma once

#include <cstdint>
#include <map>
#include <optional>
#include <string_view>
#include <unordered_map>
#include <vector>

#include <absl/status/statusor.h>

#include "storage/decide.h"
#include "storage/sqlite/statement.h"

namespace uplink::storage::sqlite {

struct Tables;

/// A session of a batch.
struct BatchSession {
  model::SessionId id;
  KnownSession known;
  /// Quarantine rows of the session begin here.
  EntryNumber first_entry = 0;
};

/// A robot of a batch.
struct BatchRobot {
  KnownRobot known;
  std::vector<BatchSession> sessions;
  /// By type: those of the types that the batch has.
  std::map<std::uint32_t, KnownSamples> samples;
  /// Whether the batch put a payload of it into quarantine, and whether it wrote gaps and
  /// connections of it.
  bool quarantined_payload = false;
  bool gaps = false;
  bool connections = false;
  /// The latest arrival of a report that left its run open.
  std::optional<SystemTime> run_reported;
};

/// What the file says, read row by row as decisions ask for it; robots and sessions once per
/// batch. The views of the batch's records are kept: it must outlive this.
///
/// Thread: confined to the thread of its database.
class BatchKnown final : public Known {
 public:
  using Robots = std::unordered_map<std::string_view, BatchRobot>;

  /// `process` commits; `next_entry` is the batch's count as it stands at each call.
  BatchKnown(Tables& tables, const ProcessId& process, const EntryNumber& next_entry)
      : tables_(tables), process_(process), next_entry_(next_entry) {}

  [[nodiscard]] absl::StatusOr<KnownRobot*> Robot(std::string_view ruri) override;
  [[nodiscard]] absl::StatusOr<KnownSession*> Session(const CommitRecord& record) override;
  [[nodiscard]] absl::StatusOr<std::optional<model::Rejection>> Rejected(
      const CommitRecord& record) override;
  [[nodiscard]] absl::StatusOr<KnownSamples*> Samples(const CommitRecord& record) override;
  [[nodiscard]] absl::StatusOr<KnownRobot::RequestIds> OpenRequests(std::string_view ruri) override;
  [[nodiscard]] absl::StatusOr<Epoch> LeaseEpoch(std::string_view client_id) override;
  [[nodiscard]] absl::StatusOr<std::optional<std::int64_t>> ExpiryOf(
      const PresentKey& key) override;
  [[nodiscard]] absl::StatusOr<std::size_t> Count(PresentKind kind, std::string_view ruri) override;
  [[nodiscard]] absl::Status Delete(const PresentKey& key) override;
  [[nodiscard]] absl::StatusOr<std::size_t> DeleteExpired(PresentKind kind, std::string_view ruri,
                                                          std::int64_t now_ms) override;

  /// A robot that was asked for, and is known.
  [[nodiscard]] BatchRobot& robot(std::string_view ruri) { return robots_.find(ruri)->second; }
  [[nodiscard]] const Robots& robots() const { return robots_; }

 private:
  Tables& tables_;
  const ProcessId& process_;
  const EntryNumber& next_entry_;
  Robots robots_;
  std::unordered_map<std::string_view, Epoch> leases_;
};

}  // namespace uplink::storage::sqlite
