#include "schema/cyberwave/records.h"

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>

#include "schema/base/one_of.h"

namespace uplink::cyberwave {
namespace {

namespace cw = model::cyberwave;

constexpr std::int64_t kUsPerMs = 1000;
constexpr double kProgressAPercent = 100;

model::MessageLevel LevelOf(cw::LogLevel level) {
  switch (level) {
    case cw::LogLevel::kUnknown:
    case cw::LogLevel::kDebug:
    case cw::LogLevel::kInfo:
      return model::MessageLevel::kInfo;
    case cw::LogLevel::kWarning:
      return model::MessageLevel::kWarn;
    case cw::LogLevel::kError:
    case cw::LogLevel::kCritical:
      return model::MessageLevel::kError;
  }
  return model::MessageLevel::kInfo;
}

/// The text that people read about a run: with the vendor's word if ours does not say it.
std::optional<std::string> TextOf(cw::RunStatus&& run) {
  if (run.status != model::MissionStatus::kUnknown) {
    if (run.message.empty()) return std::nullopt;
    return std::move(run.message);
  }
  if (run.message.empty()) return std::move(run.status_text);
  return run.status_text + ": " + run.message;
}

/// What a record of a robot says; one overload for each durable body of one.
struct ToBody {
  std::int64_t unix_time_ms;

  std::optional<model::Body> operator()(cw::Mark&& mark) const {
    return EventOf(cw::ToText(mark.kind), std::move(mark.detail));
  }
  std::optional<model::Body> operator()(cw::Event&& event) const {
    return EventOf(event.type, std::move(event.detail));
  }
  std::optional<model::Body> operator()(cw::DriverLog&& log) const {
    return model::Message{.unix_time_ms = unix_time_ms,
                          .level = LevelOf(log.level),
                          .message = std::move(log.message),
                          .detail_json = std::move(log.detail)};
  }
  std::optional<model::Body> operator()(cw::RunStatus&& run) const {
    model::MissionRunStatus status;
    status.unix_time_ms = unix_time_ms;
    status.run_id = std::move(run.run_id);
    status.status = run.status;
    if (run.progress_percent) {
      status.progress_x100 =
          static_cast<std::uint16_t>(std::lround(*run.progress_percent * kProgressAPercent));
    }
    if (run.current_step && *run.current_step <= std::numeric_limits<std::uint32_t>::max()) {
      status.current_step = static_cast<std::uint32_t>(*run.current_step);
    }
    status.status_message = TextOf(std::move(run));
    return status;
  }
  /// Live, counted, or of no robot.
  template <OneOf<cw::Ignored, cw::Position, cw::Rotation, cw::Scale, cw::Joints, cw::Metrics,
                  cw::EdgeHealth, cw::Gps, cw::BatteryStatus, cw::Report, cw::ScopeUpdate,
                  cw::CommandHead, cw::Commanded, cw::Signalling, cw::Media, cw::Ping>
                Other>
  std::optional<model::Body> operator()(Other&& /*body*/) const {
    return std::nullopt;
  }

 private:
  [[nodiscard]] model::Body EventOf(std::string_view type, std::string&& detail) const {
    return model::EventTelemetry{
        .unix_time_ms = unix_time_ms,
        .kind = model::NamedEvent{.kind = std::string(kEventPrefix).append(type),
                                  .detail_json = std::move(detail)}};
  }
};

}  // namespace

std::optional<DurableRecord> Records::Take(Judgement& judgement) {
  auto* body = std::get_if<cw::Body>(&judgement.verdict);
  if (body == nullptr) return std::nullopt;
  const std::int64_t unix_time_ms = judgement.head.timestamp_us / kUsPerMs;
  if (auto* update = std::get_if<cw::ScopeUpdate>(body)) {
    return model::ScopeUpdate{.scope = update->scope,
                              .id = judgement.topic.id.ToText(),
                              .type = std::move(update->type),
                              .detail_json = std::move(update->detail),
                              .unix_time_ms = unix_time_ms};
  }
  std::optional<model::Body> said = std::visit(ToBody{unix_time_ms}, std::move(*body));
  if (!said) return std::nullopt;
  return model::Record(*std::move(said), {}, {}, judgement.payload_bytes);
}

DurableRecord Records::Of(model::Fault fault, std::size_t payload_bytes) {
  return model::Record(std::move(fault), {}, {}, payload_bytes);
}

}  // namespace uplink::cyberwave
