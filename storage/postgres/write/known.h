#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <tuple>
#include <utility>

#include <absl/status/statusor.h>

#include "storage/batch.h"
#include "storage/commit_record.h"
#include "storage/decide.h"
#include "storage/epoch.h"
#include "storage/identity.h"
#include "storage/postgres/link/connection.h"
#include "storage/store_rules.h"

namespace uplink::storage::postgres {

/// Who commits, and by which rules. Both outlive it.
struct CommitTerms {
  const ProcessId& process;
  const StoreRules& rules;
};

/// A piece of a batch: records [first, last), and, with the last slice, its gaps and changes of
/// presence.
struct Slice {
  const Batch* batch = nullptr;
  std::size_t first = 0;
  std::size_t last = 0;
  bool with_rest = false;

  [[nodiscard]] std::span<const CommitRecord> records() const {
    return std::span(batch->records).subspan(first, last - first);
  }
};

/// What the store holds of everything that a slice of a batch touches, read with its rows locked.
/// What is decided and written then goes in too.
struct KnownRows {
  /// RURI, id and source of an entry that is present.
  using Entry = std::tuple<std::string, std::string, std::string>;
  using EntryView = std::tuple<std::string_view, std::string_view, std::string_view>;
  struct EntryOrder {
    using is_transparent = void;
    bool operator()(const EntryView& left, const EntryView& right) const { return left < right; }
  };
  /// When each entry expires; 0: never.
  using Entries = std::map<Entry, std::int64_t, EntryOrder>;
  using Number = std::tuple<std::string, model::SessionId, model::Seq>;

  /// Those that have a row, each with the counts of the kinds that the slice names of it.
  std::map<std::string, KnownRobot, std::less<>> robots;
  std::map<std::pair<std::string, model::SessionId>, KnownSession, std::less<>> sessions;
  /// By RURI and type: of samples that the slice names.
  std::map<std::pair<std::string, std::uint32_t>, KnownSamples> samples;
  /// By RURI: the open requests of robots that have one in the slice.
  std::map<std::string, KnownRobot::RequestIds, std::less<>> open_requests;
  /// By client id: the epochs of the leases under which the slice came, if this process has them
  /// still.
  std::map<std::string, Epoch, std::less<>> leases;
  /// Why a number was rejected: of those that the slice names.
  std::map<Number, model::Rejection> rejected;
  /// By PresentKind: the entries that the slice names and that exist; of robots that may meet
  /// their bound also those that have expired when the last of its upserts arrives.
  std::array<Entries, kPresentKinds> present;

  [[nodiscard]] Entries& entries(PresentKind kind) {
    return present[static_cast<std::size_t>(kind)];
  }
  /// A copy of the text that lives as long as this.
  [[nodiscard]] std::string_view Keep(const std::string& text) { return kept.emplace_back(text); }

  std::deque<std::string> kept;
};

/// Locks the rows of the slice's robots and sessions, making those of sessions that are missing,
/// and reads what it touches. Within an open transaction; also draws the transaction's number.
[[nodiscard]] absl::StatusOr<KnownRows> ReadKnown(Connection& connection, const Slice& slice,
                                                  const CommitTerms& terms);

}  // namespace uplink::storage::postgres
