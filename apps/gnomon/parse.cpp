#include "parse.h"

#include "sim/error.h"
#include "texunit/texture.h"

#include <algorithm>
#include <charconv>
#include <cmath>

namespace gnomon::cli {

namespace {

/// Whether all of `text` is a value.
template <class T>
bool read_all(std::string_view text, T& value) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc() && end == text.data() + text.size();
}

}  // namespace

std::int64_t parse_whole(const std::string& text, std::string_view option, std::int64_t low, std::int64_t high) {
    std::int64_t value = 0;
    if (!read_all(text, value) || value < low || value > high)
        fail("{} {}: expected a whole number from {} to {}", option, text, low, high);
    return value;
}

int parse_int(const std::string& text, std::string_view option, int low, int high) {
    return static_cast<int>(parse_whole(text, option, low, high));
}

std::uint64_t parse_u64(const std::string& text, std::string_view option) {
    std::uint64_t value = 0;
    if (!read_all(text, value)) fail("{} {}: expected a whole number from 0 to 2^64 - 1", option, text);
    return value;
}

float parse_number(const std::string& text, std::string_view option) {
    float value = 0;
    if (!read_all(text, value) || !std::isfinite(value)) fail("{} {}: expected a finite decimal number", option, text);
    return value;
}

std::vector<float> parse_numbers(const std::string& text, std::string_view option, std::size_t count) {
    std::vector<float> numbers;
    std::size_t first = 0;
    while (numbers.size() <= count) {
        const std::size_t comma = std::min(text.find(',', first), text.size());
        float value = 0;
        if (!read_all(std::string_view(text).substr(first, comma - first), value) || !std::isfinite(value)) break;
        numbers.push_back(value);
        if (comma == text.size()) {
            if (numbers.size() == count) return numbers;
            break;
        }
        first = comma + 1;
    }
    fail("{} {}: expected {} finite decimal numbers with commas between them", option, text, count);
}

std::pair<int, int> parse_size(const std::string& text, std::string_view option) {
    const std::size_t x = text.find('x');
    int width = 0;
    int height = 0;
    const bool valid = x != std::string::npos && read_all(std::string_view(text).substr(0, x), width) &&
                       read_all(std::string_view(text).substr(x + 1), height) && width >= 1 && width <= kMaxTextureSize &&
                       height >= 1 && height <= kMaxTextureSize;
    if (!valid) fail("{} {}: expected WIDTHxHEIGHT, each from 1 to {} pixels", option, text, kMaxTextureSize);
    return {width, height};
}

}  // namespace gnomon::cli
