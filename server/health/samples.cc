#include "server/health/samples.h"

#include <algorithm>
#include <string>
#include <vector>

#include "server/health/process.h"

namespace uplink::health {
namespace {

using enum metrics::MetricId;

double UnixSeconds(SystemTime time) { return static_cast<double>(UnixMs(time)) / 1e3; }

}  // namespace

void AddSamples(Monitor& monitor, metrics::Exposition& page) {
  page.Add(kRelayLastHandshakeSeconds, monitor.liveness().age());
  page.Add(kRelayBehind, monitor.liveness().behind() ? 1 : 0);
  page.Add(kStandstills, monitor.liveness().standstills());
  page.Add(kCertificateExpiry, UnixSeconds(monitor.certificate_expiry()));
  const auto http = monitor.http_certificate_expiry();
  page.Add(kHttpCertificateExpiry, http ? UnixSeconds(*http) : 0);
  page.Add(kDraining, monitor.draining() ? 1 : 0);
  const std::vector<std::string> degraded = monitor.readiness().degraded;
  for (const DegradedWord& each : DegradedWords()) {
    page.Add(kDegraded, std::ranges::count(degraded, each.word), {each.word});
  }
}

void AddSweepSamples(const metrics::LatencyDistribution& sweep_seconds, metrics::Exposition& page) {
  page.Add(kSweepSeconds, sweep_seconds);
}

void AddProcessSamples(const ProcessStart& start, metrics::Exposition& page) {
  page.Add(kBuildInfo, 1, {start.version});
  page.Add(kProcessStartTime, UnixSeconds(start.at));
  const ProcessFigures process = ReadProcess();
  page.Add(kProcessCpuSeconds, process.cpu_seconds);
  page.Add(kProcessResidentBytes, process.resident_bytes);
  page.Add(kProcessVirtualBytes, process.virtual_bytes);
  page.Add(kProcessVirtualMaxBytes,
           process.virtual_max_bytes ? static_cast<double>(*process.virtual_max_bytes) : -1.0);
  page.Add(kProcessThreads, process.threads);
  page.Add(kProcessOpenFds, OpenDescriptors());
  page.Add(kProcessMaxFds, DescriptorsMax());
}

}  // namespace uplink::health
