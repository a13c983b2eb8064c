#pragma once

#include <map>
#include <string>

#include <boost/json.hpp>

namespace uplink::synthetic {

/// `Robot.cyberwave` in parts that change together, each as CanonicalText, without the arrivals by
/// the server's clock: `position`, `edgeHealth/ID`, `metrics/CATEGORY`,
/// `joints/SOURCE/NAME/CHANNEL` and so on. Not sessions and counts. Pure; any thread.
[[nodiscard]] std::map<std::string, std::string> LivePartsOf(const boost::json::object& cyberwave);

}  // namespace uplink::synthetic
