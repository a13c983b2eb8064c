#include "server/identity/session_tickets.h"

#include <fstream>
#include <iterator>
#include <memory>

#include <absl/status/statusor.h>
#include <climits>
#include <fmt/format.h>
#include <openssl/conf.h>
#include <openssl/crypto.h>
#include <openssl/err.h>

#include "server/identity/pem.h"

namespace uplink::identity {
namespace {

struct ConfFree {
  void operator()(CONF* configuration) const { NCONF_free(configuration); }
};
using Configuration = std::unique_ptr<CONF, ConfFree>;

/// A step on the way to the settings of TLS servers: the section named by this key.
struct Step {
  const char* key;
  const char* section_if_none;
};
constexpr Step kSteps[] = {{"openssl_conf", "uplinkd_openssl"},
                           {"ssl_conf", "uplinkd_ssl"},
                           {"system_default", "uplinkd_tls"}};
constexpr char kTickets[] = "NumTickets";

Configuration Parse(std::string_view text) {
  if (text.size() > INT_MAX) return nullptr;
  const Bio bio = PemReader(text);
  Configuration configuration(NCONF_new(nullptr));
  long line = 0;  // NOLINT(google-runtime-int): the library's type
  if (bio == nullptr || configuration == nullptr ||
      NCONF_load_bio(configuration.get(), bio.get(), &line) != 1) {
    ERR_clear_error();
    return nullptr;
  }
  return configuration;
}

/// The value of `key` in a section; the settings before the first section have none (null).
const char* ValueOf(const Configuration& configuration, const char* section, const char* key) {
  const char* value = NCONF_get_string(configuration.get(), section, key);
  ERR_clear_error();
  return value;
}

/// The text of OpenSSL's own configuration file; nothing if there is none.
std::string DefaultText() {
  char* const path = CONF_get1_default_config_file();
  if (path == nullptr) return "";
  std::ifstream file(path);
  OPENSSL_free(path);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace

absl::StatusOr<std::string> WithoutSessionTickets(std::string_view text) {
  const Configuration configuration = Parse(text);
  if (configuration == nullptr) {
    return absl::FailedPreconditionError("OpenSSL's configuration file cannot be read");
  }
  std::string head;
  std::string tail = "\n";
  std::string section;
  bool known = true;  // whether `section` stands in the text
  for (const Step& step : kSteps) {
    const char* next =
        known ? ValueOf(configuration, section.empty() ? nullptr : section.c_str(), step.key)
              : nullptr;
    if (next == nullptr) {
      (section.empty() ? head : tail) += (section.empty() ? "" : fmt::format("[{}]\n", section)) +
                                         fmt::format("{} = {}\n", step.key, step.section_if_none);
    }
    known = next != nullptr;
    section = known ? next : step.section_if_none;
  }
  if (known && ValueOf(configuration, section.c_str(), kTickets) != nullptr) {
    return std::string(text);
  }
  return fmt::format("{}{}{}[{}]\n{} = 0\n", head, text, tail, section, kTickets);
}

absl::Status SendNoSessionTickets() {
  const absl::StatusOr<std::string> text = WithoutSessionTickets(DefaultText());
  if (!text.ok()) return text.status();
  // From here on OpenSSL does not read the file itself, which would undo this.
  OPENSSL_init_crypto(OPENSSL_INIT_NO_LOAD_CONFIG, nullptr);
  const Configuration configuration = Parse(*text);
  if (configuration == nullptr ||
      CONF_modules_load(configuration.get(), nullptr, CONF_MFLAGS_IGNORE_ERRORS) != 1) {
    ERR_clear_error();
    return absl::FailedPreconditionError("OpenSSL's configuration cannot be applied");
  }
  return absl::OkStatus();
}

}  // namespace uplink::identity
