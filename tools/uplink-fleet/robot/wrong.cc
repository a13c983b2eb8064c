#include "tools/uplink-fleet/robot/wrong.h"

#include <limits>
#include <utility>

#include "schema/encode.h"
#include "schema/limits.h"
#include "schema/model/rejection.h"
#include "tools/uplink-fleet/robot/account.h"

namespace uplink::synthetic {
namespace {

using enum model::RejectReason;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Made {
  std::string payload;
  model::RejectReason reason = kMalformed;
  std::string field;
  Content content = Content::kRoverNexus;
};

Made Of(const model::Body& body, model::RejectReason reason, std::string field) {
  return {schema::Encode(body), reason, std::move(field)};
}

model::Object ObjectAt(std::int64_t now_ms, double lat_deg) {
  model::Object object;
  object.id = "wrong";
  object.unix_time_ms = now_ms;
  object.location.lat_deg = lat_deg;
  return object;
}

model::ReportedShape Line(double lon) {
  model::ReportedShape shape;
  shape.identity.id = "wrong";
  shape.data = model::LineString{{{.lon = lon, .lat = 47}, {.lon = 8, .lat = 47}}};
  return shape;
}

/// Faults and what else is durable.
Made MakeDurable(std::size_t way, std::int64_t now_ms, model::Fault fault) {
  switch (way) {
    case 0:
      fault.fault_id.clear();
      return Of(fault, kMissingField, "faultId");
    case 1:
      fault.description.assign(schema::kDescriptionBytesMax + 1, 'x');
      return Of(fault, kTextTooLong, "description");
    case 2:
      fault.category = "\xC3\x28";
      return Of(fault, kTextNotUtf8, "category");
    case 3: {
      model::MissionRunStatus mission;
      mission.run_id = "wrong";
      mission.progress_x100 = static_cast<std::uint16_t>(schema::kProgressX100Max + 1);
      return Of(mission, kOutOfRange, "progressX100");
    }
    case 4:
      return Of(model::Message{now_ms, model::MessageLevel::kInfo, ""}, kMissingField, "message");
    case 5:
      return Of(model::ObjectOp{ObjectAt(now_ms, 91)}, kOutOfRange, "upsert.location.latDeg");
    case 6:
      return Of(model::ShapeOp{Line(kNan)}, kNotFinite, "upsert.data.lineString[0].lon");
    default: {
      model::CurrentSettings settings;
      settings.settings = {{"lights", true}, {"lights", false}};
      return Of(settings, kDuplicateKey, "[1].key");
    }
  }
}

/// Live kinds, and what is no message at all.
Made MakeOther(std::size_t way, std::int64_t now_ms, const model::Fault& fault) {
  switch (way) {
    case 8: {
      model::SystemHealth health;
      health.unix_time_ms = now_ms;
      health.device_id.assign(schema::kIdBytesMax + 1, 'd');
      return Of(health, kTextTooLong, "deviceId");
    }
    case 9: {
      model::ConsumableStatus consumable;
      consumable.unix_time_ms = now_ms;
      consumable.tank_id = "front";
      return Of(consumable, kMissingField, "kind");
    }
    case 10: {
      // Cut in the middle: the segment table promises more than there is.
      std::string payload = schema::Encode(fault);
      payload.resize(payload.size() / 2);
      return {std::move(payload), kMalformed, ""};
    }
    case 11: {
      // One word too many behind the message.
      std::string payload = schema::Encode(fault);
      payload.append(8, '\0');
      return {std::move(payload), kMalformed, ""};
    }
    case 12:
      return {"", kMalformed, ""};
    default:
      return {"", kUnsupportedContent, "", Content::kNone};
  }
}

}  // namespace

Outgoing Wrong::Next(std::int64_t now_ms, Account& account) {
  return Make(random_.Below(kWaysToBeWrong), now_ms, account);
}

Outgoing Wrong::Make(std::size_t way, std::int64_t now_ms, Account& account) {
  constexpr std::size_t kDurableWays = 8;
  const model::Fault fault = faults_.Sample({now_ms, 0});
  Made made = way < kDurableWays ? MakeDurable(way, now_ms, fault) : MakeOther(way, now_ms, fault);
  const std::uint64_t tag = account.EnterWrong(made.reason, std::move(made.field));
  return {Keeping::kDurable, made.content, std::move(made.payload), tag};
}

}  // namespace uplink::synthetic
