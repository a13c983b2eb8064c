#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

#include "server/front/call/grpc_connection.h"
#include "server/front/call/thread.h"
#include "server/journal/writer_context.h"
#include "tests/fuzz/frame_order.h"
#include "tests/support/fake_reject_source.h"
#include "tests/support/fake_store.h"
#include "tests/support/fake_trust.h"
#include "tests/support/http2_answers.h"
#include "tests/support/kept_connections.h"
#include "tests/support/manual_clock.h"

/// The transport from HTTP/2 upwards, moved by hand: no socket, no TLS, no threads; real
/// calls and sessions, and the journal on the store in memory.
namespace uplink::fuzz {

/// A robot's address that `number` tells apart.
[[nodiscard]] std::string RuriOf(std::uint8_t number);
/// The robot of this number shows a certificate that lacks something.
inline constexpr std::uint8_t kStranger = 3;
inline constexpr std::uint8_t kRobots = 4;
/// Small, so that few bytes reach them.
inline constexpr std::uint32_t kFrameBytesMax = 90'000;
inline constexpr std::size_t kUnfinishedMax = 200'000;

/// A connection of gRPC without what front::Connection has below it.
class FrontWire final : public front::GrpcConnectionOwner {
 public:
  FrontWire(front::Thread& thread, std::uint8_t robot);
  ~FrontWire() override;
  FrontWire(const FrontWire&) = delete;
  FrontWire& operator=(const FrontWire&) = delete;

  // The peer's side.
  void Receive(std::string_view bytes);
  /// What the server says waits until ReadAgain.
  void StopReading() { reads_ = false; }
  void ReadAgain();
  /// The connection is gone.
  void Break();

  // What a connection does by itself.
  void Drain(milliseconds grace);
  void Keepalive();
  void EndNow();

  [[nodiscard]] bool open() const { return open_; }
  [[nodiscard]] std::uint8_t robot() const { return robot_; }
  [[nodiscard]] std::size_t calls() const { return grpc_.calls(); }
  [[nodiscard]] const front::Origin& origin() const { return origin_; }
  [[nodiscard]] const testing::Http2Answers& answers() const { return answers_; }
  /// The highest number that the server said it has judged, on the stream.
  [[nodiscard]] model::Seq JudgedOn(std::uint32_t stream) const;
  /// What every answer keeps to.
  void Check();

  // front::GrpcConnectionOwner
  void Settle() override;
  void OnCalls(std::size_t /*calls*/) override {}
  void OnCaller(std::string_view /*name*/) override {}

 private:
  /// What was read of the answer on a stream.
  struct Watched {
    std::size_t bytes = 0;
    std::size_t frames = 0;
    FrameOrder order;
  };

  bool Flush();
  void CheckStream(std::uint32_t id, const testing::RawStream& stream);

  front::Thread& thread_;
  const std::uint8_t robot_;
  const front::Origin origin_{.text = "fuzz"};
  front::GrpcConnection grpc_;
  bool open_ = true;
  bool reads_ = true;
  testing::Http2Answers answers_;
  std::map<std::uint32_t, Watched> watched_;
};

/// One thread of the transport and what stands behind it, with its connections.
class FrontBench final : public loop::WakeInbox {
 public:
  /// Connections at once; more would only cost time.
  static constexpr std::size_t kWiresMax = 6;
  /// Of the door, for who gives it connections of his own.
  static constexpr std::size_t kPlacesMax = 8;
  static constexpr std::size_t kLingersMax = 2;

  FrontBench();
  /// Of other methods than the relay's.
  explicit FrontBench(transport::Methods methods);
  ~FrontBench() override;
  FrontBench(const FrontBench&) = delete;
  FrontBench& operator=(const FrontBench&) = delete;

  void Wake(std::uint64_t call) override { wakes_.insert(call); }

  /// A connection of this robot; with kWiresMax of them the oldest breaks for it.
  FrontWire& Connect(std::uint8_t robot);
  [[nodiscard]] const std::vector<std::unique_ptr<FrontWire>>& wires() const { return wires_; }
  /// Forgets the connections that have ended.
  void Reap();

  void DeliverWakes();
  /// One step of the store.
  journal::Step Advance();
  /// Everything that can be done now.
  void Commit();
  /// Time passes, and timers that are due fire.
  void Pass(milliseconds time);
  /// The server ends.
  void Drain(milliseconds grace);
  [[nodiscard]] testing::FakeStore& store() { return store_; }
  [[nodiscard]] fleet::Fleet& fleet() { return fleet_; }
  [[nodiscard]] session::SessionProbe& session_probe() { return session_probe_; }
  [[nodiscard]] const testing::KeptConnections& connections() const { return connections_; }
  [[nodiscard]] front::DoorBook& door_book() { return door_book_; }
  [[nodiscard]] front::Thread& thread() { return thread_; }
  [[nodiscard]] identity::DenyList& denied() { return denied_; }
  [[nodiscard]] transport::RelayProbe& relay_probe() { return relay_probe_; }
  [[nodiscard]] testing::ManualClock& clock() { return clock_; }
  [[nodiscard]] testing::FakeTrust& clock_trust() { return clock_trust_; }
  [[nodiscard]] SteadyTime now() const { return clock_.Steady(); }
  [[nodiscard]] metrics::MessageCounts counts() const { return book_.Sum().messages; }

  /// What holds after every step.
  void Check() const;
  /// Breaks all connections: everything is given back.
  void End();

 private:
  [[nodiscard]] front::RelayContext Context();

  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  testing::FakeStore store_{database_, storage::ProcessId{1}};
  const session::SessionLimits limits_;
  const ingest::Allowances allowances_;
  testing::FakeTrust clock_trust_;
  testing::KeptConnections connections_{clock_};
  testing::FakeRejectSource rejects_{&store_, testing::FakeRejectSource::Reads::kWhenTold};
  metrics::LedgerBook book_;
  session::SessionProbe session_probe_;
  transport::RelayProbe relay_probe_;
  identity::DenyList denied_;
  journal::JournalProbe journal_probe_;
  fleet::Fleet fleet_;
  journal::Journal journal_;
  journal::Shards shards_{{&journal_}};
  const front::RelayContext context_;
  transport::Gate gate_;
  front::DoorBook door_book_;
  front::Unfinished unfinished_;
  front::Thread thread_;
  std::set<std::uint64_t> wakes_;
  std::vector<std::unique_ptr<FrontWire>> wires_;
};

}  // namespace uplink::fuzz
