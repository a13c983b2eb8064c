#pragma once

#include <string>
#include <string_view>

namespace uplink::schema {

/// The RURI as it is compared: without `?sig=...`, and the shorthand
/// `<manufacturer>.<model>.<instance>` written out as `rcan://local.rcan/...`. Nothing else is
/// changed. Pure.
[[nodiscard]] std::string NormalRuri(std::string_view text);

}  // namespace uplink::schema
