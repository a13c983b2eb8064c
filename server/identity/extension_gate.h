#pragma once

#include <cstddef>
#include <cstdint>

#include "server/identity/der_reader.h"

namespace uplink::identity {

/// The elements of an extension's value, those within others too: as many as OpenSSL can make of
/// it. What is no DER counts as many as its bytes could be, and so does a list whose tag does not
/// say that it is one, where OpenSSL may read one.
///
/// `oid` is the content of the extension's identifier, `value` that of its OCTET STRING.
/// Thread: pure; any thread. Nothing is allocated. Time: linear in the bytes.
[[nodiscard]] std::size_t ElementsOfExtension(Bytes oid, Bytes value);

enum class ExtensionFlaw : std::uint8_t {
  kNone,
  /// Not as its identifier has it.
  kMalformed,
  /// A CRL distribution point whose name is relative to its issuer's. For each OpenSSL copies the
  /// issuer's whole name: 330 attributes and 330 points, which are 5.5 KB, cost 90 ms before
  /// anything is verified (measured). Nobody here reads such lists.
  kRelativePoint,
};

/// What is wrong with an extension beside the number of its elements. Judges those alone whose
/// content makes OpenSSL work. Parameters and thread as above.
[[nodiscard]] ExtensionFlaw FlawOfExtension(Bytes oid, Bytes value);

}  // namespace uplink::identity
