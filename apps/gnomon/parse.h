// Option values, strictly: the whole text, in range, or an Error that names the option and what it expects.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gnomon::cli {

/// A decimal whole number from `low` to `high`.
std::int64_t parse_whole(const std::string& text, std::string_view option, std::int64_t low, std::int64_t high);
int parse_int(const std::string& text, std::string_view option, int low, int high);
std::uint64_t parse_u64(const std::string& text, std::string_view option);

/// A decimal number, finite.
float parse_number(const std::string& text, std::string_view option);

/// "0.5,0,1": exactly `count` finite decimal numbers.
std::vector<float> parse_numbers(const std::string& text, std::string_view option, std::size_t count);

/// "1024x768": pixels, 1 to kMaxTextureSize each way.
std::pair<int, int> parse_size(const std::string& text, std::string_view option);

}  // namespace gnomon::cli
