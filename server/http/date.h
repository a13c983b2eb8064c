#pragma once

#include <string>

#include "schema/base/clock.h"

namespace uplink::http {

/// The value of a Date header, such as `Sun, 06 Nov 1994 08:49:37 GMT` (RFC 9110, 5.6.7), whatever
/// the locale. Years from 0 to 9999.
[[nodiscard]] std::string ImfFixdate(SystemTime time);

}  // namespace uplink::http
