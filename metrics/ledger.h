#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string_view>
#include <vector>

#include "metrics/ages.h"
#include "schema/model/message_source.h"
#include "schema/model/rejection.h"
#include "schema/model/variants.h"

namespace uplink::metrics {

/// The kinds of messages that are counted: the variants by their number, and RCAN's Robot State.
inline constexpr std::size_t kRcanKind = model::kVariants;
inline constexpr std::size_t kKinds = model::kVariants + 1;
/// Of a message that could not be read so far; also of one without content.
inline constexpr std::size_t kUnknownKind = kKinds;

/// What became of a message. Closed; views and metrics have the names of kBecame.
enum class Became : std::uint8_t {
  /// All that it brought is committed.
  kStored,
  /// It is live, and is the latest of its kind now.
  kApplied,
  /// It is live, and a newer one of its kind is known.
  kSuperseded,
  /// It came before; that one waits or is settled.
  kDuplicate,
  /// For a reason; its row of quarantine is committed, if it has one.
  kRejected,
  /// Not taken, through no fault of its own: no room, too many robots, or another server holds its
  /// robot. Its source delivers it again, if it keeps messages until they are acked.
  kRefused,
  /// Only counted, or answered at once: of a broker a command, signalling, media or a ping.
  kObserved,
  /// It is none of ours: of a broker a retained one, or one on a topic that we do not know.
  kIgnored,
  /// Dropped unread: an operator blocked its robot, or did not add it (identity.registration).
  kBlocked,
};

/// What happened to messages: the columns of the conservation law
/// received = the sum of what they became + in flight. A value.
struct MessageCounts {
  std::uint64_t received = 0;
  std::uint64_t stored = 0;
  std::uint64_t applied = 0;
  std::uint64_t superseded = 0;
  std::uint64_t duplicate = 0;
  std::uint64_t rejected = 0;
  std::uint64_t refused = 0;
  std::uint64_t observed = 0;
  std::uint64_t ignored = 0;
  std::uint64_t blocked = 0;
  /// Change of the number of messages that were received and are not settled: counted from what
  /// waits, never from the other columns, so that a lost settlement shows.
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

  void Count(Became became);
  MessageCounts& operator+=(const MessageCounts& other);
  /// True when the law holds.
  [[nodiscard]] bool Balanced() const;
};

/// The column of what a message became.
struct BecameColumn {
  std::string_view name;
  std::uint64_t MessageCounts::*count;
};

/// The columns, in order of Became.
inline constexpr auto kBecame = std::to_array<BecameColumn>({
    {"stored", &MessageCounts::stored},
    {"applied", &MessageCounts::applied},
    {"superseded", &MessageCounts::superseded},
    {"duplicate", &MessageCounts::duplicate},
    {"rejected", &MessageCounts::rejected},
    {"refused", &MessageCounts::refused},
    {"observed", &MessageCounts::observed},
    {"ignored", &MessageCounts::ignored},
    {"blocked", &MessageCounts::blocked},
});

inline void MessageCounts::Count(Became became) {
  ++(this->*kBecame[static_cast<std::size_t>(became)].count);
}

/// Counts by kind (kUnknownKind included) and reason.
using ReasonCounts = std::array<std::array<std::uint64_t, model::kRejectReasons + 1>, kKinds + 1>;

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
  void Publish(const MessageCounts& delta);
  /// The same with the ages of the messages.
  void Publish(const MessageCounts& delta, const MessageAges& ages);
  /// Fields that live messages went without. `kind`: a variant's number, kRcanKind or kUnknownKind.
  void CountDropped(std::size_t kind, model::RejectReason reason, std::size_t fields = 1);
  /// A message that judgement rejected. `kind`: as above.
  void CountRejected(std::size_t kind, model::RejectReason reason);
  void CountOdd(const OddCounts& delta);

  struct Page {
    MessageCounts messages;
    ReasonCounts dropped{};
    ReasonCounts rejected_kinds{};
    OddCounts odd;
    MessageAges ages;
  };
  [[nodiscard]] Page Read() const;

 private:
  mutable std::mutex mutex_;
  Page page_;
};

/// All pages of the process, each of one source. Thread-safe; pages live as long as the book.
class LedgerBook final {
 public:
  [[nodiscard]] Ledger& NewPage(model::MessageSource source = model::MessageSource::kUplink);
  /// The sum of all pages of a source; of all sources if none is given.
  [[nodiscard]] Ledger::Page Sum(std::optional<model::MessageSource> source = std::nullopt) const;

 private:
  struct SourcePage {
    model::MessageSource source;
    std::unique_ptr<Ledger> ledger;
  };

  mutable std::mutex mutex_;
  std::vector<SourcePage> pages_;
};

}  // namespace uplink::metrics
