#include "server/identity/extension_gate.h"

#include <algorithm>
#include <array>

namespace uplink::identity {
namespace {

/// The bit that marks a tag whose content is elements.
constexpr std::uint8_t kConstructed = 0x20;
/// Bytes of the shortest element.
constexpr std::size_t kElementBytesMin = 2;
/// The deepest level at which elements are counted one by one: certificates have 8 levels at most.
constexpr std::size_t kElementDepthMax = 16;
/// Context tags without kConstructed, from the first of these to the last, may mark a list: OpenSSL
/// does not require that bit where a list has a context tag. The tags after them mark only a text
/// or an address.
constexpr std::uint8_t kFirstHiddenList = 0x80;
constexpr std::uint8_t kLastHiddenList = 0x85;

/// Object identifiers of extensions, as the content of their element.
using ShortOid = std::array<std::uint8_t, 3>;
constexpr ShortOid kSubjectNames = {0x55, 0x1D, 0x11};
constexpr ShortOid kIssuerNames = {0x55, 0x1D, 0x12};
constexpr ShortOid kNameConstraints = {0x55, 0x1D, 0x1E};
constexpr ShortOid kDistributionPoints = {0x55, 0x1D, 0x1F};
constexpr ShortOid kAuthorityKey = {0x55, 0x1D, 0x23};

/// Tags in a distribution point: its name, in full or relative to its issuer's.
constexpr std::uint8_t kPointName = 0xA0;
constexpr std::uint8_t kFullName = 0xA0;
constexpr std::uint8_t kRelativeName = 0xA1;
constexpr std::uint8_t kHiddenRelativeName = 0x81;
constexpr std::uint8_t kPointReasons = 0x81;
constexpr std::uint8_t kPointIssuer = 0xA2;

bool Is(Bytes content, const ShortOid& oid) { return std::ranges::equal(content, oid); }

/// How many levels of an extension's value, from the outermost, may have a list whose tag does not
/// say so. A GeneralName has none: its primitive elements are one text, one address or one
/// identifier. The two extensions with lists of GeneralNames under a context tag have these
/// directly in their sequence. For all others every level may.
///
/// Source: RFC 5280, 4.2.1.1, 4.2.1.6 and 4.2.1.10; GENERAL_NAME, NAME_CONSTRAINTS and
/// AUTHORITY_KEYID in OpenSSL's crypto/x509.
std::size_t LevelsWithHiddenLists(Bytes oid) {
  if (Is(oid, kSubjectNames) || Is(oid, kIssuerNames)) return 0;
  return Is(oid, kNameConstraints) || Is(oid, kAuthorityKey) ? 2 : kElementDepthMax;
}

/// The elements of a value at depth `level`; the outermost `hidden_levels` levels may have hidden
/// lists. Bytes that are not DER, or lie at kElementDepthMax, count as the most elements that they
/// could be, since we do not know what OpenSSL makes of them. An element cannot end after the one
/// around it, so one that claims to hides no others.
// NOLINTNEXTLINE(misc-no-recursion): at most kElementDepthMax deep
std::size_t ElementsOf(Bytes value, std::size_t level, std::size_t hidden_levels) {
  if (level == kElementDepthMax) return value.size() / kElementBytesMin;
  std::size_t count = 0;
  DerReader reader(value);
  while (!reader.empty()) {
    const auto element = reader.Take();
    if (!element) return value.size() / kElementBytesMin;
    ++count;
    const bool hides = element->tag >= kFirstHiddenList && element->tag <= kLastHiddenList;
    if ((element->tag & kConstructed) != 0) {
      count += ElementsOf(element->content, level + 1, hidden_levels);
    } else if (hides && level < hidden_levels) {
      count += element->content.size() / kElementBytesMin;
    }
  }
  return count;
}

/// Whether the point names its list in full or not at all.
ExtensionFlaw FlawOfPoint(DerReader parts) {
  while (!parts.empty()) {
    const auto part = parts.Take();
    if (!part) return ExtensionFlaw::kMalformed;
    if (part->tag == kPointReasons || part->tag == kPointIssuer) continue;
    if (part->tag != kPointName) return ExtensionFlaw::kMalformed;
    DerReader names(part->content);
    const auto name = names.Take();
    if (!name || !names.empty()) return ExtensionFlaw::kMalformed;
    if (name->tag == kRelativeName || name->tag == kHiddenRelativeName) {
      return ExtensionFlaw::kRelativePoint;
    }
    if (name->tag != kFullName) return ExtensionFlaw::kMalformed;
  }
  return ExtensionFlaw::kNone;
}

}  // namespace

std::size_t ElementsOfExtension(Bytes oid, Bytes value) {
  return ElementsOf(value, 0, LevelsWithHiddenLists(oid));
}

ExtensionFlaw FlawOfExtension(Bytes oid, Bytes value) {
  if (!Is(oid, kDistributionPoints)) return ExtensionFlaw::kNone;
  DerReader outer(value);
  const auto points = outer.Take(DerTag::kSequence);
  if (!points || !outer.empty()) return ExtensionFlaw::kMalformed;
  DerReader each(*points);
  while (!each.empty()) {
    const auto point = each.Take(DerTag::kSequence);
    if (!point) return ExtensionFlaw::kMalformed;
    const ExtensionFlaw flaw = FlawOfPoint(DerReader(*point));
    if (flaw != ExtensionFlaw::kNone) return flaw;
  }
  return ExtensionFlaw::kNone;
}

}  // namespace uplink::identity
