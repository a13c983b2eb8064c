#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "storage/access_store.h"
#include "uplink/v1/admin.pb.h"

// What the fields of a command may hold. Errors: kInvalidArgument, whose message begins with the
// field's JSON name. Pure; any thread.
namespace uplink::admin {

/// A text of a person: well-formed UTF-8 of at most `bytes_max` bytes, which may be empty.
[[nodiscard]] absl::Status CheckText(std::string_view field, std::string_view text,
                                     std::size_t bytes_max);
[[nodiscard]] absl::Status CheckRuri(std::string_view ruri);
/// Names are of letters, digits and `._/-`, so that `label=NAME=VALUE` reads one way.
[[nodiscard]] absl::Status CheckLabels(
    const google::protobuf::Map<std::string, std::string>& labels);
/// `field`, within 1 to kPageSizeMax; 0 is kPageSizeDefault.
[[nodiscard]] absl::StatusOr<std::uint32_t> PageSizeOf(std::int32_t page_size);
/// The version in a page's token, 0 in an empty one; nothing if it is none.
[[nodiscard]] std::optional<storage::AccessVersion> VersionOf(const std::string& token);

/// The one thing that a request names, as the store keeps it: hexadecimal is taken in any case, and
/// with colons; a serial and an issuer with the word that `openssl x509` prints before them.
template <typename Request>
[[nodiscard]] absl::StatusOr<storage::Revocation> RevocationOf(const Request& request);
extern template absl::StatusOr<storage::Revocation> RevocationOf(
    const v1::RevokeCertificateRequest& request);
extern template absl::StatusOr<storage::Revocation> RevocationOf(
    const v1::UnrevokeCertificateRequest& request);

}  // namespace uplink::admin
