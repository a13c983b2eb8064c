#include <cstddef>
#include <cstdint>
#include <string>

#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/x509.h>

#include "schema/base/check.h"
#include "schema/base/utf8.h"
#include "server/identity/authorities.h"
#include "server/identity/expiry.h"
#include "server/identity/pem.h"
#include "server/identity/server_pair.h"

namespace {

namespace identity = uplink::identity;
using uplink::IsCleanUtf8;

/// Bytes of the longest sentence about each block that it names: the text's name, a label of 64
/// bytes, numbers.
constexpr std::size_t kSentenceBytesMax = identity::kRefusedNamedMax * 256;

/// What every sentence about a text keeps to, whatever the text was.
void CheckSaid(const absl::Status& status) {
  UPLINK_CHECK(ERR_peek_error() == 0, "no error of OpenSSL is left behind");
  if (status.ok()) return;
  UPLINK_CHECK(absl::IsFailedPrecondition(status), "a text is invalid, nothing else");
  const std::string said(status.message());
  UPLINK_CHECK(said.find(".pem: ") != std::string::npos, "the sentence names the text");
  UPLINK_CHECK(said.size() <= kSentenceBytesMax && IsCleanUtf8(said), "a short line of text");
}

/// How many certificates the blocks of a text are; those without a flaw are in it, one behind the
/// other.
std::size_t CertificatesIn(const identity::NamedPem& pem) {
  const auto blocks = identity::BlocksOf(pem);
  CheckSaid(blocks.status());
  if (!blocks.ok()) return 0;
  UPLINK_CHECK(blocks->size() <= identity::kPemBlocksMax, "within their bound");
  std::size_t end = 0;
  std::size_t flaws = 0;
  std::size_t certificates = 0;
  for (std::size_t i = 0; i < blocks->size(); ++i) {
    const identity::PemBlock& block = (*blocks)[i];
    UPLINK_CHECK(block.number == i + 1 && block.begin >= end, "in order");
    end = block.begin + block.bytes;
    if (!block.flaw.empty()) {
      ++flaws;
      continue;
    }
    UPLINK_CHECK(block.bytes <= identity::kPemBlockBytesMax, "within its bound");
    const auto text = identity::TextOf(pem, block);
    UPLINK_CHECK(text.size() == block.bytes && text.starts_with("-----BEGIN "), "whole");
    if (block.kind == identity::PemKind::kCertificate) ++certificates;
  }
  const absl::Status good = identity::CheckBlocks(pem, *blocks);
  CheckSaid(good);
  UPLINK_CHECK(good.ok() == (flaws == 0), "every flaw is an error");
  return certificates;
}

}  // namespace

/// Any text by every reader of PEM: what is taken is whole, all readers judge alike, and no
/// certificate of a text that is taken was passed over. The text may be two, a certificate's and
/// its key's, between which there is a NUL.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const std::string text(reinterpret_cast<const char*>(data), size);
  const std::size_t cut = text.find('\0');
  const identity::NamedPem first{"a.pem", text.substr(0, cut)};
  const identity::NamedPem second{"b.pem", cut == std::string::npos ? text : text.substr(cut + 1)};
  const std::size_t found = CertificatesIn(first);

  const auto certificates = identity::ReadCertificates(first);
  CheckSaid(certificates.status());
  if (certificates.ok()) UPLINK_CHECK(certificates->size() == found, "none is passed over");
  UPLINK_CHECK(identity::CheckCertificates(first).ok() == certificates.ok(), "they judge alike");

  const absl::Status authorities = identity::CheckAuthorities(first);
  CheckSaid(authorities);
  if (authorities.ok()) UPLINK_CHECK(certificates.ok(), "an authority is a certificate");

  const auto key = identity::ReadKey(second);
  CheckSaid(key.status());
  UPLINK_CHECK(identity::CheckKey(second).ok() == key.ok(), "they judge alike");

  const absl::Status client = identity::CheckClientPair(first, second);
  CheckSaid(client);
  if (client.ok()) UPLINK_CHECK(certificates.ok() && key.ok(), "a pair is both");
  const absl::Status server = identity::CheckServerPair(first, second);
  CheckSaid(server);
  if (server.ok()) UPLINK_CHECK(client.ok(), "a server's pair is a pair");

  const auto expiry = identity::ExpiryOf(first);
  CheckSaid(expiry.status());
  if (expiry.ok()) {
    UPLINK_CHECK(certificates.ok() && *expiry <= identity::kNoExpiry, "an end within its bound");
    UPLINK_CHECK(identity::ExpiryText(*expiry).size() <= 20, "a time of day, or never");
  }
  return 0;
}
