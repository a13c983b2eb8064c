#include "server/uncrew/sample_digest.h"

#include <algorithm>
#include <array>
#include <string>

#include <openssl/sha.h>

#include "schema/base/check.h"

namespace uplink::uncrew {

storage::SampleDigest DigestOf(model::uncrew::SampleType type, std::string_view request) {
  // One buffer and one call: the library's setup costs more than hashing a short message.
  std::string whole(1, static_cast<char>(type));
  whole.append(request);
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash{};
  UPLINK_CHECK(SHA256(reinterpret_cast<const unsigned char*>(whole.data()), whole.size(),
                      hash.data()) != nullptr,
               "OpenSSL can hash");
  storage::SampleDigest digest{};
  std::copy_n(hash.begin(), digest.size(), digest.begin());
  return digest;
}

}  // namespace uplink::uncrew
