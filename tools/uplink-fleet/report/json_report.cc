#include "tools/uplink-fleet/report/json_report.h"

#include <cstdint>
#include <map>
#include <utility>

#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

#include "tools/uplink-fleet/report/quantiles.h"

namespace uplink::synthetic {
namespace {

using google::protobuf::Struct;

void Put(Struct& object, const std::string& name, const std::string& text) {
  (*object.mutable_fields())[name].set_string_value(text);
}

void Put(Struct& object, const std::string& name, double number) {
  (*object.mutable_fields())[name].set_number_value(number);
}

void PutCount(Struct& object, const std::string& name, std::uint64_t count) {
  Put(object, name, static_cast<double>(count));
}

void PutBool(Struct& object, const std::string& name, bool value) {
  (*object.mutable_fields())[name].set_bool_value(value);
}

void PutLatency(Struct& object, const std::string& name, const Histogram& histogram) {
  Struct& latency = *(*object.mutable_fields())[name].mutable_struct_value();
  PutCount(latency, "count", histogram.count());
  for (const auto& [label, share] : kQuantiles) {
    Put(latency, label, MillisOf(histogram.Quantile(share)));
  }
  Put(latency, "max", MillisOf(histogram.max()));
}

void PutUse(Struct& object, const std::string& name, const ProcessUse& use) {
  Struct& to = *(*object.mutable_fields())[name].mutable_struct_value();
  Put(to, "cpuSeconds", use.cpu_seconds);
  PutCount(to, "rssBytes", use.rss_bytes);
}

/// The figures that are plain values.
void PutCounts(Struct& run, const RunFigures& figures) {
  Put(run, "id", figures.run);
  PutCount(run, "robots", figures.robots);
  PutCount(run, "seed", figures.seed);
  Put(run, "seconds", figures.seconds);
  PutCount(run, "sent", figures.sent);
  PutCount(run, "resent", figures.resent);
  PutCount(run, "judged", figures.judged);
  PutCount(run, "ackedLive", figures.latencies.live.count());
  PutCount(run, "ackedDurable", figures.acked_durable);
  PutCount(run, "rejects", figures.rejects);
  PutCount(run, "notices", figures.notices);
  PutCount(run, "receivers", figures.receivers);
  PutCount(run, "forwardedChanges", figures.forwarded_changes);
  PutCount(run, "forwardedSnapshots", figures.forwarded_snapshots);
  PutCount(run, "welcomes", figures.welcomes);
  PutCount(run, "breaks", figures.breaks);
  PutCount(run, "takeovers", figures.takeovers);
  PutCount(run, "connects", figures.connects);
  PutCount(run, "skippedTicks", figures.skipped_ticks);
  PutCount(run, "onlyMoving", figures.only_moving);
  PutCount(run, "sentWhileMeasured", figures.sent_while_measured);
  PutCount(run, "drains", figures.drains);
}

/// One object of counts by name.
void PutByName(Struct& object, const std::string& name,
               const std::map<std::string, std::uint64_t>& counts) {
  Struct& to = *(*object.mutable_fields())[name].mutable_struct_value();
  for (const auto& [each, count] : counts) PutCount(to, each, count);
}

void PutRun(Struct& run, const RunFigures& figures) {
  PutCounts(run, figures);
  Struct& latency = *(*run.mutable_fields())["latencyMs"].mutable_struct_value();
  PutLatency(latency, "durable", figures.latencies.durable);
  PutLatency(latency, "live", figures.latencies.live);
  PutLatency(latency, "liveGaveWay", figures.latencies.gave_way);
  PutLatency(latency, "snapshot", figures.latencies.snapshot);
  PutLatency(latency, "lateSnapshot", figures.latencies.late_snapshot);
  if (figures.server) PutUse(run, "server", *figures.server);
  PutUse(run, "fleet", figures.own);
  PutBool(run, "serverRestarted", figures.restarted);
  Put(run, "firstError", figures.first_error);
  PutByName(run, "rejectsByReason", figures.rejects_by_reason);
  PutByName(run, "ends", figures.ends);
}

void PutChecks(Struct& root, const std::vector<CheckRow>& rows) {
  auto& checks = *(*root.mutable_fields())["checks"].mutable_list_value();
  for (const CheckRow& row : rows) {
    Struct& check = *checks.add_values()->mutable_struct_value();
    Put(check, "what", row.what);
    Put(check, "fleet", row.fleet);
    Put(check, "server", row.server);
    Put(check, "store", row.store);
    PutBool(check, "ok", row.ok);
    Put(check, "note", row.note);
  }
}

void PutDifferences(Struct& root, const Findings& findings) {
  auto& differences = *(*root.mutable_fields())["differences"].mutable_list_value();
  for (const Difference& each : findings.differences()) {
    Struct& difference = *differences.add_values()->mutable_struct_value();
    Put(difference, "ruri", each.ruri);
    Put(difference, "what", std::string(TextOf(each.thing).name));
    Put(difference, "expected", each.expected);
    Put(difference, "found", each.found);
  }
}

}  // namespace

std::string JsonReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  Struct run;
  PutRun(run, figures);
  return JsonOf(std::move(run), rows, findings);
}

std::string JsonOf(Struct run, const std::vector<CheckRow>& rows, const Findings& findings) {
  Struct root;
  PutBool(root, "ok", AllOk(rows));
  *(*root.mutable_fields())["run"].mutable_struct_value() = std::move(run);
  PutChecks(root, rows);
  PutDifferences(root, findings);
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(root, &json);
  return status.ok() ? json + "\n" : "{\"ok\":false}\n";
}

}  // namespace uplink::synthetic
