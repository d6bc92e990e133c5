#include "number_lines.h"

#include "sim/error.h"

#include <algorithm>
#include <array>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace gnomon::cli {

std::vector<InputLine> read_lines() {
    // In large pieces: the stream of standard input goes character by character.
    std::string input;
    std::array<char, 1u << 16> piece;
    for (std::size_t size = 0; (size = std::fread(piece.data(), 1, piece.size(), stdin)) > 0;) input.append(piece.data(), size);
    if (std::ferror(stdin) != 0) fail("the input cannot be read from stdin");

    std::vector<InputLine> lines;
    std::string_view rest = input;
    for (std::size_t number = 1; !rest.empty(); ++number) {
        const std::size_t end = rest.find('\n');
        std::string_view text = rest.substr(0, end);
        rest = end == std::string_view::npos ? std::string_view() : rest.substr(end + 1);
        text = text.substr(0, text.find('#'));
        InputLine line{.number = number, .words = {}};
        constexpr std::string_view kBlanks = " \t\r\v\f";
        for (std::size_t at = 0; (at = text.find_first_not_of(kBlanks, at)) != std::string_view::npos;) {
            const std::size_t after = std::min(text.find_first_of(kBlanks, at), text.size());
            line.words.emplace_back(text.substr(at, after - at));
            at = after;
        }
        if (!line.words.empty()) lines.push_back(std::move(line));
    }
    return lines;
}

std::optional<double> number_of(const std::string& word) {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    return !word.empty() && end == word.c_str() + word.size() ? std::optional(value) : std::nullopt;
}

std::optional<float> float_of(const std::string& word) {
    char* end = nullptr;
    const float value = std::strtof(word.c_str(), &end);
    return !word.empty() && end == word.c_str() + word.size() ? std::optional(value) : std::nullopt;
}

}  // namespace gnomon::cli
