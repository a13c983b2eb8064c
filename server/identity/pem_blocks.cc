#include "server/identity/pem_blocks.h"

#include <algorithm>
#include <array>
#include <optional>
#include <string>
#include <utility>

#include <absl/strings/ascii.h>
#include <fmt/core.h>

#include "schema/base/utf8.h"

namespace uplink::identity {
namespace {

constexpr std::string_view kBegin = "-----BEGIN ";
constexpr std::string_view kEnd = "-----END ";
constexpr std::string_view kDashes = "-----";
constexpr std::string_view kByteOrderMark = "\xEF\xBB\xBF";
constexpr std::string_view kRevocations = "X509 CRL";
/// How many bytes of a label a message repeats.
constexpr std::size_t kLabelShownMax = 64;

struct Label {
  std::string_view text;
  PemKind kind;
};
constexpr std::array kLabels = {
    Label{"CERTIFICATE", PemKind::kCertificate},
    Label{"X509 CERTIFICATE", PemKind::kCertificate},
    Label{"TRUSTED CERTIFICATE", PemKind::kCertificate},
    Label{"PRIVATE KEY", PemKind::kKey},
    Label{"EC PRIVATE KEY", PemKind::kKey},
    Label{"RSA PRIVATE KEY", PemKind::kKey},
    Label{"ENCRYPTED PRIVATE KEY", PemKind::kEncryptedKey},
    Label{"EC PARAMETERS", PemKind::kPassedOver},
    Label{"DH PARAMETERS", PemKind::kPassedOver},
    Label{"X9.42 DH PARAMETERS", PemKind::kPassedOver},
    Label{"DSA PARAMETERS", PemKind::kPassedOver},
    Label{"PUBLIC KEY", PemKind::kPassedOver},
    Label{"RSA PUBLIC KEY", PemKind::kPassedOver},
    Label{"CERTIFICATE REQUEST", PemKind::kPassedOver},
    Label{"NEW CERTIFICATE REQUEST", PemKind::kPassedOver},
};

std::optional<PemKind> KindOf(std::string_view label) {
  const auto* const found = std::ranges::find(kLabels, label, &Label::text);
  if (found == kLabels.end()) return std::nullopt;
  return found->kind;
}

/// The text between the dashes of a line that begins or ends a block.
std::optional<std::string_view> LabelOf(std::string_view line, std::string_view mark) {
  if (!line.starts_with(mark) || !line.ends_with(kDashes)) return std::nullopt;
  if (line.size() <= mark.size() + kDashes.size()) return std::nullopt;
  return line.substr(mark.size(), line.size() - mark.size() - kDashes.size());
}

/// The line's letters and digits, as capitals.
std::string LettersOf(std::string_view line) {
  std::string letters;
  for (const char c : line) {
    if (absl::ascii_isalnum(static_cast<unsigned char>(c)))
      letters += absl::ascii_toupper(static_cast<unsigned char>(c));
  }
  return letters;
}

/// True for a line that should begin or end a certificate or a key and does not: it has other
/// dashes, blanks beside them, or small letters. Lines that only mention certificates, as `openssl
/// x509 -text` writes them, have further words.
bool IsOtherwiseWritten(std::string_view line) {
  for (const std::string_view mark : {kBegin, kEnd}) {
    if (const auto label = LabelOf(line, mark); label && KindOf(*label)) return false;
  }
  const std::string letters = LettersOf(line);
  for (const std::string_view word : {"BEGIN", "END"}) {
    if (!letters.starts_with(word)) continue;
    const std::string_view rest = std::string_view(letters).substr(word.size());
    for (const Label& label : kLabels) {
      if (label.kind != PemKind::kPassedOver && rest == LettersOf(label.text)) return true;
    }
  }
  return false;
}

/// True for a line that should begin or end a block and does not: a dash is missing, or text comes
/// before it.
bool IsDamagedMark(std::string_view line) {
  for (const std::string_view part : {"CERTIFICATE-----", "PRIVATE KEY-----", "-BEGIN ", "-END "}) {
    if (line.find(part) != std::string_view::npos) return true;
  }
  return false;
}

/// True for a line of base64 that begins a certificate or an RSA key: their DER begins with a
/// sequence of two bytes of length.
bool IsBody(std::string_view line) {
  const std::size_t at = line.find_first_not_of(" \t");
  return at != std::string_view::npos && line.substr(at).starts_with("MII");
}

/// True for the line that OpenSSL writes into an encrypted key of its own format.
bool SaysEncrypted(std::string_view line) {
  return line.starts_with("Proc-Type:") && line.find("ENCRYPTED") != std::string_view::npos;
}

/// Which end of a block a damaged line should be.
enum class Side : std::uint8_t { kFirst, kLast, kEither };

Side SideOf(std::string_view line) {
  const std::string letters = LettersOf(line);
  if (letters.find("BEGIN") != std::string::npos) return Side::kFirst;
  return letters.find("END") != std::string::npos ? Side::kLast : Side::kEither;
}

/// Reads the lines of a text. Confined to one call.
class Splitter final {
 public:
  explicit Splitter(const NamedPem& pem) : pem_(pem) {}

  absl::StatusOr<std::vector<PemBlock>> Split() && {
    // Some editors write one at the start of a file; OpenSSL skips it too.
    std::size_t at = pem_.text.starts_with(kByteOrderMark) ? kByteOrderMark.size() : 0;
    while (at < pem_.text.size()) {
      const std::size_t end = std::min(pem_.text.find('\n', at), pem_.text.size());
      ++line_;
      TakeLine(at, end);
      if (blocks_.size() > kPemBlocksMax) {
        return absl::FailedPreconditionError(
            fmt::format("{}: holds more than {} PEM blocks", pem_.name, kPemBlocksMax));
      }
      at = end + 1;
    }
    if (begun_) NoteBroken("it has no end");
    return std::move(blocks_);
  }

 private:
  void TakeLine(std::size_t at, std::size_t end) {
    std::string_view line = std::string_view(pem_.text).substr(at, end - at);
    while (!line.empty() && std::string_view(" \t\r").find(line.back()) != std::string_view::npos) {
      line.remove_suffix(1);
    }
    if (IsOtherwiseWritten(line)) return TakeDamaged(at, line);
    if (const auto label = LabelOf(line, kBegin)) {
      TakeBegin(at, *label);
    } else if (const auto label_at_end = LabelOf(line, kEnd)) {
      if (!begun_) Begin(at);
      End(*label_at_end, end);
    } else if (!begun_ && IsBody(line)) {
      Begin(at);
      NoteBroken("no line -----BEGIN CERTIFICATE----- stands before it, nor that of a key");
    } else if (IsDamagedMark(line)) {
      TakeDamaged(at, line);
    } else if (begun_ && blocks_.back().kind == PemKind::kKey && SaysEncrypted(line)) {
      blocks_.back().kind = PemKind::kEncryptedKey;
    }
  }

  void TakeBegin(std::size_t at, std::string_view label) {
    Begin(at);
    label_ = label;
    if (const auto kind = KindOf(label)) {
      blocks_.back().kind = *kind;
    } else if (label == kRevocations) {
      Refuse("cannot be used: lists of revoked certificates are not read");
    } else {
      Refuse(fmt::format("cannot be used: a file here holds no {}",
                         PrintableUtf8(label, kLabelShownMax)));
    }
  }

  /// Takes a damaged line that begins or ends a block.
  void TakeDamaged(std::size_t at, std::string_view line) {
    const Side side = SideOf(line);
    const bool ends = side == Side::kLast || (side == Side::kEither && begun_);
    if (!ends || !begun_) Begin(at);
    NoteBroken(line.starts_with(kByteOrderMark) ? "a byte order mark stands before its BEGIN"
                                                : "a line with BEGIN or END is damaged");
    begun_ = !ends;
  }

  void Begin(std::size_t at) {
    if (begun_) NoteBroken("it has no end");
    begun_ = true;
    label_.clear();
    blocks_.push_back({.number = blocks_.size() + 1, .line = line_, .begin = at});
  }

  void End(std::string_view label, std::size_t end) {
    begun_ = false;
    PemBlock& block = blocks_.back();
    block.bytes = end - block.begin;
    if (label != label_) return NoteBroken("its end does not fit its begin");
    if (block.bytes <= kPemBlockBytesMax) return;
    Refuse(
        fmt::format("cannot be used: it has {} bytes, at most {}", block.bytes, kPemBlockBytesMax));
  }

  void NoteBroken(std::string_view why) { Refuse(fmt::format("is broken: {}", why)); }

  void Refuse(std::string flaw) {
    if (blocks_.back().flaw.empty()) blocks_.back().flaw = std::move(flaw);
  }

  const NamedPem& pem_;
  /// The last one is the current one while `begun_`.
  std::vector<PemBlock> blocks_;
  std::size_t line_ = 0;
  bool begun_ = false;
  std::string label_;
};

}  // namespace

absl::StatusOr<std::vector<PemBlock>> BlocksOf(const NamedPem& pem) {
  return Splitter(pem).Split();
}

absl::Status CheckBlocks(const NamedPem& pem, const std::vector<PemBlock>& blocks) {
  std::size_t refused = 0;
  std::string said;
  for (const PemBlock& block : blocks) {
    if (block.flaw.empty() || ++refused > kRefusedNamedMax) continue;
    said += fmt::format("{}PEM block {}, from line {}, {}", said.empty() ? "" : "; ", block.number,
                        block.line, block.flaw);
  }
  if (refused == 0) return absl::OkStatus();
  if (refused > kRefusedNamedMax) {
    said += fmt::format("; and {} more blocks", refused - kRefusedNamedMax);
  }
  return absl::FailedPreconditionError(fmt::format("{}: {}", pem.name, said));
}

std::string_view TextOf(const NamedPem& pem, const PemBlock& block) {
  return std::string_view(pem.text).substr(block.begin, block.bytes);
}

}  // namespace uplink::identity
