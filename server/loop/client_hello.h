#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace uplink::loop {

/// A TLS ClientHello as OpenSSL's client would open with, for HTTP/2; empty if OpenSSL cannot make
/// one.
[[nodiscard]] std::string MakeClientHello();

/// Bytes of an answer that IsServerHello looks at: a record's header and the message's type.
inline constexpr std::size_t kServerHelloPrefix = 6;

/// True if a server's answer begins with a ServerHello; an alert is none.
[[nodiscard]] bool IsServerHello(std::string_view answer);

}  // namespace uplink::loop
