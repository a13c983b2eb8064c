// Writes the seeds of fuzz_certificate: `bin/make_certificate_corpus tests/fuzz/corpus`.
#include <cstdint>
#include <filesystem>
#include <fstream>
#include <string>
#include <utility>
#include <vector>

#include "tests/support/certificates.h"
#include "tests/support/der.h"
#include "tests/support/odd_certificates.h"

namespace {

namespace fs = std::filesystem;
namespace der = uplink::testing::der;
namespace odd = uplink::testing::odd;
using uplink::testing::CertificateSpec;
using uplink::testing::RobotSpec;
using uplink::testing::TestAuthority;

void Write(const fs::path& folder, const std::string& name, char form, const std::string& bytes) {
  std::ofstream(folder / name, std::ios::binary) << form << bytes;
}

void WriteReal(const fs::path& folder) {
  const TestAuthority authority;
  const auto of = [&](const CertificateSpec& spec) {
    return odd::DerOf(authority.Issue(spec).certificate).front();
  };
  std::vector<std::string> all;
  for (const char* key : {"P-256", "P-384", "P-521", "RSA", "ED25519", "ED448"}) {
    CertificateSpec spec = RobotSpec("rcan://x.local/robots/1", "fleet");
    spec.key = key;
    all.push_back(of(spec));
    Write(folder, std::string("real_") + key, 0, all.back());
    spec.compressed = true;
    if (spec.key.starts_with("P-")) Write(folder, std::string("compressed_") + key, 0, of(spec));
  }
  const std::string signer = odd::DerOf(authority.certificate()).front();
  Write(folder, "authority", 0, signer);
  Write(folder, "message_12", 1, odd::MessageOf12({all.front(), signer}));
  Write(folder, "message_13", 2, odd::MessageOf13({all.front(), signer}));
}

void WriteOdd(const fs::path& folder) {
  Write(folder, "explicit_curve", 0, odd::CertificateWith(odd::ExplicitCurveKey()));
  Write(folder, "rsa_4096_64", 0, odd::CertificateWith(odd::RsaKey(4096, 64)));
  Write(folder, "rsa_4097", 0, odd::CertificateWith(odd::RsaKey(4097, 17)));
  Write(folder, "rsa_pss", 0, odd::CertificateWith(odd::RsaPssKey(2048, 17)));
  odd::Parts parts;
  parts.key = odd::Ed25519Key();
  const std::string host = der::Element(0x82, "a");
  parts.extensions = odd::Extension("\x55\x1D\x11", der::Sequence(host + host)) +
                     odd::Extension("\x2A", "no element");
  Write(folder, "extensions", 0, odd::CertificateOf(parts));
  Write(folder, "message_13_of_none", 2, odd::MessageOf13({}));
  // Lists of a context, whose tags say that they are some, and do not.
  for (const auto& [name, bit] : {std::pair{"lists", 0x20}, std::pair{"hidden_lists", 0}}) {
    const auto list = [bit = bit](int tag, const std::string& content) {
      return der::Element(static_cast<std::uint8_t>(tag + bit), content);
    };
    const std::string point = der::Element(0xA0, list(0x80, der::Element(0x86, "http://a/b")));
    parts.extensions =
        odd::Extension("\x55\x1D\x1E", der::Sequence(list(0x80, der::Sequence(host)) +
                                                     list(0x81, der::Sequence(host)))) +
        odd::Extension("\x55\x1D\x23", der::Sequence(list(0x81, host))) +
        odd::Extension("\x55\x1D\x1F", der::Sequence(der::Sequence(point + list(0x82, host))));
    Write(folder, name, 0, odd::CertificateOf(parts));
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const fs::path folder = fs::path(argv[1]) / "fuzz_certificate";
  fs::create_directories(folder);
  WriteReal(folder);
  WriteOdd(folder);
  return 0;
}
