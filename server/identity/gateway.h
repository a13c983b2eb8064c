#pragma once

#include <algorithm>
#include <string>
#include <string_view>
#include <vector>

#include <openssl/types.h>

namespace uplink::identity {

/// What the authorities of a chain allow in URI names (name constraints). OpenSSL checks the names
/// in certificates against them; this class checks the robots that a gateway names in Hello.
///
/// Source: RFC 5280, 4.2.1.10: a constraint is a host; with a period in front, every host below it.
/// Limits: the gate before TLS bounds what a chain holds (kShownBytesMax).
/// Thread: a value.
class UriConstraints final {
 public:
  /// Adds the constraints of one certificate above the peer's own.
  void Add(const X509& authority);
  /// Whether each authority allows the name. A name without a host, or with a user before its host,
  /// is allowed only where no authority constrains URIs.
  [[nodiscard]] bool Allow(std::string_view uri) const;
  [[nodiscard]] bool empty() const { return authorities_.empty(); }

 private:
  struct OfAuthority {
    /// Empty: all except the excluded.
    std::vector<std::string> permitted;
    std::vector<std::string> excluded;
    /// The extension cannot be read, or a constraint in it has a range, which RFC 5280 rules out:
    /// no name is allowed.
    bool unreadable = false;

    [[nodiscard]] bool Allow(std::string_view host) const;
  };
  std::vector<OfAuthority> authorities_;
};

/// A gateway, as its certificate describes it. A value.
struct Gateway {
  /// The subject of the certificate (SubjectOf): the gateway's name in its robots' sessions, in
  /// bounds and in the log.
  std::string subject = {};
  /// The robots that the certificate names; empty: it may speak for all of its fleet.
  std::vector<std::string> ruris = {};
  /// What the authorities of its chain allow in URI names.
  UriConstraints constraints = {};

  [[nodiscard]] bool Names(std::string_view ruri) const {
    return std::ranges::find(ruris, ruri) != ruris.end();
  }
  /// Whether it may speak for this robot of its fleet: the certificate names the robot or no robot,
  /// and the authorities may sign for the robot.
  [[nodiscard]] bool MaySpeakFor(std::string_view ruri) const {
    return (ruris.empty() || Names(ruri)) && constraints.Allow(ruri);
  }
};

}  // namespace uplink::identity
