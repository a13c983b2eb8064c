#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "metrics/ledger.h"
#include "schema/base/clock.h"
#include "schema/model/ids.h"
#include "schema/model/rejection.h"
#include "server/loop/wake.h"
#include "server/robot/holding.h"
#include "storage/claim.h"
#include "storage/compare.h"
#include "storage/open_stream.h"
#include "storage/outcome.h"
#include "storage/presence.h"

namespace uplink::robot {

/// What of one robot waits in the journal. A value.
struct JournalUse {
  /// Gaps included.
  std::size_t records = 0;
  std::size_t bytes = 0;

  friend JournalUse operator+(const JournalUse& a, const JournalUse& b) {
    return {a.records + b.records, a.bytes + b.bytes};
  }
};

/// One durable message, or one range of limited numbers, of which the store has decided what
/// becomes.
struct Settled {
  model::SessionId session;
  model::Seq seq = 0;
  /// Of a range: its first number; `seq` is its last one.
  std::optional<model::Seq> first{};
  storage::Outcome outcome;
  /// The reason with which judgement rejected it; nothing for a good record.
  std::optional<model::RejectReason> rejected_for;
  SteadyTime arrived;
  /// What it cost the journal.
  std::size_t bytes = 0;
};

/// A robot as the journal sees it: what is told when this process holds it, when its stream was
/// opened or when its records are settled. Lives as long as anything of it waits in the journal, or
/// it is held (ClientRef). Called on the journal's writer thread, with no lock held.
class CommitClient : public std::enable_shared_from_this<CommitClient> {
 public:
  virtual ~CommitClient() = default;
  /// The store says that this process holds the robot, and did not before (as far as the journal
  /// knew). Comes after OnFenced where both do.
  virtual void OnHeld(const HoldNews& news) = 0;
  /// A claim found that another process holds the robot, which wrote this last; so far as the
  /// journal knew, this one did not.
  virtual void OnHeldElsewhere(const std::optional<storage::StoredPresence>& /*presence*/) {}
  /// A stream of the robot is here. Any thread.
  [[nodiscard]] virtual bool HasStream() const = 0;
  /// The robot is to leave memory, and nothing stands against it.
  [[nodiscard]] virtual bool MayLeave() const { return false; }
  /// The journal knows the robot no more.
  virtual void OnLeft() {}
  /// The stream `open_id` was opened. Returns the stream to wake.
  virtual loop::StreamRef OnOpened(std::uint64_t open_id, const storage::OpenResult& result) = 0;
  /// The store has the robot in `fleet`, and the word of stream `open_id` does not move it: that
  /// stream must end, and what waits of it is void, counted superseded; generation() has grown on
  /// return. Nothing happens where another stream was opened since. Returns the stream to wake.
  virtual loop::StreamRef OnOtherFleet(std::uint64_t open_id, const std::string& fleet,
                                       metrics::Ledger& ledger) = 0;
  /// The store answered the claim of a drone (Journal::Claim). Returns the stream to wake.
  virtual loop::StreamRef OnClaimed(const storage::ClaimResult& /*result*/) { return {}; }
  /// Of a drone: the store was connected to anew, and may remember less than it told. Returns the
  /// stream to wake.
  virtual loop::StreamRef OnDoubted() { return {}; }
  /// Outcomes of one commit, in order; never kFenced. Counts go to `ledger`. Returns the stream to
  /// wake.
  virtual loop::StreamRef OnSettled(std::span<const Settled> settled, metrics::Ledger& ledger) = 0;
  /// Gap records of this robot left the journal. Returns the stream to wake.
  virtual loop::StreamRef OnGapsWritten(std::size_t count) = 0;
  /// Another process holds the robot, or held it since this one's last OpenStream: forget its
  /// sessions and all that waits, counted superseded; generation() has grown on return. Returns the
  /// stream to wake.
  virtual loop::StreamRef OnFenced(metrics::Ledger& ledger) = 0;
  /// The sessions in memory of which the store told something, with what it told: the highest
  /// number that is committed.
  [[nodiscard]] virtual std::vector<storage::CommittedSession> Committed() const = 0;
  /// The store went back: it has less of the robot than it told, and holds it for this process as
  /// before. As OnFenced for sessions and all that waits; the robot's state stays.
  virtual loop::StreamRef OnWentBack(metrics::Ledger& ledger) = 0;
  /// Grows when what waits becomes void; entries of an older generation are dropped unwritten.
  [[nodiscard]] virtual std::uint64_t generation() const = 0;
};

/// A drone as the journal sees it, beside its robot: what is told of its claim and of its samples.
/// It has numbers of its own, and holds no robot: whose the robot is, the robot is told.
///
/// OnFenced: another server claimed the drone. What waits is void; the drone claims anew, gets what
/// the store remembers of its samples, and judges them again.
/// OnDoubted: what waits stands; then the drone claims anew.
class ClaimClient : public CommitClient {
 public:
  loop::StreamRef OnClaimed(const storage::ClaimResult& result) override = 0;

  // What streams alone are told.
  void OnHeld(const HoldNews& /*news*/) final {}
  [[nodiscard]] bool HasStream() const final { return false; }
  loop::StreamRef OnOpened(std::uint64_t /*open_id*/, const storage::OpenResult& /*result*/) final {
    return {};
  }
  loop::StreamRef OnOtherFleet(std::uint64_t /*open_id*/, const std::string& /*fleet*/,
                               metrics::Ledger& /*ledger*/) final {
    return {};
  }
  loop::StreamRef OnGapsWritten(std::size_t /*count*/) final { return {}; }
  [[nodiscard]] std::vector<storage::CommittedSession> Committed() const final { return {}; }
  loop::StreamRef OnWentBack(metrics::Ledger& /*ledger*/) final { return {}; }
};

/// A client of which something waits: keeps it alive. One that nobody shares must outlive it. A
/// value.
class ClientRef final {
 public:
  ClientRef() = default;
  ClientRef(CommitClient* client)  // NOLINT(google-explicit-constructor): stands for it
      : client_(client), kept_(client->weak_from_this().lock()) {}

  [[nodiscard]] CommitClient* get() const { return client_; }
  CommitClient* operator->() const { return client_; }
  CommitClient& operator*() const { return *client_; }
  friend bool operator==(const ClientRef& a, const ClientRef& b) { return a.client_ == b.client_; }

 private:
  CommitClient* client_ = nullptr;
  std::shared_ptr<CommitClient> kept_;
};

}  // namespace uplink::robot
