#include "server/cyberwave/commit_content.h"

#include <utility>
#include <variant>

#include "schema/cyberwave/records.h"

namespace uplink::cyberwave {
namespace {

/// One overload for each kind of record.
struct ToContent {
  std::size_t payload_bytes;

  storage::CommitContent operator()(EventRecord&& event) const {
    return Records::Of(
        model::EventTelemetry{
            .unix_time_ms = event.unix_time_ms,
            .kind = model::NamedEvent{std::move(event.kind), std::move(event.detail_json)}},
        payload_bytes);
  }
  storage::CommitContent operator()(LogRecord&& log) const {
    log.message.detail_json = std::move(log.detail_json);
    return Records::Of(std::move(log.message), payload_bytes);
  }
  storage::CommitContent operator()(model::MissionRunStatus&& run) const {
    return Records::Of(std::move(run), payload_bytes);
  }
  storage::CommitContent operator()(model::Fault&& fault) const {
    return Records::Of(std::move(fault), payload_bytes);
  }
  storage::CommitContent operator()(ScopeRecord&& scope) const {
    return model::ScopeUpdate{.scope = scope.update.scope,
                              .id = scope.id.ToText(),
                              .type = std::move(scope.update.type),
                              .detail_json = std::move(scope.update.detail),
                              .unix_time_ms = scope.unix_time_ms};
  }
};

}  // namespace

storage::CommitContent CommitContentOf(DurableRecord&& record, std::size_t payload_bytes) {
  return std::visit(ToContent{payload_bytes}, std::move(record));
}

}  // namespace uplink::cyberwave
