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
// depend on order). With that, the bytes are the same for any number of threads and any SIMD width.
#pragma once

#include "pipeline/compute_program.h"
#include "pipeline/device.h"
#include "pipeline/image_access.h"
#include "pipeline/lane_memory.h"
#include "sim/denormals.h"
#include "sim/math.h"

#include <glm/vec3.hpp>

#include <algorithm>
#include <cstring>
#include <mutex>

namespace gnomon {

/// A validated dispatch with everything it may touch.
struct DispatchContext {
    const Dispatch& dispatch;
    const Profile& profile;
    Workers& workers;
    std::span<const std::unique_ptr<Buffer>> buffers;    // [id - 1]
    std::span<const std::unique_ptr<Texture>> textures;  // [id - 1]
    Counters* counters = nullptr;
    const std::atomic<bool>* stop = nullptr;
};

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

/// A wave of threads of one group, as a block of a compute functor sees it. Every memory access takes a mask of the lanes that
/// make it; lanes that are not `active` never do.
template <class RealType>
class ThreadContext {
public:
    using Real = RealType;

    ThreadContext(const DispatchContext& dispatch, const Vec3<Int>& in_group, const glm::ivec3& group_origin, Int flat_index,
                  Mask lanes, Counters* counters)
        : index(flat_index),
          local(in_group),
          id{in_group.x + Int(group_origin.x), in_group.y + Int(group_origin.y), in_group.z + Int(group_origin.z)},
          active(lanes),
          dispatch_(dispatch),
          counters_(counters) {}

    // D3D11.3 18.6.4
    const Int index;        // of the thread in its group, x fastest. D3D11.3 23.14
    const Vec3<Int> local;  // position in the group. D3D11.3 23.13
    const Vec3<Int> id;     // position in the grid of all threads. D3D11.3 23.11
    const Mask active;      // lanes that are threads

    // Buffers: one word per lane. A float that is stored is rounded to nearest even where the arithmetic is wider.
    template <template <class> class AnyBuffer, class Word>
        requires std::is_same_v<AnyBuffer<Word>, ReadBuffer<Word>> || std::is_same_v<AnyBuffer<Word>, RwBuffer<Word>>
    auto load(const AnyBuffer<Word>& from, Int at, Mask mask = Mask(true)) const {
        const Buffer& buffer = this->buffer(from.buffer);
        const Mask valid = in_range(at, word_count(buffer), mask & active);
        count_bytes_read(from.buffer, valid, 4);
        const Int word = load_words(words_of(buffer), at, valid);
        if constexpr (std::is_same_v<Word, float>) {
            return Real(float_of_bits(word));
        } else {
            return word;
        }
    }
    void store(const RwBuffer<std::int32_t>& to, Int at, Int value, Mask mask = Mask(true)) const {
        store_word(to.buffer, at, value, mask);
    }
    /// A NaN becomes the one quiet NaN without sign, as in textures (texunit/codec.h).
    void store(const RwBuffer<float>& to, Int at, const Real& value, Mask mask = Mask(true)) const {
        const Float narrow = to_float(value);
        store_word(to.buffer, at, select(is_nan(narrow), Int(0x7fc00000), bits_of(narrow)), mask);
    }

    // Group-shared memory: one element per lane, at the full width of the arithmetic.
    template <class Lane>
    Lane load(const SharedArray<Lane>& from, Int at, Mask mask = Mask(true)) const {
        return load_shared(from, at, in_range(at, from.count, mask & active));
    }
    template <class Lane>
    void store(const SharedArray<Lane>& to, Int at, const std::type_identity_t<Lane>& value, Mask mask = Mask(true)) const {
        store_shared(to, at, value, in_range(at, to.count, mask & active));
    }

    // Images: texel (x, y); depth and other numbers as the format means them, stored as the profile narrows.
    Vec4<Real> load(const ReadImage& from, Int x, Int y, Mask mask = Mask(true)) const {
        const ImageLevel image = this->image(from);
        return load_texels<Real>(image, x, y, count_texels_read(from.texture, inside(image, x, y, mask)));
    }
    Vec4<Real> load(const RwImage& from, Int x, Int y, Mask mask = Mask(true)) const {
        const ImageLevel image = this->image(from);
        return load_texels<Real>(image, x, y, count_texels_read(from.texture, inside(image, x, y, mask)));
    }
    Vec4<Int> load(const ReadUintImage& from, Int x, Int y, Mask mask = Mask(true)) const {
        const ImageLevel image = this->image(from);
        return load_texel_codes(image, x, y, count_texels_read(from.texture, inside(image, x, y, mask)));
    }
    Vec4<Int> load(const RwUintImage& from, Int x, Int y, Mask mask = Mask(true)) const {
        const ImageLevel image = this->image(from);
        return load_texel_codes(image, x, y, count_texels_read(from.texture, inside(image, x, y, mask)));
    }
    void store(const RwImage& to, Int x, Int y, const Vec4<Real>& color, Mask mask = Mask(true)) const {
        const ImageLevel image = this->image(to);
        const Mask valid = inside(image, x, y, mask);
        count_bytes_written(to.texture, valid, image.texture.info().bytes_per_texel);
        store_texels(image, x, y, color, dispatch_.profile.float_narrowing, valid);
    }
    void store(const RwUintImage& to, Int x, Int y, const Vec4<Int>& codes, Mask mask = Mask(true)) const {
        const ImageLevel image = this->image(to);
        const Mask valid = inside(image, x, y, mask);
        count_bytes_written(to.texture, valid, image.texture.info().bytes_per_texel);
        store_texel_codes(image, x, y, codes, valid);
    }

    // Atomic operations on words of buffers and of shared memory. They return nothing: what a thread would get back depends on
    // the order of threads.
    template <class Memory>
    void atomic_add(const Memory& to, Int at, Int value, Mask mask = Mask(true)) const {
        update<AtomicOp::Add>(to, at, value, mask);
    }
    template <class Memory>
    void atomic_and(const Memory& to, Int at, Int value, Mask mask = Mask(true)) const {
        update<AtomicOp::And>(to, at, value, mask);
    }
    template <class Memory>
    void atomic_or(const Memory& to, Int at, Int value, Mask mask = Mask(true)) const {
        update<AtomicOp::Or>(to, at, value, mask);
    }
    template <class Memory>
    void atomic_xor(const Memory& to, Int at, Int value, Mask mask = Mask(true)) const {
        update<AtomicOp::Xor>(to, at, value, mask);
    }
    template <class Memory>
    void atomic_min(const Memory& to, Int at, Int value, Mask mask = Mask(true)) const {
        update<AtomicOp::Min>(to, at, value, mask);
    }
    template <class Memory>
    void atomic_max(const Memory& to, Int at, Int value, Mask mask = Mask(true)) const {
        update<AtomicOp::Max>(to, at, value, mask);
    }
    template <class Memory>
    void atomic_min_unsigned(const Memory& to, Int at, Int value, Mask mask = Mask(true)) const {
        update<AtomicOp::MinUnsigned>(to, at, value, mask);
    }
    template <class Memory>
    void atomic_max_unsigned(const Memory& to, Int at, Int value, Mask mask = Mask(true)) const {
        update<AtomicOp::MaxUnsigned>(to, at, value, mask);
    }

    Real rcp(const Real& x) const { return gnomon::rcp(x); }
    Real rsqrt(const Real& x) const { return gnomon::rsqrt(x); }
    Real exp2(const Real& x) const { return gnomon::exp2(x); }
    Real log2(const Real& x) const { return gnomon::log2(x); }

private:
    [[nodiscard]] Buffer& buffer(BufferId name) const { return *dispatch_.buffers[static_cast<std::size_t>(name) - 1]; }
    template <detail::ImageAccess kAccess>
    [[nodiscard]] ImageLevel image(const detail::ImageBinding<kAccess>& binding) const {
        return {*dispatch_.textures[static_cast<std::size_t>(binding.texture) - 1], binding.level, binding.layer};
    }
    /// Whole words of a buffer; bytes behind the last one are out of range.
    static std::int32_t word_count(const Buffer& buffer) { return static_cast<std::int32_t>(buffer.data.size() / 4); }
    static std::int32_t* words_of(Buffer& buffer) { return reinterpret_cast<std::int32_t*>(buffer.data.data()); }
    static const std::int32_t* words_of(const Buffer& buffer) {
        return reinterpret_cast<const std::int32_t*>(buffer.data.data());
    }
    [[nodiscard]] Mask inside(const ImageLevel& image, Int x, Int y, Mask mask) const {
        return in_range(x, image.width(), in_range(y, image.height(), mask & active));
    }

    void store_word(BufferId to, Int at, Int value, Mask mask) const {
        Buffer& buffer = this->buffer(to);
        const Mask valid = in_range(at, word_count(buffer), mask & active);
        count_bytes_written(to, valid, 4);
        store_words(words_of(buffer), at, value, valid);
    }
    template <AtomicOp kOp>
    void update(const RwBuffer<std::int32_t>& to, Int at, Int value, Mask mask) const {
        Buffer& buffer = this->buffer(to.buffer);
        const Mask valid = in_range(at, word_count(buffer), mask & active);
        count_bytes_read(to.buffer, valid, 4);
        count_bytes_written(to.buffer, valid, 4);
        update_words_atomically<kOp>(words_of(buffer), at, value, valid);
    }
    template <AtomicOp kOp>
    void update(const SharedArray<Int>& to, Int at, Int value, Mask mask) const {
        update_words<kOp>(to.words, at, value, in_range(at, to.count, mask & active));
    }

    // Traffic by resource: the one place that would split it by id.
    void count_bytes_read(BufferId, Mask lanes, int bytes) const {
        if (counters_ != nullptr) counters_->buffer_bytes_read += total(lanes, bytes);
    }
    void count_bytes_written(BufferId, Mask lanes, int bytes) const {
        if (counters_ != nullptr) counters_->buffer_bytes_written += total(lanes, bytes);
    }
    void count_bytes_read(TextureId, Mask lanes, int bytes) const {
        if (counters_ != nullptr) counters_->image_bytes_read += total(lanes, bytes);
    }
    void count_bytes_written(TextureId, Mask lanes, int bytes) const {
        if (counters_ != nullptr) counters_->image_bytes_written += total(lanes, bytes);
    }
    Mask count_texels_read(TextureId from, Mask lanes) const {
        count_bytes_read(from, lanes, dispatch_.textures[static_cast<std::size_t>(from) - 1]->info().bytes_per_texel);
        return lanes;
    }
    static std::uint64_t total(Mask lanes, int bytes) {
        return static_cast<std::uint64_t>(std::popcount(lanes.bits())) * static_cast<std::uint64_t>(bytes);
    }

    const DispatchContext& dispatch_;
    Counters* counters_;
};

/// One group of threads, as a compute functor sees it.
template <class RealType, GroupSize kSize>
class GroupContext {
public:
    using Real = RealType;

    GroupContext(const DispatchContext& dispatch, const glm::ivec3& group, GroupMemory& memory, Counters* counters)
        : id(group), dispatch_(dispatch), memory_(memory), counters_(counters) {}

    const glm::ivec3 id;  // of the group in the grid of groups. D3D11.3 23.12

    /// Zeroed group-shared memory. Ask for it outside blocks, in the same order in every group. Throws Error past
    /// kMaxSharedWords.
    template <class Lane>
    SharedArray<Lane> shared(int count) {
        return memory_.allocate<Lane>(count, dispatch_.dispatch.program->name);
    }
    SharedArray<Int> shared_int(int count) { return shared<Int>(count); }
    SharedArray<Real> shared_real(int count) { return shared<Real>(count); }

    /// Runs body(t) for all threads of the group, a wave at a time; then all have arrived. D3D11.3 18.6.7
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
        for (int first = 0; first < last; first += kLanes) {
            const Int index = Int(first) + lane_index();
            const Vec3<Int> local{Int::load(at.x.data() + first), Int::load(at.y.data() + first),
                                  Int::load(at.z.data() + first)};
            body(ThreadContext<Real>(dispatch_, local, origin, index, index < Int(last), counters_));
        }
    }

private:
    const DispatchContext& dispatch_;
    GroupMemory& memory_;
    Counters* counters_;
};

template <class Real, class Functor>
void run_groups(const DispatchContext& context, const Functor& functor) {
    const Dispatch& dispatch = context.dispatch;
    const std::uint64_t groups = std::uint64_t{dispatch.groups_x} * dispatch.groups_y * dispatch.groups_z;
    // Pieces small enough to share out, large enough that sharing out costs little.
    constexpr std::uint64_t kPieces = 1024;
    const std::uint64_t per_piece = (groups + kPieces - 1) / kPieces;
    std::mutex counters_mutex;
    context.workers.for_each((groups + per_piece - 1) / per_piece, [&](std::size_t piece) {
        const DenormalScope denormals(context.profile.flush_denormals);
        Counters local;
        Counters* counters = context.counters != nullptr ? &local : nullptr;
        GroupMemory memory;
        const std::uint64_t end = std::min(groups, (piece + 1) * per_piece);
        for (std::uint64_t group = piece * per_piece; group < end; ++group) {
            if (context.stop != nullptr && context.stop->load(std::memory_order_relaxed)) throw Stopped();
            const glm::ivec3 id{group % dispatch.groups_x, group / dispatch.groups_x % dispatch.groups_y,
                                group / dispatch.groups_x / dispatch.groups_y};
            memory.begin_group();
            GroupContext<Real, Functor::kGroupSize> g(context, id, memory, counters);
            functor(g);
        }
        if (counters != nullptr) {
            local.compute_groups = end - piece * per_piece;
            local.compute_threads = local.compute_groups * static_cast<std::uint64_t>(Functor::kGroupSize.threads());
            const std::lock_guard lock(counters_mutex);
            *context.counters += local;
        }
    });
}

template <class Functor>
void run_compute(const DispatchContext& context) {
    const auto functor = functor_from<Functor>(context.dispatch.constants);
    if (context.profile.arithmetic == Arithmetic::Fp32) {
        run_groups<Float>(context, functor);
    } else {
        run_groups<Double>(context, functor);
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
