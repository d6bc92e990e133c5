#include "tests/agree/made_texture.h"

#include "sim/error.h"

#include <glm/gtc/packing.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <set>

namespace gnomon::agree {
namespace {

std::uint32_t word_of(TexelFormat format, float value) {
    switch (format) {
        case TexelFormat::R32f:
        case TexelFormat::Rg32f:
        case TexelFormat::D32f: return std::bit_cast<std::uint32_t>(value);
        case TexelFormat::Rg16f: return glm::packHalf1x16(value) * 0x10001u;
        case TexelFormat::Rgba8: return static_cast<std::uint32_t>(std::lround(value * 255.0f)) * 0x1010101u;
        case TexelFormat::Rg16Unorm: return static_cast<std::uint32_t>(std::lround(value * 65535.0f)) * 0x10001u;
    }
    fail("unknown texel format");
}

}  // namespace

float largest_code(TexelFormat format) {
    if (format == TexelFormat::Rgba8) return 255.0f;
    return format == TexelFormat::Rg16Unorm ? 65535.0f : 1.0f;
}

Levels made_levels(TexelFormat format, std::array<int, 2> size, int levels, const std::function<float(int, int, int)>& value) {
    Levels made{.format = format, .width = size[0], .height = size[1]};
    for (int level = 0; level < levels; ++level) {
        std::vector<std::byte>& bytes = made.levels.emplace_back();
        for (int y = 0; y < level_size(size[1], level); ++y)
            for (int x = 0; x < level_size(size[0], level); ++x)
                for (std::size_t i = 0; i < texel_bytes(format); i += 4) {
                    const auto word = std::bit_cast<std::array<std::byte, 4>>(word_of(format, value(level, x, y)));
                    bytes.insert(bytes.end(), word.begin(), word.end());
                }
    }
    return made;
}

SamplerState clamped(Filter filter, Mip mip) {
    return {.min = filter, .mag = filter, .mip = mip, .address_u = Address::Clamp, .address_v = Address::Clamp};
}

std::vector<float> try_samples(const Source& source, const Levels& texture, const SamplerState& sampler,
                               Instruction instruction, std::span<const Point> points, std::string& refused) {
    std::vector<float> values;
    try {
        for (const Sample& sample : source(texture, sampler, instruction, points)) values.push_back(sample[0]);
    } catch (const Error& error) {
        refused = error.what();
        values.clear();
    }
    return values;
}

StepTable step_table(std::span<const float> values) {
    StepTable table{.last = static_cast<int>(values.size()) - 1, .is_monotone = true};
    std::set<float> distinct;
    for (std::size_t i = 0; i < values.size(); ++i) {
        distinct.insert(values[i]);
        if (i != 0 && values[i] == values[i - 1]) continue;
        if (i != 0 && !(values[i] > values[i - 1])) table.is_monotone = false;
        table.steps.push_back({static_cast<int>(i), values[i]});
    }
    table.distinct = static_cast<int>(distinct.size());
    return table;
}

std::vector<float> find_thresholds(std::span<const Search> searches,
                                   const std::function<std::vector<float>(std::span<const float>)>& sample_at) {
    constexpr std::uint32_t kWays = 256;
    // Positive floats are ordered as their bits.
    std::vector<std::uint32_t> low;
    std::vector<std::uint32_t> high;
    for (const Search& search : searches) {
        low.push_back(std::bit_cast<std::uint32_t>(search.below));
        high.push_back(std::bit_cast<std::uint32_t>(search.above));
    }
    const auto between = [&](std::size_t i, std::uint32_t way) {
        return low[i] + static_cast<std::uint32_t>(std::uint64_t{high[i] - low[i]} * way / kWays);
    };
    const auto is_open = [&] {
        for (std::size_t i = 0; i < low.size(); ++i)
            if (high[i] - low[i] > 1) return true;
        return false;
    };
    while (is_open()) {
        std::vector<float> at;
        for (std::size_t i = 0; i < low.size(); ++i)
            for (std::uint32_t way = 1; way <= kWays; ++way) at.push_back(std::bit_cast<float>(between(i, way)));
        const std::vector<float> values = sample_at(at);
        if (values.size() != at.size()) return {};
        for (std::size_t i = 0; i < low.size(); ++i) {
            std::uint32_t first = 1;
            while (first < kWays && values[i * kWays + first - 1] < searches[i].threshold) ++first;
            const std::uint32_t new_low = between(i, first - 1);
            high[i] = between(i, first);
            low[i] = new_low;
        }
    }
    std::vector<float> found;
    found.reserve(high.size());
    for (const std::uint32_t bits : high) found.push_back(std::bit_cast<float>(bits));
    return found;
}

}  // namespace gnomon::agree
