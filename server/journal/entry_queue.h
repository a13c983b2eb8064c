#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <list>
#include <optional>
#include <unordered_map>
#include <vector>

#include "schema/base/clock.h"
#include "server/journal/batch_shares.h"
#include "server/journal/entry.h"
#include "server/journal/gateway_use.h"
#include "server/journal/gathered_batch.h"
#include "server/journal/held_robots.h"
#include "server/journal/limits.h"

namespace uplink::journal {

/// Bounds of a batch.
struct BatchBounds {
  std::size_t records_max = 0;
  /// A batch ends with the record that reaches this.
  std::size_t bytes_max = 0;
  BatchShare robot;
  BatchShare gateway = kGatewayBatchShare;
};

/// Records and gaps that wait for the writer, in a line per robot, in their order. Certificates
/// take turns, one message each, and so do the robots of a gateway's certificate. A robot with its
/// share of a batch is skipped, and goes behind lines that were not looked at. A gateway with its
/// share has no more turns, however many of its robots wait. Half of a batch is for certificates
/// with entries left from an earlier batch, half for the others; each may use what the other half
/// leaves. Entries of one message (Origin::continues) stay together.
///
/// Limits: the journal's, kept by the callers that append. A look at either half looks at one line
///         per message that it moves, at kPassedMax skipped lines, and at one line of each gateway
///         that has its share.
/// Thread: confined to its owner's lock.
class EntryQueue final {
 public:
  void Push(Entry entry);
  /// Puts them back to the front of their robots' lines.
  void PutBack(std::vector<Entry> entries);
  /// Moves the next entries into `batch`, except those of robots that are not held yet. Returns
  /// when the oldest of them arrived; empty if there is none.
  std::optional<SteadyTime> MoveTo(GatheredBatch& batch, const BatchBounds& bounds,
                                   const HeldRobots& held);

  [[nodiscard]] bool empty() const { return lines_.empty(); }
  /// When the oldest entry arrived; empty if none waits.
  [[nodiscard]] std::optional<SteadyTime> oldest() const;

 private:
  struct Filling;
  struct Line;
  /// The next turn comes first.
  using Lines = std::list<Line>;
  struct Certificate {
    /// Null for a robot without a gateway, which is then the only one.
    GatewayRef gateway;
    Lines lines;
  };
  using Certificates = std::list<Certificate>;
  /// The entries of one robot; never empty. It stays with the certificate by which its first entry
  /// came, even if the robot changes it.
  struct Line {
    Certificates::iterator certificate;
    std::deque<Entry> entries;
  };
  enum class End : std::uint8_t { kFirst, kLast };

  /// The robot's line; a new empty one, first or last, if it has none.
  Line& LineOf(const Origin& origin, End end);
  Certificates::iterator CertificateOf(const GatewayRef& gateway, End end);
  /// Gives turns to the certificates of `from` until the batch holds `records_max` or `bytes_max`,
  /// or kPassedMax lines were skipped. A certificate that had its turn and has entries left waits
  /// in old_.
  void GiveTurns(Certificates& from, Filling& filling, std::size_t records_max,
                 std::size_t bytes_max);
  /// Moves one message into the batch; false if none may go. Moves lines that may not go into
  /// `passed`, up to the first that finds the gateway full: the rest are not looked at.
  bool GiveTurn(Certificate& certificate, Filling& filling, Lines& passed);

  /// new_: certificates without a turn since they came. old_: those that had one and have entries
  /// left.
  Certificates new_;
  Certificates old_;
  bool old_first_ = false;
  std::unordered_map<const robot::CommitClient*, Lines::iterator> lines_;
  std::unordered_map<const GatewayUse*, Certificates::iterator> gateways_;
};

}  // namespace uplink::journal
