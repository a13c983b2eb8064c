#include "schema/cyberwave/records.h"

#include <cstdint>
#include <utility>

namespace uplink::cyberwave {
namespace {

using model::cyberwave::LogLevel;

model::MessageLevel LevelOf(LogLevel level) {
  switch (level) {
    case LogLevel::kUnknown:
    case LogLevel::kDebug:
    case LogLevel::kInfo:
      return model::MessageLevel::kInfo;
    case LogLevel::kWarning:
      return model::MessageLevel::kWarn;
    case LogLevel::kError:
    case LogLevel::kCritical:
      return model::MessageLevel::kError;
  }
  return model::MessageLevel::kInfo;
}

std::int64_t SampledMs(const model::cyberwave::Head& head) {
  constexpr std::int64_t kMicrosPerMilli = 1'000;
  return head.timestamp_us / kMicrosPerMilli;
}

}  // namespace

model::Record Records::Of(model::cyberwave::DriverLog log, const model::cyberwave::Head& head,
                          std::size_t payload_bytes) {
  model::Message message{.unix_time_ms = SampledMs(head),
                         .level = LevelOf(log.level),
                         .message = std::move(log.message),
                         .detail_json = std::move(log.detail)};
  return Of(std::move(message), payload_bytes);
}

model::Record Records::Of(model::EventTelemetry event, std::size_t payload_bytes) {
  return {std::move(event), {}, {}, payload_bytes};
}

model::Record Records::Of(model::Message message, std::size_t payload_bytes) {
  return {std::move(message), {}, {}, payload_bytes};
}

model::Record Records::Of(model::MissionRunStatus run, std::size_t payload_bytes) {
  return {std::move(run), {}, {}, payload_bytes};
}

model::Record Records::Of(model::Fault fault, std::size_t payload_bytes) {
  return {std::move(fault), {}, {}, payload_bytes};
}

model::ScopeUpdate Records::Of(model::cyberwave::ScopeUpdate update,
                               const model::cyberwave::Uuid& id,
                               const model::cyberwave::Head& head) {
  return {.scope = update.scope,
          .id = id.ToText(),
          .type = std::move(update.type),
          .detail_json = std::move(update.detail),
          .unix_time_ms = SampledMs(head)};
}

}  // namespace uplink::cyberwave
