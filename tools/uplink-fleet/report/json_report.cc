#include "tools/uplink-fleet/report/json_report.h"

#include <cstdint>
#include <map>
#include <optional>
#include <utility>

#include <boost/json.hpp>

#include "tools/uplink-fleet/twin/canonical.h"

namespace uplink::synthetic {
namespace {

namespace js = boost::json;

js::object LatencyOf(const Histogram& histogram) {
  js::object latency{{"count", histogram.count()}, {"max", MillisOf(histogram.max())}};
  for (const auto& [label, share] : kQuantiles) {
    latency[label] = MillisOf(histogram.Quantile(share));
  }
  return latency;
}

js::object UseOf(const ProcessUse& use) {
  return {{"cpuSeconds", use.cpu_seconds}, {"rssBytes", use.rss_bytes}};
}

/// One object of counts by name.
js::object ByName(const std::map<std::string, std::uint64_t>& counts) {
  js::object object;
  for (const auto& [name, count] : counts) object[name] = count;
  return object;
}

js::array ChecksOf(const std::vector<CheckRow>& rows) {
  js::array checks;
  for (const CheckRow& row : rows) {
    checks.push_back({{"what", row.what},
                      {"fleet", row.fleet},
                      {"server", row.server},
                      {"store", row.store},
                      {"ok", row.ok},
                      {"note", row.note}});
  }
  return checks;
}

js::array DifferencesOf(const Findings& findings) {
  js::array differences;
  for (const Difference& each : findings.differences()) {
    differences.push_back({{"ruri", each.ruri},
                           {"what", JsonText(TextOf(each.thing).name)},
                           {"expected", each.expected},
                           {"found", each.found}});
  }
  return differences;
}

std::string ReportOf(js::object run, const std::optional<ProcessUse>& server,
                     const std::vector<CheckRow>& rows, const Findings& findings) {
  if (server) run["server"] = UseOf(*server);
  return CanonicalText(js::object{{"ok", AllOk(rows)},
                                  {"run", std::move(run)},
                                  {"checks", ChecksOf(rows)},
                                  {"differences", DifferencesOf(findings)}}) +
         "\n";
}

}  // namespace

std::string JsonReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  return ReportOf({{"id", figures.run},
                   {"robots", figures.robots},
                   {"seed", figures.seed},
                   {"seconds", figures.seconds},
                   {"sent", figures.sent},
                   {"resent", figures.resent},
                   {"judged", figures.judged},
                   {"ackedLive", figures.latencies.live.count()},
                   {"ackedDurable", figures.acked_durable},
                   {"rejects", figures.rejects},
                   {"notices", figures.notices},
                   {"receivers", figures.receivers},
                   {"forwardedChanges", figures.forwarded_changes},
                   {"forwardedSnapshots", figures.forwarded_snapshots},
                   {"welcomes", figures.welcomes},
                   {"breaks", figures.breaks},
                   {"takeovers", figures.takeovers},
                   {"connects", figures.connects},
                   {"skippedTicks", figures.skipped_ticks},
                   {"onlyMoving", figures.only_moving},
                   {"sentWhileMeasured", figures.sent_while_measured},
                   {"drains", figures.drains},
                   {"latencyMs",
                    {{"durable", LatencyOf(figures.latencies.durable)},
                     {"live", LatencyOf(figures.latencies.live)},
                     {"liveGaveWay", LatencyOf(figures.latencies.gave_way)},
                     {"snapshot", LatencyOf(figures.latencies.snapshot)},
                     {"lateSnapshot", LatencyOf(figures.latencies.late_snapshot)}}},
                   {"fleet", UseOf(figures.own)},
                   {"serverRestarted", figures.restarted},
                   {"firstError", figures.first_error},
                   {"rejectsByReason", ByName(figures.rejects_by_reason)},
                   {"ends", ByName(figures.ends)}},
                  figures.server, rows, findings);
}

std::string JsonReport(const TwinFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  const TwinTotals& totals = figures.totals;
  return ReportOf({{"id", figures.run},
                   {"seconds", figures.seconds},
                   {"serverRestarted", figures.restarted},
                   {"firstError", figures.first_error},
                   {"twins", totals.twins},
                   {"seed", figures.seed},
                   {"published", totals.published},
                   {"publishedQos1", totals.published_qos1},
                   {"acked", totals.acked},
                   {"refused", totals.refused},
                   {"connections", figures.connections},
                   {"breaks", figures.breaks},
                   {"skipped", figures.skipped},
                   {"pings", totals.pings},
                   {"pongs", totals.pongs},
                   {"pongMs", LatencyOf(figures.pong)},
                   {"fleet", UseOf(figures.own)}},
                  figures.server, rows, findings);
}

std::string JsonReport(const DroneFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  return ReportOf({{"id", figures.run},
                   {"seconds", figures.seconds},
                   {"serverRestarted", figures.restarted},
                   {"firstError", figures.first_error},
                   {"drones", figures.totals.drones},
                   {"seed", figures.seed},
                   {"sent", figures.totals.sent},
                   {"resent", figures.again},
                   {"answered", figures.totals.answered},
                   {"answersLost", figures.lost},
                   {"linksCut", figures.cut},
                   {"latencyMs",
                    {{"durable", LatencyOf(figures.latencies.durable)},
                     {"live", LatencyOf(figures.latencies.live)}}},
                   {"fleet", UseOf(figures.own)}},
                  figures.server, rows, findings);
}

}  // namespace uplink::synthetic
