#pragma once

#include <memory>
#include <string>

#include <absl/status/statusor.h>

#include "tools/pki/profile.h"

namespace uplink::pki {

/// A certificate and its private key, both PEM. A value.
struct Credentials {
  std::string certificate_pem;
  std::string key_pem;
};

/// A certificate authority of our own, for development and small fleets: ECDSA on P-256, SHA-256.
///
/// Errors: kInvalidArgument for bad input (not PEM, key and certificate that do not match, days out
///         of range, a certificate that the relay would not look into), kInternal with OpenSSL's
///         own words otherwise.
/// Thread: immutable once made; Issue may be called from several threads.
class Authority final {
 public:
  /// A new self-signed authority. `days` is 1 to kDaysMax, here and below. An empty name: one that
  /// no other authority has, since programs tell authorities apart by it.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<Authority>> Create(
      const std::string& common_name, int days);
  /// One that was made before.
  [[nodiscard]] static absl::StatusOr<std::unique_ptr<Authority>> Load(
      const Credentials& credentials);
  ~Authority();
  Authority(const Authority&) = delete;
  Authority& operator=(const Authority&) = delete;

  /// A new key and a certificate for it that says what `profile` says.
  [[nodiscard]] absl::StatusOr<Credentials> Issue(const Profile& profile, int days) const;

  [[nodiscard]] const Credentials& credentials() const { return credentials_; }

 private:
  struct Handles;
  Authority(std::unique_ptr<Handles> handles, Credentials credentials);

  std::unique_ptr<Handles> handles_;
  Credentials credentials_;
};

}  // namespace uplink::pki
