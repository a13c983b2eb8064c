#include "tests/support/uplinkd_folder.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "schema/base/check.h"

namespace uplink::testing {

UplinkdFolder::UplinkdFolder() : path_(std::filesystem::temp_directory_path() / "uplinkd_XXXXXX") {
  UPLINK_CHECK(mkdtemp(path_.data()) != nullptr, "a test can make a folder");
  const KeyPair server = authority_.Issue(ServerSpec());
  Write("server.crt", server.certificate);
  Write("server.key", server.key);
  Write("ca.crt", authority_.certificate());
  std::filesystem::permissions(Path("server.key"), std::filesystem::perms::owner_read);
  WriteConfig();
}

UplinkdFolder::~UplinkdFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

void UplinkdFolder::Write(const std::string& name, const std::string& text) const {
  std::ofstream(Path(name)) << text;
}

void UplinkdFolder::WriteConfig(const std::string& extra) const {
  Write("uplinkd.toml",
        "[listen]\nrelay = \"127.0.0.1:0\"\nhttp = \"127.0.0.1:0\"\n"
        "[tls]\ncertificate_file = \"" +
            Path("server.crt") + "\"\nkey_file = \"" + Path("server.key") +
            "\"\nclient_ca_file = \"" + Path("ca.crt") + "\"\n[store]\nurl = \"sqlite://" +
            Path("uplinkd.db") + "\"\n" + extra);
}

std::unique_ptr<ServerProcess> UplinkdFolder::Start(
    const std::vector<std::string>& arguments, const std::vector<std::string>& environment) const {
  std::vector<std::string> all = {UPLINKD_PROGRAM, "--config", Path("uplinkd.toml")};
  all.insert(all.end(), arguments.begin(), arguments.end());
  return std::make_unique<ServerProcess>(all, environment);
}

}  // namespace uplink::testing
