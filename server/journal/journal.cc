#include "server/journal/journal.h"

#include <utility>

#include "schema/base/check.h"
#include "server/journal/turns.h"
#include "server/journal/writer_context.h"

namespace uplink::journal {

Journal::Journal(storage::Store& store, const JournalLimits& limits, const Clock& clock,
                 metrics::Ledger& ledger, JournalProbe& probe, const storage::ProcessId& process)
    : inbox_(limits, clock),
      probe_(probe),
      writer_inbox_(inbox_),
      errors_(probe),
      retain_error_(probe.retention_failing),
      checkpoint_error_(probe.checkpoint_failing),
      went_back_(probe),
      turns_(std::make_unique<Turns>(WriterContext{.store = store,
                                                   .clock = clock,
                                                   .ledger = ledger,
                                                   .probe = probe,
                                                   .inbox = writer_inbox_,
                                                   .errors = errors_,
                                                   .quarantine = quarantine_,
                                                   .retain_error = retain_error_,
                                                   .checkpoint_error = checkpoint_error_,
                                                   .went_back = went_back_,
                                                   .spatial_committed = spatial_committed_,
                                                   .store_reconnected = store_reconnected_,
                                                   .slow_commit = slow_commit_,
                                                   .moved = moved_},
                                     limits, process)) {}

Journal::~Journal() = default;

void Journal::Open(robot::CommitClient& client, std::uint64_t open_id, storage::OpenRequest request,
                   std::string gateway) {
  inbox_.Open({.client = &client,
               .open_id = open_id,
               .request = std::move(request),
               .gateway = std::move(gateway)});
}

void Journal::Claim(robot::CommitClient& client, robot::CommitClient& robot,
                    storage::ClaimRequest request, std::string gateway) {
  inbox_.Claim({.client = &client,
                .robot = &robot,
                .request = std::move(request),
                .gateway = std::move(gateway)});
}

void Journal::AppendMessage(robot::CommitClient& client, const AppendedBy& by,
                            std::vector<storage::CommitRecord> records, SteadyTime arrived) {
  inbox_.AppendMessage(client, by, std::move(records), arrived);
}

void Journal::AppendGap(robot::CommitClient& client, const AppendedBy& by, storage::GapItem gap) {
  inbox_.AppendGap(client, by, std::move(gap));
}

void Journal::Remember(storage::Deliveries deliveries) { inbox_.Remember(std::move(deliveries)); }

void Journal::NotePresence(const storage::RobotRef& robot, model::Presence presence, SystemTime at,
                           std::optional<model::ConnectionEnd> why,
                           std::optional<SystemTime> parked_until) {
  inbox_.NotePresence(robot, presence, at, why, parked_until);
}

void Journal::NoteConnection(storage::ConnectionItem item) {
  const storage::RobotRef robot = item.robot;
  if (inbox_.NoteConnection(std::move(item))) return;
  probe_.connections_dropped.Add();
  if (connection_dropped_) connection_dropped_(*robot);
}

void Journal::Adopt(AdoptEntry entry) { inbox_.Adopt(std::move(entry)); }

void Journal::Lose(LossEntry entry) { inbox_.Lose(std::move(entry)); }

void Journal::Leave(LeaveEntry entry) { inbox_.Leave(std::move(entry)); }

void Journal::CheckpointFrom(fleet::LiveSource& live, milliseconds every) {
  checkpoints_ = true;
  turns_->CheckpointFrom(live, every);
}

void Journal::OnSpatial(std::function<void()> told) {
  UPLINK_CHECK(!spatial_committed_, "one listener hears of shapes and objects");
  spatial_committed_ = std::move(told);
}

void Journal::OnReconnected(std::function<void(Reconnected)> told) {
  UPLINK_CHECK(!store_reconnected_, "one listener hears that the store was connected to anew");
  store_reconnected_ = std::move(told);
}

void Journal::OnSlowCommit(std::function<void(const SlowCommit&)> told) {
  UPLINK_CHECK(!slow_commit_, "one listener hears of slow commits");
  slow_commit_ = std::move(told);
}

void Journal::OnMoved(std::function<void(const Moved&)> told) {
  UPLINK_CHECK(!moved_, "one listener hears of robots that move to another fleet");
  moved_ = std::move(told);
}

void Journal::OnConnectionDropped(std::function<void(const model::RobotId&)> told) {
  UPLINK_CHECK(!connection_dropped_, "one listener hears of connections that are dropped");
  connection_dropped_ = std::move(told);
}

void Journal::EndConnections(IsOver is_over) { turns_->EndConnections(std::move(is_over)); }

void Journal::RequestCheckpoint() {
  if (checkpoints_) inbox_.RequestCheckpoint();
}

}  // namespace uplink::journal
