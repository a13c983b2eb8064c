#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace uplink::bench {

/// What a drone publishes of one type, again and again. A value.
struct AvatarSample {
  /// `/uncrew.v1.AvatarService/PublishBattery`.
  std::string path;
  /// Every sample is answered once it is committed.
  bool durable = false;
  /// The request without metadata.
  std::string content;
};

/// The types of telemetry whose samples are live: those of live types, and modes that do not
/// change.
[[nodiscard]] std::vector<AvatarSample> LiveSamples();
/// All 23 types of telemetry: events besides.
[[nodiscard]] std::vector<AvatarSample> AllSamples();

/// What tells two samples of a drone apart, and drones of a gateway. A value.
struct AvatarMetadata {
  /// Empty: the certificate's.
  std::string_view uav_id;
  std::int64_t unix_us = 0;
  std::uint64_t boot_us = 0;
};
/// The request of a call.
[[nodiscard]] std::string RequestOf(const AvatarSample& sample, const AvatarMetadata& metadata);

}  // namespace uplink::bench
