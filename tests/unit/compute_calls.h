// Compute functors of tests, said to a device in one line.
#pragma once

#include "pipeline/compute.h"

#include <cstring>
#include <span>
#include <vector>

namespace gnomon::testing {

template <class Functor>
const ComputeProgram& program_of() {
    static const ComputeProgram program = make_compute_program<Functor>("test.compute");
    return program;
}

template <class Functor>
Dispatch make_dispatch(const Functor& functor, std::uint32_t x = 1, std::uint32_t y = 1, std::uint32_t z = 1) {
    return {.label = "test",
            .program = &program_of<Functor>(),
            .constants = constants_of(functor),
            .groups_x = x,
            .groups_y = y,
            .groups_z = z};
}

template <class Functor>
void dispatch(Device& device, const Functor& functor, std::uint32_t x = 1, std::uint32_t y = 1, std::uint32_t z = 1) {
    device.execute(make_dispatch(functor, x, y, z));
}

template <class Word>
BufferId upload_words(Device& device, const std::vector<Word>& words) {
    return device.create_buffer("words", std::as_bytes(std::span(words)));
}

/// The first `count` words of a buffer; all of them where `count` is left out.
template <class Word>
std::vector<Word> words_of(const Device& device, BufferId id, std::size_t count = ~std::size_t{0}) {
    const auto& bytes = device.buffer(id).data;
    std::vector<Word> words(std::min(count, bytes.size() / sizeof(Word)));
    if (!words.empty()) std::memcpy(words.data(), bytes.data(), words.size() * sizeof(Word));
    return words;
}

inline Profile flush_profile(bool flush) {
    Profile profile = load_profile("d3d11");
    profile.flush_denormals = flush;
    return profile;
}

}  // namespace gnomon::testing
