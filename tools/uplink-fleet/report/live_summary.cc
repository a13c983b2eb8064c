#include "tools/uplink-fleet/report/live_summary.h"

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cmath>
#include <limits>
#include <utility>

#include <fmt/core.h>

#include "tools/uplink-fleet/compare/metrics_page.h"

namespace uplink::synthetic {
namespace {

std::optional<double> NumberOf(std::string_view text) {
  if (text == "+Inf") return std::numeric_limits<double>::infinity();
  double number = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return number;
}

std::int64_t At(const google::protobuf::Map<std::string, std::int64_t>& map,
                const std::string& name) {
  const auto found = map.find(name);
  return found == map.end() ? 0 : found->second;
}

std::string Milliseconds(const std::optional<double>& seconds) {
  return seconds ? fmt::format("{:.1f} ms", *seconds * 1000) : "-";
}

}  // namespace

Buckets HistogramOf(std::string_view page, std::string_view name) {
  Buckets buckets;
  for (const Sample& sample : SamplesOf(page, fmt::format("{}_bucket", name))) {
    // Of series without other labels.
    const std::string_view text = sample.Label("le");
    const auto bound = NumberOf(text);
    if (bound && sample.labels == fmt::format("le=\"{}\"", text)) buckets[*bound] = sample.value;
  }
  return buckets;
}

std::optional<double> Quantile(const Buckets& before, const Buckets& after, double quantile) {
  Buckets came;
  for (const auto& [bound, count] : after) {
    const auto was = before.find(bound);
    came[bound] = count - (was == before.end() ? 0 : was->second);
  }
  if (came.empty() || came.rbegin()->second <= 0) return std::nullopt;
  const double rank = quantile * came.rbegin()->second;
  double low = 0;
  double below = 0;
  for (const auto& [bound, count] : came) {
    if (count >= rank && count > below) {
      if (std::isinf(bound)) return low;
      return low + (bound - low) * (rank - below) / (count - below);
    }
    if (!std::isinf(bound)) low = bound;
    below = count;
  }
  return low;
}

std::string LineOf(const LiveFigures& figures) {
  const std::string own = fmt::format("{} acked, {} rejected, {} breaks", figures.acked,
                                      figures.rejected, figures.breaks);
  if (!figures.answers) {
    return fmt::format("{:>4} s  the server does not answer  {}", figures.seconds, own);
  }
  return fmt::format("{:>4} s  {} online  {:.0f} messages/s  {} stored, {}  ack p50 {}, p99 {}",
                     figures.seconds, figures.online, figures.messages_per_second, figures.stored,
                     own, Milliseconds(figures.ack_p50_seconds),
                     Milliseconds(figures.ack_p99_seconds));
}

LiveTable TableOf(const LiveFigures& figures, std::string heading) {
  if (!figures.answers) heading += "; the server does not answer";
  const auto server = [&figures](std::string text) {
    return figures.answers ? std::move(text) : std::string("-");
  };
  return {std::move(heading),
          {{"robots online", server(fmt::format("{}", figures.online))},
           {"messages per second", server(fmt::format("{:.0f}", figures.messages_per_second))},
           {"messages received", server(fmt::format("{}", figures.received))},
           {"durable messages stored", server(fmt::format("{}", figures.stored))},
           {"durable messages acked", fmt::format("{}", figures.acked)},
           {"messages rejected", fmt::format("{}", figures.rejected)},
           {"streams broken off", fmt::format("{}", figures.breaks)},
           {"arrival to ack, p50", Milliseconds(figures.ack_p50_seconds)},
           {"arrival to ack, p99", Milliseconds(figures.ack_p99_seconds)}}};
}

LiveFigures LiveSummary::Take(const Shared& shared, SteadyTime now,
                              const std::optional<v1::ServerStatus>& status,
                              const std::optional<std::string>& page) {
  if (!began_) began_ = now;
  LiveFigures figures;
  figures.seconds = std::chrono::duration_cast<std::chrono::seconds>(now - *began_).count();
  figures.acked = shared.acked_durable.load();
  figures.rejected = shared.RejectsInAll();
  figures.breaks = shared.breaks.load();
  if (!status) return figures;
  figures.answers = true;
  figures.online = At(status->robots(), "online");
  figures.received = At(status->uplinks(), "received");
  figures.stored = At(status->uplinks(), "stored");
  const Reading reading{now, figures.received,
                        page ? HistogramOf(*page, "uplinkd_ack_seconds") : Buckets()};
  if (last_ && now > last_->at) {
    const double span = std::chrono::duration<double>(now - last_->at).count();
    // Less than before: the server was started anew.
    figures.messages_per_second =
        std::max(0.0, static_cast<double>(reading.received - last_->received) / span);
    figures.ack_p50_seconds = Quantile(last_->ack_seconds, reading.ack_seconds, 0.5);
    figures.ack_p99_seconds = Quantile(last_->ack_seconds, reading.ack_seconds, 0.99);
  }
  last_ = reading;
  return figures;
}

}  // namespace uplink::synthetic
