#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

#include "schema/base/clock.h"

namespace uplink::storage {

/// Bytes of each text of an audit row; a longer one is cut at a character.
inline constexpr std::size_t kAuditTextBytesMax = 512;

/// How an operator showed who it is. Closed; stored by number.
enum class AuditProof : std::uint8_t {
  /// A caller on this machine, where no proof is asked for.
  kLocal = 0,
  kToken = 1,
  kCertificate = 2,
  /// A program on the store's machine: uplinkctl --config.
  kStore = 3,
  /// The server itself: it started, stopped, took over a file.
  kServer = 4,
};

/// One change that an operator or the server made, or tried to. A value.
struct AuditRow {
  SystemTime at;
  AuditProof proof = AuditProof::kServer;
  /// The id of its token, the subject of its certificate, the user of the program, or the server.
  std::string who;
  /// Its address, or the machine of the program; empty: this machine.
  std::string from;
  /// One of the words in docs/reference/: `robot_block`, `certificate_revoke`, `reload`.
  std::string action;
  /// The RURI, certificate, key or file that it was about; empty: the server.
  std::string target;
  /// The fleet that the target had; empty: it belongs to none.
  std::string fleet;
  /// `ok`, or the name of the gRPC status with which it was refused.
  std::string outcome;
  /// What was given with it: a reason, a note, keys.
  std::string detail;

  friend bool operator==(const AuditRow&, const AuditRow&) = default;
};

}  // namespace uplink::storage
