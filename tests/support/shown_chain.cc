#include "tests/support/shown_chain.h"

#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509.h>

#include "schema/base/check.h"

namespace uplink::testing {

ShownChain::ShownChain(const std::vector<std::string>& certificates) {
  const std::string* before = nullptr;
  for (const std::string& each : certificates) {
    if (before != nullptr && *before == each) {
      X509_up_ref(certificates_.back());
      certificates_.push_back(certificates_.back());
      continue;
    }
    const auto* bytes = reinterpret_cast<const unsigned char*>(each.data());
    certificates_.push_back(d2i_X509(nullptr, &bytes, static_cast<long>(each.size())));
    UPLINK_CHECK(certificates_.back() != nullptr, "a certificate that OpenSSL reads");
    before = &each;
  }
  // Of keys that it could not read.
  ERR_clear_error();
}

ShownChain::~ShownChain() {
  for (X509* certificate : certificates_) X509_free(certificate);
}

void ShownChain::AddTo(SSL_CTX* context) const {
  SSL_CTX_set_security_level(context, 0);
  for (X509* certificate : certificates_) {
    UPLINK_CHECK(SSL_CTX_add1_chain_cert(context, certificate) == 1, "a chain of the test's own");
  }
}

}  // namespace uplink::testing
