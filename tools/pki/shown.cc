#include "tools/pki/shown.h"

#include <cstddef>
#include <cstdint>

#include <fmt/core.h>

#include "server/identity/certificate_gate.h"

namespace uplink::pki {
namespace {

/// Three bytes, the first of most weight.
void AddLength(std::size_t length, std::vector<std::uint8_t>& message) {
  for (const unsigned shift : {16U, 8U, 0U}) {
    message.push_back(static_cast<std::uint8_t>(length >> shift));
  }
}

}  // namespace

absl::Status CheckShown(const std::vector<std::string>& certificates) {
  // The body of TLS 1.3's message, which is longer than that of 1.2 (RFC 8446, 4.4.2).
  std::vector<std::uint8_t> list;
  for (const std::string& certificate : certificates) {
    AddLength(certificate.size(), list);
    list.insert(list.end(), certificate.begin(), certificate.end());
    list.insert(list.end(), {0, 0});
  }
  std::vector<std::uint8_t> message = {0};
  AddLength(list.size(), message);
  message.insert(message.end(), list.begin(), list.end());
  const auto flaw = identity::FlawOfMessage(identity::MessageForm::kTls13, message);
  if (flaw == identity::CertificateFlaw::kNone) return absl::OkStatus();
  if (flaw == identity::CertificateFlaw::kBytes) {
    return absl::InvalidArgumentError(fmt::format(
        "the certificate and its authority's would have {} bytes, and the relay takes at most {}: "
        "name fewer robots in one certificate",
        message.size(), identity::kShownBytesMax));
  }
  return absl::InvalidArgumentError(
      fmt::format("the relay takes neither the certificate nor another of its authority: {}",
                  identity::TextOf(flaw)));
}

}  // namespace uplink::pki
