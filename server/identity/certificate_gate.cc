#include "server/identity/certificate_gate.h"

#include <algorithm>
#include <array>
#include <optional>

#include "server/identity/public_key_gate.h"

namespace uplink::identity {
namespace {

/// The bit of a tag whose content is elements.
constexpr std::uint8_t kConstructed = 0x20;
/// Bytes of the shortest element.
constexpr std::size_t kElementBytesMin = 2;
/// Elements within elements that are counted one by one: certificates have 8 at most.
constexpr std::size_t kElementDepthMax = 16;
/// Tags of a context from the first of these to the last may stand for a list: OpenSSL does not ask
/// for kConstructed there. What follows them stands for a text or an address alone.
constexpr std::uint8_t kFirstHiddenList = 0x80;
constexpr std::uint8_t kLastHiddenList = 0x85;

/// 2.5.29.31, as the content of its element.
constexpr std::array<std::uint8_t, 3> kDistributionPoints = {0x55, 0x1D, 0x1F};
/// Of a distribution point: its name, of which that in full and that relative to the issuer.
constexpr std::uint8_t kPointName = 0xA0;
constexpr std::uint8_t kFullName = 0xA0;
constexpr std::uint8_t kPointReasons = 0x81;
constexpr std::uint8_t kPointIssuer = 0xA2;

CertificateFlaw FlawOf(KeyFlaw flaw) {
  switch (flaw) {
    case KeyFlaw::kNone:
      return CertificateFlaw::kNone;
    case KeyFlaw::kMalformed:
      return CertificateFlaw::kMalformed;
    case KeyFlaw::kKind:
      return CertificateFlaw::kKeyKind;
    case KeyFlaw::kSize:
      return CertificateFlaw::kKeySize;
  }
  return CertificateFlaw::kMalformed;
}

/// The elements of a value of any shape, those within others too. What is no DER, or lies within
/// more than `depth` others, counts as many as its bytes could be: what OpenSSL makes of it is not
/// known. An element ends where the one around it does: one that claims to go on hides none behind
/// it.
// NOLINTNEXTLINE(misc-no-recursion): at most kElementDepthMax deep
std::size_t ElementsOf(Bytes value, std::size_t depth) {
  if (depth == 0) return value.size() / kElementBytesMin;
  std::size_t count = 0;
  DerReader reader(value);
  while (!reader.empty()) {
    const auto element = reader.Take();
    if (!element) return value.size() / kElementBytesMin;
    ++count;
    if (element->tag >= kFirstHiddenList && element->tag <= kLastHiddenList) {
      count += element->content.size() / kElementBytesMin;
    } else if ((element->tag & kConstructed) != 0) {
      count += ElementsOf(element->content, depth - 1);
    }
  }
  return count;
}

/// Whether every distribution point names its list in full, if at all. For a name that is relative
/// to the issuer's OpenSSL copies the whole name of the issuer, once for each point: 330 attributes
/// and 330 points, which are 5.5 KB, cost 90 ms before anything is verified (measured). Nobody here
/// reads such lists.
bool NamesInFull(Bytes value) {
  DerReader outer(value);
  const auto points = outer.Take(DerTag::kSequence);
  if (!points || !outer.empty()) return false;
  DerReader each(*points);
  while (!each.empty()) {
    const auto point = each.Take(DerTag::kSequence);
    if (!point) return false;
    DerReader parts(*point);
    while (!parts.empty()) {
      const auto part = parts.Take();
      if (!part) return false;
      if (part->tag == kPointReasons || part->tag == kPointIssuer) continue;
      if (part->tag != kPointName) return false;
      DerReader name(part->content);
      const auto in_full = name.Take();
      if (!in_full || in_full->tag != kFullName || !name.empty()) return false;
    }
  }
  return true;
}

/// Goes through certificates, and counts their elements. Confined to one call.
class Walk final {
 public:
  CertificateFlaw Certificate(Bytes certificate) {
    DerReader outer(certificate);
    const auto whole = outer.Take(DerTag::kSequence);
    if (!whole || !outer.empty()) return CertificateFlaw::kMalformed;
    DerReader parts(*whole);
    const auto body = parts.Take(DerTag::kSequence);
    if (!body || !parts.Take(DerTag::kSequence) || !parts.Take(DerTag::kBits) || !parts.empty()) {
      return CertificateFlaw::kMalformed;
    }
    const auto key = KeyIn(DerReader(*body));
    if (elements_ > kShownElementsMax) return CertificateFlaw::kElements;
    return key ? FlawOf(FlawOfKey(*key)) : CertificateFlaw::kMalformed;
  }

 private:
  /// The content of the SubjectPublicKeyInfo of what is signed; nothing if that is not as it should
  /// be, from its first byte to its last.
  std::optional<Bytes> KeyIn(DerReader body) {
    if (body.IsNext(DerTag::kExplicit0)) {
      const auto version = body.Take(DerTag::kExplicit0);
      if (!version || !IsOne(*version, DerTag::kInteger)) return std::nullopt;
    }
    const bool begins = body.Take(DerTag::kInteger) && body.Take(DerTag::kSequence);
    if (!begins || !Name(body.Take(DerTag::kSequence))) return std::nullopt;
    if (!Validity(body.Take(DerTag::kSequence))) return std::nullopt;
    if (!Name(body.Take(DerTag::kSequence))) return std::nullopt;
    const auto key = body.Take(DerTag::kSequence);
    for (const DerTag identifier : {DerTag::kImplicit1, DerTag::kImplicit2}) {
      if (body.IsNext(identifier) && !body.Take(identifier)) return std::nullopt;
    }
    if (body.IsNext(DerTag::kExplicit3) && !Extensions(body.Take(DerTag::kExplicit3))) {
      return std::nullopt;
    }
    return body.empty() ? key : std::nullopt;
  }

  static bool IsOne(Bytes content, DerTag tag) {
    DerReader reader(content);
    return reader.Take(tag) && reader.empty();
  }

  static bool Validity(std::optional<Bytes> content) {
    if (!content) return false;
    DerReader times(*content);
    for (int i = 0; i < 2; ++i) {
      if (!times.Take(times.IsNext(DerTag::kTime) ? DerTag::kTime : DerTag::kUtcTime)) return false;
    }
    return times.empty();
  }

  bool Name(std::optional<Bytes> content) {
    if (!content) return false;
    DerReader sets(*content);
    while (!sets.empty()) {
      const auto set = sets.Take(DerTag::kSet);
      if (!set) return false;
      DerReader attributes(*set);
      while (!attributes.empty()) {
        const auto attribute = attributes.Take(DerTag::kSequence);
        if (!attribute || !Attribute(DerReader(*attribute))) return false;
      }
      ++elements_;
    }
    return true;
  }

  bool Attribute(DerReader parts) {
    elements_ += 3;
    if (!parts.Take(DerTag::kOid)) return false;
    const auto value = parts.Take();
    return value && (value->tag & kConstructed) == 0 && parts.empty();
  }

  bool Extensions(std::optional<Bytes> content) {
    if (!content) return false;
    DerReader outer(*content);
    const auto list = outer.Take(DerTag::kSequence);
    if (!list || !outer.empty()) return false;
    DerReader extensions(*list);
    while (!extensions.empty()) {
      const auto extension = extensions.Take(DerTag::kSequence);
      if (!extension || !Extension(DerReader(*extension))) return false;
    }
    return true;
  }

  bool Extension(DerReader parts) {
    elements_ += 3;
    const auto oid = parts.Take(DerTag::kOid);
    if (!oid) return false;
    if (parts.IsNext(DerTag::kBoolean) && !parts.Take(DerTag::kBoolean)) return false;
    const auto value = parts.Take(DerTag::kOctets);
    if (!value || !parts.empty()) return false;
    elements_ += ElementsOf(*value, kElementDepthMax);
    return !std::ranges::equal(*oid, kDistributionPoints) || NamesInFull(*value);
  }

  std::size_t elements_ = 0;
};

/// Takes TLS's vectors from a message: a length, and as many bytes. Confined to one call.
class VectorReader final {
 public:
  explicit VectorReader(Bytes bytes) : rest_(bytes) {}

  /// The next one's content, whose length has so many bytes; nothing if it is not there.
  std::optional<Bytes> Take(std::size_t length_bytes) {
    if (rest_.size() < length_bytes) return std::nullopt;
    std::size_t length = 0;
    for (std::size_t i = 0; i < length_bytes; ++i) length = length << 8U | rest_[i];
    if (rest_.size() - length_bytes < length) return std::nullopt;
    const Bytes content = rest_.subspan(length_bytes, length);
    rest_ = rest_.subspan(length_bytes + length);
    return content;
  }
  [[nodiscard]] bool empty() const { return rest_.empty(); }

 private:
  Bytes rest_;
};

constexpr std::size_t kContextLengthBytes = 1;
constexpr std::size_t kListLengthBytes = 3;
constexpr std::size_t kExtensionsLengthBytes = 2;

}  // namespace

// The texts below say these.
static_assert(kShownCertificatesMax == 10 && kShownBytesMax == std::size_t{32} * 1024);
static_assert(kShownElementsMax == 2048);
static_assert(kRsaBitsMax == 4096 && kRsaExponentBitsMax == 64);

std::string_view TextOf(CertificateFlaw flaw) {
  switch (flaw) {
    case CertificateFlaw::kNone:
      return "";
    case CertificateFlaw::kMalformed:
      return "malformed";
    case CertificateFlaw::kCount:
      return "more than 10 certificates";
    case CertificateFlaw::kBytes:
      return "more than 32 KiB of certificates";
    case CertificateFlaw::kElements:
      return "names and extensions of more than 2,048 elements";
    case CertificateFlaw::kKeyKind:
      return "a key that is none of P-256, P-384, P-521, Ed25519, Ed448, RSA and RSA-PSS";
    case CertificateFlaw::kKeySize:
      return "an RSA key of over 4,096 bits, or with an exponent of over 64 bits";
  }
  return "malformed";
}

CertificateFlaw FlawOfCertificate(Bytes certificate) { return Walk().Certificate(certificate); }

CertificateFlaw FlawOfMessage(MessageForm form, Bytes body) {
  if (body.size() > kShownBytesMax) return CertificateFlaw::kBytes;
  VectorReader message(body);
  if (form == MessageForm::kTls13) {
    const auto context = message.Take(kContextLengthBytes);
    if (!context || !context->empty()) return CertificateFlaw::kMalformed;
  }
  const auto list = message.Take(kListLengthBytes);
  if (!list || !message.empty()) return CertificateFlaw::kMalformed;
  VectorReader certificates(*list);
  Walk walk;
  for (std::size_t count = 1; !certificates.empty(); ++count) {
    if (count > kShownCertificatesMax) return CertificateFlaw::kCount;
    const auto certificate = certificates.Take(kListLengthBytes);
    if (!certificate) return CertificateFlaw::kMalformed;
    if (form == MessageForm::kTls13) {
      const auto extensions = certificates.Take(kExtensionsLengthBytes);
      if (!extensions || !extensions->empty()) return CertificateFlaw::kMalformed;
    }
    if (const auto flaw = walk.Certificate(*certificate); flaw != CertificateFlaw::kNone) {
      return flaw;
    }
  }
  return CertificateFlaw::kNone;
}

}  // namespace uplink::identity
