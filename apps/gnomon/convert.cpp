// gnomon convert: numbers through the formats of texels, for scripts and for other people's oracles.
#include "commands.h"

#include "number_lines.h"
#include "sim/error.h"
#include "texunit/codec.h"

#include <charconv>
#include <cstdio>

namespace gnomon {

/// A component of a texel format, or a float of the host.
enum class NumberFormat { F64, F32, F16, F11, F10, Unorm8, Unorm16, Unorm24, Snorm8, Snorm16, Srgb8, U32 };
template <>
inline constexpr std::array kEnumNames<NumberFormat>{
    EnumName{NumberFormat::F64, "f64"},         EnumName{NumberFormat::F32, "f32"},
    EnumName{NumberFormat::F16, "f16"},         EnumName{NumberFormat::F11, "f11"},
    EnumName{NumberFormat::F10, "f10"},         EnumName{NumberFormat::Unorm8, "unorm8"},
    EnumName{NumberFormat::Unorm16, "unorm16"}, EnumName{NumberFormat::Unorm24, "unorm24"},
    EnumName{NumberFormat::Snorm8, "snorm8"},   EnumName{NumberFormat::Snorm16, "snorm16"},
    EnumName{NumberFormat::Srgb8, "srgb8"},     EnumName{NumberFormat::U32, "u32"}};

}  // namespace gnomon

namespace gnomon::cli {

namespace {

int code_bits(NumberFormat format) {
    switch (format) {
        case NumberFormat::F64: return 64;
        case NumberFormat::F32:
        case NumberFormat::U32: return 32;
        case NumberFormat::F16:
        case NumberFormat::Unorm16:
        case NumberFormat::Snorm16: return 16;
        case NumberFormat::F11: return 11;
        case NumberFormat::F10: return 10;
        case NumberFormat::Unorm24: return 24;
        case NumberFormat::Unorm8:
        case NumberFormat::Snorm8:
        case NumberFormat::Srgb8: return 8;
    }
    __builtin_unreachable();
}

/// Calls visit(Codec<...>{}, component) with a codec that has a component of this format; not for f64 and f32.
template <class Visit>
auto with_component(NumberFormat format, const Visit& visit) {
    using enum ComponentType;
    switch (format) {
        case NumberFormat::F16: return visit(Codec<Float16, 1>{}, 0u);
        case NumberFormat::F11: return visit(Codec<Float11, 3>{}, 0u);
        case NumberFormat::F10: return visit(Codec<Float11, 3>{}, 2u);
        case NumberFormat::Unorm8: return visit(Codec<Unorm8, 1>{}, 0u);
        case NumberFormat::Unorm16: return visit(Codec<Unorm16, 1>{}, 0u);
        case NumberFormat::Unorm24: return visit(Codec<Depth24, 1>{}, 0u);
        case NumberFormat::Snorm8: return visit(Codec<Snorm8, 1>{}, 0u);
        case NumberFormat::Snorm16: return visit(Codec<Snorm16, 1>{}, 0u);
        case NumberFormat::Srgb8: return visit(Codec<Srgb8, 4>{}, 0u);
        case NumberFormat::U32:
        case NumberFormat::F64:
        case NumberFormat::F32: return visit(Codec<Uint32, 1>{}, 0u);
    }
    __builtin_unreachable();
}

/// Double to binary32 with the named rounding. D3D11.3 3.2.2
float narrowed(double x, Narrowing narrowing) {
    if (narrowing == Narrowing::NearestEven || x != x) return static_cast<float>(x);
    float result = static_cast<float>(x);
    if (std::isinf(result) && !std::isinf(x)) return std::copysign(std::numeric_limits<float>::max(), result);
    if (std::fabs(static_cast<double>(result)) > std::fabs(x)) result = std::nextafter(result, 0.0f);
    return result;
}

std::uint64_t encode(double x, NumberFormat format, Narrowing narrowing) {
    if (format == NumberFormat::F64) return std::bit_cast<std::uint64_t>(x);
    if (format == NumberFormat::F32) return std::bit_cast<std::uint32_t>(narrowed(x, narrowing));
    const auto code = with_component(format, [&]<class AnyCodec>(AnyCodec, std::size_t component) {
        return lane(AnyCodec::template code_of<Double>(Double(x), component, narrowing), 0);
    });
    return static_cast<std::uint32_t>(code);
}

/// The value that filters in binary32 see; f64 keeps its own, u32 is exact.
double decode(std::uint64_t code, NumberFormat format) {
    if (format == NumberFormat::F64) return std::bit_cast<double>(code);
    if (format == NumberFormat::F32) return static_cast<double>(std::bit_cast<float>(static_cast<std::uint32_t>(code)));
    if (format == NumberFormat::U32) return static_cast<double>(code);
    const float value = with_component(format, [&]<class AnyCodec>(AnyCodec, std::size_t component) {
        return lane(AnyCodec::template number<Float>(Int(static_cast<std::int32_t>(code)), component), 0);
    });
    return static_cast<double>(value);
}

/// One number of the input: text for f64 and f32, a code for the others.
double read_value(const InputLine& line, NumberFormat format) {
    if (line.words.size() != 1) fail("stdin line {}: {} words, expected one number", line.number, line.words.size());
    const std::string& word = line.words.front();
    if (format == NumberFormat::F64) {
        if (const auto value = number_of(word)) return *value;
        fail("stdin line {}: '{}' is not a number", line.number, word);
    }
    if (format == NumberFormat::F32) {
        if (const auto value = float_of(word)) return static_cast<double>(*value);
        fail("stdin line {}: '{}' is not a number", line.number, word);
    }
    const bool hexadecimal = word.starts_with("0x") || word.starts_with("0X");
    const char* begin = word.data() + (hexadecimal ? 2 : 0);
    const char* end = word.data() + word.size();
    const std::uint64_t last = (std::uint64_t{1} << code_bits(format)) - 1;
    std::uint64_t code = 0;
    const auto [stop, error] = std::from_chars(begin, end, code, hexadecimal ? 16 : 10);
    if (error != std::errc() || stop != end || begin == end || code > last)
        fail("stdin line {}: '{}' is not a code of {}: expected 0 to {:#x}", line.number, word, name_of(format), last);
    return decode(code, format);
}

struct ConvertOptions {
    std::string from;
    std::string to;
    std::string round = "zero";
};

void convert(const ConvertOptions& options) {
    const auto from = enum_from_name<NumberFormat>(options.from, "--from");
    const auto to = enum_from_name<NumberFormat>(options.to, "--to");
    if (options.round != "zero" && options.round != "nearest-even")
        fail("--round {}: expected zero or nearest-even", options.round);
    const Narrowing narrowing = options.round == "zero" ? Narrowing::TowardZero : Narrowing::NearestEven;
    std::string out;
    for (const InputLine& line : read_lines()) {
        const std::uint64_t code = encode(read_value(line, from), to, narrowing);
        const double value = decode(code, to);
        out +=
            fmt::format("0x{:0{}x} {}\n", code, (code_bits(to) + 3) / 4, value == value ? fmt::format("{:a}", value) : "nan");
    }
    fmt::print("{}", out);
}

}  // namespace

void add_convert(CLI::App& app) {
    CLI::App* command = app.add_subcommand("convert", "Convert numbers between the formats of texels, one per line of stdin");
    const auto options = std::make_shared<ConvertOptions>();
    command->add_option("--from", options->from, "Format of the input: numbers for f64 and f32, codes for the others")
        ->type_name("FORMAT")
        ->required();
    command->add_option("--to", options->to, "Format of the output")->type_name("FORMAT")->required();
    command->add_option("--round", options->round, "Rounding to narrower floats: zero (Direct3D) or nearest-even")
        ->capture_default_str();
    command->footer("Formats: " + names_of<NumberFormat>() +
                    ".\nPrints the code and its value as a C hexadecimal float:\n"
                    "  echo 65520 | gnomon convert --from f32 --to f16\n"
                    "  0x7bff 0x1.ffcp+15");
    command->callback([options] { convert(*options); });
}

}  // namespace gnomon::cli
