#include "server/broker/digest.h"

#include <algorithm>
#include <array>
#include <cstdint>
#include <string_view>

#include <openssl/sha.h>

#include "schema/base/check.h"

namespace uplink::broker {
namespace {

/// A number as eight bytes, so that different pairs of topic and payload never read the same.
std::array<unsigned char, sizeof(std::uint64_t)> BytesOf(std::uint64_t number) {
  std::array<unsigned char, sizeof(std::uint64_t)> bytes{};
  for (std::size_t i = 0; i < bytes.size(); ++i) {
    bytes[i] = static_cast<unsigned char>(number >> (8 * i));
  }
  return bytes;
}

}  // namespace

storage::DeliveryDigest DigestOf(const mqtt::Publish& publish) {
  const std::string_view payload = publish.payload.value_or(std::string_view());
  // One buffer and one call: the library's setup costs more than hashing a short message.
  std::string whole;
  whole.reserve(2 * sizeof(std::uint64_t) + publish.topic.size() + payload.size());
  for (const std::uint64_t number : {publish.topic.size(), publish.payload_bytes}) {
    const auto bytes = BytesOf(number);
    whole.append(bytes.begin(), bytes.end());
  }
  whole.append(publish.topic).append(payload);
  std::array<unsigned char, SHA256_DIGEST_LENGTH> hash{};
  UPLINK_CHECK(SHA256(reinterpret_cast<const unsigned char*>(whole.data()), whole.size(),
                      hash.data()) != nullptr,
               "OpenSSL can hash");
  storage::DeliveryDigest digest{};
  std::copy_n(hash.begin(), digest.size(), digest.begin());
  return digest;
}

}  // namespace uplink::broker
