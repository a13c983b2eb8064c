#include "tools/uplink-fleet/report/text_report.h"

#include <algorithm>
#include <cstdint>
#include <map>
#include <string_view>
#include <utility>

#include <fmt/core.h>

#include "tools/uplink-fleet/report/table.h"

namespace uplink::synthetic {
namespace {

constexpr double kMicrosPerSecond = 1e6;
constexpr double kBytesPerMiB = 1024.0 * 1024.0;
constexpr const char* kRestarted = ", server restarted: its counters are left out";

/// Named texts, each on a line, or on more below each other.
class Lines {
 public:
  void Add(std::string_view name, std::string_view text) {
    if (!text.empty()) text_ += fmt::format("{:<{}}{}\n", name, kNameWidth, text);
  }
  void Add(std::string_view name, const std::map<std::string, std::uint64_t>& counts) {
    std::string line;
    for (const auto& [each, count] : counts) {
      std::string item = fmt::format("{} {}", count, each);
      if (!line.empty() && line.size() + item.size() > kListWidth) {
        Add(std::exchange(name, ""), line + ",");
        line.clear();
      }
      line += (line.empty() ? "" : ", ") + item;
    }
    Add(name, line);
  }
  [[nodiscard]] const std::string& text() const { return text_; }

 private:
  static constexpr std::size_t kNameWidth = 11;
  /// Of a list on one line; a usual terminal has 80 columns.
  static constexpr std::size_t kListWidth = 66;

  std::string text_;
};

/// How long messages took, a line per sort of them.
class LatencyTable {
 public:
  void Add(const char* what, const Histogram& histogram, const char* each = "messages") {
    if (histogram.count() == 0) return;
    std::vector<Cell> cells{what};
    for (const auto& [label, share] : kQuantiles)
      cells.push_back(Millis(histogram.Quantile(share)));
    cells.push_back(Millis(histogram.max()));
    cells.emplace_back(fmt::format("{} {}", histogram.count(), each));
    table_.Add(std::move(cells));
  }
  [[nodiscard]] std::string Text(const Palette& palette) const {
    return table_.empty() ? "" : "\n" + table_.Text(palette);
  }

 private:
  /// Four digits or more; microseconds do not matter beside seconds.
  static Cell Millis(Histogram::Micros micros) {
    const double millis = MillisOf(micros);
    return fmt::format("{:.{}f}", millis, millis < 100 ? 2 : 1);
  }

  Table table_{{"latency in ms", "p50", "p90", "p99", "p99.9", "max", "of"}};
};

/// What processes used for so many messages in so many seconds.
class UseTable {
 public:
  UseTable(std::uint64_t messages, double seconds)
      : messages_(static_cast<double>(std::max<std::uint64_t>(messages, 1))),
        seconds_(std::max(seconds, 0.001)) {}

  void Add(const char* name, const ProcessUse& use) {
    table_.Add({name, fmt::format("{:.2f} s", use.cpu_seconds),
                fmt::format("{:.0f} %", 100 * use.cpu_seconds / seconds_),
                fmt::format("{:.1f} us", use.cpu_seconds * kMicrosPerSecond / messages_),
                fmt::format("{:.0f} MiB", static_cast<double>(use.rss_bytes) / kBytesPerMiB)});
  }
  [[nodiscard]] std::string Text(const Palette& palette) const {
    return "\n" + table_.Text(palette);
  }

 private:
  const double messages_;
  const double seconds_;
  Table table_{{"cost", "CPU", "of a core", "per message", "memory"}};
};

/// How it went, above the table.
std::string FiguresText(const RunFigures& figures, const Palette& palette) {
  const std::string heading =
      fmt::format("{} robots, {:.0f} s, seed {}, run {}{}", figures.robots, figures.seconds,
                  figures.seed, figures.run, figures.restarted ? kRestarted : "");
  Lines lines;
  lines.Add(
      "messages",
      fmt::format("{} sent ({} again), {} judged, {} live acked, {} durable acked, {} rejects",
                  figures.sent, figures.resent, figures.judged, figures.latencies.live.count(),
                  figures.acked_durable, figures.rejects));
  lines.Add("streams",
            fmt::format("{} connections, {} welcomes, {} breaks, {} takeovers, {} drains",
                        figures.connects, figures.welcomes, figures.breaks, figures.takeovers,
                        figures.drains));
  lines.Add("ended", figures.ends);
  lines.Add("rejected", figures.rejects_by_reason);
  if (figures.receivers > 0) {
    lines.Add("forwards",
              fmt::format("{} changes and {} snapshots to {} robots", figures.forwarded_changes,
                          figures.forwarded_snapshots, figures.receivers));
  }
  if (figures.skipped_ticks > 0) {
    lines.Add("too slow", fmt::format("the fleet itself was too slow: {} ticks were left out",
                                      figures.skipped_ticks));
  }
  if (figures.only_moving > 0) {
    lines.Add("full", fmt::format("{} robots had as much to remember as they may, and only moved "
                                  "then",
                                  figures.only_moving));
  }
  LatencyTable latencies;
  latencies.Add("durable, due to acked", figures.latencies.durable);
  latencies.Add("live, due to acked", figures.latencies.live);
  latencies.Add("live that gave way unacked, due to given up", figures.latencies.gave_way);
  latencies.Add("snapshot, Welcome to its end", figures.latencies.snapshot, "streams");
  latencies.Add("the same of robots that joined late", figures.latencies.late_snapshot, "robots");
  UseTable use(figures.sent_while_measured, figures.seconds);
  if (figures.server) use.Add("server", *figures.server);
  use.Add("fleet", figures.own);
  return "\n" + palette.Heading(heading) + "\n" + lines.text() + latencies.Text(palette) +
         use.Text(palette);
}

/// The same of twins.
std::string FiguresText(const TwinFigures& figures, const Palette& palette) {
  const TwinTotals& totals = figures.totals;
  const std::string heading =
      fmt::format("{} twins, {:.0f} s, seed {}, run {}{}", totals.twins, figures.seconds,
                  figures.seed, figures.run, figures.restarted ? kRestarted : "");
  Lines lines;
  lines.Add("messages", fmt::format("{} published, {} of them at QoS 1, {} acked", totals.published,
                                    totals.published_qos1, totals.acked));
  lines.Add("broker",
            fmt::format("{} connections, {} breaks", figures.connections, figures.breaks));
  if (figures.skipped > 0) {
    lines.Add("too slow", fmt::format("broker or fleet were too slow: {} messages were left out",
                                      figures.skipped));
  }
  LatencyTable latencies;
  latencies.Add("ping to pong", figures.pong, "pongs");
  UseTable use(totals.published, figures.seconds);
  if (figures.server) use.Add("server", *figures.server);
  use.Add("fleet", figures.own);
  return "\n" + palette.Heading(heading) + "\n" + lines.text() + latencies.Text(palette) +
         use.Text(palette);
}

/// The same of drones.
std::string FiguresText(const DroneFigures& figures, const Palette& palette) {
  const DroneTotals& totals = figures.totals;
  const std::string heading =
      fmt::format("{} drones, {:.0f} s, seed {}, run {}{}", totals.drones, figures.seconds,
                  figures.seed, figures.run, figures.restarted ? kRestarted : "");
  Lines lines;
  lines.Add("calls",
            fmt::format("{} made ({} again), {} answered, {} answers not taken, {} links cut",
                        totals.sent, figures.again, totals.answered, figures.lost, figures.cut));
  LatencyTable latencies;
  latencies.Add("durable, due to answered", figures.latencies.durable, "calls");
  latencies.Add("live, due to answered", figures.latencies.live, "calls");
  UseTable use(totals.sent, figures.seconds);
  if (figures.server) use.Add("server", *figures.server);
  use.Add("fleet", figures.own);
  return "\n" + palette.Heading(heading) + "\n" + lines.text() + latencies.Text(palette) +
         use.Text(palette);
}

/// What differs, robot by robot. Values may be long, so columns are not aligned.
std::string Differences(const Findings& findings, const Palette& palette) {
  if (findings.differences().empty()) return {};
  std::string text = "\n" + palette.Heading("robot | thing | expected | found") + "\n";
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
                      const std::string& first_error, const Palette& palette) {
  Table table({"what", "fleet", "server", "store", ""});
  for (const CheckRow& row : rows) {
    table.Add({row.what, row.fleet, row.server, row.store,
               row.ok ? Cell("ok", Cell::Tone::kGood) : Cell("MISMATCH", Cell::Tone::kBad)});
    if (!row.ok && !row.note.empty()) table.AddNote("    " + row.note);
  }
  std::string text = "\n" + table.Text(palette) + Differences(findings, palette) + "\n";
  if (AllOk(rows)) return text + palette.Good("verification: all agree") + "\n";
  text += palette.Bad("verification: MISMATCH") + "\n";
  return first_error.empty() ? text : text + fmt::format("first trouble: {}\n", first_error);
}

}  // namespace

std::string TextReport(const RunFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings, const Palette& palette) {
  return FiguresText(figures, palette) + TableText(rows, findings, figures.first_error, palette);
}

std::string TextReport(const TwinFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings, const Palette& palette) {
  return FiguresText(figures, palette) + TableText(rows, findings, figures.first_error, palette);
}

std::string TextReport(const DroneFigures& figures, const std::vector<CheckRow>& rows,
                       const Findings& findings, const Palette& palette) {
  return FiguresText(figures, palette) + TableText(rows, findings, figures.first_error, palette);
}

}  // namespace uplink::synthetic
