// Pseudo-random numbers that are functions of their inputs: SplitMix64 [Steele14], figure 16.
#pragma once

#include <cstdint>

namespace gnomon::scenes {

/// The finaliser of SplitMix64 applied to state + golden gamma: a bijection on 64 bits.
constexpr std::uint64_t hash64(std::uint64_t state) {
    std::uint64_t z = state + 0x9e3779b97f4a7c15u;
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
}

/// The 53 leading bits of a hash as a number in [0, 1).
constexpr double unit_interval(std::uint64_t hash) { return static_cast<double>(hash >> 11) * 0x1p-53; }

/// A stream of numbers: the hashes of a counter.
class Random {
public:
    explicit constexpr Random(std::uint64_t seed) : state_(hash64(seed)) {}

    /// Uniform in [low, high).
    constexpr double uniform(double low, double high) { return low + (high - low) * unit_interval(hash64(state_++)); }

private:
    std::uint64_t state_;
};

}  // namespace gnomon::scenes
