#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include <absl/status/status.h>
#include <absl/status/statusor.h>

#include "server/identity/pem_file.h"

namespace uplink::identity {

/// Blocks of one PEM text: far more than a system's bundle has authorities, about 150.
inline constexpr std::size_t kPemBlocksMax = 4096;
/// Bytes of one block with its lines BEGIN and END. The largest certificate that a peer may show
/// has 44 KiB as PEM, an RSA key of 16,384 bits 13 KiB.
inline constexpr std::size_t kPemBlockBytesMax = std::size_t{64} * 1024;
/// How many blocks of one text that cannot be used are named; the others are counted.
inline constexpr std::size_t kRefusedNamedMax = 8;

/// The kind of a block, from its label, the words after BEGIN. Closed: a text with another label is
/// refused.
enum class PemKind : std::uint8_t {
  /// CERTIFICATE, X509 CERTIFICATE, TRUSTED CERTIFICATE.
  kCertificate,
  /// PRIVATE KEY, EC PRIVATE KEY, RSA PRIVATE KEY.
  kKey,
  /// ENCRYPTED PRIVATE KEY, or another key with a line that says it is encrypted.
  kEncryptedKey,
  /// Blocks that tools write beside those and that we do not need: EC PARAMETERS and the like,
  /// public keys, requests for certificates.
  kPassedOver,
};

/// One block of a text, or the rest of a damaged one. A value.
struct PemBlock {
  PemKind kind = PemKind::kPassedOver;
  /// Both from 1.
  std::size_t number = 0;
  std::size_t line = 0;
  /// Its place in the text, with the lines BEGIN and END.
  std::size_t begin = 0;
  std::size_t bytes = 0;
  /// The first thing that is wrong with it; empty if nothing is. With a flaw, kind and bytes mean
  /// nothing.
  std::string flaw;
};

/// Splits a text into its blocks and does not read their content. Text between blocks is ignored,
/// and lines may end as on Windows. OpenSSL silently skips a block whose first line is damaged or
/// missing; here it is a block with a flaw, because a certificate would be lost with it. A block
/// has a flaw if it is damaged, has a label that we do not accept, or is larger than
/// kPemBlockBytesMax. CheckBlocks turns flaws into an error.
///
/// Errors: kFailedPrecondition with the text's name: there are more than kPemBlocksMax.
/// Thread: pure; any thread. Time: linear in the bytes.
/// Source: RFC 7468; OpenSSL's pem.h for the labels.
[[nodiscard]] absl::StatusOr<std::vector<PemBlock>> BlocksOf(const NamedPem& pem);

/// Errors: kFailedPrecondition with the text's name, and the number, line and flaw of every block
///         with a flaw.
/// Limits: kRefusedNamedMax.
[[nodiscard]] absl::Status CheckBlocks(const NamedPem& pem, const std::vector<PemBlock>& blocks);

/// The bytes of a block; a view into the text.
[[nodiscard]] std::string_view TextOf(const NamedPem& pem, const PemBlock& block);

}  // namespace uplink::identity
