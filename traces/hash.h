// The fingerprint of bytes in traces and reports: XXH3 with 128 bits, as `xxhsum -H2` prints it.
#pragma once

#include <cstddef>
#include <span>
#include <string>

namespace gnomon::traces {

/// 32 lower-case hexadecimal digits, most significant first.
std::string xxh3_128_hex(std::span<const std::byte> bytes);

}  // namespace gnomon::traces
