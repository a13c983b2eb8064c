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

/// Blocks of one PEM text: some times the authorities of a system's bundle, about 150.
inline constexpr std::size_t kPemBlocksMax = 4096;
/// Bytes of one block with its lines BEGIN and END. The largest certificate that a peer may show
/// has 44 KiB as PEM, an RSA key of 16,384 bits 13 KiB.
inline constexpr std::size_t kPemBlockBytesMax = std::size_t{64} * 1024;
/// Blocks of one text that are named, if they have no use; the others are counted.
inline constexpr std::size_t kRefusedNamedMax = 8;

/// What a block's label, the word behind BEGIN, says that it is. Closed: a text with another label
/// is refused.
enum class PemKind : std::uint8_t {
  /// CERTIFICATE, X509 CERTIFICATE, TRUSTED CERTIFICATE.
  kCertificate,
  /// PRIVATE KEY, EC PRIVATE KEY, RSA PRIVATE KEY.
  kKey,
  /// ENCRYPTED PRIVATE KEY, or another key whose lines say that it is encrypted.
  kEncryptedKey,
  /// What tools write beside those and no file needs: EC PARAMETERS and the like, public keys,
  /// requests for certificates.
  kPassedOver,
};

/// One block of a text, or what is left of one that is damaged. A value.
struct PemBlock {
  PemKind kind = PemKind::kPassedOver;
  /// From 1, as sentences count.
  std::size_t number = 0;
  std::size_t line = 0;
  /// Its bytes, BEGIN and END with them.
  std::size_t begin = 0;
  std::size_t bytes = 0;
  /// The first thing that is wrong with it; empty if nothing is. Kind and bytes count for nothing
  /// then.
  std::string flaw;
};

/// Splits a text into its blocks; what the blocks hold is not read. Text between blocks counts for
/// nothing, and lines may end as on Windows. OpenSSL passes over a block whose first line is
/// damaged or missing and says nothing; here it is a block with a flaw, because a certificate would
/// be lost with it. Flaws: it is damaged, has a label that no file here takes, or is past
/// kPemBlockBytesMax. CheckBlocks makes an error of them.
///
/// Errors: kFailedPrecondition with the text's name: there are more than kPemBlocksMax.
/// Thread: pure; any thread. Time: linear in the bytes.
/// Source: RFC 7468; OpenSSL's pem.h for the labels.
[[nodiscard]] absl::StatusOr<std::vector<PemBlock>> BlocksOf(const NamedPem& pem);

/// Errors: kFailedPrecondition with the text's name, and the number, the line and the flaw of every
///         block that has one.
/// Limits: kRefusedNamedMax.
[[nodiscard]] absl::Status CheckBlocks(const NamedPem& pem, const std::vector<PemBlock>& blocks);

/// The bytes of a block; a view into the text.
[[nodiscard]] std::string_view TextOf(const NamedPem& pem, const PemBlock& block);

}  // namespace uplink::identity
