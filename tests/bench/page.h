#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace uplink::bench {

// What a server's pages say.

/// The value of each sample, by its name with its labels as the page spells them.
using Samples = std::map<std::string, double>;
/// Those of one page of metrics. A line that is none is left out.
[[nodiscard]] Samples SamplesOf(std::string_view page);
/// The sample of that name with its labels; 0 if the page has none.
[[nodiscard]] double FigureOf(const Samples& samples, const std::string& name);
/// The sum of the samples whose names begin so.
[[nodiscard]] double SumOf(const Samples& samples, std::string_view begin);
/// Within which time the share (0 to 1) of what a histogram of seconds took between two pages lies:
/// milliseconds, evenly spread within a bucket; 0 if it took nothing, and the highest bound for
/// what lies over all of them.
[[nodiscard]] double HistogramMs(const Samples& before, const Samples& after,
                                 std::string_view histogram, double share);

/// What the conservation law says of one page: received = sum of settled + in flight. Empty if it
/// holds, else the three figures.
[[nodiscard]] std::string BrokenLaw(const Samples& samples);

/// RURIs of a page of /api/v1/robots; none if it is not JSON of that form.
[[nodiscard]] std::set<std::string> RurisOf(const std::string& page);

}  // namespace uplink::bench
