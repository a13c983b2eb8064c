#include "server/identity/server_names.h"

#include <array>
#include <cstddef>
#include <memory>

#include <arpa/inet.h>
#include <openssl/asn1.h>
#include <openssl/err.h>
#include <openssl/x509v3.h>

#include "server/identity/pem.h"

namespace uplink::identity {
namespace {

constexpr int kIpv4Bytes = 4;
constexpr int kIpv6Bytes = 16;

struct NamesFree {
  void operator()(GENERAL_NAMES* names) const { GENERAL_NAMES_free(names); }
};

/// Empty if the bytes are no address.
std::string AddressText(const ASN1_STRING* bytes) {
  const int length = ASN1_STRING_length(bytes);
  if (length != kIpv4Bytes && length != kIpv6Bytes) return {};
  std::array<char, INET6_ADDRSTRLEN> text{};
  const int family = length == kIpv4Bytes ? AF_INET : AF_INET6;
  return inet_ntop(family, ASN1_STRING_get0_data(bytes), text.data(), text.size()) == nullptr
             ? std::string()
             : text.data();
}

/// Empty if it names no host.
std::string HostOf(const GENERAL_NAME& name) {
  if (name.type == GEN_IPADD) return AddressText(name.d.iPAddress);
  if (name.type != GEN_DNS) return {};
  const auto* const bytes = reinterpret_cast<const char*>(ASN1_STRING_get0_data(name.d.dNSName));
  return {bytes, static_cast<std::size_t>(ASN1_STRING_length(name.d.dNSName))};
}

}  // namespace

absl::StatusOr<std::vector<std::string>> ServerNamesOf(const NamedPem& certificate) {
  const auto certificates = ReadCertificates(certificate);
  if (!certificates.ok()) return certificates.status();
  const std::unique_ptr<GENERAL_NAMES, NamesFree> names(static_cast<GENERAL_NAMES*>(
      X509_get_ext_d2i(certificates->front().get(), NID_subject_alt_name, nullptr, nullptr)));
  ERR_clear_error();
  std::vector<std::string> hosts;
  for (int i = 0; names != nullptr && i < sk_GENERAL_NAME_num(names.get()); ++i) {
    std::string host = HostOf(*sk_GENERAL_NAME_value(names.get(), i));
    if (!host.empty()) hosts.push_back(std::move(host));
  }
  return hosts;
}

}  // namespace uplink::identity
