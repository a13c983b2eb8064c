#include "server/identity/certificate_gate.h"

#include <optional>

#include "server/identity/extension_gate.h"
#include "server/identity/public_key_gate.h"

namespace uplink::identity {
namespace {

/// The bit that marks a tag whose content is elements.
constexpr std::uint8_t kConstructed = 0x20;

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

/// Reads certificates and counts their elements. Confined to one call.
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
    if (has_relative_point_) return CertificateFlaw::kRelativePoint;
    return key ? FlawOf(FlawOfKey(*key)) : CertificateFlaw::kMalformed;
  }

 private:
  /// The content of the SubjectPublicKeyInfo in the signed part; nothing if any byte of that part
  /// is not as it should be.
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
    elements_ += ElementsOfExtension(*oid, *value);
    const ExtensionFlaw flaw = FlawOfExtension(*oid, *value);
    has_relative_point_ = has_relative_point_ || flaw == ExtensionFlaw::kRelativePoint;
    return flaw != ExtensionFlaw::kMalformed;
  }

  std::size_t elements_ = 0;
  bool has_relative_point_ = false;
};

/// Takes TLS's vectors from a message: a length, then that many bytes. Confined to one call.
class VectorReader final {
 public:
  explicit VectorReader(Bytes bytes) : rest_(bytes) {}

  /// The content of the next vector, whose length has `length_bytes`; nothing if it is incomplete.
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

// The texts below repeat these bounds.
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
      return "a key that is none of P-256, P-384, P-521 (by name: written out they are none), "
             "Ed25519, Ed448, RSA and RSA-PSS";
    case CertificateFlaw::kKeySize:
      return "an RSA key of over 4,096 bits, or with an exponent of over 64 bits";
    case CertificateFlaw::kRelativePoint:
      return "a CRL distribution point relative to its issuer's name: issue it with the full name "
             "(a URI), or without the point";
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
