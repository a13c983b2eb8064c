#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/statusor.h>
#include <openssl/types.h>

namespace uplink::identity {

/// What a certificate's subject says its holder is (protocol: Certificates). Closed.
enum class Role : std::uint8_t { kRobot, kGateway, kViewer, kOperator, kAdmin };

[[nodiscard]] std::string_view ToText(Role role);

/// Bytes of a subject that are kept; a longer one is cut.
inline constexpr std::size_t kSubjectBytesMax = 256;

/// Who stands behind a verified client certificate. Immutable after it was made.
struct PeerIdentity {
  Role role = Role::kRobot;
  /// Subject O; `default` if the certificate has none. `*` for operators that may see all fleets.
  std::string fleet;
  /// The RURIs of the certificate: exactly one for a robot, none or several for a gateway, none for
  /// the others.
  std::vector<std::string> ruris;
  /// Of a gateway, whom its robots, bounds and log lines name: the subject of its certificate, at
  /// most kSubjectBytesMax. Empty of all others.
  std::string subject = {};

  /// A gateway may speak for this robot of its fleet: its certificate names the robot, or none.
  [[nodiscard]] bool MaySpeakFor(std::string_view ruri) const {
    return ruris.empty() || Names(ruri);
  }
  /// The certificate names this robot.
  [[nodiscard]] bool Names(std::string_view ruri) const {
    return std::ranges::find(ruris, ruri) != ruris.end();
  }
  /// The RURI of a robot's certificate.
  [[nodiscard]] const std::string& ruri() const { return ruris.front(); }
};

/// Reads the identity of certificates that the TLS layer has verified.
///
/// OpenSSL 3.0 looks for a decoder of the public key whenever it reads a certificate: 92 of 114 us
/// (measured). Nobody here wants the key, so they are read in a library context that has none.
///
/// Thread: any.
class PeerReader final {
 public:
  PeerReader();
  ~PeerReader();
  PeerReader(const PeerReader&) = delete;
  PeerReader& operator=(const PeerReader&) = delete;

  /// Errors: kUnauthenticated with a sentence of its own for each way to be wrong; it repeats no
  ///         more of the certificate than the invalid part, printable and cut.
  [[nodiscard]] absl::StatusOr<PeerIdentity> IdentityOf(std::string_view certificate_pem) const;
  /// The same of one that the TLS layer holds. Reading its extensions caches them in it.
  [[nodiscard]] static absl::StatusOr<PeerIdentity> IdentityOf(X509& certificate);
  /// The subject as one line (RFC 2253), at most kSubjectBytesMax; empty if the library cannot
  /// print it.
  [[nodiscard]] static std::string SubjectOf(const X509& certificate);

 private:
  struct Library;
  std::unique_ptr<Library> library_;
};

}  // namespace uplink::identity
