#pragma once

#include <cstdint>
#include <deque>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "server/session/session.h"
#include "storage/reader.h"
#include "tests/simulation/recorder.h"
#include "tests/simulation/sim_forwards.h"
#include "tests/simulation/trace.h"
#include "tests/support/fake_reject_source.h"
#include "tests/support/fake_trust.h"
#include "tests/support/manual_clock.h"

namespace uplink::simulation {

/// A response on its way to an agent, or the end of the stream.
struct ToAgent {
  v1::RelayResponse frame;
  /// Batches that the session had been given when it wrote this.
  std::uint64_t batches_seen = 0;
  /// The status with which the call ends, in place of a frame.
  std::optional<absl::StatusCode> end;
};

/// One stream: the real session, and a network in both directions whose every hop is a step of the
/// schedule.
class SimStream final : public session::FrameSource, public session::FrameSink {
 public:
  SimStream(const session::SessionContext& context, identity::PeerIdentity peer,
            loop::StreamRef self, Trace* trace);

  /// The robot that opened it, and when.
  [[nodiscard]] const std::string& ruri() const { return ruri_; }
  [[nodiscard]] SteadyTime opened_at() const { return opened_at_; }

  void RequestRead() override { read_wanted_ = true; }
  void Write(const v1::RelayResponse& frame) override;
  void WriteEncoded(std::span<const session::EncodedFrame> frames) override;
  void Finish(const absl::Status& status) override;
  void Cancel() override {}
  void AskPeer() override {}

  // Steps.
  [[nodiscard]] bool CanDeliver() const { return read_wanted_ && !to_server_.empty(); }
  void DeliverToServer();
  [[nodiscard]] bool CanHalfClose() const {
    return read_wanted_ && to_server_.empty() && half_closed_;
  }
  void DeliverHalfClose(SteadyTime now);
  /// When the session learned of the half-close.
  [[nodiscard]] std::optional<SteadyTime> half_closed_at() const { return half_closed_at_; }
  [[nodiscard]] bool Writing() const { return !writing_.empty(); }
  void CompleteWrite();
  [[nodiscard]] bool CanReceive() const { return !to_agent_.empty(); }
  ToAgent Receive();
  /// All that was written and has not arrived, as if it arrived now.
  std::vector<ToAgent> TakeInFlight();
  /// From now on nothing that the server writes arrives, though it is written; what the agent sends
  /// does.
  void LoseAnswers();
  [[nodiscard]] bool loses_answers() const { return loses_answers_; }
  /// The network drops everything; the server learns of it by TellBroken.
  void Break();
  [[nodiscard]] bool CanTellBroken() const { return broken_ && !told_broken_; }
  void TellBroken();

  // The agent's side.
  void Send(const v1::RelayRequest& frame);
  void HalfClose() { half_closed_ = true; }
  [[nodiscard]] bool half_closed() const { return half_closed_; }
  [[nodiscard]] bool broken() const { return broken_; }
  [[nodiscard]] std::uint64_t batches_seen() const { return batches_seen_; }

  [[nodiscard]] session::Session& session() { return session_; }
  /// The status of Finish, once; also of a stream that broke before its agent could see it.
  std::optional<absl::Status> TakeEnd() { return std::exchange(end_, std::nullopt); }
  /// Nothing can happen on it any more.
  [[nodiscard]] bool Over() const {
    return session_.done() && (broken_ || (writing_.empty() && to_agent_.empty() && !queued_end_));
  }

 private:
  /// Writes what the session did into the trace, if one is taken.
  void AddToTrace(std::string_view what, const std::string& text);

  const std::string ruri_;
  const std::uint64_t id_;
  Trace* const trace_;
  const SteadyTime opened_at_;
  std::deque<std::string> to_server_;
  std::deque<ToAgent> to_agent_;
  /// The frames of the write under way.
  std::vector<ToAgent> writing_;
  /// Its frames have arrived already.
  bool arrived_ = false;
  bool read_wanted_ = false;
  bool half_closed_ = false;
  bool broken_ = false;
  bool loses_answers_ = false;
  bool told_broken_ = false;
  /// The end goes out after the write under way.
  std::optional<absl::StatusCode> queued_end_;
  std::optional<absl::Status> end_;
  std::optional<SteadyTime> half_closed_at_;
  std::uint64_t batches_seen_ = 0;
  session::Session session_;
};

struct ServerLimits {
  session::SessionLimits session;
  journal::JournalLimits journal;
  robot::PresenceLimits presence;
  ingest::Allowance allowance;
};

/// What the lives of the process stand on.
struct Ground {
  const Clock& clock;
  /// What every life of the process finds there; null: nothing.
  storage::Reader* rows = nullptr;
  /// What the journal calls: the recorder, behind whatever else looks on.
  storage::Store& store;
  /// Null where no trace is taken.
  Trace* trace = nullptr;
  ForwardSetup forwards;
};

/// One life of the server process: the real fleet, journal and sessions over one store.
class SimServer final : public loop::WakeInbox {
 public:
  SimServer(const Ground& ground, const ServerLimits& limits, const storage::ProcessId& process);

  void Wake(std::uint64_t stream) override { wakes_.insert(stream); }

  /// A new stream of the robot; its session waits for the first frame.
  std::uint64_t Open(const model::RobotId& robot);
  [[nodiscard]] SimStream* Find(std::uint64_t stream);
  /// The robot's last stream that was opened, gone or not; 0 before the first.
  [[nodiscard]] std::uint64_t NewestOf(const std::string& ruri) const;
  [[nodiscard]] std::map<std::uint64_t, std::unique_ptr<SimStream>>& streams() { return streams_; }

  [[nodiscard]] bool HasWakes() const { return !wakes_.empty(); }
  void DeliverWake(std::size_t pick);
  void FireTimers();
  void Forget(std::uint64_t stream) { streams_.erase(stream); }

  /// Reads of quarantined Rejects, each a step.
  [[nodiscard]] testing::FakeRejectSource& rejects() { return rejects_; }
  /// Null where nothing is forwarded.
  [[nodiscard]] SimForwards* forwards() { return forwards_ ? &*forwards_ : nullptr; }
  [[nodiscard]] journal::Journal& journal() { return journal_; }
  [[nodiscard]] fleet::Fleet& fleet() { return fleet_; }
  [[nodiscard]] metrics::Ledger::Page counts() const { return book_.Sum(); }
  bool draining = false;

 private:
  const Clock& clock_;
  Trace* const trace_;
  const ServerLimits limits_;
  metrics::LedgerBook book_;
  session::SessionProbe probe_;
  journal::JournalProbe journal_probe_;
  fleet::Fleet fleet_;
  journal::Journal journal_;
  journal::Shards shards_{{&journal_}};
  schema::Judge judge_;
  session::IntakeScratch scratch_;
  const ingest::Allowances allowances_{limits_.allowance};
  const testing::FakeTrust clock_trust_;
  testing::FakeRejectSource rejects_;
  std::optional<SimForwards> forwards_;
  metrics::Ledger& ledger_;
  std::uint64_t next_stream_ = 1;
  std::map<std::string, std::uint64_t> newest_;
  std::set<std::uint64_t> wakes_;
  std::map<std::uint64_t, std::unique_ptr<SimStream>> streams_;
};

}  // namespace uplink::simulation
