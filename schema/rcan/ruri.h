#pragma once

#include <string>
#include <string_view>

namespace uplink::schema {

/// The RURI without `?sig=...`; a view into `text`. Pure.
[[nodiscard]] std::string_view WithoutSignature(std::string_view text);

/// The RURI as it is compared: without `?sig=...`, and the shorthand
/// `<manufacturer>.<model>.<instance>` written out as `rcan://local.rcan/...`. Nothing else is
/// changed. Pure.
[[nodiscard]] std::string NormalRuri(std::string_view text);

}  // namespace uplink::schema
