#pragma once

#include <string>
#include <vector>

#include <absl/status/statusor.h>

namespace uplink::pki {

/// Days that a certificate is valid unless the caller says otherwise.
inline constexpr int kDaysDefault = 365;
inline constexpr int kAuthorityDaysDefault = 3650;
inline constexpr int kDaysMax = 36'500;
/// Host names in one server certificate.
inline constexpr std::size_t kHostsMax = 64;
/// Robots that one gateway certificate may speak for.
inline constexpr std::size_t kGatewayRobotsMax = 256;

/// What a certificate says of its holder: the profile that the server reads identities from. Only
/// the functions below make one, so a Profile is always one that the server understands. A value.
struct Profile {
  /// For people; never an identity.
  std::string common_name;
  /// O: the fleet; empty for a server.
  std::string organization;
  /// OU: the role; empty for robots and servers.
  std::string organizational_unit;
  /// Subject alternative names in OpenSSL's spelling: `DNS:...`, `IP:...`, `URI:...`.
  std::vector<std::string> alternative_names;
  /// serverAuth instead of clientAuth.
  bool server = false;
};

/// `hosts`: DNS names and IP addresses that clients dial, 1 to kHostsMax.
/// Errors: kInvalidArgument names the value, for this and the functions below.
[[nodiscard]] absl::StatusOr<Profile> ServerProfile(const std::vector<std::string>& hosts);

/// `ruri` begins with `rcan://`, has at most 256 bytes and is no twin's; `name` is for people.
[[nodiscard]] absl::StatusOr<Profile> RobotProfile(const std::string& ruri,
                                                   const std::string& fleet,
                                                   const std::string& name);

/// `ruris` are the robots that the gateway may speak for; none: every robot of the fleet.
[[nodiscard]] absl::StatusOr<Profile> GatewayProfile(const std::vector<std::string>& ruris,
                                                     const std::string& fleet,
                                                     const std::string& name);

/// `role` is viewer, operator, admin or metrics; `fleet` may be `*` for all fleets.
[[nodiscard]] absl::StatusOr<Profile> OperatorProfile(const std::string& role,
                                                      const std::string& fleet,
                                                      const std::string& name);

}  // namespace uplink::pki
