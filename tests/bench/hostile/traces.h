#pragma once

#include <string>
#include <string_view>

#include "tests/bench/page.h"

namespace uplink::bench {

/// The first warning or error of the log that has one of the attacker's addresses or its robot;
/// empty if there is none.
[[nodiscard]] std::string_view LineThatNames(std::string_view log);

/// Of the metrics that count what is refused or ended, the one that grew the most, by its label if
/// it has one: `resets 50`. Empty if none grew.
[[nodiscard]] std::string GrownMost(const Samples& before, const Samples& after);

}  // namespace uplink::bench
