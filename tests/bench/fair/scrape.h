#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <string_view>

namespace uplink::bench {

/// The samples of one page of metrics by their name with its labels, as the page spells them. A
/// line that is none is left out.
[[nodiscard]] std::map<std::string, double> SamplesOf(std::string_view page);

/// What the conservation law says of one page: received = sum of settled + in flight. Empty if it
/// holds, else the three figures.
[[nodiscard]] std::string BrokenLaw(const std::map<std::string, double>& samples);

/// RURIs of a page of /api/v1/robots; none if it is not JSON of that form.
[[nodiscard]] std::set<std::string> RurisOf(const std::string& page);

}  // namespace uplink::bench
