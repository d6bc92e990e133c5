#include "pipeline/parallel_primitives.h"

#include "pipeline/compute_program.h"

#include <cstring>

namespace gnomon {

BufferId ParallelPrimitives::scratch(Scratch& kept, std::string_view label, int words) {
    if (kept.words < words) {
        // At least double, so that all buffers that were too small take less than the last.
        const auto grown = std::max<std::int64_t>({words, std::int64_t{2} * kept.words, 256});
        kept.id = device_.create_zeroed_buffer(label, static_cast<std::size_t>(grown) * 4);
        kept.words = static_cast<int>(grown);
    }
    return kept.id;
}

void ParallelPrimitives::check(std::string_view what, int count, std::initializer_list<BufferId> buffers) const {
    if (count < 0 || count > kMaxPrimitiveWords) fail("{} of {} words: expected 0 to {}", what, count, kMaxPrimitiveWords);
    for (const BufferId id : buffers)
        if (device_.buffer(id).data.size() / 4 < static_cast<std::size_t>(count))
            fail("{} of {} words: buffer {} holds {}", what, count, static_cast<std::size_t>(id),
                 device_.buffer(id).data.size() / 4);
    for (const BufferId* a = buffers.begin(); a != buffers.end(); ++a)
        for (const BufferId* b = buffers.begin(); b != a; ++b)
            if (*a == *b) fail("{}: buffer {} is named twice", what, static_cast<std::size_t>(*a));
}

std::uint32_t ParallelPrimitives::word(BufferId id, int index) const {
    std::uint32_t value = 0;
    std::memcpy(&value, device_.buffer(id).data.data() + std::size_t{4} * static_cast<std::size_t>(index), 4);
    return value;
}

void ParallelPrimitives::run(std::string_view label, const ComputeProgram& program, std::span<const std::byte> constants,
                             int groups) {
    device_.execute(
        Dispatch{.label = label, .program = &program, .constants = constants, .groups_x = static_cast<std::uint32_t>(groups)});
}

}  // namespace gnomon
