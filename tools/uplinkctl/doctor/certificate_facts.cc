#include "tools/uplinkctl/doctor/certificate_facts.h"

#include <algorithm>
#include <cstddef>
#include <ctime>
#include <memory>
#include <utility>

#include <openssl/bio.h>
#include <openssl/err.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

#include "server/identity/expiry.h"
#include "server/identity/peer_identity.h"
#include "server/identity/pem.h"
#include "server/identity/server_names.h"

namespace uplink::ctl {
namespace {

using Chain = std::vector<identity::Certificate>;

struct StoreFree {
  void operator()(X509_STORE* store) const { X509_STORE_free(store); }
};
struct ContextFree {
  void operator()(X509_STORE_CTX* context) const { X509_STORE_CTX_free(context); }
};
struct StackFree {
  void operator()(STACK_OF(X509) * stack) const { sk_X509_free(stack); }
};
using Store = std::unique_ptr<X509_STORE, StoreFree>;

Chain Read(const identity::NamedPem& pem) {
  auto chain = identity::ReadCertificates(pem);
  return chain.ok() ? *std::move(chain) : Chain();
}

SystemTime TimeOf(const ASN1_TIME* time) {
  std::tm utc{};
  if (ASN1_TIME_to_tm(time, &utc) != 1) return identity::kNoExpiry;
  return std::min(FromUnixMs(std::int64_t{timegm(&utc)} * 1000), identity::kNoExpiry);
}

/// As one line (RFC 2253), as identity::SubjectOf.
std::string NameOf(const X509_NAME* name) {
  const identity::Bio bio(BIO_new(BIO_s_mem()));
  if (bio == nullptr || X509_NAME_print_ex(bio.get(), name, 0, XN_FLAG_RFC2253) < 0) return {};
  char* text = nullptr;
  const long size = BIO_get_mem_data(bio.get(), &text);
  return {text, std::min(static_cast<std::size_t>(size), identity::kSubjectBytesMax)};
}

std::vector<CertificateFacts> FactsOf(const Chain& chain) {
  std::vector<CertificateFacts> facts;
  for (const identity::Certificate& each : chain) {
    facts.push_back({identity::SubjectOf(*each), TimeOf(X509_get0_notBefore(each.get())),
                     TimeOf(X509_get0_notAfter(each.get()))});
  }
  return facts;
}

/// Whether the leaf leads to a certificate of the store, by way of those behind it. Dates are
/// judged apart.
bool Leads(const Store& store, const Chain& chain) {
  const std::unique_ptr<STACK_OF(X509), StackFree> between(sk_X509_new_null());
  const std::unique_ptr<X509_STORE_CTX, ContextFree> context(X509_STORE_CTX_new());
  if (store == nullptr || between == nullptr || context == nullptr) return false;
  for (const identity::Certificate& each : chain) sk_X509_push(between.get(), each.get());
  // As the server does with robots' chains: an intermediate authority in the store is enough.
  X509_STORE_set_flags(store.get(), X509_V_FLAG_PARTIAL_CHAIN | X509_V_FLAG_NO_CHECK_TIME);
  const bool leads =
      X509_STORE_CTX_init(context.get(), store.get(), chain.front().get(), between.get()) == 1 &&
      X509_verify_cert(context.get()) == 1;
  ERR_clear_error();
  return leads;
}

Store StoreOf(const Chain& authorities) {
  Store store(X509_STORE_new());
  if (store == nullptr) return store;
  for (const identity::Certificate& each : authorities) {
    X509_STORE_add_cert(store.get(), each.get());
  }
  return store;
}

Store SystemStore() {
  Store store(X509_STORE_new());
  if (store != nullptr) X509_STORE_set_default_paths(store.get());
  return store;
}

bool Signed(const identity::Certificate& by, const identity::Certificate& what) {
  const bool is = X509_check_issued(by.get(), what.get()) == X509_V_OK &&
                  X509_verify(what.get(), X509_get0_pubkey(by.get())) == 1;
  ERR_clear_error();
  return is;
}

Trust TrustOf(const Chain& chain, const Chain& authorities) {
  if (Leads(StoreOf(authorities), chain)) return Trust::kOwnAuthority;
  if (Leads(SystemStore(), chain)) return Trust::kSystem;
  for (std::size_t i = 1; i < chain.size(); ++i) {
    if (!Signed(chain[i], chain[i - 1])) return Trust::kBroken;
  }
  const X509_NAME* issuer = X509_get_issuer_name(chain.back().get());
  for (const identity::Certificate& each : authorities) {
    if (X509_NAME_cmp(X509_get_subject_name(each.get()), issuer) == 0) return Trust::kOtherKey;
  }
  return Trust::kElsewhere;
}

}  // namespace

std::vector<CertificateFacts> ReadFacts(const identity::NamedPem& pem) {
  return FactsOf(Read(pem));
}

std::optional<ChainFacts> ReadChain(const identity::NamedPem& certificate,
                                    const identity::NamedPem& authorities) {
  const Chain chain = Read(certificate);
  if (chain.empty()) return std::nullopt;
  ChainFacts facts;
  facts.chain = FactsOf(chain);
  facts.trust = TrustOf(chain, Read(authorities));
  facts.issuer = NameOf(X509_get_issuer_name(chain.back().get()));
  if (auto names = identity::ServerNamesOf(certificate); names.ok()) {
    facts.names = *std::move(names);
  }
  return facts;
}

}  // namespace uplink::ctl
