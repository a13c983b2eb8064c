#include "server/identity/revocation_list.h"

#include <cstdint>
#include <ctime>
#include <memory>
#include <string_view>
#include <utility>

#include <fmt/core.h>
#include <openssl/err.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include "server/identity/pem.h"
#include "server/identity/shown_certificate.h"
#include "storage/access_store.h"

namespace uplink::identity {
namespace {

struct CrlFree {
  void operator()(X509_CRL* list) const { X509_CRL_free(list); }
};
using Crl = std::unique_ptr<X509_CRL, CrlFree>;
struct PointFree {
  void operator()(ISSUING_DIST_POINT* point) const { ISSUING_DIST_POINT_free(point); }
};

constexpr std::string_view kBegin = "-----BEGIN ";

absl::Status Unfit(const NamedPem& file, const std::string& why) {
  return absl::FailedPreconditionError(fmt::format("{}: {}", file.name, why));
}

absl::StatusOr<std::vector<Crl>> ListsOfPem(const NamedPem& file) {
  std::vector<Crl> lists;
  const Bio reader = PemReader(file.text);
  // An empty pass phrase: without one the library would ask the terminal.
  char no_phrase[] = "";
  while (true) {
    Crl list(PEM_read_bio_X509_CRL(reader.get(), nullptr, nullptr, no_phrase));
    if (list == nullptr) {
      const bool is_end = ERR_GET_REASON(ERR_peek_last_error()) == PEM_R_NO_START_LINE;
      ERR_clear_error();
      if (is_end) break;
      return Unfit(file, fmt::format("list {} is broken: it cannot be read", lists.size() + 1));
    }
    lists.push_back(std::move(list));
    if (lists.size() > kRevocationListsMax) {
      return Unfit(file, fmt::format("it has more than {} lists", kRevocationListsMax));
    }
  }
  if (lists.empty()) return Unfit(file, "holds no PEM X509 CRL; name the file that does");
  return lists;
}

absl::StatusOr<std::vector<Crl>> ListsOf(const NamedPem& file) {
  if (file.text.find(kBegin) != std::string::npos) return ListsOfPem(file);
  const auto* bytes = reinterpret_cast<const unsigned char*>(file.text.data());
  const auto* const end = bytes + file.text.size();
  std::vector<Crl> lists;
  lists.emplace_back(d2i_X509_CRL(nullptr, &bytes, static_cast<long>(file.text.size())));
  ERR_clear_error();
  if (lists.front() != nullptr && bytes == end) return lists;
  return Unfit(file, "is neither a list (CRL) in DER nor one in PEM");
}

/// Why the list tells only a part of what its issuer revoked; empty: it tells all.
std::string FlawOf(X509_CRL* list) {
  if (X509_CRL_get_ext_by_NID(list, NID_delta_crl, -1) >= 0) return "is a delta list";
  const std::unique_ptr<ISSUING_DIST_POINT, PointFree> point(static_cast<ISSUING_DIST_POINT*>(
      X509_CRL_get_ext_d2i(list, NID_issuing_distribution_point, nullptr, nullptr)));
  if (point != nullptr && point->indirectCRL > 0) return "is an indirect list";
  for (int at = X509_CRL_get_ext_by_critical(list, 1, -1); at >= 0;
       at = X509_CRL_get_ext_by_critical(list, 1, at)) {
    const ASN1_OBJECT* const kind = X509_EXTENSION_get_object(X509_CRL_get_ext(list, at));
    if (OBJ_obj2nid(kind) != NID_issuing_distribution_point) {
      return "has a critical extension that the server does not know";
    }
  }
  return {};
}

bool MaySign(X509* authority) {
  // All bits, if the certificate names no usages.
  return (X509_get_key_usage(authority) & KU_CRL_SIGN) != 0;
}

/// The authority that signed the list; null: none of these.
const X509* SignerOf(X509_CRL* list, const std::vector<Certificate>& authorities) {
  for (const Certificate& authority : authorities) {
    if (X509_NAME_cmp(X509_get_subject_name(authority.get()), X509_CRL_get_issuer(list)) != 0) {
      continue;
    }
    EVP_PKEY* const key = X509_get0_pubkey(authority.get());
    const bool good = key != nullptr && MaySign(authority.get()) && X509_CRL_verify(list, key) == 1;
    ERR_clear_error();
    if (good) return authority.get();
  }
  return nullptr;
}

std::optional<SystemTime> NextUpdateOf(const X509_CRL* list) {
  const ASN1_TIME* const next = X509_CRL_get0_nextUpdate(list);
  std::tm utc{};
  if (next == nullptr || ASN1_TIME_to_tm(next, &utc) != 1) return std::nullopt;
  return FromUnixMs(std::int64_t{timegm(&utc)} * 1000);
}

RevocationList ValueOf(X509_CRL* list, const X509& signer) {
  RevocationList value{.issuer = NameOf(*X509_CRL_get_issuer(list)),
                       .revoked = {},
                       .next_update = NextUpdateOf(list)};
  const ShownCertificate::Sha256 key = KeyDigestOf(signer);
  const STACK_OF(X509_REVOKED)* const entries = X509_CRL_get_REVOKED(list);
  for (int i = 0; i < sk_X509_REVOKED_num(entries); ++i) {
    const X509_REVOKED* const entry = sk_X509_REVOKED_value(entries, i);
    value.revoked.push_back(
        {.serial = SerialText(*X509_REVOKED_get0_serialNumber(entry)), .signer = key});
  }
  return value;
}

}  // namespace

absl::StatusOr<std::vector<RevocationList>> ReadRevocationLists(const NamedPem& file,
                                                                const NamedPem& authorities) {
  auto lists = ListsOf(file);
  if (!lists.ok()) return lists.status();
  const auto trusted = ReadCertificates(authorities);
  if (!trusted.ok()) return trusted.status();
  std::vector<RevocationList> values;
  std::size_t revoked = 0;
  for (const Crl& list : *lists) {
    const std::string issuer = NameOf(*X509_CRL_get_issuer(list.get()));
    if (const std::string flaw = FlawOf(list.get()); !flaw.empty()) {
      return Unfit(file, fmt::format("the list of {} {}; name a whole list", issuer, flaw));
    }
    const X509* const signer = SignerOf(list.get(), *trusted);
    if (signer == nullptr) {
      return Unfit(file, fmt::format("the list of {} is not signed by an authority of {} that may "
                                     "sign lists",
                                     issuer, authorities.name));
    }
    values.push_back(ValueOf(list.get(), *signer));
    revoked += values.back().revoked.size();
    if (revoked > storage::kRevocationsMax) {
      return Unfit(file,
                   fmt::format("it revokes more than {} certificates", storage::kRevocationsMax));
    }
  }
  ERR_clear_error();
  return values;
}

}  // namespace uplink::identity
