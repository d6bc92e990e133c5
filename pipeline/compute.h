// Compute functors: what they see, and a dispatch from end to end, instantiated once per program. D3D11.3 18.6
//
// A compute functor is a plain struct with named fields, a `static constexpr GroupSize kGroupSize` and
//     template <class G> void operator()(G& g) const
// which runs once per group. Threads are blocks inside it:
//     auto sums = g.shared_real(64);
//     g.threads([&](const auto& t) { t.store(sums, t.index, t.load(values, t.id.x)); });
//     g.threads([&](const auto& t) { ... t.load(sums, t.index + Int(1)) ... });
// The end of a block is the barrier: what its threads wrote, those of the next block see. Inside one block, and between groups
// of one dispatch, no thread may read or write a word that another one writes, except through atomic_... (whose results do not
// depend on order). With that, the bytes are the same for any number of threads and any SIMD width; Device::set_race_check
// finds where a functor breaks it.
#pragma once

#include "pipeline/thread_context.h"
#include "sim/denormals.h"

#include <algorithm>
#include <cstring>
#include <mutex>

namespace gnomon {

/// The group-shared memory of one worker, handed from group to group.
class GroupMemory {
public:
    void begin_group() {
        used_words_ = 0;
        used_bytes_ = 0;
    }

    /// `count` zeroed elements. Throws Error past kMaxSharedWords.
    template <class Lane>
    SharedArray<Lane> allocate(int count, std::string_view program) {
        using Word = typename SharedArray<Lane>::Word;
        if (count < 0 || count > kMaxSharedWords - used_words_)
            fail("program {}: {} words of group-shared memory beside {}, expected up to {} in all", program, count, used_words_,
                 kMaxSharedWords);
        if (bytes_ == nullptr) bytes_ = hwy::AllocateAligned<std::byte>(kBytes);
        const std::size_t size = static_cast<std::size_t>(count) * sizeof(Word);
        auto* words = reinterpret_cast<Word*>(bytes_.get() + used_bytes_);
        std::memset(words, 0, size);
        used_words_ += count;
        used_bytes_ += (size + 7) & ~std::size_t{7};
        return {words, count};
    }

private:
    static constexpr std::size_t kBytes = (std::size_t{kMaxSharedWords} + 1) * sizeof(double);

    hwy::AlignedFreeUniquePtr<std::byte[]> bytes_;
    int used_words_ = 0;
    std::size_t used_bytes_ = 0;
};

/// Where the threads of a wave stand in their group, for every thread of a group of this size.
template <GroupSize kSize>
struct ThreadPositions {
    static constexpr std::size_t kPadded = (static_cast<std::size_t>(kSize.threads()) + kLanes - 1) / kLanes * kLanes;
    std::array<std::int32_t, kPadded> x{}, y{}, z{};

    constexpr ThreadPositions() {
        for (std::size_t i = 0; i < kPadded; ++i) {
            const int thread = static_cast<int>(i);
            x[i] = thread % kSize.x;
            y[i] = thread / kSize.x % kSize.y;
            z[i] = thread / (kSize.x * kSize.y);
        }
    }
};
template <GroupSize kSize>
inline constexpr ThreadPositions<kSize> kThreadPositions;

/// One group of threads, as a compute functor sees it.
template <class RealType, GroupSize kSize, bool kWatched>
class GroupContext {
public:
    using Real = RealType;

    GroupContext(const DispatchContext& dispatch, const glm::ivec3& group, GroupMemory& memory, const GroupObservers* observers)
        : id(group), dispatch_(dispatch), memory_(memory), observers_(observers) {}

    const glm::ivec3 id;  // of the group in the grid of groups. D3D11.3 23.12

    /// Zeroed group-shared memory. Ask for it outside blocks, in the same order in every group. Throws Error inside one, and
    /// past kMaxSharedWords.
    template <class Lane>
    SharedArray<Lane> shared(int count) {
        if (in_block_) refuse_in_block("shared memory asked for");
        return memory_.allocate<Lane>(count, dispatch_.dispatch.program->name);
    }
    SharedArray<Int> shared_int(int count) { return shared<Int>(count); }
    SharedArray<Real> shared_real(int count) { return shared<Real>(count); }

    /// Runs body(t) for all threads of the group, a wave at a time; then all have arrived. Not inside another block, for a
    /// barrier in flow control that varies between threads is none: that throws Error. D3D11.3 18.6.7
    template <class Body>
    void threads(const Body& body) {
        threads(kSize.threads(), body);
    }
    /// The same for the first `count` threads; the others wait.
    template <class Body>
    void threads(int count, const Body& body) {
        const auto& at = kThreadPositions<kSize>;
        const glm::ivec3 origin{id.x * kSize.x, id.y * kSize.y, id.z * kSize.z};
        const int last = std::min(count, kSize.threads());
        if (in_block_) refuse_in_block("threads");
        in_block_ = true;
        if constexpr (kWatched)
            if (observers_->races != nullptr) observers_->races->begin_block();
        for (int first = 0; first < last; first += kLanes) {
            const Int index = Int(first) + lane_index();
            const Vec3<Int> local{Int::load(at.x.data() + first), Int::load(at.y.data() + first),
                                  Int::load(at.z.data() + first)};
            body(ThreadContext<Real, kWatched>(dispatch_, local, origin, index, index < Int(last), observers_));
        }
        in_block_ = false;
    }

private:
    [[noreturn, gnu::cold, gnu::noinline]] void refuse_in_block(std::string_view what) const {
        fail("dispatch '{}': {} inside a block of threads, which not all threads of the group reach together",
             dispatch_.dispatch.label, what);
    }

    const DispatchContext& dispatch_;
    GroupMemory& memory_;
    const GroupObservers* observers_;
    bool in_block_ = false;
};

template <class Real, bool kWatched, class Functor>
void run_groups(const DispatchContext& context, const Functor& functor) {
    const Dispatch& dispatch = context.dispatch;
    const std::uint64_t groups = std::uint64_t{dispatch.groups_x} * dispatch.groups_y * dispatch.groups_z;
    // Pieces small enough to share out, large enough that sharing out costs little.
    constexpr std::uint64_t kPieces = 1024;
    const std::uint64_t per_piece = context.checks_races ? groups : (groups + kPieces - 1) / kPieces;
    std::mutex tally_mutex;
    context.workers.for_each((groups + per_piece - 1) / per_piece, [&](std::size_t piece) {
        const DenormalScope denormals(context.profile.flush_denormals);
        Tally local;
        RaceCheck races(dispatch.label);
        const GroupObservers observers{.tally = context.tally != nullptr ? &local : nullptr,
                                       .races = context.checks_races ? &races : nullptr};
        GroupMemory memory;
        const std::uint64_t end = std::min(groups, (piece + 1) * per_piece);
        for (std::uint64_t group = piece * per_piece; group < end; ++group) {
            if (context.stop != nullptr && context.stop->load(std::memory_order_relaxed)) throw Stopped();
            const glm::ivec3 id{group % dispatch.groups_x, group / dispatch.groups_x % dispatch.groups_y,
                                group / dispatch.groups_x / dispatch.groups_y};
            memory.begin_group();
            races.begin_group();
            GroupContext<Real, Functor::kGroupSize, kWatched> g(context, id, memory, &observers);
            functor(g);
        }
        if (context.tally != nullptr) {
            local.counters.compute_groups = end - piece * per_piece;
            local.counters.compute_threads =
                local.counters.compute_groups * static_cast<std::uint64_t>(Functor::kGroupSize.threads());
            const std::lock_guard lock(tally_mutex);
            *context.tally += local;
        }
    });
}

template <class Functor>
void run_compute(const DispatchContext& context) {
    const auto functor = functor_from<Functor>(context.dispatch.constants);
    const bool fp32 = context.profile.arithmetic == Arithmetic::Fp32;
    if (context.tally != nullptr || context.checks_races) {
        fp32 ? run_groups<Float, true>(context, functor) : run_groups<Double, true>(context, functor);
    } else {
        fp32 ? run_groups<Float, false>(context, functor) : run_groups<Double, false>(context, functor);
    }
}

/// The program of a compute functor. Call it in the .cpp of who uses it, so that it is compiled there once.
template <class Functor>
ComputeProgram make_compute_program(std::string_view name) {
    static_assert(is_group_size(Functor::kGroupSize), "at most 1024 x 1024 x 64 threads and 1024 in all. D3D11.3 18.6.3");
    return {.name = name,
            .group_size = Functor::kGroupSize,
            .constants_size = sizeof(Functor),
            .named_constants = &named_constants<Functor>,
            .bindings = &compute_bindings<Functor>,
            .run = &run_compute<Functor>};
}

}  // namespace gnomon
