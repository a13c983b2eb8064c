#pragma once

#include <cstddef>
#include <string>
#include <string_view>

namespace uplink::loop {

/// The ClientHello with which OpenSSL's client begins, for HTTP/2; empty if OpenSSL cannot make
/// one.
[[nodiscard]] std::string MakeClientHello();

/// Bytes of an answer that IsServerHello needs: a record's header and the message's type.
inline constexpr std::size_t kServerHelloPrefix = 6;

/// True if a server's answer begins with a ServerHello, not with an alert.
[[nodiscard]] bool IsServerHello(std::string_view answer);

}  // namespace uplink::loop
