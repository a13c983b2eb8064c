#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <openssl/types.h>

namespace uplink::identity {

/// What the authorities of a chain allow in URI names (name constraints). OpenSSL checks the names
/// in certificates against it; this checks the robots that a gateway names in Hello.
///
/// Source: RFC 5280, 4.2.1.10: a constraint is a host; with a period in front, every host below it.
/// Limits: the gate before TLS bounds what a chain holds (kShownBytesMax).
/// Thread: a value.
class UriConstraints final {
 public:
  /// Adds those of one certificate above the peer's own.
  void Add(const X509& authority);
  /// Whether each authority allows the name. A name without a host, or with a user before its host,
  /// is allowed only where no authority constrains URIs.
  [[nodiscard]] bool Allow(std::string_view uri) const;
  [[nodiscard]] bool empty() const { return authorities_.empty(); }

 private:
  struct OfAuthority {
    /// Empty: all but the excluded.
    std::vector<std::string> permitted;
    std::vector<std::string> excluded;
    /// The extension cannot be read, or a constraint in it has a range, which RFC 5280 rules out:
    /// no name is allowed.
    bool unreadable = false;

    [[nodiscard]] bool Allow(std::string_view host) const;
  };
  std::vector<OfAuthority> authorities_;
};

}  // namespace uplink::identity
