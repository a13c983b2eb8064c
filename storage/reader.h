#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include <absl/status/statusor.h>

#include "schema/base/clock.h"
#include "schema/model/fault.h"
#include "schema/model/ids.h"
#include "schema/model/rejection.h"

namespace uplink::storage {

inline constexpr std::uint32_t kPageSizeDefault = 100;
inline constexpr std::uint32_t kPageSizeMax = 1'000;

/// Which rows, and which part of them. Empty texts match everything.
struct HistoryQuery {
  std::string ruri;
  std::string fleet;
  /// Arrival times, both inclusive.
  std::optional<SystemTime> from;
  std::optional<SystemTime> to;
  /// 1 to kPageSizeMax.
  std::uint32_t page_size = kPageSizeDefault;
  /// next_token of the page before; empty for the first.
  std::string page_token;
};

/// Newest first by arrival. A token stays valid while rows are added: a walk sees every row that
/// was there when it began exactly once.
template <typename Row>
struct Page {
  std::vector<Row> rows;
  /// Empty when this page is the last.
  std::string next_token;
};

struct RobotRow {
  model::RobotId robot;
  SystemTime first_seen;
  SystemTime last_seen;
};

struct FaultRow {
  model::RobotId robot;
  model::Fault fault;
  SystemTime received_at;
  /// First raise since it was last clear; only in rows of the active set.
  std::optional<SystemTime> raised_at;
};

struct QuarantineRow {
  model::RobotId robot;
  model::SessionId session;
  model::Seq seq = 0;
  model::Rejection rejection;
  SystemTime received_at;
  std::string payload;
  std::uint64_t payload_bytes = 0;
};

struct GapRow {
  model::RobotId robot;
  model::SessionId session;
  model::Seq first = 0;
  model::Seq last = 0;
  SystemTime seen_at;
};

struct ActiveFaults {
  std::string ruri;
  std::int64_t count = 0;
};

/// The query side of the store.
///
/// Errors:  kInvalidArgument for a page token that is none of ours (the message begins with
///          `pageToken`); kUnavailable and the like as in Store.
/// Thread:  thread-safe; a slow read never holds up a commit.
class Reader {
 public:
  virtual ~Reader() = default;

  /// Robots that ever opened a stream, by RURI, at most `robots_max`.
  [[nodiscard]] virtual absl::StatusOr<std::vector<RobotRow>> Robots(std::uint32_t robots_max) = 0;
  /// Faults that are active now, one row a fault.
  [[nodiscard]] virtual absl::StatusOr<Page<FaultRow>> FaultsActive(const HistoryQuery& query) = 0;
  /// Every report of a fault.
  [[nodiscard]] virtual absl::StatusOr<Page<FaultRow>> FaultHistory(const HistoryQuery& query) = 0;
  /// The number of active faults of each of `ruris`; robots without any may be left out.
  [[nodiscard]] virtual absl::StatusOr<std::vector<ActiveFaults>> ActiveFaultCounts(
      std::span<const std::string> ruris) = 0;
  [[nodiscard]] virtual absl::StatusOr<Page<QuarantineRow>> Quarantine(
      const HistoryQuery& query) = 0;
  [[nodiscard]] virtual absl::StatusOr<Page<GapRow>> Gaps(const HistoryQuery& query) = 0;
};

}  // namespace uplink::storage
