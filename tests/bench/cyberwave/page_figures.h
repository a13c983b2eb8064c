#pragma once

#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace uplink::bench {

using Samples = std::map<std::string, double>;

/// The sample of that name with its labels; 0 if the page has none.
[[nodiscard]] double FigureOf(const Samples& samples, const std::string& name);
/// The sum of the samples whose names begin so.
[[nodiscard]] double SumOf(const Samples& samples, std::string_view begin);

/// Within which time the share (0 to 1) of what a histogram of seconds took between two pages lies:
/// milliseconds, evenly spread within a bucket; 0 if it took nothing, and the highest bound for
/// what lies over all of them.
[[nodiscard]] double HistogramMs(const Samples& before, const Samples& after,
                                 std::string_view histogram, double share);

/// The smallest value that as much as the share (0 to 1) is not above; 0 of none.
[[nodiscard]] double ShareOf(std::vector<double> values, double share);

}  // namespace uplink::bench
