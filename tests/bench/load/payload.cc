#include <array>

#include <fmt/core.h>

#include "schema/encode.h"
#include "tests/bench/load/client.h"

namespace uplink::bench {
namespace {

constexpr std::size_t kPayloads = 64;
constexpr std::int64_t kTimeMs = 1'763'683'200'000;

/// 104 bytes.
std::string MotionAt(std::int64_t time_ms, double step) {
  model::MotionTelemetry motion;
  motion.unix_time_ms = time_ms;
  motion.pose = model::Pose{.lat_deg = 52 + step / 1e5,
                            .lon_deg = 13 + step / 1e5,
                            .altitude_m = 40 + step / 10,
                            .heading_deg = step};
  motion.velocity = model::VelTwist{.linear_mps = static_cast<float>(step / 50),
                                    .angular_rps = static_cast<float>(step / 500)};
  motion.gps_fix_type = model::GpsFixType::kFixedRtk;
  return schema::Encode(motion);
}

/// 208 bytes.
std::string StatusAt(std::int64_t time_ms, double step) {
  model::StatusTelemetry status;
  status.unix_time_ms = time_ms;
  status.battery = model::BatteryStatus();
  status.battery->soc_pct = static_cast<float>(step);
  status.mode = model::RobotMode::kAuto;
  status.mission_active = true;
  status.status = "row 12 of field 7";
  return schema::Encode(status);
}

/// Alternately motion and status: a little over 150 bytes on average.
std::array<std::string, kPayloads> MakePayloads() {
  std::array<std::string, kPayloads> payloads;
  for (std::size_t i = 0; i < kPayloads; ++i) {
    const std::int64_t time_ms = kTimeMs + static_cast<std::int64_t>(i) * 100;
    const auto step = static_cast<double>(i);
    payloads.at(i) = i % 2 == 0 ? MotionAt(time_ms, step) : StatusAt(time_ms, step);
  }
  return payloads;
}

}  // namespace

const std::string& Payload(std::size_t variation) {
  static const std::array<std::string, kPayloads> kMade = MakePayloads();
  return kMade.at(variation % kPayloads);
}

ClientStyle LiveStyle(std::size_t number) {
  return {.name = fmt::format("robot-{}", number),
          .topic = fmt::format("robot.{}", number),
          .write = [number](std::uint64_t seq, std::string& payload) {
            payload = Payload(number + seq);
          }};
}

}  // namespace uplink::bench
