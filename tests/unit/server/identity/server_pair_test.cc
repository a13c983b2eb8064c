// Whether a certificate and its key belong together.
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

}  // namespace
}  // namespace uplink::identity
