#pragma once

#include <cstddef>

/// The fixed numbers of drones' samples. Those of keyed parts are in the table of types
/// (schema/model/uncrew/types.h).
namespace uplink::uncrew {

/// Largest request.
inline constexpr std::size_t kRequestBytesMax = std::size_t{64} * 1024;
inline constexpr std::size_t kAlertsMax = 64;
inline constexpr std::size_t kOperatorRequestsMax = 16;
/// The upper right triangle of a matrix of 6 by 6.
inline constexpr std::size_t kCovarianceValues = 21;
inline constexpr double kVoltsMax = 10'000;
inline constexpr double kAmperesMax = 10'000;
inline constexpr double kSatellitesMax = 255;

}  // namespace uplink::uncrew
