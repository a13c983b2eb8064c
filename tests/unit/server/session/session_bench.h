#pragma once

#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include <absl/status/status.h>

#include "server/journal/writer_context.h"
#include "server/session/session.h"
#include "tests/support/fake_reject_source.h"
#include "tests/support/fake_store.h"
#include "tests/support/fake_trust.h"
#include "tests/support/manual_clock.h"

/// Scripts for sessions: the real core on the store in memory, moved by hand, without threads.
namespace uplink::session {

using robot::HeldBack;

inline constexpr std::string_view kRobot = "rcan://bench/1";

/// A session id that tests tell apart by one number.
[[nodiscard]] model::SessionId SessionOf(std::uint8_t number);

/// One message of a batch. A value.
struct Message {
  model::Seq seq = 0;
  std::string payload;
};

// Payloads, serialized.
[[nodiscard]] std::string Fault(std::string_view id = "BATTERY_LOW");
/// Rejected by the rules: a fault without an id.
[[nodiscard]] std::string BadFault();
/// A fault that the store of the bench refuses.
[[nodiscard]] std::string RefusedFault();
[[nodiscard]] std::string Motion(double lat_deg = 47);

[[nodiscard]] v1::RelayRequest HelloFrame(const model::SessionId& session, model::Seq settled = 0,
                                          model::Seq judged = 0);
[[nodiscard]] v1::RelayRequest BatchFrame(const std::vector<Message>& messages);
/// Messages of numbers `first` to `last` with one payload.
[[nodiscard]] std::vector<Message> Messages(model::Seq first, model::Seq last,
                                            const std::string& payload);

/// A response as one line: `welcome 3`, `ack 3 judged 5`, `reject 4 missing_field faultId`,
/// `notice 1 out_of_range battery.socPct`, `resend AGENT_INFO CURRENT_SETTINGS`, `drain 1000`,
/// `forward 2 rcan://a/1` (its kind and origin).
[[nodiscard]] std::string ToLine(const v1::RelayResponse& frame);

/// One stream: a session, and an agent that takes every frame at once unless it is told not to.
class BenchStream final : public FrameSource, public FrameSink {
 public:
  BenchStream(const SessionContext& context, identity::PeerIdentity peer, loop::StreamRef self);
  ~BenchStream() override;

  void RequestRead() override { reading_ = true; }
  void Write(const v1::RelayResponse& frame) override;
  void WriteEncoded(std::span<const EncodedFrame> frames) override;
  void Finish(const absl::Status& status) override { status_ = status; }
  void Cancel() override { cancelled_ = true; }
  void AskPeer() override {}

  // The agent's side. Sending needs a read under way.
  void Send(const v1::RelayRequest& frame) { SendBytes(frame.SerializeAsString()); }
  void SendBytes(std::string_view bytes);
  /// Without the further turns that the stream asks for.
  void SendOnce(const v1::RelayRequest& frame) { SendBytesOnce(frame.SerializeAsString()); }
  void SendBytesOnce(std::string_view bytes);
  void SendTooLarge(std::uint64_t bytes);
  void HalfClose();
  void Break();
  /// Writes stay under way until ReadAgain.
  void StopReading() { agent_reads_ = false; }
  void ReadAgain();
  /// Takes the one write that is under way, however the agent reads.
  void ReadOne();
  /// Runs `job` within the next Write.
  void AtNextWrite(std::function<void()> job) { at_next_write_ = std::move(job); }

  // The result.
  /// A line for each frame since the last call, without requests to send again.
  [[nodiscard]] std::vector<std::string> TakeLines();
  /// With those.
  [[nodiscard]] std::vector<std::string> TakeAllLines();
  [[nodiscard]] const std::vector<v1::RelayResponse>& frames() const { return frames_; }
  /// The server wants a frame.
  [[nodiscard]] bool reading() const { return reading_; }
  /// `CODE: message` of the end; empty while the stream goes on.
  [[nodiscard]] std::string end() const;
  [[nodiscard]] bool cancelled() const { return cancelled_; }

  void Wake();
  void Timer();
  void Drain(milliseconds grace, transport::EndCause cause = transport::EndCause::kDrain);
  [[nodiscard]] Session& session() { return session_; }

 private:
  void Pump();

  const loop::StreamRef self_;
  std::vector<v1::RelayResponse> frames_;
  std::size_t told_ = 0;
  bool reading_ = false;
  bool writing_ = false;
  bool agent_reads_ = true;
  bool cancelled_ = false;
  std::optional<absl::Status> status_;
  std::function<void()> at_next_write_;
  Session session_;
};

struct BenchLimits {
  SessionLimits session;
  journal::JournalLimits journal;
  /// As much as comes, but where a test says otherwise.
  ingest::Allowance allowance{.flow = {.records = {}, .bytes = {}}};
  std::size_t robots_max = 100;
};

/// One life of a server process on a database that outlives it.
class BenchServer final : public loop::WakeInbox {
 public:
  BenchServer(testing::ManualClock& clock, testing::FakeDatabase& database, std::uint8_t process,
              const BenchLimits& limits);
  ~BenchServer() override;

  void Wake(std::uint64_t stream) override { wakes_.insert(stream); }
  /// Whether a wake of the stream waits; takes it.
  bool TakeWake(std::uint64_t stream) { return wakes_.erase(stream) > 0; }

  /// A new stream that waits for Hello.
  BenchStream& Open(std::string_view ruri = kRobot);
  BenchStream& OpenAs(identity::PeerIdentity peer);
  /// A stream that was welcomed, if the store answers; records that wait stay where they are.
  BenchStream& Connect(const model::SessionId& session, model::Seq settled = 0,
                       model::Seq judged = 0, std::string_view ruri = kRobot);
  /// Everything that can be done now, is: opened, committed, told.
  void Commit();
  /// The store does one step; no stream is woken.
  journal::Step Advance();
  void DeliverWakes();
  /// Time passes, and timers that are due fire.
  void Pass(milliseconds time);
  /// Others wait for a place among the connections.
  std::atomic<bool> pressed{false};
  /// Of streams that are opened from now on; null: nothing is forwarded.
  ForwardSource* forwards = nullptr;
  /// Where they are reported; null: nowhere.
  robot::ConnectionReports* reports = nullptr;
  void StoreAway();
  void StoreBack();

  [[nodiscard]] robot::Robot& robot(std::string_view ruri = kRobot);
  [[nodiscard]] fleet::Fleet& fleet() { return fleet_; }
  [[nodiscard]] journal::Journal& journal() { return journal_; }
  [[nodiscard]] testing::FakeStore& store() { return store_; }
  /// Its reads are done by Commit, and by ReadRejects.
  [[nodiscard]] testing::FakeRejectSource& rejects() { return rejects_; }
  /// One read is done and its stream told. False if none waits.
  bool ReadRejects();
  [[nodiscard]] SessionProbe& probe() { return probe_; }
  /// For a reload.
  [[nodiscard]] ingest::Allowances& allowances() { return allowances_; }
  [[nodiscard]] testing::FakeTrust& clock_trust() { return clock_trust_; }
  [[nodiscard]] metrics::MessageCounts counts() const { return book_.Sum().messages; }
  [[nodiscard]] metrics::Ledger::Page page() const { return book_.Sum(); }

 private:
  testing::ManualClock& clock_;
  const BenchLimits limits_;
  testing::FakeStore store_;
  ingest::Allowances allowances_;
  testing::FakeTrust clock_trust_;
  testing::FakeRejectSource rejects_{&store_, testing::FakeRejectSource::Reads::kWhenTold};
  metrics::LedgerBook book_;
  SessionProbe probe_;
  journal::JournalProbe journal_probe_;
  fleet::Fleet fleet_;
  journal::Journal journal_;
  journal::Shards shards_{{&journal_}};
  schema::Judge judge_;
  IntakeScratch scratch_;
  metrics::Ledger& ledger_;
  std::set<std::uint64_t> wakes_;
  std::map<std::uint64_t, std::unique_ptr<BenchStream>> streams_;
};

}  // namespace uplink::session
