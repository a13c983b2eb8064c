#include "tools/uplink-fleet/report/report.h"

#include <algorithm>
#include <array>
#include <utility>

#include <fmt/core.h>
#include <google/protobuf/struct.pb.h>
#include <google/protobuf/util/json_util.h>

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

constexpr std::array<std::pair<const char*, double>, 4> kQuantiles = {
    {{"p50", 0.5}, {"p90", 0.9}, {"p99", 0.99}, {"p99.9", 0.999}}};
constexpr double kMicrosAMilli = 1000;
constexpr double kMicrosASecond = 1e6;
constexpr double kBytesAMiB = 1024.0 * 1024.0;

double MillisOf(Histogram::Micros micros) {
  return static_cast<double>(micros.count()) / kMicrosAMilli;
}

std::string LatencyLine(const char* what, const Histogram& histogram) {
  if (histogram.count() == 0) return {};
  std::string text = fmt::format("{}:", what);
  for (const auto& [label, share] : kQuantiles) {
    text += fmt::format(" {} {:.2f} ms,", label, MillisOf(histogram.Quantile(share)));
  }
  return text + fmt::format(" max {:.2f} ms ({} messages)\n", MillisOf(histogram.max()),
                            histogram.count());
}

std::string UseLine(const char* name, const ProcessUse& use, const RunFigures& figures) {
  const double sent = static_cast<double>(std::max<std::uint64_t>(figures.sent_while_measured, 1));
  return fmt::format(
      "{}: {:.2f} s of CPU, {:.0f} % of a core, {:.1f} us per message; {:.0f} MiB\n", name,
      use.cpu_seconds, 100 * use.cpu_seconds / std::max(figures.seconds, 0.001),
      use.cpu_seconds * kMicrosASecond / sent, static_cast<double>(use.rss_bytes) / kBytesAMiB);
}

/// How it went, above the table.
std::string FiguresText(const RunFigures& figures) {
  std::string text = fmt::format(
      "\n{} robots, {:.0f} s, seed {}, run {}: {} messages sent ({} again), {} judged, "
      "{} live acked, {} durable acked, {} rejects, {} connections, {} welcomes, {} breaks, {} "
      "takeovers, {} drains{}\n",
      figures.robots, figures.seconds, figures.seed, figures.run, figures.sent, figures.resent,
      figures.judged, figures.latencies.live.count(), figures.acked_durable, figures.rejects,
      figures.connects, figures.welcomes, figures.breaks, figures.takeovers, figures.drains,
      figures.restarted ? ", server restarted: its counters are left out" : "");
  text += LatencyLine("durable, due to acked", figures.latencies.durable);
  text += LatencyLine("live, due to acked", figures.latencies.live);
  text += LatencyLine("live that gave way unacked, due to given up", figures.latencies.gave_way);
  if (figures.server) text += UseLine("server", *figures.server, figures);
  text += UseLine("fleet", figures.own, figures);
  if (figures.skipped_ticks > 0) {
    text += fmt::format("the fleet itself was too slow: {} ticks were left out\n",
                        figures.skipped_ticks);
  }
  if (figures.only_moving > 0) {
    text += fmt::format("{} robots had as much to remember as they may, and only moved then\n",
                        figures.only_moving);
  }
  for (const auto& [reason, count] : figures.rejects_by_reason) {
    text += fmt::format("rejected {}: {}\n", reason, count);
  }
  for (const auto& [name, count] : figures.ends) {
    text += fmt::format("streams ended {}: {}\n", name, count);
  }
  return text;
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

/// What differs, robot by robot.
std::string Differences(const Findings& findings) {
  if (findings.differences().empty()) return {};
  std::string text = "\nrobot | thing | expected | found\n";
  for (std::size_t i = 0; i < findings.differences().size() && i < kDifferencesShown; ++i) {
    const Difference& difference = findings.differences()[i];
    text += fmt::format("{} | {} | {} | {}\n", difference.ruri, TextOf(difference.thing).name,
                        difference.expected, difference.found);
  }
  const std::uint64_t all = findings.differences_in_all();
  if (all > kDifferencesShown) text += fmt::format("and {} more\n", all - kDifferencesShown);
  return text;
}

}  // namespace

std::map<std::string, std::uint64_t> RejectsByReason(const Shared& shared) {
  std::map<std::string, std::uint64_t> counts;
  for (std::size_t index = 0; index < shared.rejects.size(); ++index) {
    const std::uint64_t count = shared.rejects[index].load();
    if (count == 0) continue;
    const bool known = index > 0 && index <= model::kRejectReasons;
    const auto reason = static_cast<model::RejectReason>(index);
    counts[known ? std::string(model::ToText(reason)) : "unknown"] += count;
  }
  return counts;
}

bool AllOk(const std::vector<CheckRow>& rows) {
  return std::all_of(rows.begin(), rows.end(), [](const CheckRow& row) { return row.ok; });
}

std::string TextReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  std::string text = FiguresText(figures);
  std::size_t widest = 0;
  for (const CheckRow& row : rows) {
    widest = std::max(widest, row.what.size());
  }
  text += fmt::format("\n{:<{}} | {:>10} | {:>21} | {:>10} |\n", "what", widest, "fleet", "server",
                      "store");
  text += fmt::format("{:-<{}}-+-{:-<10}-+-{:-<21}-+-{:-<10}-+---------\n", "", widest, "", "", "");
  for (const CheckRow& row : rows) {
    text += fmt::format("{:<{}} | {:>10} | {:>21} | {:>10} | {}\n", row.what, widest, row.fleet,
                        row.server, row.store, row.ok ? "ok" : "MISMATCH");
    if (!row.ok && !row.note.empty()) text += fmt::format("    {}\n", row.note);
  }
  text += Differences(findings);
  text += AllOk(rows) ? "\nverification: all agree\n" : "\nverification: MISMATCH\n";
  if (!AllOk(rows) && !figures.first_error.empty()) {
    text += fmt::format("first trouble: {}\n", figures.first_error);
  }
  return text;
}

std::string JsonReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  Struct root;
  PutBool(root, "ok", AllOk(rows));
  Struct& run = *(*root.mutable_fields())["run"].mutable_struct_value();
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
  PutCount(run, "welcomes", figures.welcomes);
  PutCount(run, "breaks", figures.breaks);
  PutCount(run, "takeovers", figures.takeovers);
  PutCount(run, "connects", figures.connects);
  PutCount(run, "skippedTicks", figures.skipped_ticks);
  PutCount(run, "onlyMoving", figures.only_moving);
  PutCount(run, "sentWhileMeasured", figures.sent_while_measured);
  PutCount(run, "drains", figures.drains);
  Struct& latency = *(*run.mutable_fields())["latencyMs"].mutable_struct_value();
  PutLatency(latency, "durable", figures.latencies.durable);
  PutLatency(latency, "live", figures.latencies.live);
  PutLatency(latency, "liveGaveWay", figures.latencies.gave_way);
  if (figures.server) PutUse(run, "server", *figures.server);
  PutUse(run, "fleet", figures.own);
  PutBool(run, "serverRestarted", figures.restarted);
  Put(run, "firstError", figures.first_error);
  Struct& rejected = *(*run.mutable_fields())["rejectsByReason"].mutable_struct_value();
  for (const auto& [reason, count] : figures.rejects_by_reason) {
    PutCount(rejected, reason, count);
  }
  Struct& ends = *(*run.mutable_fields())["ends"].mutable_struct_value();
  for (const auto& [name, count] : figures.ends) {
    PutCount(ends, name, count);
  }
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
  auto& differences = *(*root.mutable_fields())["differences"].mutable_list_value();
  for (const Difference& each : findings.differences()) {
    Struct& difference = *differences.add_values()->mutable_struct_value();
    Put(difference, "ruri", each.ruri);
    Put(difference, "what", std::string(TextOf(each.thing).name));
    Put(difference, "expected", each.expected);
    Put(difference, "found", each.found);
  }
  std::string json;
  const auto status = google::protobuf::util::MessageToJsonString(root, &json);
  return status.ok() ? json + "\n" : "{\"ok\":false}\n";
}

}  // namespace uplink::synthetic
