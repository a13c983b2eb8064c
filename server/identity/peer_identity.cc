#include "server/identity/peer_identity.h"

#include <memory>
#include <optional>
#include <utility>

#include <fmt/format.h>
#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>

#include "schema/base/utf8.h"
#include "server/identity/fleet_name.h"
#include "server/identity/pem.h"
#include "server/identity/ruri.h"

namespace uplink::identity {
namespace {

/// How many bytes of a certificate a message repeats.
constexpr std::size_t kShownBytesMax = 128;
constexpr std::string_view kDefaultFleet = "default";

struct NamesFree {
  void operator()(GENERAL_NAMES* names) const { GENERAL_NAMES_free(names); }
};
using Names = std::unique_ptr<GENERAL_NAMES, NamesFree>;

absl::Status Wrong(std::string_view sentence) {
  return absl::UnauthenticatedError(fmt::format("client certificate: {}", sentence));
}

std::string Shown(std::string_view text) { return PrintableUtf8(text, kShownBytesMax); }

/// The raw bytes of an ASN.1 string; a view into `text`.
std::string_view BytesOf(const ASN1_STRING* text) {
  // The library's bytes are unsigned char; looking at them as char is always allowed.
  return {reinterpret_cast<const char*>(ASN1_STRING_get0_data(text)),
          static_cast<std::size_t>(ASN1_STRING_length(text))};
}

/// The attribute as UTF-8, from any ASN.1 string type; nothing if it cannot be converted.
std::optional<std::string> Utf8Of(const ASN1_STRING* text) {
  unsigned char* bytes = nullptr;
  const int length = ASN1_STRING_to_UTF8(&bytes, text);
  if (length < 0) {
    ERR_clear_error();
    return std::nullopt;
  }
  std::string utf8(bytes, bytes + length);
  OPENSSL_free(bytes);
  return utf8;
}

/// An attribute that the subject may have only once.
absl::StatusOr<std::optional<std::string>> SubjectPart(const X509& certificate, int nid,
                                                       std::string_view name) {
  const X509_NAME* subject = X509_get_subject_name(&certificate);
  const int first = X509_NAME_get_index_by_NID(subject, nid, -1);
  if (first < 0) return std::optional<std::string>();
  if (X509_NAME_get_index_by_NID(subject, nid, first) >= 0) {
    return Wrong(fmt::format("its subject has more than one {}", name));
  }
  std::optional<std::string> text =
      Utf8Of(X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, first)));
  if (!text) return Wrong(fmt::format("the {} of its subject is not valid text", name));
  if (text->find('\0') != std::string::npos) {
    return Wrong(fmt::format("the {} of its subject holds a NUL byte", name));
  }
  return text;
}

absl::Status CheckKeyUsage(X509& certificate) {
  // Reading the flags makes the library parse the extensions.
  const std::uint32_t flags = X509_get_extension_flags(&certificate);
  ERR_clear_error();
  if ((flags & EXFLAG_INVALID) != 0) return Wrong("its extensions are malformed");
  if ((flags & EXFLAG_XKUSAGE) == 0) return Wrong("it has no extended key usage clientAuth");
  if ((X509_get_extended_key_usage(&certificate) & XKU_SSL_CLIENT) == 0) {
    return Wrong("its extended key usage lacks clientAuth");
  }
  return absl::OkStatus();
}

/// The URI names that begin rcan://, each checked. Other names are ignored.
absl::StatusOr<std::vector<std::string>> RurisOf(const X509& certificate) {
  int critical = 0;
  const Names names(static_cast<GENERAL_NAMES*>(
      X509_get_ext_d2i(&certificate, NID_subject_alt_name, &critical, nullptr)));
  ERR_clear_error();
  if (names == nullptr) {
    if (critical == -1) return std::vector<std::string>();
    return Wrong("its subject alternative names are malformed or stand there twice");
  }
  std::vector<std::string> ruris;
  for (int i = 0; i < sk_GENERAL_NAME_num(names.get()); ++i) {
    const GENERAL_NAME* name = sk_GENERAL_NAME_value(names.get(), i);
    if (name->type != GEN_URI) continue;
    const std::string_view uri = BytesOf(name->d.uniformResourceIdentifier);
    if (!uri.starts_with(kRuriScheme)) continue;
    if (const auto flaw = FlawOfRuri(uri)) return Wrong(fmt::format("its rcan:// URI {}", *flaw));
    if (NamesTwin(uri)) {
      return Wrong(
          fmt::format("its rcan:// URI {} is a twin's, and twins are heard through their "
                      "broker alone",
                      Shown(uri)));
    }
    ruris.emplace_back(uri);
  }
  return ruris;
}

absl::StatusOr<Role> RoleOf(const std::optional<std::string>& unit) {
  if (!unit) return Role::kRobot;
  for (const Role role : {Role::kRobot, Role::kGateway}) {
    if (*unit == ToText(role)) return role;
  }
  if (const std::optional<Role> role = AskingRoleOf(*unit)) return *role;
  return Wrong(fmt::format("its OU is {}, which is no role", Shown(*unit)));
}

absl::StatusOr<std::string> FleetOf(const std::optional<std::string>& organization) {
  if (!organization) return std::string(kDefaultFleet);
  if (const auto flaw = FlawOfFleet(*organization)) return Wrong(fmt::format("its O {}", *flaw));
  return *organization;
}

/// `count`: how many RURIs the certificate has.
absl::Status CheckRole(const PeerIdentity& identity, std::size_t count) {
  switch (identity.role) {
    case Role::kRobot:
      if (count == 0) return Wrong("it is a robot's and has no URI name that begins rcan://");
      if (count > 1) {
        return Wrong(fmt::format("it is a robot's and has {} rcan:// URIs instead of one", count));
      }
      [[fallthrough]];
    case Role::kGateway:
      if (identity.fleet == kAllFleets) {
        return Wrong("its O is *, which only operators may have");
      }
      return absl::OkStatus();
    case Role::kViewer:
    case Role::kOperator:
    case Role::kAdmin:
    case Role::kMetrics:
      if (count > 0) {
        return Wrong(
            fmt::format("its OU is {} and it has an rcan:// URI, which only robots and "
                        "gateways may have",
                        ToText(identity.role)));
      }
      return absl::OkStatus();
  }
  return Wrong("it has no role");
}

}  // namespace

std::string_view ToText(Role role) {
  switch (role) {
    case Role::kRobot:
      return "robot";
    case Role::kGateway:
      return "gateway";
    case Role::kViewer:
      return "viewer";
    case Role::kOperator:
      return "operator";
    case Role::kAdmin:
      return "admin";
    case Role::kMetrics:
      return "metrics";
  }
  return "";
}

std::optional<Role> AskingRoleOf(std::string_view text) {
  for (const Role role : kAskingRoles) {
    if (text == ToText(role)) return role;
  }
  return std::nullopt;
}

absl::StatusOr<PeerIdentity> IdentityOf(X509& certificate) {
  if (const absl::Status status = CheckKeyUsage(certificate); !status.ok()) return status;

  const auto unit = SubjectPart(certificate, NID_organizationalUnitName, "OU");
  if (!unit.ok()) return unit.status();
  const auto organization = SubjectPart(certificate, NID_organizationName, "O");
  if (!organization.ok()) return organization.status();
  const auto role = RoleOf(*unit);
  if (!role.ok()) return role.status();
  auto fleet = FleetOf(*organization);
  if (!fleet.ok()) return fleet.status();
  auto ruris = RurisOf(certificate);
  if (!ruris.ok()) return ruris.status();

  PeerIdentity identity{.role = *role, .fleet = *std::move(fleet)};
  if (const absl::Status status = CheckRole(identity, ruris->size()); !status.ok()) return status;
  if (identity.role == Role::kRobot) identity.ruri = std::move(ruris->front());
  if (identity.role == Role::kGateway) {
    identity.gateway = {.subject = SubjectOf(certificate), .ruris = *std::move(ruris)};
  }
  return identity;
}

std::string SubjectOf(const X509& certificate) {
  // Letters beyond ASCII as they are.
  constexpr unsigned long kFlags =
      XN_FLAG_RFC2253 & ~static_cast<unsigned long>(ASN1_STRFLGS_ESC_MSB);
  const Bio bio(BIO_new(BIO_s_mem()));
  if (bio == nullptr ||
      X509_NAME_print_ex(bio.get(), X509_get_subject_name(&certificate), 0, kFlags) < 0) {
    ERR_clear_error();
    return {};
  }
  char* text = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &text);
  return PrintableUtf8({text, static_cast<std::size_t>(size)}, kSubjectBytesMax);
}

}  // namespace uplink::identity
