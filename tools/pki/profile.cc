#include "tools/pki/profile.h"

#include <algorithm>
#include <string_view>

#include <arpa/inet.h>
#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "schema/cyberwave/ruri.h"
#include "schema/model/ids.h"
#include "server/identity/fleet_name.h"
#include "server/identity/peer_identity.h"

namespace uplink::pki {
namespace {

constexpr std::string_view kRuriScheme = "rcan://";
/// Upper bounds of X.520 for common name, organization and organizational unit.
constexpr std::size_t kNameBytesMax = 64;
/// Longest DNS name (RFC 1035).
constexpr std::size_t kHostBytesMax = 253;

absl::Status Bad(const std::string& text) { return absl::InvalidArgumentError(text); }

absl::Status CheckName(std::string_view what, std::string_view text) {
  if (text.empty() || text.size() > kNameBytesMax || !IsCleanUtf8(text)) {
    return Bad(fmt::format("{} \"{}\": it must be 1 to {} bytes of UTF-8 text", what,
                           PrintableUtf8(text, kNameBytesMax), kNameBytesMax));
  }
  return absl::OkStatus();
}

absl::Status CheckFleet(std::string_view fleet) {
  if (absl::Status status = CheckName("fleet", fleet); !status.ok()) return status;
  const auto flaw = identity::FlawOfNewFleet(fleet);
  if (!flaw) return absl::OkStatus();
  return Bad(fmt::format("fleet \"{}\": it {}", PrintableUtf8(fleet, kNameBytesMax), *flaw));
}

/// A fleet that robots are in.
absl::Status CheckOneFleet(std::string_view fleet) {
  if (fleet != identity::kAllFleets) return CheckFleet(fleet);
  return Bad(fmt::format("fleet \"{}\": only operators may have all fleets", fleet));
}

/// A URI in a certificate is ASCII, and a comma would end it in OpenSSL's list of names.
bool FitsNameList(std::string_view text) {
  return std::all_of(text.begin(), text.end(),
                     [](char c) { return c > ' ' && c < '\x7f' && c != ','; });
}

absl::Status CheckRuri(std::string_view ruri) {
  if (ruri.size() <= kRuriScheme.size() || ruri.size() > model::kRuriBytesMax ||
      ruri.substr(0, kRuriScheme.size()) != kRuriScheme || !FitsNameList(ruri)) {
    return Bad(
        fmt::format("RURI \"{}\": it must begin with rcan://, have at most {} bytes and hold "
                    "printable ASCII without comma and space only",
                    PrintableUtf8(ruri, model::kRuriBytesMax), model::kRuriBytesMax));
  }
  if (cyberwave::IsTwinRuri(ruri)) {
    return Bad(
        fmt::format("RURI \"{}\": it is a twin's, which the relay refuses: twins are heard "
                    "through their broker alone",
                    ruri));
  }
  return absl::OkStatus();
}

bool IsAddress(const std::string& host) {
  unsigned char bytes[sizeof(in6_addr)];
  return inet_pton(AF_INET, host.c_str(), bytes) == 1 ||
         inet_pton(AF_INET6, host.c_str(), bytes) == 1;
}

bool IsDnsName(std::string_view host) {
  return !host.empty() && host.size() <= kHostBytesMax &&
         std::all_of(host.begin(), host.end(), [](char c) {
           return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') ||
                  c == '.' || c == '-' || c == '_' || c == '*';
         });
}

}  // namespace

absl::StatusOr<Profile> ServerProfile(const std::vector<std::string>& hosts) {
  if (hosts.empty() || hosts.size() > kHostsMax) {
    return Bad(fmt::format("a server needs 1 to {} hosts, not {}", kHostsMax, hosts.size()));
  }
  Profile profile;
  profile.server = true;
  for (const std::string& host : hosts) {
    if (IsAddress(host)) {
      profile.alternative_names.push_back("IP:" + host);
    } else if (IsDnsName(host)) {
      profile.alternative_names.push_back("DNS:" + host);
    } else {
      return Bad(fmt::format("host \"{}\": it is neither a DNS name nor an IP address",
                             PrintableUtf8(host, kHostBytesMax)));
    }
  }
  profile.common_name = hosts.front().substr(0, kNameBytesMax);
  return profile;
}

absl::StatusOr<Profile> RobotProfile(const std::string& ruri, const std::string& fleet,
                                     const std::string& name) {
  for (const absl::Status& status :
       {CheckRuri(ruri), CheckOneFleet(fleet), CheckName("name", name)}) {
    if (!status.ok()) return status;
  }
  Profile profile;
  profile.common_name = name;
  profile.organization = fleet;
  profile.alternative_names.push_back("URI:" + ruri);
  return profile;
}

absl::StatusOr<Profile> GatewayProfile(const std::vector<std::string>& ruris,
                                       const std::string& fleet, const std::string& name) {
  if (ruris.size() > kGatewayRobotsMax) {
    return Bad(fmt::format("a gateway may name at most {} robots, not {}", kGatewayRobotsMax,
                           ruris.size()));
  }
  for (const absl::Status& status : {CheckOneFleet(fleet), CheckName("name", name)}) {
    if (!status.ok()) return status;
  }
  Profile profile;
  profile.common_name = name;
  profile.organization = fleet;
  profile.organizational_unit = "gateway";
  for (const std::string& ruri : ruris) {
    if (absl::Status status = CheckRuri(ruri); !status.ok()) return status;
    profile.alternative_names.push_back("URI:" + ruri);
  }
  return profile;
}

absl::StatusOr<Profile> OperatorProfile(const std::string& role, const std::string& fleet,
                                        const std::string& name) {
  if (!identity::AskingRoleOf(role)) {
    return Bad(fmt::format("role \"{}\": it must be viewer, operator, admin or metrics",
                           PrintableUtf8(role, kNameBytesMax)));
  }
  for (const absl::Status& status : {CheckFleet(fleet), CheckName("name", name)}) {
    if (!status.ok()) return status;
  }
  Profile profile;
  profile.common_name = name;
  profile.organization = fleet;
  profile.organizational_unit = role;
  return profile;
}

}  // namespace uplink::pki
