#pragma once

#include <atomic>
#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <thread>
#include <utility>

#include "tests/support/fake_reject_source.h"
#include "tests/support/fake_trust.h"
#include "tests/unit/server/session/threads_agent.h"

namespace uplink::session {

/// The machine's clock, whose readers give way to other threads now and then: it widens the gaps
/// between what a session looks at and what it does, where wakes get lost. Thread-safe.
class YieldingClock final : public Clock {
 public:
  [[nodiscard]] SteadyTime Steady() const override {
    for (std::uint64_t i = reads_.fetch_add(1) % 16; i > 0; --i) std::this_thread::yield();
    return clock_.Steady();
  }
  [[nodiscard]] SystemTime System() const override { return clock_.System(); }

 private:
  const SystemClock clock_{};
  mutable std::atomic<std::uint64_t> reads_{0};
};

/// What all streams of one process share.
struct ThreadsCore {
  ThreadsCore(std::size_t robots, const BenchLimits& given)
      : limits(given), fleet(clock, robots, {}) {}

  const BenchLimits limits;
  YieldingClock clock;
  testing::FakeDatabase database;
  testing::FakeStore store{database, storage::ProcessId{1}};
  metrics::LedgerBook book;
  SessionProbe probe;
  journal::JournalProbe journal_probe;
  fleet::Fleet fleet;
  journal::Journal journal{store,          limits.journal, clock,
                           book.NewPage(), journal_probe,  storage::ProcessId{1}};
  journal::Shards shards{{&journal}};
  testing::FakeRejectSource rejects{&store};
  std::atomic<std::uint64_t> next_stream{1};
};

/// A session with its transport: one read and one write at most are under way.
class ThreadsStream final : public FrameSource, public FrameSink {
 public:
  ThreadsStream(const SessionContext& context, const std::string& ruri, loop::StreamRef self)
      : session_(context, {{.role = identity::Role::kRobot, .fleet = "bench", .ruri = ruri}}, self,
                 *this, *this) {}

  void RequestRead() override { reading_ = true; }
  void Write(const v1::RelayResponse& frame) override { writing_ = frame; }
  /// Nothing is forwarded here.
  void WriteEncoded(std::span<const EncodedFrame> /*frames*/) override {}
  void Finish(const absl::Status& status) override { end_ = status; }
  void Cancel() override {}
  void AskPeer() override {}

  [[nodiscard]] Session& session() { return session_; }
  [[nodiscard]] bool reading() const { return reading_ && !session_.done(); }
  void Send(const v1::RelayRequest& frame) {
    reading_ = false;
    session_.OnFrame(frame.SerializeAsString());
  }
  void HalfClose() {
    reading_ = false;
    session_.OnHalfClose();
  }
  std::optional<v1::RelayResponse> TakeWritten() { return std::exchange(writing_, std::nullopt); }
  std::optional<absl::Status> TakeEnd() { return std::exchange(end_, std::nullopt); }

 private:
  bool reading_ = false;
  std::optional<v1::RelayResponse> writing_;
  std::optional<absl::Status> end_;
  Session session_;
};

/// One thread with the loop of a queue: one stream at a time, its wakes and its timers.
///
/// Thread: Connect, Wake and Stop from any thread; the rest on its own.
class ThreadsWorker final : public loop::WakeInbox {
 public:
  ThreadsWorker(ThreadsCore& core, ThreadsAgent& agent)
      : core_(core), agent_(agent), ledger_(core.book.NewPage()) {}
  ~ThreadsWorker() override { Stop(); }

  /// `partner` takes the robot over when the agent says so.
  void Start(ThreadsWorker& partner);
  /// Opens a new stream of the agent; the one before breaks.
  void Connect();
  void Wake(std::uint64_t stream) override;
  void Stop();

 private:
  struct Signals {
    bool stop = false;
    bool connect = false;
    bool wake = false;
    [[nodiscard]] bool any() const { return stop || connect || wake; }
  };

  void Run();
  /// What other threads want; waits for it, or for the session's timer, unless `busy`.
  Signals Next(bool busy);
  void Open();
  /// One frame either way, or the end; false if there is nothing to do but to wait.
  bool Step();
  bool Give(const Move& move);

  ThreadsCore& core_;
  ThreadsAgent& agent_;
  metrics::Ledger& ledger_;
  schema::Judge judge_{{}};
  IntakeScratch scratch_;
  const ingest::Allowances allowances_;
  const testing::FakeTrust clock_trust_;
  ThreadsWorker* partner_ = nullptr;

  std::mutex mutex_;
  std::condition_variable changed_;
  Signals signals_;
  std::uint64_t id_ = 0;

  // The thread's own.
  std::uint64_t stream_id_ = 0;
  std::unique_ptr<ThreadsStream> stream_;
  std::thread thread_;
};

}  // namespace uplink::session
