#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include <absl/functional/function_ref.h>
#include <absl/status/statusor.h>
#include <openssl/types.h>

#include "server/identity/pem_blocks.h"

/// OpenSSL's objects with an owner, and the only functions that read them from PEM texts: both at
/// the start and when a file is read again, so that both accept the same. They never ask the
/// terminal for a pass phrase.
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

/// Reads a text that a library wrote, or one block; it outlives the reader and has at most INT_MAX
/// bytes.
[[nodiscard]] Bio PemReader(std::string_view text);

/// What is wrong with a certificate that can be read; empty if nothing is.
using CertificateJudge = absl::FunctionRef<std::string(X509*)>;

/// All certificates of a text in their order, at least one, also those with OpenSSL's own notes on
/// their trust. Blocks of other kinds are ignored.
///
/// Errors: kFailedPrecondition as of BlocksOf and CheckBlocks, or if there is no certificate.
///         Certificates that cannot be read, or in which the judge finds a flaw, are named
///         too.
/// Thread: any, as those below; OpenSSL's queue of errors is empty after it.
[[nodiscard]] absl::StatusOr<std::vector<Certificate>> ReadCertificates(const NamedPem& pem);
[[nodiscard]] absl::StatusOr<std::vector<Certificate>> ReadCertificates(const NamedPem& pem,
                                                                        CertificateJudge judge);

/// The one private key of a text. Its parameters may stand before it, as `openssl ecparam -genkey`
/// writes them, and certificates beside it.
///
/// Errors: kFailedPrecondition as of BlocksOf and CheckBlocks, or if there is none, a second one,
///         one behind a pass phrase, or one that cannot be read.
[[nodiscard]] absl::StatusOr<Key> ReadKey(const NamedPem& pem);

/// Makes a context show the certificates of a text: its own first, then those that lead to an
/// authority. False if one cannot be read or is refused.
[[nodiscard]] bool UseChain(SSL_CTX* context, std::string_view text);

/// Makes a context use the private key of a text, which must be that of its certificate.
[[nodiscard]] bool UseKey(SSL_CTX* context, std::string_view text);

}  // namespace uplink::identity
