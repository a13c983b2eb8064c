#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>

namespace uplink::metrics {

enum class MetricType : std::uint8_t { kCounter, kGauge, kHistogram };

/// `counter`, `gauge` or `histogram`.
[[nodiscard]] std::string_view ToText(MetricType type);

/// Our own metrics, in the order of the reference page. A metric exists by its entry here and in
/// the table of catalogue.cc; nothing else names one.
enum class MetricId : std::uint8_t {
  kUplinksReceived,
  kUplinksSettled,
  kUplinksInFlight,
  kRejects,
  kRejectsJudged,
  kFieldsDropped,
  kUplinksMissing,
  kRecords,
  kRcanStatesMissing,
  kTimesUnknown,
  kEnumerantsUnrecognized,
  kControlCharacters,
  kRobots,
  kRobotsElsewhere,
  kRobotsLimit,
  kRobotsLeaving,
  kRobotsForgotten,
  kPresenceChanges,
  kPresenceRefused,
  kRobotsAdopted,
  kLeaseRenewals,
  kLeaseFailing,
  kLeaseOthers,
  kLeaseOthersLate,
  kStreams,
  kStreamsOpened,
  kStreamsHeldBack,
  kHoldBacks,
  kHeldBackBy,
  kHeldBackByTotal,
  kStreamsWaiting,
  kStreamDelays,
  kTakeovers,
  kContested,
  kSuperseded,
  kStreamsEnded,
  kProtocolErrors,
  kPeerStalls,
  kRejectsUnconfirmed,
  kRejectPages,
  kRejectReadsFailed,
  kResumes,
  kResendRequests,
  kResendUnanswered,
  kFrames,
  kFrameBytes,
  kAcks,
  kNotices,
  kForwardsDue,
  kForwardsSettled,
  kForwardsWaiting,
  kForwardSnapshots,
  kForwardSnapshotItems,
  kForwardSnapshotsOpen,
  kForwardOverflows,
  kForwardReceivers,
  kForwardItems,
  kForwardBytes,
  kForwardBytesLimit,
  kForwardLeftOut,
  kForwardUnreadable,
  kForwardUnreadableNow,
  kForwardPaced,
  kForwardChanges,
  kForwardReadsOfAll,
  kForwardFailing,
  kForwardLookAge,
  kForwardHeard,
  kForwardDeaf,
  kStreamsRefused,
  kGatewayStreams,
  kHandshakesFailed,
  kConnectionsTurnedAway,
  kConnections,
  kConnectionsLimit,
  kHandshakesUnderWay,
  kHandshakesWaiting,
  kProxyHeadersWaiting,
  kUnfinishedBytes,
  kUnfinishedEnds,
  kAcceptPauses,
  kFinishTimeouts,
  kWakes,
  kAckSeconds,
  kJournalRecords,
  kJournalRecordsLimit,
  kJournalBytes,
  kJournalBytesLimit,
  kJournalOldestSeconds,
  kJournalShardRecords,
  kJournalShardRecordsLimit,
  kJournalShardBytes,
  kJournalShardBytesLimit,
  kJournalShardOldestSeconds,
  kStoreCommitSeconds,
  kStoreCommitRecords,
  kExpiredDeleted,
  kMissionRunsClosed,
  kQuarantineDropped,
  kHistoryDeleted,
  kRetentionFailing,
  kSweepSeconds,
  kCheckpointSeconds,
  kCheckpointRobots,
  kCheckpointFailing,
  kStoreErrors,
  kStoreFailing,
  kStoreUnsafe,
  kStoreClockOffset,
  kStoreCommitsInDoubt,
  kStoreOldestSnapshot,
  kStoreFreeBytes,
  kStoreFreeMinBytes,
  kStoreDiskBytes,
  kStoreStopped,
  kStoreRobotsLimited,
  kClockVouched,
  kClockAhead,
  kHttpRequests,
  kHttpRequestSeconds,
  kHttpConnections,
  kHttpConnectionsLimit,
  kHttpConnectionsRefused,
  kHttpConnectionsGivenUp,
  kHttpReadsWaiting,
  kHttpReadsWaitingLimit,
  kHttpReadsRefused,
  kRcanSeries,
  kRcanSeriesLimit,
  kRcanRobotsLeftOut,
  kRcanRobotsIncomplete,
  kRcanSeriesLeftOut,
  kRcanScrapeSeconds,
  kRcanScrapeBytes,
  kRcanScrapesRefused,
  kRelayLastHandshakeSeconds,
  kRelayBehind,
  kStandstills,
  kCertificateExpiry,
  kDraining,
  kDegraded,
  kBuildInfo,
  kProcessStartTime,
  kProcessCpuSeconds,
  kProcessResidentBytes,
  kProcessVirtualBytes,
  kProcessVirtualMaxBytes,
  kProcessThreads,
  kProcessOpenFds,
  kProcessMaxFds,
};
inline constexpr std::size_t kMetrics = static_cast<std::size_t>(MetricId::kProcessMaxFds) + 1;

/// What is declared of one metric. Immutable.
struct MetricSpec {
  MetricId id;
  std::string_view name;
  MetricType type;
  /// `seconds`, `bytes`, or what is counted.
  std::string_view unit;
  /// One sentence for an operator.
  std::string_view help;
  /// Names of the labels, in the order in which their values are given.
  std::span<const std::string_view> labels{};
  /// The first version that has it.
  std::string_view since = "0.1.0";
};

/// All metrics, by MetricId.
[[nodiscard]] std::span<const MetricSpec> Catalogue();
[[nodiscard]] const MetricSpec& SpecOf(MetricId id);

/// The catalogue as a Markdown table: `uplinkd --print-metrics`, docs/reference/metrics.md.
[[nodiscard]] std::string CatalogueTable();

}  // namespace uplink::metrics
