#pragma once

#include <functional>
#include <string>
#include <string_view>

#include <boost/json.hpp>

#include "tools/uplink-fleet/robot/behaviour/seeded.h"

namespace uplink::synthetic {

/// Draws what the texts within `value` stand for: `1..9` is a number between, `1..9#` a whole one,
/// `a|b` one of both; all others are what `named` makes of them. Pure but for `chance`.
void FillTexts(boost::json::value& value, Seeded& chance,
               const std::function<std::string(const std::string&)>& named);

/// `text` with every `token` replaced. Pure.
[[nodiscard]] std::string Replaced(std::string text, std::string_view token, std::string_view with);

}  // namespace uplink::synthetic
