#include "server/identity/authorities.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

#include <absl/strings/ascii.h>
#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/x509.h>

#include "server/identity/certificate_gate.h"
#include "server/identity/pem.h"

namespace uplink::identity {
namespace {

constexpr std::string_view kBegin = "-----BEGIN ";
constexpr std::string_view kEnd = "-----END ";
constexpr std::string_view kDashes = "-----";
/// The labels of certificates.
constexpr std::array<std::string_view, 3> kKinds = {"CERTIFICATE", "X509 CERTIFICATE",
                                                    "TRUSTED CERTIFICATE"};

/// What is between the dashes of a line that begins or ends a block.
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

bool IsCertificate(std::string_view label) {
  return std::ranges::find(kKinds, label) != kKinds.end();
}

/// True for a line that was meant to begin or end a certificate and does not: its dashes are others
/// or have blanks beside them, its letters are small. Lines that only speak of certificates, as
/// `openssl x509 -text` writes them, say more than that.
bool IsOtherwiseWritten(std::string_view line) {
  for (const std::string_view mark : {kBegin, kEnd}) {
    if (const auto label = LabelOf(line, mark); label && IsCertificate(*label)) return false;
  }
  const std::string letters = LettersOf(line);
  for (const std::string_view word : {"BEGIN", "END"}) {
    if (!letters.starts_with(word)) continue;
    for (const std::string_view kind : kKinds) {
      if (letters.substr(word.size()) == LettersOf(kind)) return true;
    }
  }
  return false;
}

/// True for a line that was meant to begin or end a block and does not: a dash is missing, or
/// something stands before it.
bool IsDamagedMark(std::string_view line) {
  if (line.find("CERTIFICATE-----") != std::string_view::npos) return true;
  for (const std::string_view word : {"-BEGIN ", "-END "}) {
    if (line.find(word) != std::string_view::npos) return true;
  }
  return false;
}

/// True for a line of a certificate's base64: its DER begins with a sequence of two bytes of
/// length.
bool IsBody(std::string_view line) {
  const std::size_t at = line.find_first_not_of(" \t");
  return at != std::string_view::npos && line.substr(at).starts_with("MII");
}

/// What is said of a block without a use. What no robot may show, no authority may have either: it
/// could show it as part of its chain.
std::optional<std::string> FlawOf(std::string_view block) {
  const Certificate certificate = NextCertificate(PemReader(block).get());
  ERR_clear_error();
  if (certificate == nullptr) return "is broken: it is no certificate that can be read";
  // Without what a TRUSTED CERTIFICATE has behind it.
  unsigned char* bytes = nullptr;
  const int size = i2d_X509(certificate.get(), &bytes);
  if (size <= 0) return "is broken: it is no certificate that can be read";
  const CertificateFlaw flaw = FlawOfCertificate({bytes, static_cast<std::size_t>(size)});
  OPENSSL_free(bytes);
  if (flaw == CertificateFlaw::kNone) return std::nullopt;
  return fmt::format("cannot be used: {}", TextOf(flaw));
}

/// Which end of a block a damaged line was meant to be, as far as it says so.
enum class Side : std::uint8_t { kFirst, kLast, kEither };

Side SideOf(std::string_view line) {
  const std::string letters = LettersOf(line);
  if (letters.find("BEGIN") != std::string::npos) return Side::kFirst;
  return letters.find("END") != std::string::npos ? Side::kLast : Side::kEither;
}

/// Goes through the lines of a text. Confined to one call.
class Blocks final {
 public:
  explicit Blocks(const NamedPem& pem) : pem_(pem) {}

  absl::Status Check() {
    std::size_t at = 0;
    while (at < pem_.text.size()) {
      const std::size_t end = std::min(pem_.text.find('\n', at), pem_.text.size());
      ++line_;
      TakeLine(at, end);
      at = end + 1;
    }
    if (begun_) NoteBroken("it has no end");
    if (refused_ > kRefusedNamedMax) {
      said_ += fmt::format("; and {} more blocks", refused_ - kRefusedNamedMax);
    } else if (refused_ == 0 && certificates_ == 0) {
      said_ = "holds no PEM certificate";
    }
    if (said_.empty()) return absl::OkStatus();
    return absl::FailedPreconditionError(fmt::format("{}: {}", pem_.name, said_));
  }

 private:
  void TakeLine(std::size_t at, std::size_t end) {
    std::string_view line = std::string_view(pem_.text).substr(at, end - at);
    while (!line.empty() && std::string_view(" \t\r").find(line.back()) != std::string_view::npos) {
      line.remove_suffix(1);
    }
    if (IsOtherwiseWritten(line)) return TakeDamaged(at, SideOf(line));
    if (const auto label = LabelOf(line, kBegin)) {
      Begin(at);
      label_ = *label;
    } else if (const auto label_at_end = LabelOf(line, kEnd)) {
      if (!begun_) Begin(at);
      End(*label_at_end, end);
    } else if (!begun_ && IsBody(line)) {
      Begin(at);
      NoteBroken("no line -----BEGIN CERTIFICATE----- stands before it");
    } else if (IsDamagedMark(line)) {
      TakeDamaged(at, SideOf(line));
    }
  }

  /// A line that begins or ends a block, and is damaged.
  void TakeDamaged(std::size_t at, Side side) {
    const bool ends = side == Side::kLast || (side == Side::kEither && begun_);
    if (!ends || !begun_) Begin(at);
    NoteBroken("a line with BEGIN or END is damaged");
    begun_ = !ends;
  }

  void Begin(std::size_t at) {
    if (begun_) NoteBroken("it has no end");
    begun_ = true;
    is_refused_ = false;
    begin_ = at;
    begin_line_ = line_;
    label_ = {};
    ++number_;
  }

  void End(std::string_view label, std::size_t end) {
    begun_ = false;
    if (is_refused_) return;
    if (label != label_) return NoteBroken("its end does not fit its begin");
    if (!IsCertificate(label_)) return;
    ++certificates_;
    const auto block = std::string_view(pem_.text).substr(begin_, end - begin_);
    if (const auto flaw = FlawOf(block)) Refuse(*flaw);
  }

  void NoteBroken(std::string_view why) { Refuse(fmt::format("is broken: {}", why)); }

  /// Of a block the first thing that is wrong is said.
  void Refuse(std::string_view flaw) {
    if (std::exchange(is_refused_, true) || ++refused_ > kRefusedNamedMax) return;
    if (!said_.empty()) said_ += "; ";
    said_ += fmt::format("PEM block {}, from line {}, {}", number_, begin_line_, flaw);
  }

  const NamedPem& pem_;
  std::size_t line_ = 0;
  /// Of the block that is begun, or was last.
  bool begun_ = false;
  bool is_refused_ = false;
  std::size_t begin_ = 0;
  std::size_t begin_line_ = 0;
  std::size_t number_ = 0;
  std::string label_;
  std::size_t certificates_ = 0;
  /// Blocks without a use, and what is said of the first of them.
  std::size_t refused_ = 0;
  std::string said_;
};

}  // namespace

absl::Status CheckAuthorities(const NamedPem& authorities) { return Blocks(authorities).Check(); }

}  // namespace uplink::identity
