#include "tools/uplink-fleet/report/twin_report.h"

#include <algorithm>
#include <utility>

#include <fmt/core.h>
#include <google/protobuf/struct.pb.h>

#include "tools/uplink-fleet/report/json_report.h"
#include "tools/uplink-fleet/report/quantiles.h"
#include "tools/uplink-fleet/report/text_report.h"

namespace uplink::synthetic {
namespace {

using google::protobuf::Struct;

void PutCount(Struct& object, const char* name, std::uint64_t count) {
  (*object.mutable_fields())[name].set_number_value(static_cast<double>(count));
}

void PutUse(Struct& object, const char* name, const ProcessUse& use) {
  Struct& to = *(*object.mutable_fields())[name].mutable_struct_value();
  (*to.mutable_fields())["cpuSeconds"].set_number_value(use.cpu_seconds);
  PutCount(to, "rssBytes", use.rss_bytes);
}

std::string UseLine(const char* name, const ProcessUse& use, const TwinFigures& figures) {
  constexpr double kMicrosPerSecond = 1e6;
  constexpr double kBytesPerMiB = 1024.0 * 1024.0;
  const auto sent = static_cast<double>(std::max<std::uint64_t>(figures.totals.published, 1));
  return fmt::format("{}: {:.2f} s of CPU, {:.1f} us per message; {:.0f} MiB\n", name,
                     use.cpu_seconds, use.cpu_seconds * kMicrosPerSecond / sent,
                     static_cast<double>(use.rss_bytes) / kBytesPerMiB);
}

}  // namespace

std::string TwinTextReport(const TwinFigures& figures, const std::vector<CheckRow>& rows,
                           const Findings& findings) {
  const TwinTotals& totals = figures.totals;
  std::string text = fmt::format(
      "\n{} twins, {:.0f} s, seed {}, run {}: {} messages published, {} of them at QoS 1, {} "
      "acked; {} connections, {} breaks{}\n",
      totals.twins, figures.seconds, figures.seed, figures.run, totals.published,
      totals.published_qos1, totals.acked, figures.connections, figures.breaks,
      figures.restarted ? ", server restarted: its counters are left out" : "");
  if (figures.pong.count() > 0) {
    text += "ping to pong:";
    for (const auto& [label, share] : kQuantiles) {
      text += fmt::format(" {} {:.2f} ms,", label, MillisOf(figures.pong.Quantile(share)));
    }
    text += fmt::format(" max {:.2f} ms ({} pongs)\n", MillisOf(figures.pong.max()),
                        figures.pong.count());
  }
  if (figures.server) text += UseLine("server", *figures.server, figures);
  text += UseLine("fleet", figures.own, figures);
  if (figures.skipped > 0) {
    text +=
        fmt::format("broker or fleet were too slow: {} messages were left out\n", figures.skipped);
  }
  return text + TableText(rows, findings, figures.first_error);
}

std::string TwinJsonReport(const TwinFigures& figures, const std::vector<CheckRow>& rows,
                           const Findings& findings) {
  const TwinTotals& totals = figures.totals;
  Struct run;
  auto& fields = *run.mutable_fields();
  fields["id"].set_string_value(figures.run);
  fields["seconds"].set_number_value(figures.seconds);
  fields["serverRestarted"].set_bool_value(figures.restarted);
  fields["firstError"].set_string_value(figures.first_error);
  PutCount(run, "twins", totals.twins);
  PutCount(run, "seed", figures.seed);
  PutCount(run, "published", totals.published);
  PutCount(run, "publishedQos1", totals.published_qos1);
  PutCount(run, "acked", totals.acked);
  PutCount(run, "refused", totals.refused);
  PutCount(run, "connections", figures.connections);
  PutCount(run, "breaks", figures.breaks);
  PutCount(run, "skipped", figures.skipped);
  PutCount(run, "pings", totals.pings);
  PutCount(run, "pongs", totals.pongs);
  Struct& pong = *fields["pongMs"].mutable_struct_value();
  for (const auto& [label, share] : kQuantiles) {
    (*pong.mutable_fields())[label].set_number_value(MillisOf(figures.pong.Quantile(share)));
  }
  (*pong.mutable_fields())["max"].set_number_value(MillisOf(figures.pong.max()));
  if (figures.server) PutUse(run, "server", *figures.server);
  PutUse(run, "fleet", figures.own);
  return JsonOf(std::move(run), rows, findings);
}

}  // namespace uplink::synthetic
