#include "tests/bench/cyberwave/page_figures.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

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

double ShareOf(std::vector<double> values, double share) {
  if (values.empty()) return 0;
  const double rank = std::ceil(share * static_cast<double>(values.size()));
  const auto place = static_cast<std::size_t>(std::max(rank, 1.0)) - 1;
  std::ranges::nth_element(values, values.begin() + static_cast<std::ptrdiff_t>(place));
  return values[place];
}

}  // namespace uplink::bench
