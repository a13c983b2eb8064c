// Whether a certificate and its key belong together, and may serve.
#include "server/identity/server_pair.h"

#include <string>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/support/certificates.h"

namespace uplink::identity {
namespace {

using ::testing::HasSubstr;

// A broker may take certificates without an extended key usage, or with whatever it likes.
TEST(ClientPair, IsACertificateAndItsOwnKey) {
  const testing::TestAuthority authority;
  testing::CertificateSpec spec = testing::ServerSpec();
  spec.key_usages.clear();
  const testing::KeyPair pair = authority.Issue(spec);
  EXPECT_TRUE(CheckClientPair({"c.crt", pair.certificate}, {"c.key", pair.key}).ok());
  EXPECT_THAT(
      CheckClientPair({"c.crt", pair.certificate}, {"c.key", authority.Issue(spec).key}).message(),
      HasSubstr("c.key: is not the key of c.crt"));
  EXPECT_THAT(CheckClientPair({"c.crt", "text"}, {"c.key", pair.key}).message(),
              HasSubstr("c.crt: holds no PEM certificate"));
}

// OpenSSL takes it as a server's own and then fails every handshake.
TEST(ServerPair, HasAKeyOfAKindWithWhichATlsServerSigns) {
  const testing::TestAuthority authority;
  testing::CertificateSpec spec = testing::ServerSpec();
  const auto check = [&] {
    const testing::KeyPair pair = authority.Issue(spec);
    return CheckServerPair({"s.crt", pair.certificate}, {"s.key", pair.key});
  };
  for (const char* key : {"P-256", "P-384", "P-521", "RSA", "ED25519", "ED448"}) {
    spec.key = key;
    EXPECT_TRUE(check().ok()) << key << ": " << check();
  }
  for (const char* key : {"secp256k1", "brainpoolP256r1"}) {
    spec.key = key;
    EXPECT_THAT(check().message(), HasSubstr("s.crt: its key is of a kind")) << key;
  }
}

// A start failed with it that --check-config had called good.
TEST(ServerPair, IsStrongEnoughForOpenSsl) {
  const testing::TestAuthority authority;
  testing::CertificateSpec spec = testing::ServerSpec();
  spec.key = "RSA-1024";
  const testing::KeyPair weak = authority.Issue(spec);
  const std::string refused = "s.crt: OpenSSL refuses it: ee key too small; issue another";
  EXPECT_EQ(CheckServerPair({"s.crt", weak.certificate}, {"s.key", weak.key}).message(), refused);
  EXPECT_EQ(CheckClientPair({"s.crt", weak.certificate}, {"s.key", weak.key}).message(), refused);
  const testing::KeyPair good = authority.Issue(testing::ServerSpec());
  EXPECT_EQ(CheckServerPair({"s.crt", good.certificate + weak.certificate}, {"s.key", good.key})
                .message(),
            "s.crt: OpenSSL refuses it: ca key too small; issue another");
}

}  // namespace
}  // namespace uplink::identity
