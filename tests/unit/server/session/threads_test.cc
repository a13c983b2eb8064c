// Real sessions on threads of their own over a real journal writer: for wakes that get lost, and
// for ThreadSanitizer. No timer hides a lost wake: no Ack is due within the test, and what an agent
// does follows only from what it is sent.
#include <algorithm>
#include <cstdint>
#include <memory>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include "server/journal/writer.h"
#include "tests/support/eventually.h"
#include "tests/unit/server/session/threads_worker.h"

namespace uplink::session {
namespace {

constexpr std::size_t kRobots = 4;
constexpr std::size_t kMessages = 2'000;
/// Threads that take turns are slow on a machine that does something else.
constexpr milliseconds kDeadline{240'000};
constexpr BackoffLimits kBackoff{.first = milliseconds(2), .longest = milliseconds(4)};

/// Which bound holds the streams back.
struct Bound {
  const char* name;
  std::uint32_t in_flight_uplinks_max;
  std::size_t journal_bytes_max;
};

void PrintTo(const Bound& bound, std::ostream* out) { *out << bound.name; }

class SessionThreads : public ::testing::TestWithParam<Bound> {
 protected:
  SessionThreads() : core_(kRobots, Limits()) {
    for (std::size_t i = 0; i < kRobots; ++i) {
      agents_.push_back(std::make_unique<ThreadsAgent>(fmt::format("rcan://threads/{}", i), i + 1,
                                                       kMessages, core_.database));
      for (int copy = 0; copy < 2; ++copy) {
        workers_.push_back(std::make_unique<ThreadsWorker>(core_, *agents_.back()));
      }
    }
  }

  static BenchLimits Limits() {
    BenchLimits limits;
    limits.session.in_flight_uplinks_max = GetParam().in_flight_uplinks_max;
    limits.session.ack_interval = std::chrono::hours(1);
    limits.session.reconnects.per_minute = robot::kStreamTimesMax;
    limits.session.drain_timeout = std::chrono::hours(1);
    limits.journal.bytes_max = GetParam().journal_bytes_max;
    limits.journal.batch_records_max = 3;
    return limits;
  }

  /// Runs until every agent has finished; false after kDeadline. The law is looked at all the time,
  /// and the store fails now and then.
  bool RunAll() {
    for (std::size_t i = 0; i < workers_.size(); ++i) workers_[i]->Start(*workers_[i ^ 1U]);
    for (std::size_t i = 0; i < workers_.size(); i += 2) workers_[i]->Connect();
    std::uint64_t next_failure = 10;
    std::size_t failures = 0;
    return testing::Eventually(
        [this, &next_failure, &failures] {
          const metrics::MessageCounts counts = core_.book.Sum().messages;
          if (!counts.Balanced()) ++unbalanced_;
          // By what the store did, not by time: on a busy machine every call would fail.
          if (const std::uint64_t calls = core_.store.commits(); calls >= next_failure) {
            next_failure = calls + 10;
            core_.store.FailNext(
                1, ++failures % 2 == 0 ? testing::FailAt::kBefore : testing::FailAt::kAfter);
          }
          return std::ranges::all_of(agents_, [](const auto& agent) { return agent->finished(); });
        },
        kDeadline);
  }

  [[nodiscard]] std::string State() const {
    std::string text =
        fmt::format("the journal holds {} records, {} bytes, room {}\n", core_.journal.records(),
                    core_.journal.bytes(), core_.journal.HasRoom());
    for (const auto& agent : agents_) {
      const fleet::RobotPtr robot = core_.fleet.Find(agent->ruri());
      text += fmt::format("{}; in flight {}, held back {}\n", agent->State(),
                          robot == nullptr ? 0 : robot->sessions.in_flight(),
                          robot != nullptr && robot->state.held_back());
    }
    return text;
  }

  ThreadsCore core_;
  std::vector<std::unique_ptr<ThreadsAgent>> agents_;
  std::vector<std::unique_ptr<ThreadsWorker>> workers_;
  std::size_t unbalanced_ = 0;
};

TEST_P(SessionThreads, AllIsAckedAndNothingIsLost) {
  journal::JournalWriter writer(core_.journal, kBackoff, std::mt19937_64(7));
  const bool finished = RunAll();
  const bool idle = testing::Eventually([this] { return core_.journal.idle(); });
  EXPECT_TRUE(finished && idle) << State();
  for (const auto& worker : workers_) worker->Stop();
  writer.Stop();
  if (!finished || !idle) return;

  EXPECT_EQ(unbalanced_, 0U) << "the conservation law";
  const metrics::MessageCounts counts = core_.book.Sum().messages;
  EXPECT_TRUE(counts.Balanced());
  EXPECT_EQ(counts.in_flight, 0);
  EXPECT_EQ(core_.probe.streams.value(), 0);
  EXPECT_EQ(core_.probe.held_back.value(), 0);
  EXPECT_EQ(core_.probe.protocol_errors_total.value(), 0);
  for (const auto& agent : agents_) {
    agent->CheckStore();
    EXPECT_EQ(core_.fleet.Find(agent->ruri())->sessions.in_flight(), 0U);
  }
  // The run must have met what it is there for.
  // What was stored while its answer was lost counts as a duplicate: how much, is up to the load.
  EXPECT_GT(counts.stored, kRobots * kMessages / 4);
  EXPECT_GT(counts.rejected, kRobots * kMessages / 10);
  EXPECT_GT(counts.applied, kRobots * kMessages / 10);
  EXPECT_GT(core_.probe.held_back_total.value(), 100);
  EXPECT_GT(core_.probe.superseded_total.value(), 5);
  EXPECT_GT(core_.probe.resumes_total.value(), 5);
  EXPECT_GT(counts.duplicate + counts.missing, 10U);
  EXPECT_GT(core_.journal_probe.store_errors.value(), 0);
}

INSTANTIATE_TEST_SUITE_P(Bounds, SessionThreads,
                         ::testing::Values(Bound{"OneRecord", 8, 1}, Bound{"Journal", 8, 2'000},
                                           Bound{"InFlight", 2, 1'000'000},
                                           Bound{"Both", 3, 2'000}),
                         [](const auto& bound) { return std::string(bound.param.name); });

}  // namespace
}  // namespace uplink::session
