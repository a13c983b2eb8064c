#include "tests/bench/forward/update.h"

#include <charconv>

#include <fmt/core.h>

#include "schema/encode.h"
#include "schema/nexus_command/encode.h"
#include "uplink/v1/relay.pb.h"

namespace uplink::bench {
namespace {

/// Stands before the time in an object's name, and nowhere else in a message.
constexpr std::string_view kMark = "~published at ";
/// Nanoseconds of the steady clock, with zeros before them.
constexpr std::size_t kTimeDigits = 19;

model::Object ObjectOf(const Update& update) {
  const auto step = static_cast<double>(update.number % kUpdatedObjects);
  return {.id = fmt::format("object-{}", update.number % kUpdatedObjects),
          .name = fmt::format("{}{:0{}}", kMark, update.at.time_since_epoch().count(), kTimeDigits),
          .unix_time_ms = UnixMs(SystemClock().System()),
          .scope = model::ScopeType::kFleet,
          .object_type = model::ObjectType::kUnknown,
          .location = {.lat_deg = 52 + step / 1e5,
                       .lon_deg = 13 + step / 1e5,
                       .altitude_m = 40,
                       .heading_deg = step},
          .radius_m = 1};
}

}  // namespace

std::string ReportOf(const Update& update) {
  return schema::Encode(model::ObjectOp{ObjectOf(update)});
}

std::string ForwardOf(const Update& update, std::string_view origin_ruri) {
  v1::RelayResponse frame;
  v1::Forward& forward = *frame.mutable_forward();
  forward.set_kind(v1::FORWARD_KIND_COMMAND);
  forward.set_origin_ruri(std::string(origin_ruri));
  forward.set_nexus_command(nexus_command::EncodeUpsert({}, ObjectOf(update), origin_ruri));
  return frame.SerializeAsString();
}

std::optional<SteadyTime> PublishedAt(std::string_view message) {
  const std::size_t mark = message.find(kMark);
  if (mark == std::string_view::npos) return std::nullopt;
  const std::string_view digits = message.substr(mark + kMark.size(), kTimeDigits);
  SteadyTime::rep count = 0;
  const auto [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), count);
  if (error != std::errc() || digits.size() < kTimeDigits || end != digits.end()) {
    return std::nullopt;
  }
  return SteadyTime(SteadyTime::duration(count));
}

}  // namespace uplink::bench
