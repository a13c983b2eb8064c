#include "server/cyberwave/records.h"

#include <cmath>
#include <limits>
#include <utility>

namespace uplink::cyberwave {
namespace {

namespace cw = model::cyberwave;

constexpr std::int64_t kUsPerMs = 1000;
constexpr double kProgressAPercent = 100;

std::string KindOf(std::string_view type) { return std::string(kEventPrefix).append(type); }

/// What people are told of a run: the vendor's word too, if ours does not say it.
std::optional<std::string> TextOf(cw::RunStatus&& run) {
  if (run.status != model::MissionStatus::kUnknown) {
    if (run.message.empty()) return std::nullopt;
    return std::move(run.message);
  }
  if (run.message.empty()) return std::move(run.status_text);
  return run.status_text + ": " + run.message;
}

/// One overload for each durable body; nothing for the others.
struct ToRecord {
  std::int64_t unix_time_ms;
  cw::Uuid id;

  std::optional<DurableRecord> operator()(cw::Mark&& mark) const {
    return EventRecord{unix_time_ms, KindOf(cw::ToText(mark.kind)), std::move(mark.detail)};
  }
  std::optional<DurableRecord> operator()(cw::Event&& event) const {
    return EventRecord{unix_time_ms, KindOf(event.type), std::move(event.detail)};
  }
  std::optional<DurableRecord> operator()(cw::DriverLog&& log) const {
    return LogRecord{{.unix_time_ms = unix_time_ms,
                      .level = MessageLevelOf(log.level),
                      .message = std::move(log.message)},
                     std::move(log.detail)};
  }
  std::optional<DurableRecord> operator()(cw::RunStatus&& run) const {
    model::MissionRunStatus record;
    record.unix_time_ms = unix_time_ms;
    record.run_id = std::move(run.run_id);
    record.status = run.status;
    if (run.progress_percent) {
      record.progress_x100 =
          static_cast<std::uint16_t>(std::lround(*run.progress_percent * kProgressAPercent));
    }
    if (run.current_step && *run.current_step <= std::numeric_limits<std::uint32_t>::max()) {
      record.current_step = static_cast<std::uint32_t>(*run.current_step);
    }
    record.status_message = TextOf(std::move(run));
    return record;
  }
  std::optional<DurableRecord> operator()(cw::ScopeUpdate&& update) const {
    return ScopeRecord{unix_time_ms, id, std::move(update)};
  }
  template <typename Other>
  std::optional<DurableRecord> operator()(Other&& /*live or counted*/) const {
    return std::nullopt;
  }
};

}  // namespace

model::MessageLevel MessageLevelOf(cw::LogLevel level) {
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

std::optional<DurableRecord> TakeRecord(Judgement& judgement) {
  auto* body = std::get_if<cw::Body>(&judgement.verdict);
  if (body == nullptr) return std::nullopt;
  const ToRecord to_record{judgement.head.timestamp_us / kUsPerMs, judgement.topic.id};
  return std::visit(to_record, std::move(*body));
}

}  // namespace uplink::cyberwave
