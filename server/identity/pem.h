#pragma once

#include <memory>
#include <string_view>

#include <openssl/types.h>

/// OpenSSL's objects with an owner, and how they are read from PEM texts. Nobody is ever asked for
/// a pass phrase: what needs one cannot be read. What OpenSSL has to say of a failure stays in its
/// queue of errors, which is the caller's to clear.
namespace uplink::identity {

struct BioFree {
  void operator()(BIO* bio) const;
};
struct X509Free {
  void operator()(X509* certificate) const;
};
struct KeyFree {
  void operator()(EVP_PKEY* key) const;
};
using Bio = std::unique_ptr<BIO, BioFree>;
using Certificate = std::unique_ptr<X509, X509Free>;
using Key = std::unique_ptr<EVP_PKEY, KeyFree>;

/// Reads a text, which outlives it and has at most INT_MAX bytes.
[[nodiscard]] Bio PemReader(std::string_view text);

/// The next certificate of a text, also one with OpenSSL's own notes on its trust; null at its end,
/// and where one cannot be read.
[[nodiscard]] Certificate NextCertificate(BIO* reader);

/// The first private key of a text; null if there is none that can be read.
[[nodiscard]] Key ReadKey(std::string_view text);

/// Has a context show the certificates of a text: its own first, those that lead to an authority
/// behind it. False if there is none or one is refused.
[[nodiscard]] bool UseChain(SSL_CTX* context, std::string_view text);

/// Has a context use the private key of a text, which must be that of its certificate.
[[nodiscard]] bool UseKey(SSL_CTX* context, std::string_view text);

}  // namespace uplink::identity
