#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <map>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>
#include <vector>

#include <absl/status/statusor.h>

#include "storage/postgres/connection.h"
#include "storage/types.h"

namespace uplink::storage::postgres {

/// Part of a batch: records [first, last), and, with the last part, its gaps and changes of
/// presence.
struct Part {
  const Batch* batch = nullptr;
  std::size_t first = 0;
  std::size_t last = 0;
  bool with_rest = false;

  [[nodiscard]] std::span<const CommitRecord> records() const {
    return std::span(batch->records).subspan(first, last - first);
  }
};

/// Shapes or objects of the robots of a part, as far as the part needs to know.
struct KnownPresent {
  /// When each id that the part names expires; ids that are not there are left out. Of robots that
  /// are near their bound also all ids that expire at all.
  std::map<std::pair<std::string, std::string>, std::int64_t> expires_ms;
  /// Rows a robot.
  std::map<std::string, std::size_t> counts;
};

/// What the store holds of everything that a part of a batch touches, read with its rows locked.
struct Known {
  struct Session {
    model::Seq cursor = 0;
  };
  std::map<std::string, Epoch> held_since;
  std::map<std::pair<std::string, model::SessionId>, Session> sessions;
  /// Why the record at this place of the batch lies in quarantine, for numbers at or below a
  /// cursor.
  std::map<std::size_t, model::Rejection> quarantined;
  /// Active faults that the part names.
  std::set<std::tuple<std::string, std::string, std::string>> active;
  std::map<std::string, std::size_t> active_counts;
  KnownPresent shapes;
  KnownPresent objects;

  // What a decision adds.
  void NoteQuarantined(const CommitRecord& record, const model::Rejection& rejection) {
    quarantined_now_[{record.robot->ruri, record.session, record.seq}] = rejection;
  }
  /// Why the record's number lies in quarantine; nothing if it does not.
  [[nodiscard]] std::optional<model::Rejection> Quarantined(const CommitRecord& record,
                                                            std::size_t place) const;
  /// A copy of the text that lives as long as this.
  [[nodiscard]] std::string_view Keep(const std::string& text) { return kept_.emplace_back(text); }

 private:
  std::map<std::tuple<std::string, model::SessionId, model::Seq>, model::Rejection>
      quarantined_now_;
  std::deque<std::string> kept_;
};

/// Locks the rows of the part's robots and sessions, making those that are missing, and reads what
/// it touches. Within an open transaction; also draws the transaction's number.
[[nodiscard]] absl::StatusOr<Known> ReadKnown(Connection& connection, const Part& part,
                                              const ProcessId& process);

}  // namespace uplink::storage::postgres
