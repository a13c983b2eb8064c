#include "tests/support/vector_files.h"

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <iterator>

namespace uplink::test {
namespace {

constexpr const char* kVectors = "tests/conformance/vectors";

}  // namespace

std::vector<std::string> VectorNames(const std::string& extension) {
  std::vector<std::string> names;
  for (const auto& entry : std::filesystem::directory_iterator(kVectors)) {
    if (entry.path().extension() == extension) names.push_back(entry.path().stem().string());
  }
  std::sort(names.begin(), names.end());
  return names;
}

std::string ReadVector(const std::string& name, const std::string& extension) {
  std::ifstream file(std::filesystem::path(kVectors) / (name + extension), std::ios::binary);
  return {std::istreambuf_iterator<char>(file), std::istreambuf_iterator<char>()};
}

}  // namespace uplink::test
