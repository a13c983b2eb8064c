#pragma once

#include <functional>
#include <string>
#include <utility>
#include <vector>

#include "server/journal/holds.h"
#include "server/journal/inbox.h"
#include "server/journal/writer_context.h"
#include "tests/support/fake_store.h"
#include "tests/support/manual_clock.h"
#include "tests/unit/server/journal/recording_client.h"

namespace uplink::journal {

/// What a phase or a duty stands on, over the store in memory: no Journal.
struct StepBench {
  explicit StepBench(const JournalLimits& limits = {}) : inbox(limits, clock) {}

  [[nodiscard]] WriterContext context() { return context(clock); }
  [[nodiscard]] WriterContext context(const Clock& by) {
    return {.store = store,
            .clock = by,
            .ledger = ledger,
            .probe = probe,
            .inbox = writer_inbox,
            .errors = errors,
            .quarantine = quarantine,
            .retain_error = retain_error,
            .checkpoint_error = checkpoint_error,
            .went_back = went_back,
            .spatial_committed = spatial_committed,
            .store_reconnected = store_reconnected,
            .slow_commit = slow_commit,
            .moved = note_move};
  }

  void Open(RecordingClient& client, std::uint64_t open_id = 1) {
    inbox.Open(OpenOf(client, open_id));
  }
  void Append(RecordingClient& client, model::Seq seq, std::string payload = "") {
    inbox.AppendMessage(client, client.generation(), {RecordOf(client, seq, std::move(payload))},
                        clock.Steady());
  }
  void AppendGap(RecordingClient& client, model::Seq first) {
    inbox.AppendGap(client, client.generation(), GapOf(client, first));
  }
  /// As after the robot's OpenStream, in the store too.
  void Hold(RecordingClient& client) {
    const auto opened = store.OpenStreams(std::vector{OpenOf(client, 1).request});
    static_cast<void>(holds.Begin(client, client.robot(), {.since = opened->front().held_since}));
  }

  [[nodiscard]] static OpenEntry OpenOf(RecordingClient& client, std::uint64_t open_id) {
    return {.client = &client, .open_id = open_id, .request = {.robot = client.robot()}};
  }
  [[nodiscard]] static storage::CommitRecord RecordOf(const RecordingClient& client, model::Seq seq,
                                                      std::string payload = "") {
    return {.robot = client.robot(),
            .seq = seq,
            .content = FaultRecord(),
            .payload = std::move(payload)};
  }
  [[nodiscard]] static storage::GapItem GapOf(const RecordingClient& client, model::Seq first) {
    return {.robot = client.robot(), .first = first, .last = first};
  }
  /// A record that waits, of the client's present generation.
  [[nodiscard]] static Entry EntryOf(RecordingClient& client, model::Seq seq) {
    return {.origin = {.client = &client, .generation = client.generation(), .bytes = seq},
            .item = RecordOf(client, seq)};
  }
  [[nodiscard]] static Entry GapEntryOf(RecordingClient& client, model::Seq first) {
    return {.origin = {.client = &client, .generation = client.generation(), .bytes = first},
            .item = GapOf(client, first)};
  }
  [[nodiscard]] std::vector<model::Seq> Stored(const RecordingClient& client) const {
    return database.Log(client.robot()->ruri, {}).stored;
  }

  testing::ManualClock clock;
  testing::FakeDatabase database;
  testing::FakeStore store{database, storage::ProcessId{1}};
  metrics::Ledger ledger;
  JournalProbe probe;
  Inbox inbox;
  WriterInbox writer_inbox{inbox};
  StoreErrors errors{probe};
  QuarantineNotes quarantine;
  DutyError retain_error{probe.retention_failing};
  DutyError checkpoint_error{probe.checkpoint_failing};
  WentBackNotes went_back{probe};
  /// Commits that held shapes or objects, once they were told.
  int spatial_commits = 0;
  std::function<void()> spatial_committed = [this] { ++spatial_commits; };
  /// What was told each time that the store was connected to anew, and compared.
  std::vector<Reconnected> reconnects;
  std::function<void(Reconnected)> store_reconnected = [this](Reconnected to) {
    reconnects.push_back(to);
  };
  std::vector<SlowCommit> slow_commits;
  std::function<void(const SlowCommit&)> slow_commit = [this](const SlowCommit& commit) {
    slow_commits.push_back(commit);
  };
  std::vector<Moved> moves;
  std::function<void(const Moved&)> note_move = [this](const Moved& robot) {
    moves.push_back(robot);
  };
  Holds holds{context()};
};

/// The numbers of the records, then the first numbers of the gaps.
[[nodiscard]] inline std::vector<model::Seq> SeqsOf(const storage::Batch& batch) {
  std::vector<model::Seq> seqs;
  for (const storage::CommitRecord& record : batch.records) seqs.push_back(record.seq);
  for (const storage::GapItem& gap : batch.gaps) seqs.push_back(gap.first);
  return seqs;
}

}  // namespace uplink::journal
