#pragma once

#include <string>

// Keys as other tools write them, and damaged texts. Failures of the library end the test program.
namespace uplink::testing {

/// A key on P-256 as `openssl ecparam -genkey` writes it: its parameters, then the key in OpenSSL's
/// own form.
[[nodiscard]] std::string EcparamKey(const std::string& key_pem);
/// The same key behind a pass phrase: an ENCRYPTED PRIVATE KEY.
[[nodiscard]] std::string LockedKey(const std::string& key_pem);
/// In OpenSSL's own form: an EC PRIVATE KEY with `Proc-Type: 4,ENCRYPTED`.
[[nodiscard]] std::string LockedOwnKey(const std::string& key_pem);

/// Its lines end as on Windows.
[[nodiscard]] std::string WithCrlf(const std::string& text);
/// With the first `from`, which it has, replaced.
[[nodiscard]] std::string With(std::string text, const std::string& from, const std::string& to);
/// A block of this label; `body` is its lines.
[[nodiscard]] std::string BlockOf(const std::string& label, const std::string& body = "");

}  // namespace uplink::testing
