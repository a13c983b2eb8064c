#pragma once

#include <cstddef>
#include <cstdint>

#include "server/identity/der_reader.h"

namespace uplink::identity {

/// How many elements OpenSSL may make of an extension's value, nested ones too. Bytes that are not
/// DER count as the most elements that they could be. So does the content of an element whose tag
/// does not mark a list, but which OpenSSL may read as one.
///
/// `oid` is the content of the extension's identifier, `value` that of its OCTET STRING.
/// Thread: pure; any thread. Nothing is allocated. Time: linear in the bytes.
[[nodiscard]] std::size_t ElementsOfExtension(Bytes oid, Bytes value);

enum class ExtensionFlaw : std::uint8_t {
  kNone,
  /// Its value does not fit its identifier.
  kMalformed,
  /// A CRL distribution point with a name relative to its issuer's. OpenSSL copies the issuer's
  /// whole name for each: 330 attributes and 330 points, which are 5.5 KB, cost 90 ms before
  /// anything is verified (measured). This server reads no such lists.
  kRelativePoint,
};

/// What is wrong with an extension besides the number of its elements. It judges only the extension
/// whose content costs OpenSSL time. Parameters and thread as above.
[[nodiscard]] ExtensionFlaw FlawOfExtension(Bytes oid, Bytes value);

}  // namespace uplink::identity
