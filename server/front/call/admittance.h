#pragma once

#include <optional>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/front/door/origin.h"
#include "server/identity/peer_identity.h"
#include "server/transport/gate.h"

namespace uplink::front {

struct Thread;

/// The places that one call takes: in transport::Gate, where a drain waits for it, and, once it was
/// answered, among KnownSources. The destructor gives them back.
///
/// Thread: confined to its connection's.
class Admittance final {
 public:
  Admittance(Thread& thread, const Origin& origin) : thread_(thread), origin_(origin) {}
  ~Admittance() { Leave(); }
  Admittance(const Admittance&) = delete;
  Admittance& operator=(const Admittance&) = delete;

  /// Call once. `peer`: not OK for a caller of an open method. Errors: those of
  /// transport::Gate::Enter, which are logged.
  [[nodiscard]] absl::Status Enter(const absl::StatusOr<identity::PeerIdentity>& peer,
                                   transport::Admission admission);
  /// A message of ours went out.
  void NoteAnswered();
  /// Idempotent.
  void Leave();

 private:
  Thread& thread_;
  const Origin& origin_;
  transport::Admission admission_ = transport::Admission::kStream;
  /// Set while it has a place.
  std::optional<transport::Entrant> entrant_;
  bool answered_ = false;
};

}  // namespace uplink::front
