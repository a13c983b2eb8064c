#include "server/front/call/admittance.h"

#include <utility>

#include "server/front/call/thread.h"

namespace uplink::front {

absl::Status Admittance::Enter(const absl::StatusOr<identity::PeerIdentity>& peer,
                               transport::Admission admission) {
  transport::Entrant entrant = peer.ok() ? transport::EntrantOf(*peer) : transport::Entrant();
  if (absl::Status in = thread_.gate.Enter(entrant, admission); !in.ok()) {
    thread_.book.TellRefusal(in, origin_, thread_.clock.Steady());
    return in;
  }
  entrant_ = std::move(entrant);
  admission_ = admission;
  return absl::OkStatus();
}

void Admittance::NoteAnswered() {
  if (entrant_ && !std::exchange(answered_, true)) thread_.book.known().Enter(origin_.source);
}

void Admittance::Leave() {
  if (!entrant_) return;
  if (answered_) thread_.book.known().Leave(origin_.source, thread_.clock.Steady());
  thread_.gate.Leave(*std::exchange(entrant_, std::nullopt), admission_);
}

}  // namespace uplink::front
