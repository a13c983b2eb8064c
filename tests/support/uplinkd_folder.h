#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tests/support/certificates.h"
#include "tests/support/server_process.h"

namespace uplink::testing {

/// A folder of its own for one test: certificates, a configuration with free ports, a store.
/// Removed by the destructor.
class UplinkdFolder final {
 public:
  UplinkdFolder();
  ~UplinkdFolder();
  UplinkdFolder(const UplinkdFolder&) = delete;
  UplinkdFolder& operator=(const UplinkdFolder&) = delete;

  [[nodiscard]] std::string Path(const std::string& name) const { return path_ + "/" + name; }
  /// Whom the server's configuration trusts, and who issued its certificate.
  [[nodiscard]] const TestAuthority& authority() const { return authority_; }
  void Write(const std::string& name, const std::string& text) const;
  /// Writes the configuration; `extra` is TOML that is added at its end.
  void WriteConfig(const std::string& extra = "") const;
  /// Starts uplinkd on the configuration with these further arguments.
  [[nodiscard]] std::unique_ptr<ServerProcess> Start(
      const std::vector<std::string>& arguments = {},
      const std::vector<std::string>& environment = {}) const;

 private:
  std::string path_;
  TestAuthority authority_;
};

}  // namespace uplink::testing
