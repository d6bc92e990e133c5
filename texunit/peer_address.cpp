#include "texunit/peer_address.h"

namespace gnomon {

namespace {

constexpr float kBelowOne = 0x1.fffffep-1f;

/// x86 cvttps2dq and cvtps2dq: what does not fit, NaN included, becomes the lowest integer.
Int truncate_or_lowest(Float x) {
    const Mask fits = (x >= Float(-0x1p31f)) & (x < Float(0x1p31f));
    return select(fits, bounded_truncate_to_int(select(fits, x, Float(0.0f))), Int(std::numeric_limits<std::int32_t>::min()));
}
Int round_or_lowest(Float x) { return truncate_or_lowest(round(x)); }

Float fraction_below_one(Float x) { return min_second(x - floor(x), Float(kBelowOne)); }

/// Distance to the nearest even number: mirror with period 2, [0, 1].
Float llvmpipe_mirror(Float c) {
    const Float half = c * Float(0.5f);
    const Float rest = half - round(half);
    return max_second(abs(rest + rest), Float(0.0f));
}

AxisTexels<Float> one_texel(Int texel, const PeerAxis& axis) {
    AxisTexels<Float> result{.texel = {}, .outside = {}, .fraction = Float(0.0f)};
    result.outside[0] = outside(texel, axis.size, axis.mode);
    result.texel[0] = clamp(texel, Int(0), axis.size - Int(1));  // reading must stay inside; only border leaves it
    return result;
}

AxisTexels<Float> two_texels(Int first, Int second, Float fraction, const PeerAxis& axis) {
    AxisTexels<Float> result{.texel = {}, .outside = {}, .fraction = fraction};
    const std::array<Int, 2> texels{first, second};
    for (std::size_t i = 0; i < 2; ++i) {
        result.outside[i] = outside(texels[i], axis.size, axis.mode);
        result.texel[i] = clamp(texels[i], Int(0), axis.size - Int(1));
    }
    return result;
}

/// The coordinate an offset of texels further on.
Float moved(Float c, Float size, const PeerAxis& axis) {
    return axis.offset == 0 ? c : c + Float(static_cast<float>(axis.offset)) / size;
}
/// The same after scaling by the size.
Float moved_texels(Float scaled, const PeerAxis& axis) {
    return axis.offset == 0 ? scaled : scaled + Float(static_cast<float>(axis.offset));
}

Int llvmpipe_nearest(Float c, Float size, const PeerAxis& axis) {
    const Int last = axis.size - Int(1);
    const Int offset(axis.offset);
    switch (axis.mode) {
        case AddressMode::Wrap:
            if (axis.base_power_of_two) return (truncate_or_lowest(floor(c * size)) + offset) & last;
            return truncate_or_lowest(fraction_below_one(moved(c, size, axis)) * size);
        case AddressMode::Clamp: return clamp(truncate_or_lowest(moved_texels(c * size, axis)), Int(0), last);
        case AddressMode::Border: return truncate_or_lowest(floor(c * size)) + offset;
        case AddressMode::Mirror: return min(truncate_or_lowest(llvmpipe_mirror(moved(c, size, axis)) * size), last);
        case AddressMode::MirrorOnce: {
            const Int texel = truncate_or_lowest(abs(moved_texels(c * size, axis)));
            return select((texel < Int(0)) | (texel > last), last, texel);  // compared unsigned
        }
    }
    __builtin_unreachable();
}

/// -x - 1 of negative ones, then at most the last.
Int fold_once(Int texel, Int last) { return min(select(texel < Int(0), ~texel, texel), last); }

}  // namespace

AxisTexels<Float> llvmpipe_texels(Float c, const PeerAxis& axis) {
    const Float size(axis.size);
    const Int last = axis.size - Int(1);
    if (!axis.linear) return one_texel(llvmpipe_nearest(c, size, axis), axis);

    const Float half(0.5f);
    const auto floor_of = [](Float a) { return truncate_or_lowest(floor(a)); };
    const auto rest_of = [](Float a) { return a - floor(a); };
    switch (axis.mode) {
        case AddressMode::Wrap: {
            if (axis.base_power_of_two) {
                const Float a = moved_texels(c * size - half, axis);
                const Int first = floor_of(a);
                return two_texels(first & last, (first + Int(1)) & last, rest_of(a), axis);
            }
            const Float m = moved(c, size, axis);
            const Float a = (m - floor(m)) * size - half;
            const Int first = select(a >= Float(0.0f), floor_of(a), last);
            return two_texels(first, select(first != last, first + Int(1), Int(0)), rest_of(a), axis);
        }
        case AddressMode::Clamp: {
            const Float limited = min_second(moved_texels(c * size, axis), size);
            if (axis.gathers) {
                const Float low = max_second(limited, Float(0.0f));
                return two_texels(truncate_or_lowest(low - half), min(truncate_or_lowest(low + half), last), Float(0.0f), axis);
            }
            const Float a = max_second(limited - half, Float(0.0f));
            const Int first = floor_of(a);
            return two_texels(first, min(first + Int(1), last), rest_of(a), axis);
        }
        case AddressMode::Border: {
            const Float a = moved_texels(c * size, axis) - half;
            const Int first = floor_of(a);
            return two_texels(first, first + Int(1), rest_of(a), axis);
        }
        case AddressMode::Mirror: {
            const Float m = moved(c, size, axis);
            if (axis.gathers) {
                const Float halved = m * half;
                const Float rest = halved - round(halved);
                const Int first = floor_of((rest + rest) * size - half);
                return two_texels(fold_once(first, last), fold_once(first + Int(1), last), Float(0.0f), axis);
            }
            const Float a = llvmpipe_mirror(m) * size - half;
            const Int first = floor_of(a);
            return two_texels(max(first, Int(0)), min(first + Int(1), last), rest_of(a), axis);
        }
        case AddressMode::MirrorOnce: {
            const Float scaled = moved_texels(c * size, axis);
            if (axis.gathers) {
                const Int first = floor_of(scaled - half);
                return two_texels(fold_once(first, last), fold_once(first + Int(1), last), Float(0.0f), axis);
            }
            const Float a = max_second(min_second(abs(scaled), size) - half, Float(0.0f));
            const Int first = floor_of(a);
            return two_texels(first, min(first + Int(1), last), rest_of(a), axis);
        }
    }
    __builtin_unreachable();
}

AxisTexels<Float> llvmpipe_fixed_texels(Float coordinate, const PeerAxis& axis) {
    const Float size(axis.size);
    const Int last = axis.size - Int(1);
    const Float c = moved(coordinate, size, axis);
    const bool wraps = axis.mode == AddressMode::Wrap;
    if (!axis.linear) {
        if (wraps) return one_texel(llvmpipe_nearest(coordinate, size, axis), axis);
        return one_texel(clamp(truncate_or_lowest(floor(c * size)), Int(0), last), axis);
    }

    const bool fractional = wraps && !axis.base_power_of_two;
    const Float scaled = fractional ? (c - floor(c)) * size * Float(256.0f) : c * (size * Float(256.0f));
    const Int fixed = round_or_lowest(scaled) - Int(128);
    const Float fraction = Float(fixed & Int(255)) * Float(1.0f / 256.0f);
    const Int texel = shift_right<8>(fixed);
    if (wraps) {
        const Int first = fractional ? min(select(texel < Int(0), last, texel), last) : texel & last;
        return two_texels(first, select(first != last, first + Int(1), Int(0)), fraction, axis);
    }
    const Int first = clamp(texel, Int(0), last);
    return two_texels(first, select((texel >= Int(0)) & (texel < last), first + Int(1), first), fraction, axis);
}

AxisTexels<Float> swiftshader_texels(Float coordinate, const PeerAxis& axis, bool integer) {
    const Float size(axis.size);
    const Int last = axis.size - Int(1);
    const Float c = moved(coordinate, size, axis);
    if (integer) {
        // 16 bits of the coordinate; UNORM formats that are not filtered.
        const Float steps(65536.0f);
        Int code;
        switch (axis.mode) {
            case AddressMode::Clamp: {
                const Float limited = min_second(max_second(c, Float(0.0f)), Float(65535.0f / 65536.0f));
                code = truncate_or_lowest(limited * steps);
                break;
            }
            case AddressMode::Mirror: {
                const Int whole = truncate_or_lowest(c * steps);
                code = whole ^ shift_right<31>(shift_left<15>(whole));
                break;
            }
            case AddressMode::MirrorOnce: {
                const Int whole = truncate_or_lowest(abs(c * steps)) - Int(0x8000);
                code = clamp(whole, Int(-32768), Int(32767)) + Int(0x8000);
                break;
            }
            case AddressMode::Wrap:
            case AddressMode::Border: code = truncate_or_lowest(c * steps); break;
        }
        const Int texel = shift_right_logical<16>((code & Int(0xffff)) * axis.size);
        return one_texel(clamp(texel, Int(0), last), axis);
    }

    if (axis.gathers && axis.mode == AddressMode::Mirror) {
        const Int first = truncate_or_lowest(floor(c * size - Float(0.5f)));
        return two_texels(apply_address_mode(first, axis.size, axis.mode, true),
                          apply_address_mode(first + Int(1), axis.size, axis.mode, true), Float(0.0f), axis);
    }

    // Into [0, 1) by the mode, then to texels.
    Float k = c;
    switch (axis.mode) {
        case AddressMode::Clamp: k = min_second(max_second(c, Float(0.0f)), Float(kBelowOne)); break;
        case AddressMode::Mirror: {
            const Float half = c * Float(0.5f);
            k = min_second(Float(2.0f) * abs(half - round(half)), Float(kBelowOne));
            break;
        }
        case AddressMode::MirrorOnce: k = min_second(abs(c), Float(kBelowOne)); break;
        case AddressMode::Wrap: k = fraction_below_one(c); break;
        case AddressMode::Border: break;
    }
    k = k * size;
    if (!axis.linear) {
        const Int texel = axis.mode == AddressMode::Border ? truncate_or_lowest(floor(k)) : truncate_or_lowest(k);
        return one_texel(texel, axis);
    }
    const Float a = k - Float(0.5f);
    const Float whole = floor(a);
    const Int first = truncate_or_lowest(whole);
    const Int second = first + Int(1);
    if (axis.mode == AddressMode::Wrap)
        return two_texels(select(first < Int(0), last, first), select(second <= last, second, Int(0)), a - whole, axis);
    return two_texels(axis.mode == AddressMode::Border ? first : max(first, Int(0)),
                      axis.mode == AddressMode::Border ? second : min(second, last), a - whole, axis);
}

}  // namespace gnomon
