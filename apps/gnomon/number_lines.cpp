#include "number_lines.h"

#include "sim/error.h"

#include <cstdlib>
#include <iostream>
#include <sstream>

namespace gnomon::cli {

std::vector<InputLine> read_lines() {
    std::vector<InputLine> lines;
    std::string text;
    for (std::size_t number = 1; std::getline(std::cin, text); ++number) {
        std::istringstream words(text.substr(0, text.find('#')));
        InputLine line{.number = number, .words = {}};
        for (std::string word; words >> word;) line.words.push_back(word);
        if (!line.words.empty()) lines.push_back(std::move(line));
    }
    if (std::cin.bad()) fail("the input cannot be read from stdin");
    return lines;
}

std::optional<double> number_of(const std::string& word) {
    char* end = nullptr;
    const double value = std::strtod(word.c_str(), &end);
    return *end == '\0' && end != word.c_str() ? std::optional(value) : std::nullopt;
}

std::optional<float> float_of(const std::string& word) {
    char* end = nullptr;
    const float value = std::strtof(word.c_str(), &end);
    return *end == '\0' && end != word.c_str() ? std::optional(value) : std::nullopt;
}

}  // namespace gnomon::cli
