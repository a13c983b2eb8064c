#include "server/journal/samples.h"

#include <chrono>
#include <cstddef>
#include <string>

#include "schema/model/presence.h"

namespace uplink::journal {

using enum metrics::MetricId;

namespace {

void AddShardSamples(const Shards& journals, const JournalLimits& limits, SteadyTime now,
                     metrics::Exposition& page) {
  const JournalLimits share = ShareOf(limits, journals.all().size());
  page.Add(kJournalShardRecordsLimit, share.records_max);
  page.Add(kJournalShardBytesLimit, share.bytes_max);
  for (std::size_t place = 0; place < journals.all().size(); ++place) {
    const Journal& journal = *journals.all()[place];
    const std::string shard = std::to_string(place);
    page.Add(kJournalShardRecords, journal.records(), {shard});
    page.Add(kJournalShardBytes, journal.bytes(), {shard});
    page.Add(kJournalShardOldestSeconds, std::chrono::duration<double>(journal.oldest(now)).count(),
             {shard});
  }
}

}  // namespace

void AddSamples(const Shards& journals, const JournalLimits& limits, SteadyTime now,
                metrics::Exposition& page) {
  page.Add(kJournalRecords, journals.records());
  page.Add(kJournalRecordsLimit, limits.records_max);
  page.Add(kJournalBytes, journals.bytes());
  page.Add(kJournalBytesLimit, limits.bytes_max);
  page.Add(kJournalOldestSeconds, journals.oldest(now));
  AddShardSamples(journals, limits, now, page);
}

void AddSamples(const JournalProbe& probe, metrics::Exposition& page) {
  page.Add(kStoreCommitSeconds, probe.commit_seconds);
  page.Add(kStoreCommitRecords, probe.commit_records);
  for (const model::Presence presence :
       {model::Presence::kOnline, model::Presence::kOffline, model::Presence::kUnknown}) {
    page.Add(kPresenceChanges, probe.presence_changes[static_cast<std::size_t>(presence)],
             {ToText(presence)});
  }
  page.Add(kPresenceRefused, probe.presence_refused);
  page.Add(kConnectionsWritten, probe.connections_written);
  page.Add(kConnectionsDropped, probe.connections_dropped);
  page.Add(kConnectionsEnded, probe.connections_ended);
  page.Add(kRobotsAdopted, probe.adopted);
  page.Add(kExpiredDeleted, probe.expired_deleted);
  page.Add(kMissionRunsClosed, probe.runs_closed_for_bound, {"bound"});
  page.Add(kMissionRunsClosed, probe.runs_closed_for_age, {"age"});
  for (const model::RejectReason reason : model::kAllRejectReasons) {
    page.Add(kQuarantineDropped, probe.quarantine_dropped[static_cast<std::size_t>(reason)],
             {ToText(reason)});
  }
  page.Add(kHistoryDeleted, probe.history_deleted);
  page.Add(kRejectsKept, probe.rejects_kept);
  page.Add(kRetentionFailing, probe.retention_failing.value() > 0 ? 1 : 0);
  page.Add(kCheckpointSeconds, probe.checkpoint_seconds);
  page.Add(kCheckpointRobots, probe.checkpoint_robots);
  page.Add(kCheckpointFailing, probe.checkpoint_failing.value() > 0 ? 1 : 0);
  page.Add(kStoreWentBack, probe.went_back);
  page.Add(kStoreErrors, probe.store_errors);
  page.Add(kStoreFailing, probe.store_failing.value() > 0 ? 1 : 0);
}

}  // namespace uplink::journal
