#include "tests/chaos/script.h"

#include <array>

#include "schema/encode.h"
#include "schema/limits.h"
#include "schema/model/record.h"

namespace uplink::chaos {
namespace {

constexpr std::int64_t kTimeMs = 1'763'683'200'000;

model::Fault FaultOf(model::Seq seq, bool active) {
  model::Fault fault;
  fault.unix_time_ms = kTimeMs;
  fault.fault_id = "CHAOS";
  fault.source = "script";
  fault.active = active;
  fault.description = std::to_string(seq);
  return fault;
}

model::Message MessageOf(std::string text) {
  model::Message message;
  message.unix_time_ms = kTimeMs;
  message.message = std::move(text);
  return message;
}

model::Body BodyOf(model::Seq seq) {
  switch (StepOf(seq)) {
    case Step::kEvent: {
      model::EventTelemetry event;
      event.unix_time_ms = kTimeMs;
      return event;
    }
    case Step::kMessage:
    case Step::kNote:
      return MessageOf(std::to_string(seq));
    case Step::kRaise:
      return FaultOf(seq, true);
    case Step::kClear:
      return FaultOf(seq, false);
    case Step::kMissionReport: {
      model::MissionRunStatus report;
      report.unix_time_ms = kTimeMs;
      report.mission_id = "mission";
      report.run_id = "run";
      report.status_message = std::to_string(seq);
      return report;
    }
    case Step::kWrong:
      return MessageOf(std::string(schema::kMessageTextBytesMax + 1, 'w'));
    case Step::kMotion: {
      model::MotionTelemetry motion;
      motion.unix_time_ms = kTimeMs;
      return motion;
    }
  }
  return model::MotionTelemetry{};
}

}  // namespace

std::string PayloadOf(model::Seq seq) { return schema::Encode(BodyOf(seq)); }

model::SessionId SessionOf(std::uint64_t seed, std::uint32_t robot) {
  constexpr unsigned kBitsPerByte = 8;
  constexpr std::size_t kSeedBytes = 8;
  std::array<std::uint8_t, model::SessionId::kBytes> bytes{};
  for (std::size_t i = 0; i < kSeedBytes; ++i) {
    bytes[i] = static_cast<std::uint8_t>(seed >> (kBitsPerByte * i));
  }
  for (std::size_t i = 0; i < sizeof(robot); ++i) {
    bytes[kSeedBytes + i] = static_cast<std::uint8_t>(robot >> (kBitsPerByte * i));
  }
  return model::SessionId(bytes);
}

}  // namespace uplink::chaos
