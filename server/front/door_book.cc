#include "server/front/door_book.h"

#include "server/transport/refusals.h"

namespace uplink::front {

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
  const std::string_view event = transport::RefusalEvent(status, origin.gateway);
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
