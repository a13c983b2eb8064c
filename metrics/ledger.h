#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <vector>

#include "schema/model/record.h"
#include "schema/model/rejection.h"

namespace uplink::metrics {

/// The kinds of messages that are counted: the variants by their number, and RCAN's Robot State.
inline constexpr std::size_t kRcanKind = model::kVariants;
inline constexpr std::size_t kKinds = model::kVariants + 1;
/// Of a message that could not be read so far; also of one without content.
inline constexpr std::size_t kUnknownKind = kKinds;

/// What happened to uplink messages: the columns of the conservation law
/// received = stored + applied + superseded + duplicate + rejected + in flight. A value.
struct UplinkCounts {
  std::uint64_t received = 0;
  std::uint64_t stored = 0;
  std::uint64_t applied = 0;
  std::uint64_t superseded = 0;
  std::uint64_t duplicate = 0;
  std::uint64_t rejected = 0;
  /// Change of the number of messages that ack windows hold: counted from the windows, never from
  /// the other columns, so that a lost settlement shows.
  std::int64_t in_flight = 0;
  /// Numbers that agents skipped.
  std::uint64_t missing = 0;
  /// Settled rejections by reason; index: RejectReason.
  std::array<std::uint64_t, model::kRejectReasons + 1> rejects{};
  /// Good records by variant.
  std::array<std::uint64_t, model::kVariants> records{};
  /// Good Robot States.
  std::uint64_t rcan_states = 0;
  /// Numbers of `seq` that Robot States skipped.
  std::uint64_t rcan_missing = 0;

  UplinkCounts& operator+=(const UplinkCounts& other);
  /// True when the law holds.
  [[nodiscard]] bool Balanced() const;
};

/// Fields of live messages that were dropped, by kind and reason.
using DroppedCounts = std::array<std::array<std::uint64_t, model::kRejectReasons + 1>, kKinds>;

/// Messages that judgement rejected, by kind (kUnknownKind included) and reason.
using RejectedCounts = std::array<std::array<std::uint64_t, model::kRejectReasons + 1>, kKinds + 1>;

/// What messages hold that is no violation and not kept as it is. A value.
struct OddCounts {
  /// Times taken as unknown.
  std::uint64_t times_unknown = 0;
  /// Enumerants kept as numbers.
  std::uint64_t enumerants_unrecognized = 0;
  /// Control characters of texts, replaced by U+FFFD.
  std::uint64_t control_characters = 0;

  OddCounts& operator+=(const OddCounts& other);
  [[nodiscard]] bool any() const {
    return (times_unknown | enumerants_unrecognized | control_characters) != 0;
  }
};

/// One thread's page of counts. What belongs together is published together, so that the law holds
/// on every page at every moment and so in their sum. Thread-safe; one writer in practice.
class Ledger final {
 public:
  void Publish(const UplinkCounts& delta);
  /// `kind`: a variant's number, or kRcanKind.
  void CountDropped(std::size_t kind, model::RejectReason reason, std::size_t fields = 1);
  /// `kind`: as above, or kUnknownKind.
  void CountRejected(std::size_t kind, model::RejectReason reason);
  void CountOdd(const OddCounts& delta);

  struct Page {
    UplinkCounts uplinks;
    DroppedCounts dropped{};
    RejectedCounts rejected_kinds{};
    OddCounts odd;
  };
  [[nodiscard]] Page Read() const;

 private:
  mutable std::mutex mutex_;
  Page page_;
};

/// All pages of the process. Thread-safe; pages live as long as the book.
class LedgerBook final {
 public:
  [[nodiscard]] Ledger& NewPage();
  /// The sum of all pages.
  [[nodiscard]] Ledger::Page Sum() const;

 private:
  mutable std::mutex mutex_;
  std::vector<std::unique_ptr<Ledger>> pages_;
};

}  // namespace uplink::metrics
