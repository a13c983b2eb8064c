#include "tests/bench/page.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <vector>

#include <boost/json.hpp>
#include <fmt/core.h>

namespace uplink::bench {
namespace {

constexpr double kMsPerSecond = 1e3;

/// A bucket of a histogram, cumulative.
struct Bucket {
  double seconds = 0;
  double count = 0;
};

/// In the order of their bounds; the one without a bound is last.
std::vector<Bucket> BucketsOf(const Samples& before, const Samples& after,
                              std::string_view histogram) {
  const std::string begin = std::string(histogram) + "_bucket{le=\"";
  std::vector<Bucket> buckets;
  for (const auto& [name, count] : after) {
    if (!name.starts_with(begin)) continue;
    buckets.push_back({.seconds = std::strtod(name.c_str() + begin.size(), nullptr),
                       .count = count - FigureOf(before, name)});
  }
  std::ranges::sort(buckets, {}, &Bucket::seconds);
  return buckets;
}

}  // namespace

double FigureOf(const Samples& samples, const std::string& name) {
  const auto found = samples.find(name);
  return found == samples.end() ? 0 : found->second;
}

double SumOf(const Samples& samples, std::string_view begin) {
  double sum = 0;
  for (auto at = samples.lower_bound(std::string(begin)); at != samples.end(); ++at) {
    if (!at->first.starts_with(begin)) break;
    sum += at->second;
  }
  return sum;
}

double HistogramMs(const Samples& before, const Samples& after, std::string_view histogram,
                   double share) {
  const std::vector<Bucket> buckets = BucketsOf(before, after, histogram);
  if (buckets.empty() || buckets.back().count <= 0) return 0;
  const double wanted = share * buckets.back().count;
  Bucket below;
  for (const Bucket& each : buckets) {
    if (each.count < wanted) {
      below = each;
      continue;
    }
    if (!std::isfinite(each.seconds) || each.count == below.count) break;
    const double part = (wanted - below.count) / (each.count - below.count);
    return (below.seconds + part * (each.seconds - below.seconds)) * kMsPerSecond;
  }
  return below.seconds * kMsPerSecond;
}

Samples SamplesOf(std::string_view page) {
  Samples samples;
  while (!page.empty()) {
    const std::size_t end = page.find('\n');
    const std::string_view line = page.substr(0, end);
    page.remove_prefix(end == std::string_view::npos ? page.size() : end + 1);
    const std::size_t space = line.rfind(' ');
    if (line.starts_with('#') || space == std::string_view::npos || space == 0) continue;
    const std::string value(line.substr(space + 1));
    char* stopped = nullptr;
    const double number = std::strtod(value.c_str(), &stopped);
    if (stopped != value.c_str() && *stopped == '\0') {
      samples.emplace(line.substr(0, space), number);
    }
  }
  return samples;
}

std::string BrokenLaw(const Samples& samples) {
  const double received = FigureOf(samples, "uplinkd_uplinks_received_total");
  const double settled = SumOf(samples, "uplinkd_uplinks_settled_total{");
  const double in_flight = FigureOf(samples, "uplinkd_uplinks_in_flight");
  // Counts are whole, and exact as doubles far beyond what a run sends.
  if (received == settled + in_flight) return "";
  return fmt::format("received {:.0f}, settled {:.0f}, in flight {:.0f}", received, settled,
                     in_flight);
}

std::set<std::string> RurisOf(const std::string& page) {
  std::set<std::string> ruris;
  boost::system::error_code error;
  const boost::json::value parsed = boost::json::parse(page, error);
  const auto* object = error ? nullptr : parsed.if_object();
  const auto* robots = object == nullptr ? nullptr : object->if_contains("robots");
  const auto* list = robots == nullptr ? nullptr : robots->if_array();
  if (list == nullptr) return ruris;
  for (const boost::json::value& each : *list) {
    const auto* robot = each.if_object();
    const auto* ruri = robot == nullptr ? nullptr : robot->if_contains("ruri");
    if (ruri != nullptr && ruri->is_string()) ruris.emplace(ruri->as_string());
  }
  return ruris;
}

}  // namespace uplink::bench
