// What a thread of a compute functor sees: where it stands, and the memory it may touch. D3D11.3 18.6.4, 18.6.8
#pragma once

#include "pipeline/compute_program.h"
#include "pipeline/device.h"
#include "pipeline/image_access.h"
#include "pipeline/lane_memory.h"
#include "pipeline/race_check.h"
#include "sim/math.h"

#include <glm/vec3.hpp>

namespace gnomon {

/// A validated dispatch with everything it may touch.
struct DispatchContext {
    const Dispatch& dispatch;
    const Profile& profile;
    Workers& workers;
    std::span<const std::unique_ptr<Buffer>> buffers;    // [id - 1]
    std::span<const std::unique_ptr<Texture>> textures;  // [id - 1]
    Tally* tally = nullptr;
    const std::atomic<bool>* stop = nullptr;
    bool checks_races = false;  // groups run one after the other then
};

/// What a functor made up beside the constants that the device has checked: there is no such resource.
[[noreturn, gnu::cold, gnu::noinline]] inline void refuse_resource(const DispatchContext& context, std::string_view kind,
                                                                   std::size_t id) {
    fail("dispatch '{}': the functor uses {} {}, which does not exist", context.dispatch.label, kind, id);
}

/// What all threads of a group report to.
struct GroupObservers {
    Tally* tally = nullptr;      // none: not counted
    RaceCheck* races = nullptr;  // none: not checked
};

/// A wave of threads of one group, as a block of a compute functor sees it. Every memory access takes a mask of the lanes that
/// make it; lanes that are not `active` never do. `kWatched`: somebody counts or checks; a class of its own, because a call
/// that might happen costs as much as the loads around it.
template <class RealType, bool kWatched>
class ThreadContext {
public:
    using Real = RealType;

    ThreadContext(const DispatchContext& dispatch, const Vec3<Int>& in_group, const glm::ivec3& group_origin, Int flat_index,
                  Mask lanes, const GroupObservers* observers)
        : index(flat_index),
          local(in_group),
          id{in_group.x + Int(group_origin.x), in_group.y + Int(group_origin.y), in_group.z + Int(group_origin.z)},
          active(lanes),
          dispatch_(dispatch),
          observers_(observers) {}

    // D3D11.3 18.6.4
    const Int index;        // of the thread in its group, x fastest. D3D11.3 23.14
    const Vec3<Int> local;  // position in the group. D3D11.3 23.13
    const Vec3<Int> id;     // position in the grid of all threads. D3D11.3 23.11
    const Mask active;      // lanes that are threads

    // Buffers: one word per lane. A float that is stored is rounded to nearest even where the arithmetic is wider.
    template <template <class> class AnyBuffer, class Word>
        requires std::is_same_v<AnyBuffer<Word>, ReadBuffer<Word>> || std::is_same_v<AnyBuffer<Word>, RwBuffer<Word>>
    GNOMON_INLINE auto load(const AnyBuffer<Word>& from, Int at, Mask mask = Mask(true)) const {
        const Buffer& buffer = this->buffer(from.buffer);
        const Mask valid = in_range(at, word_count(buffer), mask & active);
        note(from.buffer, MemoryAccess::Read, at, valid);
        const Int word = load_words(words_of(buffer), at, valid);
        if constexpr (std::is_same_v<Word, float>) {
            return Real(float_of_bits(word));
        } else {
            return word;
        }
    }
    GNOMON_INLINE void store(const RwBuffer<std::int32_t>& to, Int at, Int value, Mask mask = Mask(true)) const {
        store_word(to.buffer, at, value, mask);
    }
    /// A NaN becomes the one quiet NaN without sign, as in textures (texunit/codec.h).
    GNOMON_INLINE void store(const RwBuffer<float>& to, Int at, const Real& value, Mask mask = Mask(true)) const {
        const Float narrow = to_float(value);
        store_word(to.buffer, at, select(is_nan(narrow), Int(0x7fc00000), bits_of(narrow)), mask);
    }

    // Group-shared memory: one element per lane, at the full width of the arithmetic.
    template <class Lane>
    GNOMON_INLINE Lane load(const SharedArray<Lane>& from, Int at, Mask mask = Mask(true)) const {
        const Mask valid = in_range(at, from.count, mask & active);
        note(from, MemoryAccess::Read, at, valid);
        return load_shared(from, at, valid);
    }
    template <class Lane>
    GNOMON_INLINE void store(const SharedArray<Lane>& to, Int at, const std::type_identity_t<Lane>& value,
                             Mask mask = Mask(true)) const {
        const Mask valid = in_range(at, to.count, mask & active);
        note(to, MemoryAccess::Write, at, valid);
        store_shared(to, at, value, valid);
    }

    // Images: texel (x, y); depth and other numbers as the format means them, stored as the profile narrows.
    Vec4<Real> load(const ReadImage& from, Int x, Int y, Mask mask = Mask(true)) const {
        return load_texels<Real>(image(from), x, y, touch_texels(from, MemoryAccess::Read, x, y, mask));
    }
    Vec4<Real> load(const RwImage& from, Int x, Int y, Mask mask = Mask(true)) const {
        return load_texels<Real>(image(from), x, y, touch_texels(from, MemoryAccess::Read, x, y, mask));
    }
    Vec4<Int> load(const ReadUintImage& from, Int x, Int y, Mask mask = Mask(true)) const {
        return load_texel_codes(image(from), x, y, touch_texels(from, MemoryAccess::Read, x, y, mask));
    }
    Vec4<Int> load(const RwUintImage& from, Int x, Int y, Mask mask = Mask(true)) const {
        return load_texel_codes(image(from), x, y, touch_texels(from, MemoryAccess::Read, x, y, mask));
    }
    void store(const RwImage& to, Int x, Int y, const Vec4<Real>& color, Mask mask = Mask(true)) const {
        const Mask valid = touch_texels(to, MemoryAccess::Write, x, y, mask);
        store_texels(image(to), x, y, color, dispatch_.profile.float_narrowing, valid);
    }
    void store(const RwUintImage& to, Int x, Int y, const Vec4<Int>& codes, Mask mask = Mask(true)) const {
        store_texel_codes(image(to), x, y, codes, touch_texels(to, MemoryAccess::Write, x, y, mask));
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
    SinCosLanes<Real> sin_cos(const Real& x) const { return gnomon::sin_cos(x); }

private:
    [[nodiscard]] Buffer& buffer(BufferId name) const {
        const std::size_t place = static_cast<std::size_t>(name) - 1;
        if (place >= dispatch_.buffers.size()) [[unlikely]]
            refuse_resource(dispatch_, "buffer", place + 1);
        return *dispatch_.buffers[place];
    }
    template <detail::ImageAccess kAccess>
    [[nodiscard]] ImageLevel image(const detail::ImageBinding<kAccess>& binding) const {
        const std::size_t place = static_cast<std::size_t>(binding.texture) - 1;
        if (place >= dispatch_.textures.size()) [[unlikely]]
            refuse_resource(dispatch_, "texture", place + 1);
        return {*dispatch_.textures[place], binding.level, binding.layer};
    }
    /// Whole words of a buffer; bytes behind the last one are out of range.
    static std::int32_t word_count(const Buffer& buffer) { return static_cast<std::int32_t>(buffer.data.size() / 4); }
    static std::int32_t* words_of(Buffer& buffer) { return reinterpret_cast<std::int32_t*>(buffer.data.data()); }
    static const std::int32_t* words_of(const Buffer& buffer) {
        return reinterpret_cast<const std::int32_t*>(buffer.data.data());
    }
    GNOMON_INLINE void store_word(BufferId to, Int at, Int value, Mask mask) const {
        Buffer& buffer = this->buffer(to);
        const Mask valid = in_range(at, word_count(buffer), mask & active);
        note(to, MemoryAccess::Write, at, valid);
        store_words(words_of(buffer), at, value, valid);
    }
    template <AtomicOp kOp>
    void update(const RwBuffer<std::int32_t>& to, Int at, Int value, Mask mask) const {
        Buffer& buffer = this->buffer(to.buffer);
        const Mask valid = in_range(at, word_count(buffer), mask & active);
        note(to.buffer, MemoryAccess::Atomic, at, valid);
        update_words_atomically<kOp>(words_of(buffer), at, value, valid);
    }
    template <AtomicOp kOp>
    void update(const SharedArray<Int>& to, Int at, Int value, Mask mask) const {
        const Mask valid = in_range(at, to.count, mask & active);
        note(to, MemoryAccess::Atomic, at, valid);
        update_words<kOp>(to.words, at, value, valid);
    }

    // Every access passes one of these three, after its lanes are known to be in bounds. What they do when somebody watches
    // stays out of line, for it must not keep the rest from being inlined.
    GNOMON_INLINE void note(BufferId id_of_buffer, MemoryAccess access, Int at, Mask valid) const {
        if constexpr (kWatched) observe_words(id_of_buffer, access, at, valid);
    }
    template <class Lane>
    GNOMON_INLINE void note(const SharedArray<Lane>& array, MemoryAccess access, Int at, Mask valid) const {
        if constexpr (kWatched) observe_elements(array, access, at, valid);
    }
    template <detail::ImageAccess kAccess>
    Mask touch_texels(const detail::ImageBinding<kAccess>& binding, MemoryAccess access, Int x, Int y, Mask mask) const {
        const ImageLevel level = image(binding);
        const Mask valid = in_range(x, level.width(), in_range(y, level.height(), mask & active));
        if constexpr (kWatched) observe_texels(binding, access, x, y, valid);
        return valid;
    }

    [[gnu::noinline]] void observe_words(BufferId id_of_buffer, MemoryAccess access, Int at, Mask valid) const {
        count_bytes(id_of_buffer, access, valid, 4);
        if (observers_->races == nullptr) return;
        for_each_lane(valid, [&](std::size_t i) {
            const std::int32_t word = at.lanes()[i];
            observers_->races->admit(words_of(buffer(id_of_buffer)) + word, {access, false}, index.lanes()[i], [&] {
                return fmt::format("word {} of buffer {}", word, static_cast<std::uint32_t>(id_of_buffer));
            });
        });
    }
    template <class Lane>
    [[gnu::noinline]] void observe_elements(const SharedArray<Lane>& array, MemoryAccess access, Int at, Mask valid) const {
        if (observers_->races == nullptr) return;
        for_each_lane(valid, [&](std::size_t i) {
            const std::int32_t element = at.lanes()[i];
            observers_->races->admit(array.words + element, {access, true}, index.lanes()[i],
                                     [&] { return fmt::format("element {} of a shared array of {}", element, array.count); });
        });
    }
    template <detail::ImageAccess kAccess>
    [[gnu::noinline]] void observe_texels(const detail::ImageBinding<kAccess>& binding, MemoryAccess access, Int x, Int y,
                                          Mask valid) const {
        const ImageLevel level = image(binding);
        const int bytes = level.texture.info().bytes_per_texel;
        count_bytes(binding.texture, access, valid, static_cast<int>(texel_bytes(level.texture.info())));
        if (observers_->races == nullptr) return;
        for_each_lane(valid, [&](std::size_t i) {
            const std::int32_t tx = x.lanes()[i];
            const std::int32_t ty = y.lanes()[i];
            const std::byte* texel = level.texture.row(level.level, ty, level.layer) + tx * bytes;
            observers_->races->admit(texel, {access, false}, index.lanes()[i], [&] {
                return fmt::format("texel ({}, {}) of texture {}", tx, ty, static_cast<std::uint32_t>(binding.texture));
            });
        });
    }

    template <class Id>
    void count_bytes(Id resource, MemoryAccess access, Mask lanes, int bytes) const {
        if (observers_->tally == nullptr) return;
        if (access != MemoryAccess::Write) observers_->tally->read(resource, total(lanes, bytes));
        if (access != MemoryAccess::Read) observers_->tally->write(resource, total(lanes, bytes));
    }
    static std::uint64_t total(Mask lanes, int bytes) {
        return static_cast<std::uint64_t>(std::popcount(lanes.bits())) * static_cast<std::uint64_t>(bytes);
    }

    const DispatchContext& dispatch_;
    const GroupObservers* observers_;  // where kWatched
};

}  // namespace gnomon
