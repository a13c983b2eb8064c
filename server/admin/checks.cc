#include "server/admin/checks.h"

#include <algorithm>
#include <charconv>
#include <cstddef>
#include <optional>
#include <string>

#include <fmt/core.h>

#include "schema/base/utf8.h"
#include "server/identity/ruri.h"
#include "server/identity/shown_certificate.h"
#include "storage/reader.h"

namespace uplink::admin {
namespace {

constexpr std::size_t kDigestDigits = 64;
/// Beside a serial and a space.
constexpr std::size_t kIssuerBytesMax =
    storage::kRevokedValueBytesMax - identity::kSerialTextBytesMax - 1;

absl::Status Wrong(std::string_view field, std::string_view what) {
  return absl::InvalidArgumentError(fmt::format("{} {}", field, what));
}

bool IsLetterOrDigit(char c) {
  return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9');
}

bool IsOfLabel(char c) {
  return IsLetterOrDigit(c) || std::string_view("._/-").find(c) != std::string_view::npos;
}

bool IsOneLine(std::string_view text) {
  return CountControls(text) == 0 && text.find_first_of("\t\r\n") == std::string_view::npos;
}

enum class Case : std::uint8_t { kLower, kUpper };

/// Without colons; nothing if it is no hexadecimal.
std::optional<std::string> HexOf(std::string_view text, Case letters) {
  std::string hex;
  for (const char c : text) {
    if (c == ':') continue;
    if (c >= '0' && c <= '9') {
      hex += c;
    } else if ((c >= 'a' && c <= 'f') || (c >= 'A' && c <= 'F')) {
      const int letter = c & ~0x20;
      hex += static_cast<char>(letters == Case::kUpper ? letter : letter | 0x20);
    } else {
      return std::nullopt;
    }
  }
  return hex;
}

/// As certificates' serials are kept: whole bytes, without leading zero bytes.
std::optional<std::string> SerialOf(std::string_view text) {
  std::optional<std::string> hex = HexOf(text, Case::kUpper);
  if (!hex || hex->empty() || hex->size() > identity::kSerialTextBytesMax) return std::nullopt;
  const std::size_t first = hex->find_first_not_of('0');
  if (first == std::string::npos) return "0";
  hex->erase(0, first);
  return hex->size() % 2 == 0 ? *hex : "0" + *hex;
}

/// Without the word that `openssl x509` prints before it.
std::string_view WithoutLabel(std::string_view text, std::string_view label) {
  if (!text.starts_with(label)) return text;
  text.remove_prefix(label.size());
  text.remove_prefix(std::min(text.find_first_not_of(' '), text.size()));
  return text;
}

bool IsOfAttributeType(char c) { return IsLetterOrDigit(c) || c == '.' || c == '-'; }

/// `CN=x` as OpenSSL writes it: no space stands around the sign unless it is escaped.
bool IsAttribute(std::string_view text) {
  const std::size_t sign = text.find('=');
  return sign != std::string_view::npos && sign > 0 &&
         std::ranges::all_of(text.substr(0, sign), IsOfAttributeType) &&
         !text.substr(sign + 1).starts_with(' ');
}

/// Attributes between commas and pluses that no backslash escapes.
bool IsRfc2253Name(std::string_view name) {
  std::size_t begin = 0;
  for (std::size_t i = 0; i < name.size(); ++i) {
    if (name[i] == '\\') {
      ++i;
    } else if (name[i] == ',' || name[i] == '+') {
      if (!IsAttribute(name.substr(begin, i - begin))) return false;
      begin = i + 1;
    }
  }
  return IsAttribute(name.substr(begin));
}

absl::StatusOr<std::string> DigestOf(std::string_view field, std::string_view text) {
  const std::optional<std::string> hex = HexOf(text, Case::kLower);
  if (!hex || hex->size() != kDigestDigits) {
    return Wrong(field, "must be a SHA-256: 64 hexadecimal digits");
  }
  return *hex;
}

}  // namespace

absl::Status CheckText(std::string_view field, std::string_view text, std::size_t bytes_max) {
  if (text.size() > bytes_max) {
    return Wrong(field, fmt::format("must have at most {} bytes", bytes_max));
  }
  if (!IsCleanUtf8(text)) return Wrong(field, "must be text in UTF-8");
  return absl::OkStatus();
}

absl::Status CheckRuri(std::string_view ruri) {
  if (ruri.empty()) return Wrong("ruri", "is missing: name the robot");
  if (const auto flaw = identity::FlawOfRuri(ruri)) return Wrong("ruri", *flaw);
  return absl::OkStatus();
}

absl::Status CheckLabels(const google::protobuf::Map<std::string, std::string>& labels) {
  if (labels.size() > storage::kLabelsMax) {
    return Wrong("labels", fmt::format("must be {} at most", storage::kLabelsMax));
  }
  for (const auto& [name, value] : labels) {
    if (name.empty() || name.size() > storage::kLabelBytesMax ||
        !std::ranges::all_of(name, IsOfLabel)) {
      return Wrong("labels", fmt::format("must have names of 1 to {} letters, digits and ._/-",
                                         storage::kLabelBytesMax));
    }
    if (value.size() > storage::kLabelBytesMax || !IsOneLine(value)) {
      return Wrong("labels", fmt::format("must have values of at most {} bytes of text in one line",
                                         storage::kLabelBytesMax));
    }
  }
  return absl::OkStatus();
}

absl::StatusOr<std::uint32_t> PageSizeOf(std::int32_t page_size) {
  if (page_size == 0) return storage::kPageSizeDefault;
  if (page_size > 0 && static_cast<std::uint32_t>(page_size) <= storage::kPageSizeMax) {
    return static_cast<std::uint32_t>(page_size);
  }
  return Wrong("pageSize", fmt::format("must be a number from 1 to {}", storage::kPageSizeMax));
}

std::optional<storage::AccessVersion> VersionOf(const std::string& token) {
  storage::AccessVersion version = 0;
  if (token.empty()) return version;
  const char* const end = token.data() + token.size();
  const auto [read, error] = std::from_chars(token.data(), end, version);
  if (error != std::errc() || read != end) return std::nullopt;
  return version;
}

template <typename Request>
absl::StatusOr<storage::Revocation> RevocationOf(const Request& request) {
  const bool names_serial = !request.serial().empty() || !request.issuer().empty();
  const int ways =
      int{names_serial} + int{!request.sha256().empty()} + int{!request.key_sha256().empty()};
  if (ways != 1) {
    return Wrong("sha256", "or keySha256, or serial with issuer must be given, one of them alone");
  }
  storage::Revocation revocation;
  if (!names_serial) {
    const bool is_key = !request.key_sha256().empty();
    absl::StatusOr<std::string> digest =
        is_key ? DigestOf("keySha256", request.key_sha256()) : DigestOf("sha256", request.sha256());
    if (!digest.ok()) return digest.status();
    revocation.by = is_key ? storage::RevokedBy::kKey : storage::RevokedBy::kCertificate;
    revocation.value = *std::move(digest);
    return revocation;
  }
  const std::optional<std::string> serial = SerialOf(WithoutLabel(request.serial(), "serial="));
  if (!serial) return Wrong("serial", "must be hexadecimal");
  const std::string_view issuer = WithoutLabel(request.issuer(), "issuer=");
  if (issuer.empty()) return Wrong("issuer", "is missing: serials differ within one");
  if (absl::Status checked = CheckText("issuer", issuer, kIssuerBytesMax); !checked.ok())
    return checked;
  // Any other spelling of the name would be kept and match no certificate.
  if (!IsRfc2253Name(issuer)) {
    return Wrong("issuer", "must be as openssl x509 -issuer -nameopt RFC2253 prints it");
  }
  revocation.by = storage::RevokedBy::kIssuerSerial;
  revocation.value = fmt::format("{} {}", *serial, issuer);
  return revocation;
}

template absl::StatusOr<storage::Revocation> RevocationOf(
    const v1::RevokeCertificateRequest& request);
template absl::StatusOr<storage::Revocation> RevocationOf(
    const v1::UnrevokeCertificateRequest& request);

}  // namespace uplink::admin
