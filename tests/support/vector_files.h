#pragma once

#include <string>
#include <vector>

namespace uplink::test {

/// The names of all vectors, sorted; one for each file with this extension (`.bin`, `.json`).
[[nodiscard]] std::vector<std::string> VectorNames(const std::string& extension = ".bin");

/// The file of a vector, whole. Tests start in the root of the source tree.
[[nodiscard]] std::string ReadVector(const std::string& name, const std::string& extension);

}  // namespace uplink::test
