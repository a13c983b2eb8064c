#include "tests/support/odd_certificates.h"

#include <cstdint>
#include <memory>

#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/evp.h>
#include <openssl/objects.h>
#include <openssl/pem.h>
#include <openssl/x509.h>

#include "schema/base/check.h"
#include "tests/support/der.h"

namespace uplink::testing::odd {
namespace {

template <auto kFree>
struct FreeWith {
  template <typename T>
  void operator()(T* object) const {
    kFree(object);
  }
};
using Number = std::unique_ptr<BIGNUM, FreeWith<BN_free>>;
using Group = std::unique_ptr<EC_GROUP, FreeWith<EC_GROUP_free>>;

constexpr std::string_view kEcKey("\x2A\x86\x48\xCE\x3D\x02\x01", 7);
constexpr std::string_view kPrimeField("\x2A\x86\x48\xCE\x3D\x01\x01", 7);
constexpr std::string_view kRsa("\x2A\x86\x48\x86\xF7\x0D\x01\x01\x01", 9);
constexpr std::string_view kRsaPss("\x2A\x86\x48\x86\xF7\x0D\x01\x01\x0A", 9);
constexpr std::string_view kEd25519("\x2B\x65\x70", 3);
constexpr std::string_view kEd448("\x2B\x65\x71", 3);
constexpr std::string_view kEcdsaSha256("\x2A\x86\x48\xCE\x3D\x04\x03\x02", 8);
constexpr std::string_view kCommonName("\x55\x04\x03", 3);

void Require(bool done) { UPLINK_CHECK(done, "OpenSSL refused to make a test certificate"); }

int NidOf(Curve curve) {
  switch (curve) {
    case Curve::kP256:
      return NID_X9_62_prime256v1;
    case Curve::kP384:
      return NID_secp384r1;
    case Curve::kP521:
      return NID_secp521r1;
  }
  return NID_undef;
}

std::string OidOf(int nid) {
  const ASN1_OBJECT* object = OBJ_nid2obj(nid);
  return {reinterpret_cast<const char*>(OBJ_get0_data(object)), OBJ_length(object)};
}

std::string BytesOf(const BIGNUM* number, int size) {
  std::string bytes(static_cast<std::size_t>(size), '\0');
  Require(BN_bn2binpad(number, reinterpret_cast<unsigned char*>(bytes.data()), size) == size);
  return bytes;
}

/// So many bits, the highest and the lowest of them set.
std::string NumberOf(std::size_t bits) {
  std::string bytes((bits + 7) / 8, '\x5A');
  const auto top = static_cast<std::uint8_t>(1U << ((bits - 1) % 8));
  bytes.front() = static_cast<char>(top);
  bytes.back() = static_cast<char>(static_cast<std::uint8_t>(bytes.back()) | 1U);
  return bytes;
}

std::string RsaOf(std::string_view oid, std::string_view parameters, std::size_t modulus_bits,
                  std::size_t exponent_bits) {
  const std::string key =
      der::Sequence(der::Integer(NumberOf(modulus_bits)) + der::Integer(NumberOf(exponent_bits)));
  return KeyOf(der::Oid(oid).append(parameters), key);
}

std::string Length(std::size_t size, std::size_t bytes) {
  std::string text;
  for (std::size_t i = bytes; i > 0; --i) text += static_cast<char>(size >> (8 * (i - 1)));
  return text;
}

}  // namespace

std::string KeyOf(std::string_view algorithm, std::string_view key) {
  return der::Sequence(der::Sequence(algorithm) + der::Bits(key));
}

std::string NamedCurveKey(Curve curve, Point form) {
  const Group group(EC_GROUP_new_by_curve_name(NidOf(curve)));
  const auto conversion =
      form == Point::kCompressed ? POINT_CONVERSION_COMPRESSED : POINT_CONVERSION_UNCOMPRESSED;
  unsigned char* bytes = nullptr;
  const std::size_t size = EC_POINT_point2buf(group.get(), EC_GROUP_get0_generator(group.get()),
                                              conversion, &bytes, nullptr);
  Require(size > 0);
  const std::string point(bytes, bytes + size);
  OPENSSL_free(bytes);
  return KeyOf(der::Oid(kEcKey) + der::Oid(OidOf(NidOf(curve))), point);
}

std::string ExplicitCurveKey() {
  // y^2 = x^3 + x + 270 has the point (5, 20); an element of the field may be written without the
  // zeros before it.
  const Number prime(BN_new());
  Require(BN_set_word(prime.get(), 97) == 1 && BN_lshift(prime.get(), prime.get(), 652) == 1 &&
          BN_add_word(prime.get(), 1) == 1);
  const int size = BN_num_bytes(prime.get());
  const std::string p = BytesOf(prime.get(), size);
  const std::string a(1, '\x01');
  const std::string b("\x01\x0E", 2);
  const std::string point = "\x02" + std::string(static_cast<std::size_t>(size) - 1, '\0') + "\x05";
  const std::string curve = der::Sequence(
      der::Integer("\x01") + der::Sequence(der::Oid(kPrimeField) + der::Integer(p)) +
      der::Sequence(der::Octets(a) + der::Octets(b)) + der::Octets(point) + der::Integer(p));
  return KeyOf(der::Oid(kEcKey) + curve, point);
}

std::string RsaKey(std::size_t modulus_bits, std::size_t exponent_bits) {
  return RsaOf(kRsa, der::Null(), modulus_bits, exponent_bits);
}

std::string RsaPssKey(std::size_t modulus_bits, std::size_t exponent_bits) {
  return RsaOf(kRsaPss, "", modulus_bits, exponent_bits);
}

std::string Ed25519Key() { return KeyOf(der::Oid(kEd25519), std::string(32, '\x11')); }

std::string Ed448Key() { return KeyOf(der::Oid(kEd448), std::string(57, '\x11')); }

std::string NameOf(std::string_view common_name) {
  return der::Sequence(
      der::Set(der::Sequence(der::Oid(kCommonName) + der::Element(0x0C, common_name))));
}

std::string Extension(std::string_view oid, std::string_view value) {
  return der::Sequence(der::Oid(oid) + der::Octets(value));
}

std::string CertificateOf(const Parts& parts) {
  const std::string signature = der::Sequence(der::Oid(kEcdsaSha256));
  const std::string validity =
      der::Sequence(der::Element(0x17, "200101000000Z") + der::Element(0x18, parts.not_after));
  std::string body = parts.version + der::Integer("\x01") + signature + parts.issuer + validity +
                     parts.subject + parts.key;
  if (!parts.extensions.empty()) {
    body += der::Element(0xA3, der::Sequence(parts.extensions));
  }
  body += parts.tail;
  return der::Sequence(der::Sequence(body) + signature + der::Bits(std::string(70, '\x30')));
}

std::string CertificateWith(const std::string& key) {
  Parts parts;
  parts.key = key;
  return CertificateOf(parts);
}

std::string MessageOf12(const std::vector<std::string>& certificates) {
  std::string list;
  for (const std::string& each : certificates) list += Length(each.size(), 3) + each;
  return Length(list.size(), 3) + list;
}

std::string MessageOf13(const std::vector<std::string>& certificates) {
  std::string list;
  for (const std::string& each : certificates) {
    list += Length(each.size(), 3) + each + Length(0, 2);
  }
  return std::string(1, '\0') + Length(list.size(), 3) + list;
}

std::vector<std::string> DearChain() {
  constexpr std::size_t kBehind = 9;
  // What is left of the 2,048 elements of a message, without those of the others' names.
  constexpr std::size_t kExtensions = 600;
  const std::string key = NamedCurveKey(Curve::kP521, Point::kCompressed);
  std::vector<std::string> chain(kBehind - 1, CertificateWith(key));
  Parts parts;
  parts.key = key;
  for (std::size_t i = 0; i < kExtensions; ++i) {
    const std::string oid = {'\x2A', static_cast<char>(1 + i / 128), static_cast<char>(i % 128)};
    parts.extensions += Extension(oid, "");
  }
  chain.push_back(CertificateOf(parts));
  return chain;
}

std::string PemOf(const std::string& certificate, const std::string& label) {
  const std::unique_ptr<BIO, FreeWith<BIO_free>> bio(BIO_new(BIO_s_mem()));
  const auto* bytes = reinterpret_cast<const unsigned char*>(certificate.data());
  Require(PEM_write_bio(bio.get(), label.c_str(), "", bytes,
                        static_cast<long>(certificate.size())) > 0);
  char* text = nullptr;
  const auto size = BIO_get_mem_data(bio.get(), &text);
  return {text, static_cast<std::size_t>(size)};
}

std::vector<std::string> DerOf(std::string_view pem) {
  const std::unique_ptr<BIO, FreeWith<BIO_free>> bio(
      BIO_new_mem_buf(pem.data(), static_cast<int>(pem.size())));
  std::vector<std::string> certificates;
  char* name = nullptr;
  char* header = nullptr;
  unsigned char* bytes = nullptr;
  long size = 0;  // NOLINT(google-runtime-int): the library's type
  while (PEM_read_bio(bio.get(), &name, &header, &bytes, &size) == 1) {
    certificates.emplace_back(bytes, bytes + size);
    OPENSSL_free(name);
    OPENSSL_free(header);
    OPENSSL_free(bytes);
  }
  return certificates;
}

}  // namespace uplink::testing::odd
