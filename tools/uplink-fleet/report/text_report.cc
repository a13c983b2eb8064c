#include "tools/uplink-fleet/report/text_report.h"

#include <algorithm>
#include <cstdint>
#include <optional>

#include <fmt/core.h>

namespace uplink::synthetic {
namespace {

constexpr double kMicrosPerSecond = 1e6;
constexpr double kBytesPerMiB = 1024.0 * 1024.0;

std::string LatencyLine(const char* what, const Histogram& histogram,
                        const char* each = "messages") {
  if (histogram.count() == 0) return {};
  std::string text = fmt::format("{}:", what);
  for (const auto& [label, share] : kQuantiles) {
    text += fmt::format(" {} {:.2f} ms,", label, MillisOf(histogram.Quantile(share)));
  }
  return text + fmt::format(" max {:.2f} ms ({} {})\n", MillisOf(histogram.max()),
                            histogram.count(), each);
}

/// What was used for so many messages, and in how many seconds if that is known.
std::string UseLine(const char* name, const ProcessUse& use, std::uint64_t messages,
                    std::optional<double> seconds = std::nullopt) {
  const auto sent = static_cast<double>(std::max<std::uint64_t>(messages, 1));
  std::string text = fmt::format("{}: {:.2f} s of CPU, ", name, use.cpu_seconds);
  if (seconds) {
    text += fmt::format("{:.0f} % of a core, ", 100 * use.cpu_seconds / std::max(*seconds, 0.001));
  }
  return text + fmt::format("{:.1f} us per message; {:.0f} MiB\n",
                            use.cpu_seconds * kMicrosPerSecond / sent,
                            static_cast<double>(use.rss_bytes) / kBytesPerMiB);
}

constexpr const char* kRestarted = ", server restarted: its counters are left out";

/// How it went, above the table.
std::string FiguresText(const RunFigures& figures) {
  std::string text = fmt::format(
      "\n{} robots, {:.0f} s, seed {}, run {}: {} messages sent ({} again), {} judged, "
      "{} live acked, {} durable acked, {} rejects, {} connections, {} welcomes, {} breaks, {} "
      "takeovers, {} drains{}\n",
      figures.robots, figures.seconds, figures.seed, figures.run, figures.sent, figures.resent,
      figures.judged, figures.latencies.live.count(), figures.acked_durable, figures.rejects,
      figures.connects, figures.welcomes, figures.breaks, figures.takeovers, figures.drains,
      figures.restarted ? kRestarted : "");
  text += LatencyLine("durable, due to acked", figures.latencies.durable);
  text += LatencyLine("live, due to acked", figures.latencies.live);
  text += LatencyLine("live that gave way unacked, due to given up", figures.latencies.gave_way);
  if (figures.receivers > 0) {
    text += fmt::format("forwards: {} changes and {} snapshots to {} robots\n",
                        figures.forwarded_changes, figures.forwarded_snapshots, figures.receivers);
  }
  text += LatencyLine("snapshot, Welcome to its end", figures.latencies.snapshot, "streams");
  text +=
      LatencyLine("the same of robots that joined late", figures.latencies.late_snapshot, "robots");
  const std::uint64_t messages = figures.sent_while_measured;
  if (figures.server) text += UseLine("server", *figures.server, messages, figures.seconds);
  text += UseLine("fleet", figures.own, messages, figures.seconds);
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

/// The same of twins.
std::string FiguresText(const TwinFigures& figures) {
  const TwinTotals& totals = figures.totals;
  std::string text = fmt::format(
      "\n{} twins, {:.0f} s, seed {}, run {}: {} messages published, {} of them at QoS 1, {} "
      "acked; {} connections, {} breaks{}\n",
      totals.twins, figures.seconds, figures.seed, figures.run, totals.published,
      totals.published_qos1, totals.acked, figures.connections, figures.breaks,
      figures.restarted ? kRestarted : "");
  text += LatencyLine("ping to pong", figures.pong, "pongs");
  if (figures.server) text += UseLine("server", *figures.server, totals.published);
  text += UseLine("fleet", figures.own, totals.published);
  if (figures.skipped > 0) {
    text +=
        fmt::format("broker or fleet were too slow: {} messages were left out\n", figures.skipped);
  }
  return text;
}

/// The same of drones.
std::string FiguresText(const DroneFigures& figures) {
  const DroneTotals& totals = figures.totals;
  std::string text = fmt::format(
      "\n{} drones, {:.0f} s, seed {}, run {}: {} calls ({} again), {} answered, {} answers not "
      "taken, {} links cut{}\n",
      totals.drones, figures.seconds, figures.seed, figures.run, totals.sent, figures.again,
      totals.answered, figures.lost, figures.cut, figures.restarted ? kRestarted : "");
  text += LatencyLine("durable, due to answered", figures.latencies.durable, "calls");
  text += LatencyLine("live, due to answered", figures.latencies.live, "calls");
  if (figures.server) text += UseLine("server", *figures.server, totals.sent);
  return text + UseLine("fleet", figures.own, totals.sent);
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

/// The table, what differs, and the line; `first_error` is said if something differs.
std::string TableText(const std::vector<CheckRow>& rows, const Findings& findings,
                      const std::string& first_error) {
  std::string text;
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
  if (!AllOk(rows) && !first_error.empty()) {
    text += fmt::format("first trouble: {}\n", first_error);
  }
  return text;
}

}  // namespace

std::string TextReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  return FiguresText(figures) + TableText(rows, findings, figures.first_error);
}

std::string TextReport(const TwinFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  return FiguresText(figures) + TableText(rows, findings, figures.first_error);
}

std::string TextReport(const DroneFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings) {
  return FiguresText(figures) + TableText(rows, findings, figures.first_error);
}

}  // namespace uplink::synthetic
