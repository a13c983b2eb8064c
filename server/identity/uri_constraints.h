#pragma once

#include <string>
#include <string_view>
#include <vector>

#include <openssl/types.h>

namespace uplink::identity {

/// What the authorities of a chain allow in URI names. TLS holds the names of certificates against
/// it; this holds the robot that a gateway names in a frame against the same.
///
/// Source: RFC 5280, 4.2.1.10: a constraint is a host, or the end of one from a period on.
/// Limits:  the gate before TLS bounds what a chain holds (kShownBytesMax).
/// Thread:  a value.
class UriConstraints final {
 public:
  /// Adds those of one certificate above the peer's own.
  void Add(const X509& authority);
  /// Whether each authority allows the name. One without a host, or with a user before it, is
  /// allowed only where no authority constrains URIs.
  [[nodiscard]] bool Allow(std::string_view uri) const;
  [[nodiscard]] bool empty() const { return authorities_.empty(); }

 private:
  struct OfAuthority {
    std::vector<std::string> permitted;
    std::vector<std::string> excluded;
    /// They say something that nobody can hold a name against: none is allowed.
    bool unreadable = false;

    [[nodiscard]] bool Allow(std::string_view host) const;
  };
  std::vector<OfAuthority> authorities_;
};

}  // namespace uplink::identity
