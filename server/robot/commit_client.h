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

/// Records of one robot that wait in the journal. A value.
struct JournalUse {
  /// Gaps included.
  std::size_t records = 0;
  std::size_t bytes = 0;

  friend JournalUse operator+(const JournalUse& a, const JournalUse& b) {
    return {a.records + b.records, a.bytes + b.bytes};
  }
};

/// One durable message, or one range of limited numbers, with the store's decision.
struct Settled {
  model::SessionId session;
  model::Seq seq = 0;
  /// For a range: its first number; `seq` is its last one.
  std::optional<model::Seq> first{};
  storage::Outcome outcome;
  /// The reason for which judgement rejected it; empty for a good record.
  std::optional<model::RejectReason> rejected_for;
  SteadyTime arrived;
  /// Its bytes in the journal.
  std::size_t bytes = 0;
};

/// Whether a robot may be here, where registration is closed (fleet::Entry). Closed.
enum class Registration : std::uint8_t {
  /// The store or an operator knows it, or any robot may come.
  kFits,
  /// It came before the store was read, so no one could tell: it gets no row until it is judged.
  kUnjudged,
  /// It is new, and no operator added it: it gets no row, and must go.
  kRefused,
};

/// A robot as the journal sees it. The journal calls it when this process holds the robot, when its
/// stream was opened, and when its records are settled, on the writer's thread with no lock held.
/// It lives while a record of it waits in the journal or it is held (ClientRef).
class CommitClient : public std::enable_shared_from_this<CommitClient> {
 public:
  virtual ~CommitClient() = default;
  /// The store says that this process now holds the robot, which is news to the journal. Comes
  /// after OnFenced if both come.
  virtual void OnHeld(const HoldNews& news) = 0;
  /// A claim found that another process holds the robot; the argument is what that one wrote last.
  /// The journal knew of no hold by this process.
  virtual void OnHeldElsewhere(const std::optional<storage::StoredPresence>& /*presence*/) {}
  /// A stream of the robot is here. Any thread.
  [[nodiscard]] virtual bool HasStream() const = 0;
  /// Any thread.
  [[nodiscard]] virtual Registration registration() const { return Registration::kFits; }
  /// A stream of it waited to be opened, and the robot is kRefused: the stream must end, and its
  /// waiting records are void, counted superseded; generation() has grown on return. Returns the
  /// stream to wake.
  virtual loop::StreamRef OnRefused(metrics::Ledger& /*ledger*/) { return {}; }
  /// The robot should leave memory, and nothing prevents it.
  [[nodiscard]] virtual bool MayLeave() const { return false; }
  /// The journal has forgotten the robot.
  virtual void OnLeft() {}
  /// The stream `open_id` was opened. Returns the stream to wake.
  virtual loop::StreamRef OnOpened(std::uint64_t open_id, const storage::OpenResult& result) = 0;
  /// The store has the robot in `fleet`, and the claim of stream `open_id` does not move it. That
  /// stream must end, and its waiting records are void, counted superseded; generation() has grown
  /// on return. No effect if another stream was opened since. Returns the stream to wake.
  virtual loop::StreamRef OnOtherFleet(std::uint64_t open_id, const std::string& fleet,
                                       metrics::Ledger& ledger) = 0;
  /// The store answered the claim of a drone (Journal::Claim). Returns the stream to wake.
  virtual loop::StreamRef OnClaimed(const storage::ClaimResult& /*result*/) { return {}; }
  /// For a drone: the store was connected to anew, and may remember less than it confirmed. Returns
  /// the stream to wake.
  virtual loop::StreamRef OnDoubted() { return {}; }
  /// Outcomes of one commit, in order; never kFenced. Counts go to `ledger`. Returns the stream to
  /// wake.
  virtual loop::StreamRef OnSettled(std::span<const Settled> settled, metrics::Ledger& ledger) = 0;
  /// Gap records of this robot left the journal. Returns the stream to wake.
  virtual loop::StreamRef OnGapsWritten(std::size_t count) = 0;
  /// Another process holds the robot, or held it since this one's last OpenStream. Forgets its
  /// sessions and all waiting records, counted superseded; generation() has grown on return.
  /// Returns the stream to wake.
  virtual loop::StreamRef OnFenced(metrics::Ledger& ledger) = 0;
  /// The sessions in memory that have commits, each with the highest committed number.
  [[nodiscard]] virtual std::vector<storage::CommittedSession> Committed() const = 0;
  /// The store went back: it has less of the robot than it confirmed, and still holds it for this
  /// process. As OnFenced for sessions and waiting records; the robot's state stays.
  virtual loop::StreamRef OnWentBack(metrics::Ledger& ledger) = 0;
  /// Grows when waiting records become void; entries of an older generation are dropped unwritten.
  [[nodiscard]] virtual std::uint64_t generation() const = 0;
};

/// A drone as the journal sees it, beside its robot: it is called about its claim and its samples.
/// It has numbers of its own and holds no robot; news of the holder goes to the robot.
///
/// OnFenced: another server claimed the drone. Waiting records are void. The drone claims anew,
/// gets what the store remembers of its samples, and judges them again. OnDoubted: waiting records
/// stay valid, and the drone claims anew after them.
class ClaimClient : public CommitClient {
 public:
  loop::StreamRef OnClaimed(const storage::ClaimResult& result) override = 0;

  // These are for streams only.
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

/// Keeps a client alive while a record of it waits. A client that is not shared must outlive it. A
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
