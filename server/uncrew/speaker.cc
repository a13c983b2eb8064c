#include "server/uncrew/speaker.h"

#include <optional>
#include <string>

#include <fmt/format.h>

#include "schema/base/utf8.h"
#include "server/identity/ruri.h"
#include "server/identity/uav_ruri.h"

namespace uplink::uncrew {
namespace {

/// Bytes of an id that an error's text repeats.
constexpr std::size_t kShownBytesMax = 128;

absl::Status MayNot(std::string_view who, std::string_view uav_id) {
  return absl::PermissionDeniedError(
      fmt::format("the certificate of {} may not speak for metadata.uav_id {}",
                  PrintableUtf8(who, kShownBytesMax), PrintableUtf8(uav_id, kShownBytesMax)));
}

/// Whether the id names the drone with this RURI: it is the RURI, its last segment, or makes it by
/// the template.
bool Names(std::string_view uav_id, std::string_view ruri, std::string_view ruri_template) {
  return uav_id == ruri || identity::UavRuri(ruri_template, uav_id) == ruri ||
         ruri.substr(ruri.rfind('/') + 1) == uav_id;
}

}  // namespace

absl::StatusOr<fleet::Claim> SpeakerOf(const identity::PeerIdentity& peer, std::string_view uav_id,
                                       std::string_view ruri_template) {
  if (peer.role == identity::Role::kRobot) {
    if (!uav_id.empty() && !Names(uav_id, peer.ruri, ruri_template)) {
      return MayNot(peer.ruri, uav_id);
    }
    return fleet::Claim{.robot = {.ruri = peer.ruri, .fleet = peer.fleet}, .bounds = peer.bounds};
  }
  if (uav_id.empty()) {
    return absl::PermissionDeniedError(
        "a gateway must name the drone that it speaks for: metadata.uav_id is empty");
  }
  std::string ruri = uav_id.starts_with(identity::kRuriScheme)
                         ? std::string(uav_id)
                         : identity::UavRuri(ruri_template, uav_id);
  const identity::Gateway& gateway = peer.gateway;
  const std::optional<std::string> flaw = identity::FlawOfRuri(ruri);
  if (flaw || identity::NamesTwin(ruri) || !gateway.MaySpeakFor(ruri)) {
    absl::Status why = MayNot("gateway " + gateway.subject, uav_id);
    return absl::PermissionDeniedError(fmt::format(
        "{}: uncrew.ruri_template makes it {}{}", std::string(why.message()),
        PrintableUtf8(ruri, kShownBytesMax), flaw ? ", which is no RURI: " + *flaw : ""));
  }
  return fleet::Claim{.robot = {.ruri = std::move(ruri), .fleet = peer.fleet},
                      .grant = gateway.ruris.empty() ? fleet::Grant::kFleet : fleet::Grant::kNamed,
                      .gateway = gateway.subject,
                      .bounds = peer.bounds};
}

}  // namespace uplink::uncrew
