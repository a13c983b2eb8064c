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

/// What a batch may hold.
struct BatchBounds {
  std::size_t records_max = 0;
  /// A batch ends with the record that reaches this.
  std::size_t bytes_max = 0;
  BatchShare robot;
  BatchShare gateway = kGatewayBatchShare;
};

/// Records and gaps that wait for the writer, each robot's in a line, in their order. Certificates
/// go in turn, one message each, and so do the robots of one certificate: those of a gateway. A
/// robot with its share of a batch is passed over, and goes behind those that were not looked at. A
/// gateway with its share has no more turns, however many of its robots wait. Half of a batch is
/// for certificates of which something is left from an earlier batch, half for the others; what one
/// half leaves is the other's. What comes of one message (Origin::continues) stays together.
///
/// Limits: the journal's, kept by those who append. A look at either half looks at a line for each
///         message that it moves, at kPassedMax lines that it passes over, and at one of each
///         gateway that has its share.
/// Thread: confined to its owner's lock.
class EntryQueue final {
 public:
  void Push(Entry entry);
  /// They wait again, ahead of all else of their robots.
  void PutBack(std::vector<Entry> entries);
  /// Moves what goes first into `batch`, but nothing of robots that are not held yet. Returns when
  /// the oldest of it arrived; nothing if there is none.
  std::optional<SteadyTime> MoveTo(GatheredBatch& batch, const BatchBounds& bounds,
                                   const HeldRobots& held);

  [[nodiscard]] bool empty() const { return lines_.empty(); }
  /// When the oldest of them arrived; nothing if none waits.
  [[nodiscard]] std::optional<SteadyTime> oldest() const;

 private:
  struct Filling;
  struct Line;
  /// Whose turn is next goes first.
  using Lines = std::list<Line>;
  struct Certificate {
    /// Null of a robot by itself, which is the only one then.
    GatewayRef gateway;
    Lines lines;
  };
  using Certificates = std::list<Certificate>;
  /// The entries of one robot; never empty. It stays with the certificate by which its first entry
  /// came, whichever the robot has later.
  struct Line {
    Certificates::iterator certificate;
    std::deque<Entry> entries;
  };
  enum class End : std::uint8_t { kFirst, kLast };

  /// The robot's line; an empty one that goes first or last, if it has none.
  Line& LineOf(const Origin& origin, End end);
  Certificates::iterator CertificateOf(const GatewayRef& gateway, End end);
  /// Gives turns to the certificates of `from` until the batch holds `records_max` or `bytes_max`,
  /// or kPassedMax lines were passed over. A certificate that had its turn and has something left
  /// waits in old_.
  void GiveTurns(Certificates& from, Filling& filling, std::size_t records_max,
                 std::size_t bytes_max);
  /// Moves one message into the batch; false if none may go. Moves lines that may not go into
  /// `passed`, up to the first that finds the gateway full: the others are not looked at.
  bool GiveTurn(Certificate& certificate, Filling& filling, Lines& passed);

  /// new_: certificates that had no turn since they came. old_: those that had one, and have
  /// something left.
  Certificates new_;
  Certificates old_;
  bool old_first_ = false;
  std::unordered_map<const robot::CommitClient*, Lines::iterator> lines_;
  std::unordered_map<const GatewayUse*, Certificates::iterator> gateways_;
};

}  // namespace uplink::journal
