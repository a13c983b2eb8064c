#include "server/http/scrape.h"

#include <utility>

#include "server/health/process.h"
#include "server/http/read_thread.h"

namespace uplink::http {
namespace {

using enum metrics::MetricId;

template <typename Number>
double Value(Number number) {
  return static_cast<double>(number);
}

double Seconds(milliseconds duration) { return Value(duration.count()) / 1e3; }

}  // namespace

Scrape::Scrape(Sources sources)
    : sources_(std::move(sources)), started_at_(sources_.clock.System()) {}

std::string Scrape::Text(metrics::Format format) const {
  metrics::Exposition page;
  page.AddLedger(sources_.ledgers.Sum());
  AddSessions(page);
  AddFleet(page);
  AddJournal(page);
  AddHttp(page);
  AddRcan(page);
  AddProcess(page);
  sources_.add_relay(page);
  return page.Text(format);
}

void Scrape::AddSessions(metrics::Exposition& page) const {
  const session::SessionProbe& probe = sources_.sessions;
  page.Add(kStreams, probe.streams);
  page.Add(kStreamsOpened, probe.streams_total);
  page.Add(kStreamsHeldBack, probe.held_back);
  page.Add(kHoldBacks, probe.held_back_total);
  page.Add(kTakeovers, probe.takeovers_total);
  page.Add(kContested, probe.contested_total);
  page.Add(kSuperseded, probe.superseded_total);
  for (std::size_t end = 0; end < session::kStreamEnds.size(); ++end) {
    page.Add(kStreamsEnded, Value(probe.ended_total[end].value()), {session::kStreamEnds[end]});
  }
  page.Add(kProtocolErrors, probe.protocol_errors_total);
  page.Add(kPeerStalls, probe.peer_stalls_total);
  page.Add(kResumes, probe.resumes_total);
  page.Add(kFrames, probe.frames_total);
  page.Add(kFrameBytes, probe.frame_bytes_total);
  page.Add(kAcks, probe.acks_total);
  page.Add(kNotices, probe.notices_total);
  page.Add(kAckSeconds, probe.ack_seconds);
}

void Scrape::AddFleet(metrics::Exposition& page) const {
  const fleet::PresenceCounts counts = sources_.fleet.presence_counts();
  page.Add(kRobots, Value(counts.online), {"online"});
  page.Add(kRobots, Value(counts.offline), {"offline"});
  page.Add(kRobots, Value(counts.unknown), {"unknown"});
  page.Add(kSweepSeconds, sources_.sweep_seconds);
  page.Add(kRobotsLimit, Value(sources_.fleet.robots_max()));
}

void Scrape::AddJournal(metrics::Exposition& page) const {
  const journal::Shards& journals = sources_.journals;
  page.Add(kJournalRecords, Value(journals.records()));
  page.Add(kJournalRecordsLimit, Value(sources_.journal_limits.records_max));
  page.Add(kJournalBytes, Value(journals.bytes()));
  page.Add(kJournalBytesLimit, Value(sources_.journal_limits.bytes_max));
  page.Add(kJournalOldestSeconds, Seconds(journals.oldest(sources_.clock.Steady())));
  const journal::JournalProbe& probe = sources_.journal_probe;
  page.Add(kStoreCommitSeconds, probe.commit_seconds);
  page.Add(kStoreCommitRecords, probe.commit_records);
  for (const model::Presence presence :
       {model::Presence::kOnline, model::Presence::kOffline, model::Presence::kUnknown}) {
    page.Add(kPresenceChanges,
             Value(probe.presence_changes[static_cast<std::size_t>(presence)].value()),
             {ToText(presence)});
  }
  page.Add(kExpiredDeleted, probe.expired_deleted);
  page.Add(kHistoryDeleted, probe.history_deleted);
  page.Add(kRetentionFailing, probe.retention_failing);
  page.Add(kCheckpointSeconds, probe.checkpoint_seconds);
  page.Add(kCheckpointRobots, probe.checkpoint_robots);
  page.Add(kCheckpointFailing, probe.checkpoint_failing.value() > 0 ? 1 : 0);
  page.Add(kStoreErrors, probe.store_errors);
  page.Add(kStoreFailing, probe.store_failing.value() > 0 ? 1 : 0);
  page.Add(kStoreUnsafe, sources_.store_facts().unsafe ? 1 : 0);
  page.Add(kStoreClockOffset, Seconds(sources_.store_facts().clock_offset));
}

void Scrape::AddHttp(metrics::Exposition& page) const {
  const HttpProbe& probe = sources_.http;
  for (std::size_t route = 0; route < kRouteNames.size(); ++route) {
    for (std::size_t code = 0; code < kCodeClasses.size(); ++code) {
      page.Add(kHttpRequests, Value(probe.requests[route][code].value()),
               {kRouteNames[route], kCodeClasses[code]});
    }
  }
  page.Add(kHttpRequestSeconds, probe.request_seconds);
  page.Add(kHttpConnections, probe.connections);
  page.Add(kHttpConnectionsLimit, Value(sources_.http_connections_max));
  page.Add(kHttpConnectionsRefused, probe.connections_refused);
  page.Add(kHttpReadsWaiting, probe.reads_waiting);
  page.Add(kHttpReadsWaitingLimit, Value(kReadsWaitingMax));
  page.Add(kHttpReadsRefused, probe.reads_refused);
}

void Scrape::AddRcan(metrics::Exposition& page) const {
  const rcan::RcanProbe& probe = sources_.rcan;
  page.Add(kRcanSeries, probe.series);
  page.Add(kRcanSeriesLimit, Value(sources_.rcan_series_max));
  page.Add(kRcanRobotsLeftOut, probe.robots_left_out);
  page.Add(kRcanScrapeSeconds, probe.scrape_seconds);
  page.Add(kRcanScrapeBytes, probe.bytes);
  page.Add(kRcanScrapesRefused, probe.refused_total);
}

void Scrape::AddProcess(metrics::Exposition& page) const {
  health::Monitor& monitor = sources_.monitor;
  page.Add(kRelayLastHandshakeSeconds, Seconds(monitor.liveness().age()));
  page.Add(kRelayBehind, monitor.liveness().behind() ? 1 : 0);
  page.Add(kCertificateExpiry, Value(UnixMs(monitor.certificate_expiry())) / 1e3);
  page.Add(kDraining, monitor.draining() ? 1 : 0);
  page.Add(kBuildInfo, 1, {sources_.version});
  page.Add(kProcessStartTime, Value(UnixMs(started_at_)) / 1e3);
  const health::ProcessFigures process = health::ReadProcess();
  page.Add(kProcessCpuSeconds, process.cpu_seconds);
  page.Add(kProcessResidentBytes, Value(process.resident_bytes));
  page.Add(kProcessVirtualBytes, Value(process.virtual_bytes));
  page.Add(kProcessVirtualMaxBytes,
           process.virtual_max_bytes ? Value(*process.virtual_max_bytes) : -1);
  page.Add(kProcessThreads, Value(process.threads));
  page.Add(kProcessOpenFds, Value(health::OpenDescriptors()));
  page.Add(kProcessMaxFds, Value(health::DescriptorsMax()));
}

}  // namespace uplink::http
