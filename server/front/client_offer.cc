#include "server/front/client_offer.h"

#include <algorithm>
#include <optional>
#include <utility>

#include <absl/strings/str_replace.h>
#include <fmt/format.h>
#include <openssl/evp.h>
#include <openssl/ssl.h>

#include "schema/base/utf8.h"

namespace uplink::front {
namespace {

/// Both bytes of such a number are the same, and end in A.
///
/// Source: RFC 8701, 2.
bool IsGrease(std::uint16_t number) {
  return number >> 8U == (number & 0xFFU) && (number & 0x0FU) == 0x0AU;
}

std::string Hex(std::uint16_t number, SSL* /*connection*/) {
  return fmt::format("0x{:04x}", number);
}

std::string VersionName(std::uint16_t number, SSL* connection) {
  if (number < TLS1_VERSION || number > TLS1_3_VERSION) return Hex(number, connection);
  return fmt::format("TLS 1.{}", number - TLS1_VERSION);
}

/// As tls.groups calls them.
std::string GroupName(std::uint16_t number, SSL* connection) {
  constexpr std::array<std::pair<std::uint16_t, const char*>, 6> kNames = {
      {{23, "P-256"},
       {24, "P-384"},
       {25, "P-521"},
       {29, "X25519"},
       {30, "X448"},
       {4588, "X25519MLKEM768"}}};
  const auto* const found = std::ranges::find(kNames, number, &decltype(kNames)::value_type::first);
  return found == kNames.end() ? Hex(number, connection) : found->second;
}

std::string SuiteName(std::uint16_t number, SSL* connection) {
  const unsigned char bytes[] = {static_cast<unsigned char>(number >> 8U),
                                 static_cast<unsigned char>(number)};
  const SSL_CIPHER* suite = SSL_CIPHER_find(connection, bytes);
  return suite == nullptr ? Hex(number, connection) : SSL_CIPHER_get_name(suite);
}

std::string_view ViewOf(const unsigned char* bytes, std::size_t size) {
  return {reinterpret_cast<const char*>(bytes), size};
}

std::string_view ExtensionOf(SSL* connection, unsigned int type) {
  const unsigned char* bytes = nullptr;
  std::size_t size = 0;
  if (SSL_client_hello_get0_ext(connection, type, &bytes, &size) != 1) return {};
  return ViewOf(bytes, size);
}

std::string KeyName(SSL* connection) {
  const EVP_PKEY* key = SSL_get_privatekey(connection);
  const char* name = key == nullptr ? nullptr : EVP_PKEY_get0_type_name(key);
  return name == nullptr ? "none" : name;
}

}  // namespace

void ClientOffer::Numbers::Add(std::uint16_t number) {
  if (IsGrease(number)) return;
  if (count < first.size()) first[count] = number;
  ++count;
}

void ClientOffer::Numbers::AddList(std::string_view bytes, std::size_t length_bytes) {
  for (std::size_t at = length_bytes; at + 1 < bytes.size(); at += 2) {
    Add(static_cast<std::uint16_t>(static_cast<std::uint8_t>(bytes[at]) << 8U |
                                   static_cast<std::uint8_t>(bytes[at + 1])));
  }
}

ClientOffer::ClientOffer(SSL* connection) {
  versions_.AddList(ExtensionOf(connection, TLSEXT_TYPE_supported_versions), 1);
  if (versions_.count == 0) {
    versions_.Add(static_cast<std::uint16_t>(SSL_client_hello_get0_legacy_version(connection)));
  }
  const unsigned char* suites = nullptr;
  const std::size_t suite_bytes = SSL_client_hello_get0_ciphers(connection, &suites);
  suites_.AddList(ViewOf(suites, suite_bytes), 0);
  groups_.AddList(ExtensionOf(connection, TLSEXT_TYPE_supported_groups), 2);
  signatures_.AddList(ExtensionOf(connection, TLSEXT_TYPE_signature_algorithms), 2);
  std::string_view protocols =
      ExtensionOf(connection, TLSEXT_TYPE_application_layer_protocol_negotiation);
  protocols.remove_prefix(std::min<std::size_t>(2, protocols.size()));
  protocol_bytes_ = protocols.copy(protocols_.data(), protocols_.size());
}

std::string ClientOffer::TextOf(const Numbers& numbers, std::string (*name)(std::uint16_t, SSL*),
                                SSL* connection) {
  if (numbers.count == 0) return "none";
  const std::size_t named = std::min(numbers.count, numbers.first.size());
  std::string text;
  for (std::size_t i = 0; i < named; ++i) {
    text += (i == 0 ? "" : ", ") + name(numbers.first[i], connection);
  }
  if (numbers.count > named) text += fmt::format(" and {} more", numbers.count - named);
  return text;
}

std::string ClientOffer::ProtocolsText() const {
  std::string_view rest(protocols_.data(), protocol_bytes_);
  std::string text;
  while (!rest.empty()) {
    const auto size = static_cast<std::uint8_t>(rest.front());
    const std::string_view name = rest.substr(1, size);
    text += (text.empty() ? "" : ", ") + PrintableUtf8(name, kProtocolBytesMax);
    rest.remove_prefix(1 + name.size());
  }
  return text.empty() ? "none" : text;
}

std::string ClientOffer::WhyNot(Agreed what, SSL* connection,
                                const transport::TlsRules& rules) const {
  const std::string groups = absl::StrReplaceAll(rules.groups, {{":", ", "}});
  switch (what) {
    case Agreed::kVersion:
      return fmt::format("it offers {}, and we take {}", TextOf(versions_, VersionName, connection),
                         rules.minimum == config::TlsVersion::k13 ? "TLS 1.3" : "TLS 1.2, TLS 1.3");
    case Agreed::kSuite:
      return fmt::format(
          "it offers the suites {} and the groups {}; we take ECDHE with AES-GCM or "
          "ChaCha20-Poly1305 for a key of kind {}, and the groups {}",
          TextOf(suites_, SuiteName, connection), TextOf(groups_, GroupName, connection),
          KeyName(connection), groups);
    case Agreed::kGroup:
      return fmt::format("it offers the groups {}, and we take {} (tls.groups)",
                         TextOf(groups_, GroupName, connection), groups);
    case Agreed::kSignature:
      return fmt::format("it offers the signature algorithms {}, and our key is of kind {}",
                         TextOf(signatures_, Hex, connection), KeyName(connection));
    case Agreed::kProtocol:
      return fmt::format("it offers by ALPN {}, and we take h2", ProtocolsText());
  }
  return {};
}

}  // namespace uplink::front
