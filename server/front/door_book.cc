#include "server/front/door_book.h"

namespace uplink::front {

void DoorBook::Note(transport::TurnedAway cause, const Origin& origin, SteadyTime now) {
  if (origin.health_check) return;
  const auto index = static_cast<std::size_t>(cause);
  probe_.turned_away_total[index].Add();
  Tell("connection_turned_away", transport::kTurnedAwayTexts[index], origin, now);
}

void DoorBook::NoteFailedHandshake(transport::TurnedAway cause, const Origin& origin,
                                   SteadyTime now) {
  if (!origin.health_check) probe_.handshakes_failed_total.Add();
  Note(cause, origin, now);
}

bool DoorBook::Enter() {
  if (connections_.fetch_add(1) >= limits_.connections_max) {
    connections_.fetch_sub(1);
    return false;
  }
  probe_.connections.Add();
  return true;
}

bool DoorBook::BeginLinger() {
  if (lingers_.fetch_add(1) < limits_.lingers_max) return true;
  lingers_.fetch_sub(1);
  return false;
}

void DoorBook::Leave() {
  connections_.fetch_sub(1);
  probe_.connections.Add(-1);
}

}  // namespace uplink::front
