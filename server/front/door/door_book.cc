#include "server/front/door/door_book.h"

namespace uplink::front {
namespace {

/// The event for a stream that ends with this status: `stream_refused`, or `protocol_error` if it
/// broke a rule of the protocol. For a stream through `gateway` also `stream_superseded`, since two
/// speakers for one robot are hard to find. Empty for other ends.
std::string_view RefusalEvent(const absl::Status& status, std::string_view gateway) {
  if (absl::IsAborted(status) && !gateway.empty()) return "stream_superseded";
  if (absl::IsInvalidArgument(status)) return "protocol_error";
  const bool refused = absl::IsUnauthenticated(status) || absl::IsPermissionDenied(status) ||
                       absl::IsResourceExhausted(status);
  return refused ? "stream_refused" : "";
}

}  // namespace

void DoorBook::Note(transport::TurnedAway cause, const Origin& origin, SteadyTime now) {
  Note(cause, {}, origin, now);
}

void DoorBook::Note(transport::TurnedAway cause, std::string_view detail, const Origin& origin,
                    SteadyTime now) {
  if (origin.health_check) return;
  const auto index = static_cast<std::size_t>(cause);
  probe_.turned_away_total[index].Add();
  const std::string_view why = transport::kTurnedAwayTexts[index];
  std::string text(why);
  if (!detail.empty()) text.append(": ").append(detail);
  Tell("connection_turned_away", why, text, origin, now);
}

void DoorBook::NoteRequest(const std::string& why, const Origin& origin, SteadyTime now) {
  probe_.refused_request_total.Add();
  Tell("stream_refused", "request", why, origin, now);
}

void DoorBook::TellFailure(const absl::Status& status, const Origin& origin, SteadyTime now) {
  if (!absl::IsInternal(status)) return TellRefusal(status, origin, now);
  Tell("protocol_error", "message", std::string(status.message()), origin, now);
}

void DoorBook::TellRefusal(const absl::Status& status, const Origin& origin, SteadyTime now) {
  const std::string_view event = RefusalEvent(status, origin.gateway);
  if (!event.empty()) Tell(event, event, std::string(status.message()), origin, now);
}

void DoorBook::NoteFailedHandshake(transport::TurnedAway cause, std::string_view detail,
                                   const Origin& origin, SteadyTime now) {
  if (!origin.health_check) probe_.handshakes_failed_total.Add();
  Note(cause, detail, origin, now);
}

bool DoorBook::Enter() {
  if (connections_.fetch_add(1) >= limits_.connections_max) {
    connections_.fetch_sub(1);
    return false;
  }
  probe_.connections.Add();
  return true;
}

void DoorBook::Leave() {
  connections_.fetch_sub(1);
  probe_.connections.Add(-1);
}

}  // namespace uplink::front
