// Writes the seeds of fuzz_pem: `bin/make_pem_corpus tests/fuzz/corpus`.
#include <filesystem>
#include <fstream>
#include <string>

#include "tests/support/certificates.h"
#include "tests/support/der.h"
#include "tests/support/odd_certificates.h"
#include "tests/support/pem_texts.h"

namespace {

namespace fs = std::filesystem;
namespace der = uplink::testing::der;
namespace odd = uplink::testing::odd;
using uplink::testing::BlockOf;
using uplink::testing::EcparamKey;
using uplink::testing::KeyPair;
using uplink::testing::ServerSpec;
using uplink::testing::TestAuthority;
using uplink::testing::With;
using uplink::testing::WithCrlf;

class Corpus final {
 public:
  explicit Corpus(fs::path folder) : folder_(std::move(folder)) {}

  void Write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  void WritePair(const std::string& name, const std::string& certificate,
                 const std::string& key) const {
    Write(name, certificate + std::string(1, '\0') + key);
  }

 private:
  const fs::path folder_;
};

void WritePairs(const Corpus& corpus, const TestAuthority& authority) {
  const KeyPair pair = authority.Issue(ServerSpec());
  corpus.WritePair("pair", pair.certificate, pair.key);
  corpus.WritePair("pair_ecparam", pair.certificate, EcparamKey(pair.key));
  corpus.WritePair("pair_crlf", WithCrlf(pair.certificate), WithCrlf(EcparamKey(pair.key)));
  corpus.WritePair("pair_chain", pair.certificate + "text\n" + authority.certificate(), pair.key);
  corpus.WritePair("pair_locked", pair.certificate, uplink::testing::LockedKey(pair.key));
  corpus.WritePair("pair_locked_own", pair.certificate, uplink::testing::LockedOwnKey(pair.key));
  corpus.WritePair("pair_two_keys", pair.certificate, pair.key + pair.key);
  corpus.WritePair("pair_of_others", pair.certificate, authority.Issue(ServerSpec()).key);
  corpus.Write("both_in_one", pair.key + pair.certificate);
}

void WriteTexts(const Corpus& corpus, const std::string& authority) {
  const std::string der = odd::DerOf(authority).front();
  corpus.Write("authorities", "# one\n" + authority + "\n" + authority);
  corpus.Write("trusted", odd::PemOf(der + der::Sequence(""), "TRUSTED CERTIFICATE"));
  corpus.Write("cut", authority.substr(0, authority.size() / 2));
  corpus.Write("no_begin", With(authority, "-----BEGIN CERTIFICATE-----\n", ""));
  corpus.Write("other_dashes", With(authority, "-----BEGIN", "----- BEGIN"));
  corpus.Write("other_end", With(authority, "-----END CERT", "-----END KEY"));
  corpus.Write("byte_order_mark", "\xEF\xBB\xBF" + authority);
  corpus.Write("revocations", authority + BlockOf("X509 CRL", "AA==\n"));
  corpus.Write("unknown", BlockOf("OPENSSH PRIVATE KEY", "AA==\n"));
  corpus.Write("empty_block", BlockOf("CERTIFICATE"));
  odd::Parts parts;
  parts.key = odd::Ed25519Key();
  parts.not_after = "99991231235959Z";
  corpus.Write("no_end", odd::PemOf(odd::CertificateOf(parts)));
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 2) return 2;
  const fs::path folder = fs::path(argv[1]) / "fuzz_pem";
  fs::create_directories(folder);
  const TestAuthority authority;
  WritePairs(Corpus(folder), authority);
  WriteTexts(Corpus(folder), authority.certificate());
  return 0;
}
