#pragma once

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "server/journal/journal.h"
#include "server/journal/turns.h"
#include "tests/support/fake_store.h"
#include "tests/support/manual_clock.h"
#include "tests/unit/server/journal/recording_client.h"

namespace uplink::journal {

/// A journal on the store in memory.
struct JournalBench {
  explicit JournalBench(const JournalLimits& limits = {})
      : journal(store, limits, clock, ledger, probe, storage::ProcessId{1}) {}

  void Open(RecordingClient& client, std::uint64_t open_id = 1) {
    journal.Open(client, open_id,
                 {.robot = client.robot(), .session = kSession, .at = clock.System()});
  }
  void Append(RecordingClient& client, model::Seq seq, std::string payload = "") {
    const std::size_t bytes = payload.size();
    journal.AppendMessage(client, client.generation(),
                          {{.robot = client.robot(),
                            .session = kSession,
                            .seq = seq,
                            .received_at = clock.System(),
                            .content = FaultRecord(),
                            .payload = std::move(payload),
                            .payload_bytes = bytes}},
                          clock.Steady());
  }
  void AppendGap(RecordingClient& client, model::Seq first, model::Seq last) {
    journal.AppendGap(client, client.generation(),
                      {.robot = client.robot(),
                       .session = kSession,
                       .first = first,
                       .last = last,
                       .seen_at = clock.System()});
  }
  [[nodiscard]] std::vector<model::Seq> Stored(const RecordingClient& client) const {
    return database.Log(client.robot()->ruri, kSession).stored;
  }
  void Run() {
    while (journal.turns().Advance() == Step::kWorked) {
    }
  }

  static inline const model::SessionId kSession;

  testing::ManualClock clock;
  testing::FakeDatabase database;
  testing::FakeStore store{database, storage::ProcessId{1}};
  metrics::Ledger ledger;
  JournalProbe probe;
  Journal journal;
};

}  // namespace uplink::journal
