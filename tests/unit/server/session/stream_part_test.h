#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "server/session/attachment.h"
#include "server/session/stream_timers.h"
#include "tests/support/fake_reject_source.h"
#include "tests/support/fake_trust.h"
#include "tests/unit/server/session/session_bench.h"

namespace uplink::session {

/// Notes which streams were woken, in order.
class WokenStreams final : public loop::WakeInbox {
 public:
  void Wake(std::uint64_t stream) override { streams.push_back(stream); }

  std::vector<std::uint64_t> streams;
};

/// What one part of a stream is built on: the real fleet and journal, on a store in memory, and the
/// robot of the stream. The stream itself is left out.
class StreamPartTest : public ::testing::Test {
 protected:
  /// What a Hello of the robot asks for.
  static HelloTerms Terms(const model::SessionId& session) {
    return {.claim = {.robot = {.ruri = std::string(kRobot)}}, .session = session};
  }
  /// Admits the robot and attaches the stream, without its wait.
  static absl::StatusOr<robot::Standing> Attach(Attachment& stream, HelloTerms terms) {
    const absl::StatusOr<milliseconds> delay = stream.Admit(std::move(terms));
    if (!delay.ok()) return delay.status();
    return stream.Attach();
  }
  /// A stream of this number.
  loop::StreamRef Stream(std::uint64_t number) { return {.inbox = &woken_, .stream = number}; }

  WokenStreams woken_;
  testing::ManualClock clock_;
  testing::FakeDatabase database_;
  BenchLimits limits_;
  BenchServer server_{clock_, database_, 1, limits_};
  SessionProbe probe_;
  metrics::Ledger ledger_;
  schema::Judge judge_{schema::JudgeLimits{}};
  IntakeScratch scratch_;
  const ingest::Allowances allowances_;
  const testing::FakeTrust clock_trust_;
  testing::FakeRejectSource rejects_{&server_.store()};
  journal::Shards shards_{{&server_.journal()}};
  SessionContext context_{.clock = clock_,
                          .fleet = server_.fleet(),
                          .journals = shards_,
                          .probe = probe_,
                          .ledger = ledger_,
                          .judge = judge_,
                          .limits = limits_.session,
                          .scratch = scratch_,
                          .allowances = allowances_,
                          .rejects = rejects_,
                          .clock_trust = clock_trust_};
  StreamTimers timers_;
  Attachment robot_{context_, Stream(1)};
};

}  // namespace uplink::session
