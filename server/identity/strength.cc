#include "server/identity/strength.h"

#include <array>
#include <cstddef>
#include <memory>

#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include "server/identity/pem.h"

namespace uplink::identity {
namespace {

/// Bits of security that each level requires (SSL_CTX_set_security_level(3)).
constexpr auto kBitsOfLevel = std::to_array<int>({0, 80, 112, 128, 192, 256});

struct ContextFree {
  void operator()(SSL_CTX* context) const { SSL_CTX_free(context); }
};
using Context = std::unique_ptr<SSL_CTX, ContextFree>;

Context NewContext() { return Context(SSL_CTX_new(TLS_method())); }

}  // namespace

std::string WeaknessOf(X509& authority) {
  const Context context = NewContext();
  if (context == nullptr) return {};
  const int level = SSL_CTX_get_security_level(context.get());
  const auto row = static_cast<std::size_t>(level);
  const int needed = level >= 0 && row < kBitsOfLevel.size() ? kBitsOfLevel.at(row) : 0;
  const EVP_PKEY* const key = X509_get0_pubkey(&authority);
  const int bits = key == nullptr ? 0 : EVP_PKEY_get_security_bits(key);
  ERR_clear_error();
  if (bits >= needed) return {};
  return fmt::format(
      "its key is too weak: {} bits of security, and OpenSSL's security level {} takes {} and "
      "more, which RSA has from 2,048 bits on",
      bits, level, needed);
}

absl::Status CheckStrength(const NamedPem& certificate, const NamedPem& key) {
  const Context context = NewContext();
  if (context == nullptr) return absl::InternalError("OpenSSL: no context");
  ERR_clear_error();
  const NamedPem* refused = nullptr;
  if (!UseChain(context.get(), certificate.text)) {
    refused = &certificate;
  } else if (!UseKey(context.get(), key.text)) {
    refused = &key;
  }
  const char* why = ERR_reason_error_string(ERR_peek_last_error());
  ERR_clear_error();
  if (refused == nullptr) return absl::OkStatus();
  return absl::FailedPreconditionError(fmt::format("{}: OpenSSL refuses it: {}; issue another",
                                                   refused->name,
                                                   why == nullptr ? "no reason" : why));
}

}  // namespace uplink::identity
