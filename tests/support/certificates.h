#pragma once

#include <memory>
#include <string>
#include <vector>

namespace uplink::testing {

/// What a test certificate says. Its parts go into the certificate as they are, wrong ones too.
struct CertificateSpec {
  /// Attributes of the subject; each element becomes one, so that a test can repeat an attribute.
  std::vector<std::string> common_names;
  std::vector<std::string> organizations;
  std::vector<std::string> units;
  /// Subject alternative names by kind. IP addresses as text.
  std::vector<std::string> uris;
  std::vector<std::string> dns_names;
  std::vector<std::string> ip_addresses;
  /// Extended key usages by OpenSSL's short names (`clientAuth`, `serverAuth`); empty: no
  /// extension.
  std::vector<std::string> key_usages{"clientAuth"};
  /// Validity, in seconds from now.
  long not_before_s = -3600;
  long not_after_s = 3600;
  bool is_authority = false;
  /// In OpenSSL's words; empty: no extension.
  std::string name_constraints = {};
  /// The kind of its key: `P-256`, `P-384`, `P-521`, `RSA` (2,048 bits), `ED25519` or `ED448`; and
  /// what no robot should have: `RSA-1024`, and curves by OpenSSL's name (`secp256k1`,
  /// `brainpoolP256r1`).
  std::string key = "P-256";
  /// Its point is compressed, if its key has one.
  bool compressed = false;
};

/// A robot's certificate by the profile of the protocol.
[[nodiscard]] CertificateSpec RobotSpec(const std::string& ruri, const std::string& fleet = "");
/// A server's certificate for loopback and `localhost`.
[[nodiscard]] CertificateSpec ServerSpec();

/// A certificate and its key, PEM.
struct KeyPair {
  std::string certificate;
  std::string key;
};

/// A certificate authority in memory. Failures of the library end the test program: they are the
/// test's own bugs. Confined to one thread.
class TestAuthority final {
 public:
  explicit TestAuthority(const std::string& name = "test authority");
  /// One that `issuer` has signed, with name constraints in OpenSSL's words
  /// (`permitted;URI:example.org,excluded;URI:.example.org`), if any.
  TestAuthority(const std::string& name, const TestAuthority& issuer,
                const std::string& name_constraints = {});
  ~TestAuthority();
  TestAuthority(const TestAuthority&) = delete;
  TestAuthority& operator=(const TestAuthority&) = delete;

  /// The authority's own certificate, PEM.
  [[nodiscard]] const std::string& certificate() const;
  [[nodiscard]] KeyPair Issue(const CertificateSpec& spec) const;
  /// A list of these certificates (PEM) as revoked, PEM. `next_update_s`: in seconds from now.
  [[nodiscard]] std::string Revoke(const std::vector<KeyPair>& revoked,
                                   long next_update_s = 3600) const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace uplink::testing
