#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace uplink::http {

/// The names under which the server's data may be asked for. They stop DNS rebinding: a page whose
/// own name resolves to our address asks under that name, which is not known here.
/// Immutable.
class KnownHosts final {
 public:
  /// `names`: http.hosts.
  explicit KnownHosts(std::vector<std::string> names = {});

  /// Whether the value of a Host header is an address (`192.0.2.7`, `[::1]:7480`), `localhost` or
  /// one of the names; with or without a port.
  [[nodiscard]] bool Has(std::string_view host) const;

  /// Whether the value of an Origin header is a page of ours: its host is that of the request
  /// (`host`, the value of Host), localhost or one of the names, whatever its scheme and port. The
  /// page of another address is foreign, and so is `null`, the Origin of a page without one.
  [[nodiscard]] bool HasOrigin(std::string_view origin, std::string_view host) const;

  /// Whether the page of that Origin came from the very host and port of the request.
  [[nodiscard]] static bool IsSameOrigin(std::string_view origin, std::string_view host);

 private:
  [[nodiscard]] bool HasName(const std::string& name) const;

  /// In lower case.
  const std::vector<std::string> names_;
};

}  // namespace uplink::http
