#pragma once

#include <memory>

#include <openssl/ssl.h>

// OpenSSL's objects with an owner, for tests; those of certificates and keys are in
// server/identity/pem.h.
namespace uplink::testing {

template <auto kFree>
struct FreeWith {
  template <typename T>
  void operator()(T* object) const {
    kFree(object);
  }
};

using SslContext = std::unique_ptr<SSL_CTX, FreeWith<SSL_CTX_free>>;
using Ssl = std::unique_ptr<SSL, FreeWith<SSL_free>>;

}  // namespace uplink::testing
