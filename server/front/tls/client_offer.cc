#include "server/front/tls/client_offer.h"

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

using Named = std::pair<std::uint16_t, const char*>;

template <std::size_t kCount>
std::string NameIn(const std::array<Named, kCount>& names, std::uint16_t number, SSL* connection) {
  const auto* const found = std::ranges::find(names, number, &Named::first);
  return found == names.end() ? Hex(number, connection) : found->second;
}

/// As tls.groups calls them.
std::string GroupName(std::uint16_t number, SSL* connection) {
  constexpr std::array<Named, 6> kNames = {{{23, "P-256"},
                                            {24, "P-384"},
                                            {25, "P-521"},
                                            {29, "X25519"},
                                            {30, "X448"},
                                            {4588, "X25519MLKEM768"}}};
  return NameIn(kNames, number, connection);
}

/// Source: RFC 8446, 4.2.3.
std::string SignatureName(std::uint16_t number, SSL* connection) {
  constexpr std::array<Named, 11> kNames = {{{0x0401, "rsa_pkcs1_sha256"},
                                             {0x0501, "rsa_pkcs1_sha384"},
                                             {0x0601, "rsa_pkcs1_sha512"},
                                             {0x0403, "ecdsa_secp256r1_sha256"},
                                             {0x0503, "ecdsa_secp384r1_sha384"},
                                             {0x0603, "ecdsa_secp521r1_sha512"},
                                             {0x0804, "rsa_pss_rsae_sha256"},
                                             {0x0805, "rsa_pss_rsae_sha384"},
                                             {0x0806, "rsa_pss_rsae_sha512"},
                                             {0x0807, "ed25519"},
                                             {0x0808, "ed448"}}};
  return NameIn(kNames, number, connection);
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

/// The kind of the server's key, with its curve as OpenSSL calls it.
std::string KeyName(SSL* connection) {
  const EVP_PKEY* key = SSL_get_privatekey(connection);
  const char* name = key == nullptr ? nullptr : EVP_PKEY_get0_type_name(key);
  if (name == nullptr) return "none";
  std::array<char, 32> curve{};
  std::size_t size = 0;
  if (EVP_PKEY_get_group_name(key, curve.data(), curve.size(), &size) != 1) return name;
  return fmt::format("{} ({})", name, std::string_view(curve.data(), size));
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
  // A ClientHello of SSLv2 has three bytes for each.
  if (SSL_client_hello_isv2(connection) == 0) suites_.AddList(ViewOf(suites, suite_bytes), 0);
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
      return fmt::format("it offers {}, and we take {} (tls.min_version)",
                         TextOf(versions_, VersionName, connection),
                         rules.minimum == config::TlsVersion::k13 ? "TLS 1.3" : "TLS 1.2, TLS 1.3");
    case Agreed::kSuite:
      return fmt::format(
          "it offers the suites {} and the groups {}; we take ECDHE with AES-GCM or "
          "ChaCha20-Poly1305 for our key {}, whose curve has to be among its groups, and the "
          "groups {}",
          TextOf(suites_, SuiteName, connection), TextOf(groups_, GroupName, connection),
          KeyName(connection), groups);
    case Agreed::kGroup:
      return fmt::format("it offers the groups {}, and we take {} (tls.groups)",
                         TextOf(groups_, GroupName, connection), groups);
    case Agreed::kSignature:
      return fmt::format("it offers the signature algorithms {}, and our key is {}",
                         TextOf(signatures_, SignatureName, connection), KeyName(connection));
    case Agreed::kProtocol:
      return fmt::format("it offers by ALPN {}, and we take h2", ProtocolsText());
  }
  return {};
}

}  // namespace uplink::front
