#include "metrics/catalogue.h"

#include <array>

namespace uplink::metrics {
namespace {

using enum MetricId;
using enum MetricType;

constexpr std::array<std::string_view, 1> kByOutcome{"outcome"};
constexpr std::array<std::string_view, 1> kByReason{"reason"};
constexpr std::array<std::string_view, 2> kByVariantReason{"variant", "reason"};
constexpr std::array<std::string_view, 1> kByKind{"kind"};
constexpr std::array<std::string_view, 2> kByKindReason{"kind", "reason"};
constexpr std::array<std::string_view, 1> kByCode{"code"};
constexpr std::array<std::string_view, 1> kByPresence{"presence"};
constexpr std::array<std::string_view, 2> kByRouteCode{"route", "code"};
constexpr std::array<std::string_view, 1> kByCause{"cause"};
constexpr std::array<std::string_view, 1> kByShard{"shard"};
constexpr std::array<std::string_view, 1> kByVersion{"version"};
constexpr std::array<std::string_view, 1> kByWhy{"why"};

constexpr auto kSpecs = std::to_array<MetricSpec>({
    {kUplinksReceived, "uplinkd_uplinks_received_total", kCounter, "messages",
     "Messages that were judged, each once."},
    {kUplinksSettled, "uplinkd_uplinks_settled_total", kCounter, "messages",
     "Messages that are settled, by what became of them.", kByOutcome},
    {kUplinksInFlight, "uplinkd_uplinks_in_flight", kGauge, "messages",
     "Messages that wait for their commit, as the ack windows count them."},
    {kRejects, "uplinkd_rejects_total", kCounter, "messages", "Settled rejections by reason.",
     kByReason},
    {kRejectsJudged, "uplinkd_rejects_judged_total", kCounter, "messages",
     "Messages that judgement rejected, by kind and reason; unknown: not read so far.",
     kByKindReason},
    {kFieldsDropped, "uplinkd_fields_dropped_total", kCounter, "fields",
     "Fields of live messages that were at fault and dropped.", kByVariantReason},
    {kUplinksMissing, "uplinkd_uplinks_missing_total", kCounter, "messages",
     "Numbers that agents skipped, of one jump 1048576 at most; after a restart of the server an "
     "upper bound."},
    {kRecords, "uplinkd_records_total", kCounter, "messages", "Good messages by kind.", kByKind},
    {kRcanStatesMissing, "uplinkd_rcan_states_missing_total", kCounter, "messages",
     "Numbers of seq that RCAN Robot States skipped."},
    {kTimesUnknown, "uplinkd_times_unknown_total", kCounter, "fields",
     "Times of robots that were taken as unknown."},
    {kEnumerantsUnrecognized, "uplinkd_enumerants_unrecognized_total", kCounter, "fields",
     "Enumerants that this version does not know, kept as their number."},
    {kControlCharacters, "uplinkd_control_characters_total", kCounter, "characters",
     "Control characters in texts of good messages, kept as U+FFFD."},
    {kRobots, "uplinkd_robots", kGauge, "robots",
     "Robots that this server holds, or that have a stream here, by presence.", kByPresence},
    {kRobotsElsewhere, "uplinkd_robots_elsewhere", kGauge, "robots",
     "Known robots that another server holds, by presence as that one wrote it.", kByPresence},
    {kRobotsLimit, "uplinkd_robots_limit", kGauge, "robots",
     "Robots that are admitted at most (limits.robots_max)."},
    {kRobotsLeaving, "uplinkd_robots_leaving", kGauge, "robots",
     "Robots on their way out of memory, 1024 at most; one leaves once nothing of it waits."},
    {kRobotsForgotten, "uplinkd_robots_forgotten_total", kCounter, "robots",
     "Robots that left memory: silent for fleet.forget_after, for others at limits.robots_max, "
     "or removed from the store, which each server counts that had the robot."},
    {kPresenceChanges, "uplinkd_presence_changes_total", kCounter, "changes",
     "Changes of presence that were stored, by what they led to.", kByPresence},
    {kPresenceRefused, "uplinkd_presence_refused_total", kCounter, "changes",
     "Changes of presence that the store refused: the server did not hold the robot."},
    {kRobotsAdopted, "uplinkd_robots_adopted_total", kCounter, "robots",
     "Robots that were adopted, since the server that held them was over."},
    {kLeaseRenewals, "uplinkd_lease_renewals_total", kCounter, "renewals",
     "Renewals of this server's lease in the store."},
    {kLeaseFailing, "uplinkd_lease_failing", kGauge, "0 or 1",
     "1 while the lease cannot be renewed, or those of others cannot be read."},
    {kLeaseOthers, "uplinkd_lease_others", kGauge, "servers",
     "Other servers on the same store whose leases stand."},
    {kLeaseOthersLate, "uplinkd_lease_others_late", kGauge, "servers",
     "Other servers that may be cut off from the store: meanwhile a robot without a stream here is "
     "unknown instead of offline."},
    {kStreams, "uplinkd_streams", kGauge, "streams", "Open streams."},
    {kStreamsOpened, "uplinkd_streams_opened_total", kCounter, "streams",
     "Streams that were opened."},
    {kStreamsHeldBack, "uplinkd_streams_held_back", kGauge, "streams",
     "Streams that are not read now."},
    {kHoldBacks, "uplinkd_stream_hold_backs_total", kCounter, "times",
     "Times that a stream was held back."},
    {kHeldBackBy, "uplinkd_held_back", kGauge, "streams",
     "Streams that are held back, by what holds them back.", kByReason},
    {kHeldBackByTotal, "uplinkd_held_back_total", kCounter, "times",
     "Times that something began to hold a stream back.", kByReason},
    {kStreamsWaiting, "uplinkd_streams_waiting", kGauge, "streams",
     "Streams that wait for their turn now: streams of their robot come too often."},
    {kStreamDelays, "uplinkd_stream_delays_total", kCounter, "streams",
     "Streams that had to wait, since streams of their robot come too often."},
    {kTakeovers, "uplinkd_takeovers_total", kCounter, "streams",
     "Streams that took over from an older one of the same robot."},
    {kContested, "uplinkd_robots_contested_total", kCounter, "times",
     "Takeovers over ten a minute of one robot: two agents share an identity."},
    {kSuperseded, "uplinkd_streams_superseded_total", kCounter, "streams",
     "Streams that ended because a newer one has the robot."},
    {kStreamsEnded, "uplinkd_streams_ended_total", kCounter, "streams",
     "Streams that ended, by gRPC's code; broken: without one.", kByCode},
    {kProtocolErrors, "uplinkd_protocol_errors_total", kCounter, "streams",
     "Streams that ended for an error of the agent."},
    {kPeerStalls, "uplinkd_peer_stalls_total", kCounter, "streams",
     "Streams that ended because the peer took nothing."},
    {kRejectsUnconfirmed, "uplinkd_rejects_unconfirmed_ends_total", kCounter, "streams",
     "Streams that ended because 10,000 Rejects of the session were not confirmed."},
    {kResumes, "uplinkd_resumes_total", kCounter, "streams",
     "Streams that went on with a session that was known."},
    {kFrames, "uplinkd_frames_received_total", kCounter, "frames",
     "Frames that streams delivered."},
    {kFrameBytes, "uplinkd_frame_bytes_received_total", kCounter, "bytes",
     "Bytes of the frames that streams delivered."},
    {kAcks, "uplinkd_acks_sent_total", kCounter, "frames", "Acks that were sent."},
    {kNotices, "uplinkd_notices_sent_total", kCounter, "frames", "Notices that were sent."},
    {kStreamsRefused, "uplinkd_streams_refused_total", kCounter, "streams",
     "Calls that ended before they became a stream.", kByCause},
    {kHandshakesFailed, "uplinkd_handshakes_failed_total", kCounter, "connections",
     "TLS handshakes of the relay that failed: no or a wrong certificate, another protocol."},
    {kFinishTimeouts, "uplinkd_finish_timeouts_total", kCounter, "streams",
     "Streams that were cancelled because the peer did not take their end."},
    {kWakes, "uplinkd_relay_wakes_total", kCounter, "wakes",
     "Wakes of streams that the relay's threads answered."},
    {kAckSeconds, "uplinkd_ack_seconds", kHistogram, "seconds",
     "Arrival of a durable message to the Ack that covers it."},
    {kJournalRecords, "uplinkd_journal_records", kGauge, "records",
     "Records that wait for a commit."},
    {kJournalRecordsLimit, "uplinkd_journal_records_limit", kGauge, "records",
     "Records at which streams are held back (journal.records_max)."},
    {kJournalBytes, "uplinkd_journal_bytes", kGauge, "bytes",
     "Bytes of the records that wait for a commit."},
    {kJournalBytesLimit, "uplinkd_journal_bytes_limit", kGauge, "bytes",
     "Bytes at which streams are held back (journal.bytes_max)."},
    {kJournalOldestSeconds, "uplinkd_journal_oldest_seconds", kGauge, "seconds",
     "Age of the oldest record that waits; 0 if none does."},
    {kJournalShardRecords, "uplinkd_journal_shard_records", kGauge, "records",
     "Records that wait for a commit, by the shard that writes them (store.shards).", kByShard},
    {kJournalShardRecordsLimit, "uplinkd_journal_shard_records_limit", kGauge, "records",
     "Records of one shard at which the streams of its robots are held back."},
    {kJournalShardBytes, "uplinkd_journal_shard_bytes", kGauge, "bytes",
     "Bytes of the records that wait for a commit, by shard.", kByShard},
    {kJournalShardBytesLimit, "uplinkd_journal_shard_bytes_limit", kGauge, "bytes",
     "Bytes of one shard at which the streams of its robots are held back."},
    {kJournalShardOldestSeconds, "uplinkd_journal_shard_oldest_seconds", kGauge, "seconds",
     "Age of the oldest record that waits, by shard; 0 if none does.", kByShard},
    {kStoreCommitSeconds, "uplinkd_store_commit_seconds", kHistogram, "seconds",
     "Duration of a commit."},
    {kStoreCommitRecords, "uplinkd_store_commit_records", kHistogram, "records",
     "Records of a commit."},
    {kExpiredDeleted, "uplinkd_expired_deleted_total", kCounter, "rows",
     "Expired shapes and objects that the sweep deleted."},
    {kMissionRunsClosed, "uplinkd_mission_runs_closed_total", kCounter, "runs",
     "Open mission runs that the server closed: bound: the robot had 1,000 newer ones open; age: "
     "not reported for 30 days.",
     kByWhy},
    {kQuarantineDropped, "uplinkd_quarantine_dropped_total", kCounter, "rows",
     "Rows of quarantine that went for the bound of their robot, by reason.", kByReason},
    {kHistoryDeleted, "uplinkd_history_deleted_total", kCounter, "rows",
     "Rows, and whole partitions of days, that were deleted for their age."},
    {kRetentionFailing, "uplinkd_retention_failing", kGauge, "0 or 1",
     "1 while histories cannot be kept to their age; commits go on."},
    {kSweepSeconds, "uplinkd_sweep_seconds", kHistogram, "seconds",
     "Duration of the look at every robot's presence, once a second."},
    {kCheckpointSeconds, "uplinkd_checkpoint_seconds", kHistogram, "seconds",
     "Duration of a round of checkpoints; commits go on between its calls."},
    {kCheckpointRobots, "uplinkd_checkpoint_robots_total", kCounter, "robots",
     "Robots whose live state was written, once a checkpoint (store.checkpoint)."},
    {kCheckpointFailing, "uplinkd_checkpoint_failing", kGauge, "0 or 1",
     "1 while live states cannot be written though commits go on."},
    {kStoreErrors, "uplinkd_store_errors_total", kCounter, "errors",
     "Calls of the store that failed and are tried again."},
    {kStoreFailing, "uplinkd_store_failing", kGauge, "0 or 1",
     "1 while the last call of at least one shard of the store failed."},
    {kStoreUnsafe, "uplinkd_store_unsafe", kGauge, "0 or 1",
     "1 if the store may lose what is acked when the power fails (store.accept_unsafe)."},
    {kStoreClockOffset, "uplinkd_store_clock_offset_seconds", kGauge, "seconds",
     "The store's clock less the server's, as of the start."},
    {kStoreCommitsInDoubt, "uplinkd_store_commits_in_doubt_total", kCounter, "commits",
     "Commits that the database answered with a warning: whether they are durable is unknown, and"
     " they are tried again."},
    {kStoreOldestSnapshot, "uplinkd_store_oldest_snapshot_seconds", kGauge, "seconds",
     "How long another transaction, a replication slot or a prepared transaction has kept the "
     "database"
     " from removing dead rows, as far as this process saw."},
    {kStoreFreeBytes, "uplinkd_store_free_bytes", kGauge, "bytes",
     "What the store may still write: free on its disk, with SQLite in its file too. Not there "
     "where it cannot be known."},
    {kStoreFreeMinBytes, "uplinkd_store_free_min_bytes", kGauge, "bytes",
     "What is to be free (store.free_min); below that some robots are slowed down, below half of "
     "that nothing is stored."},
    {kStoreDiskBytes, "uplinkd_store_disk_bytes", kGauge, "bytes", "The size of the store's disk."},
    {kStoreStopped, "uplinkd_store_stopped", kGauge, "0 or 1",
     "1 while nothing is stored, since the store's disk is nearly full."},
    {kStoreRobotsLimited, "uplinkd_store_robots_limited", kGauge, "robots",
     "Robots that are slowed down to the median's rate, since the store's disk is nearly full and "
     "they store far more than others."},
    {kClockVouched, "uplinkd_clock_vouched", kGauge, "0 or 1",
     "1 while the civil clock is vouched for; 0: nothing is deleted until it is."},
    {kClockAhead, "uplinkd_clock_ahead_seconds", kGauge, "seconds",
     "By how much civil time ran ahead of the monotonic clock since the start."},
    {kHttpRequests, "uplinkd_http_requests_total", kCounter, "requests",
     "HTTP requests that were answered.", kByRouteCode},
    {kHttpRequestSeconds, "uplinkd_http_request_seconds", kHistogram, "seconds",
     "Duration from a whole request to its answer, the wait for a read included."},
    {kHttpConnections, "uplinkd_http_connections", kGauge, "connections", "Open HTTP connections."},
    {kHttpConnectionsLimit, "uplinkd_http_connections_limit", kGauge, "connections",
     "HTTP connections that are held at most (http.connections_max)."},
    {kHttpConnectionsRefused, "uplinkd_http_connections_refused_total", kCounter, "connections",
     "HTTP connections that were closed at accept because the limit was reached."},
    {kHttpConnectionsGivenUp, "uplinkd_http_connections_given_up_total", kCounter, "connections",
     "HTTP connections without a request under way that were closed, because further ones came."},
    {kHttpReadsWaiting, "uplinkd_http_reads_waiting", kGauge, "requests",
     "API requests that wait for the thread that reads."},
    {kHttpReadsWaitingLimit, "uplinkd_http_reads_waiting_limit", kGauge, "requests",
     "API requests that wait at most; further ones get 503."},
    {kHttpReadsRefused, "uplinkd_http_reads_refused_total", kCounter, "requests",
     "API requests that got 503 because too many waited."},
    {kRcanSeries, "uplinkd_rcan_series", kGauge, "series",
     "Series of the last scrape of /metrics/robots."},
    {kRcanSeriesLimit, "uplinkd_rcan_series_limit", kGauge, "series",
     "Series that such a scrape holds at most (rcan.series_max)."},
    {kRcanRobotsLeftOut, "uplinkd_rcan_robots_left_out", kGauge, "robots",
     "Robots that the last scrape of /metrics/robots had no room for."},
    {kRcanRobotsIncomplete, "uplinkd_rcan_robots_incomplete", kGauge, "robots",
     "Robots of which the last scrape of /metrics/robots left out some series, not all."},
    {kRcanSeriesLeftOut, "uplinkd_rcan_series_left_out_total", kCounter, "series",
     "Series that scrapes left out of a robot that they show, at each scrape again, by the bound "
     "of "
     "the configuration.",
     kByCause},
    {kRcanScrapeSeconds, "uplinkd_rcan_scrape_seconds", kHistogram, "seconds",
     "Time to write a scrape of /metrics/robots."},
    {kRcanScrapeBytes, "uplinkd_rcan_scrape_bytes", kGauge, "bytes",
     "Size of the last scrape of /metrics/robots, uncompressed."},
    {kRcanScrapesRefused, "uplinkd_rcan_scrapes_refused_total", kCounter, "requests",
     "Scrapes of /metrics/robots that got 503 because too many were still being read."},
    {kRelayLastHandshakeSeconds, "uplinkd_relay_last_handshake_seconds", kGauge, "seconds",
     "Age of the last sign that the relay listener answers; /livez fails above 60."},
    {kRelayBehind, "uplinkd_relay_behind", kGauge, "0 or 1",
     "1 from a handshake with the relay that takes more than 3 s, or from a standstill of the "
     "process, until one that began afterwards takes 1 s at most: nobody goes offline meanwhile."},
    {kStandstills, "uplinkd_standstills_total", kCounter, "standstills",
     "Times the process stood still: more than 3 s lay between two of its looks at presence."},
    {kCertificateExpiry, "uplinkd_certificate_expiry_timestamp_seconds", kGauge, "seconds",
     "Unix time at which the server's certificate expires."},
    {kDraining, "uplinkd_draining", kGauge, "0 or 1", "1 once the server drains."},
    {kDegraded, "uplinkd_degraded", kGauge, "0 or 1",
     "1 while /readyz has the word in degraded; each word that there is has its series.",
     kByReason},
    {kBuildInfo, "uplinkd_build_info", kGauge, "1", "Version of the server.", kByVersion},
    {kProcessStartTime, "process_start_time_seconds", kGauge, "seconds",
     "Unix time at which the server started."},
    {kProcessCpuSeconds, "process_cpu_seconds_total", kCounter, "seconds",
     "User and system time of the process."},
    {kProcessResidentBytes, "process_resident_memory_bytes", kGauge, "bytes",
     "Memory of the process that is resident."},
    {kProcessVirtualBytes, "process_virtual_memory_bytes", kGauge, "bytes",
     "Addresses that the process has in use."},
    {kProcessVirtualMaxBytes, "process_virtual_memory_max_bytes", kGauge, "bytes",
     "Addresses that it may use; -1 if there is no limit."},
    {kProcessThreads, "process_threads", kGauge, "threads", "Threads of the process."},
    {kProcessOpenFds, "process_open_fds", kGauge, "descriptors", "Open file descriptors."},
    {kProcessMaxFds, "process_max_fds", kGauge, "descriptors",
     "File descriptors that the process may open."},
});
static_assert(kSpecs.size() == kMetrics, "each MetricId has one entry");

constexpr bool InOrder() {
  for (std::size_t i = 0; i < kSpecs.size(); ++i) {
    if (static_cast<std::size_t>(kSpecs[i].id) != i) return false;
  }
  return true;
}
static_assert(InOrder(), "the table stands in the order of MetricId");

}  // namespace

std::span<const MetricSpec> Catalogue() { return kSpecs; }

const MetricSpec& SpecOf(MetricId id) { return kSpecs[static_cast<std::size_t>(id)]; }

}  // namespace uplink::metrics
