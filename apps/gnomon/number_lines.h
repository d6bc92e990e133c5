// Lines of numbers from standard input: what `sample` and `convert` read.
#pragma once

#include <cstddef>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gnomon::cli {

/// One line: its number in the input, from 1, and its words.
struct InputLine {
    std::size_t number = 0;
    std::vector<std::string> words;
};

/// Every line of standard input that has a word; what follows a '#' does not count. Throws Error when reading fails.
std::vector<InputLine> read_lines();

/// All of `word` as a decimal or C hexadecimal number, or inf or nan.
std::optional<double> number_of(const std::string& word);
/// The same, rounded once to binary32.
std::optional<float> float_of(const std::string& word);

}  // namespace gnomon::cli
