// Random numbers for tests: one generator per case, seeded from the case's index, the same everywhere. [Steele14] splitmix64
#pragma once

#include <bit>
#include <cstdint>

namespace oracle {

class Random {
public:
    explicit Random(std::uint64_t case_index) : state_(case_index * 0x9e3779b97f4a7c15u + 0x1234567u) { (void)next(); }

    std::uint64_t next() {
        std::uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
        z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
        z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
        return z ^ (z >> 31);
    }
    std::uint32_t bits() { return static_cast<std::uint32_t>(next() >> 32); }
    /// Uniform in [low, high], both included.
    std::int64_t between(std::int64_t low, std::int64_t high) {
        return low + static_cast<std::int64_t>(next() % static_cast<std::uint64_t>(high - low + 1));
    }
    int integer(int low, int high) { return static_cast<int>(between(low, high)); }
    /// Uniform in [0, 1), 24 bits.
    float unit() { return static_cast<float>(next() >> 40) * 0x1p-24f; }
    float in(float low, float high) { return low + (high - low) * unit(); }
    /// Any bit pattern: NaN, infinities and denormals included.
    float any_float() { return std::bit_cast<float>(bits()); }
    bool chance(int one_in) { return between(1, one_in) == 1; }

private:
    std::uint64_t state_;
};

}  // namespace oracle
