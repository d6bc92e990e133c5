// One split per quad from derivatives of 2^split, on the machine: every quad of splits 0 to 7, under every derivative.
// [PSVSM] "Texture coordinate derivatives"
#include "pipeline/program.h"
#include "techniques/common/full_screen.h"
#include "techniques/common/seam_cures.h"

#include <fmt/format.h>
#include <catch2/catch.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <vector>

using namespace gnomon;
using namespace gnomon::techniques;

namespace {

constexpr int kSplits = 8;
constexpr int kQuadsPerRow = 64;  // 64 x 64 quads: all 8^4

using Quad = std::array<int, 4>;  // top-left, top-right, bottom-left, bottom-right

Quad quad_of(int index) {
    Quad quad{};
    for (int& split : quad) {
        split = index % kSplits;
        index /= kSplits;
    }
    return quad;
}

/// Reads each pixel's split and writes what the trick makes of it.
struct Trick {
    TextureId splits = TextureId::None;

    static constexpr auto fields() { return std::tuple{Field{"splits", &Trick::splits}}; }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Vec2<Int> at = pixel_of(f);
        const Real split = f.load(splits, at.x, at.y).x;
        return Vec4<Real>{quad_min_split(f, split), quad_max_split(f, split), f.template quad_read<0>(split), split};
    }
};

struct Answer {
    Quad least;  // quad_min_split, lane by lane
    Quad most;
    Quad broadcast;
};

std::vector<Answer> run_trick(const Profile& profile) {
    static const Program program = make_program<FullScreenVertex, Trick>("test.trick");
    constexpr int kSide = 2 * kQuadsPerRow;
    std::vector<float> splits(static_cast<std::size_t>(kSide * kSide));
    const auto place = [](int index, int lane) {
        const int x = 2 * (index % kQuadsPerRow) + lane % 2;
        const int y = 2 * (index / kQuadsPerRow) + lane / 2;
        return static_cast<std::size_t>(y * kSide + x);
    };
    for (int index = 0; index < kQuadsPerRow * kQuadsPerRow; ++index)
        for (int lane = 0; lane < 4; ++lane)
            splits[place(index, lane)] = static_cast<float>(quad_of(index)[static_cast<std::size_t>(lane)]);

    Device device(profile, 1);
    const TextureDesc desc{.format = Format::R32Float, .width = kSide, .height = kSide};
    const TextureId source = device.create_texture("splits", desc);
    device.execute(WriteTexture{.id = source, .data = std::as_bytes(std::span(splits))});
    const std::array<TargetView, 1> target{
        device.create_texture("chosen", {.format = Format::Rgba32Float, .width = kSide, .height = kSide})};
    FullScreen(device).run("trick", program, Trick{.splits = source}, target);

    const std::vector<std::byte> bytes = device.texture(target[0].texture).level_bytes(0);
    std::vector<std::array<float, 4>> pixels(bytes.size() / sizeof(std::array<float, 4>));
    std::memcpy(pixels.data(), bytes.data(), bytes.size());
    std::vector<Answer> answers;
    for (int index = 0; index < kQuadsPerRow * kQuadsPerRow; ++index) {
        Answer answer{};
        for (int lane = 0; lane < 4; ++lane) {
            const auto i = static_cast<std::size_t>(lane);
            const std::array<float, 4>& pixel = pixels[place(index, lane)];
            answer.least[i] = static_cast<int>(pixel[0]);
            answer.most[i] = static_cast<int>(pixel[1]);
            answer.broadcast[i] = static_cast<int>(pixel[2]);
            for (const float value : pixel) REQUIRE(value == std::floor(value));
        }
        answers.push_back(answer);
    }
    return answers;
}

bool agree(const Quad& quad) { return std::ranges::count(quad, quad[0]) == 4; }

/// The lanes that a coarse derivative does not read: the one opposite to its corner.
int unread_lane(DerivativeCorner corner) {
    switch (corner) {
        case DerivativeCorner::TopLeft: return 3;
        case DerivativeCorner::TopRight: return 2;
        case DerivativeCorner::BottomLeft: return 1;
        case DerivativeCorner::BottomRight: return 0;
    }
    return -1;
}

struct Mix {
    int low;
    int high;
    int kinds;  // how many different splits there are
};
Mix mix_of(const Quad& quad) {
    Quad sorted = quad;
    std::ranges::sort(sorted);
    const auto kinds = std::unique(sorted.begin(), sorted.end()) - sorted.begin();
    return {*std::ranges::min_element(quad), *std::ranges::max_element(quad), static_cast<int>(kinds)};
}

/// Whether coarse derivatives through the corner see that the quad has two splits: the row and the column through it do.
bool is_seen(const Quad& quad, DerivativeCorner corner) {
    const auto unread = static_cast<std::size_t>(unread_lane(corner));
    Quad read = quad;
    read[unread] = quad[3 - unread];  // the corner itself
    return !agree(read);
}

/// The trick without rounding: log2 rounded to nearest by comparing squares, cut off by counting bits.
Answer trick_in_whole_numbers(const Quad& quad, bool fine) {
    std::array<int, 4> power{};
    for (std::size_t i = 0; i < 4; ++i) power[i] = 1 << quad[i];
    Answer answer{.least = {}, .most = {}, .broadcast = {quad[0], quad[0], quad[0], quad[0]}};
    for (std::size_t i = 0; i < 4; ++i) {
        const std::size_t row = fine ? i & 2 : 0;
        const std::size_t column = fine ? i & 1 : 0;
        const auto dy = [&](std::size_t x) { return std::abs(power[x + 2] - power[x]); };
        const int dxy = fine ? std::abs(dy(1) - dy(0)) : 0;
        const int largest = std::max({std::abs(power[row + 1] - power[row]), dy(column), dxy});
        if (largest == 0) {
            answer.least[i] = answer.most[i] = quad[i];
            continue;
        }
        const int whole = static_cast<int>(std::bit_width(static_cast<unsigned>(largest))) - 1;
        answer.least[i] = whole + (largest * largest >= 1 << (2 * whole + 1) ? 1 : 0);
        answer.most[i] = whole + 1;
    }
    return answer;
}

/// Fine derivatives, and a logarithm that is off.
struct InexactQuad {
    using Real = Float;

    float error = 0.0f;

    [[nodiscard]] Float ddx(Float x) const { return ddx_fine(x); }
    [[nodiscard]] Float ddy(Float x) const { return ddy_fine(x); }
    [[nodiscard]] Float exp2(Float x) const { return gnomon::exp2(x); }
    [[nodiscard]] Float log2(Float x) const { return gnomon::log2(x) + Float(error); }
};

Float lanes_of(const Quad& quad) {
    std::array<float, kLanes> values{};
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = static_cast<float>(quad[i % 4]);
    return Float::load(values.data());
}
Quad first_quad(Float lanes) {
    Quad quad{};
    for (int i = 0; i < 4; ++i) quad[static_cast<std::size_t>(i)] = static_cast<int>(lane(lanes, i));
    return quad;
}

Profile profile_with(PlainDerivative derivative, DerivativeCorner corner, Arithmetic arithmetic = Arithmetic::Fp32) {
    Profile profile;
    profile.plain_derivative = derivative;
    profile.derivative_corner = corner;
    profile.arithmetic = arithmetic;
    return profile;
}

constexpr std::array kCorners{DerivativeCorner::TopLeft, DerivativeCorner::TopRight, DerivativeCorner::BottomLeft,
                              DerivativeCorner::BottomRight};

}  // namespace

TEST_CASE("two neighbouring splits: with fine derivatives all lanes of a quad take the smaller, or the larger",
          "[techniques][PSVSM]") {
    for (const Arithmetic arithmetic : {Arithmetic::Fp32, Arithmetic::Fp64}) {
        const std::vector<Answer> answers =
            run_trick(profile_with(PlainDerivative::Fine, DerivativeCorner::TopLeft, arithmetic));
        int quads = 0;
        for (int index = 0; index < static_cast<int>(answers.size()); ++index) {
            const Quad quad = quad_of(index);
            const Mix mix = mix_of(quad);
            if (mix.high - mix.low > 1) continue;
            ++quads;
            INFO(fmt::format("splits {}", fmt::join(quad, " ")));
            const Answer& answer = answers[static_cast<std::size_t>(index)];
            CHECK(answer.least == Quad{mix.low, mix.low, mix.low, mix.low});
            CHECK(answer.most == Quad{mix.high, mix.high, mix.high, mix.high});
        }
        CHECK(quads == 8 + 7 * 14);  // one split, or two neighbours in any of 2^4 - 2 patterns
    }
}

TEST_CASE(
    "two splits further apart: the logarithm of 2^a - 2^b rounds to the larger or past the smaller, the same in all lanes",
    "[techniques][PSVSM]") {
    const std::vector<Answer> answers = run_trick(profile_with(PlainDerivative::Fine, DerivativeCorner::TopLeft));
    int quads = 0;
    for (int index = 0; index < static_cast<int>(answers.size()); ++index) {
        const Quad quad = quad_of(index);
        const Mix mix = mix_of(quad);
        if (mix.kinds != 2 || mix.high - mix.low < 2) continue;
        ++quads;
        INFO(fmt::format("splits {}", fmt::join(quad, " ")));
        const Answer& answer = answers[static_cast<std::size_t>(index)];
        // 2^a - 2^b = 2^b (2^k - 1), whose logarithm is b + 1.58 for k = 2, b + 2.81 for k = 3: the larger split.
        CHECK(answer.least == Quad{mix.high, mix.high, mix.high, mix.high});
        CHECK(answer.most == Quad{mix.high, mix.high, mix.high, mix.high});
    }
    CHECK(quads == 21 * 14);
}

TEST_CASE("coarse derivatives miss the lane opposite to their corner: there, and only there, a quad of two splits disagrees",
          "[techniques][PSVSM]") {
    for (const DerivativeCorner corner : kCorners) {
        const std::vector<Answer> answers = run_trick(profile_with(PlainDerivative::Coarse, corner));
        int missed = 0;
        for (int index = 0; index < static_cast<int>(answers.size()); ++index) {
            const Quad quad = quad_of(index);
            const Mix mix = mix_of(quad);
            if (mix.kinds > 2) continue;
            INFO(fmt::format("corner {}, splits {}", static_cast<int>(corner), fmt::join(quad, " ")));
            const Answer& answer = answers[static_cast<std::size_t>(index)];
            if (mix.kinds == 2 && !is_seen(quad, corner)) {
                ++missed;
                CHECK(answer.least == quad);  // nobody moves
                CHECK(answer.most == quad);
            } else {
                CHECK(agree(answer.least));
                CHECK(answer.most == Quad{mix.high, mix.high, mix.high, mix.high});
                if (mix.high - mix.low <= 1) CHECK(answer.least[0] == mix.low);
            }
        }
        CHECK(missed == 8 * 7);  // three lanes of one split, the unread one of another
    }
}

TEST_CASE("every quad: the machine does what whole numbers say, and three splits are too many for fine derivatives",
          "[techniques][PSVSM]") {
    // With fine derivatives the largest difference of a lane is that of its own row, its own column, and that of the columns,
    // which is not the same in all lanes once there are three splits. Coarse ones are the same in all lanes.
    struct Expected {
        PlainDerivative derivative;
        int least;  // quads of three or four splits whose lanes disagree
        int most;
    };
    for (const Expected& expected : {Expected{PlainDerivative::Fine, 1732, 728}, Expected{PlainDerivative::Coarse, 0, 0}}) {
        const std::vector<Answer> answers = run_trick(profile_with(expected.derivative, DerivativeCorner::TopLeft));
        int quads = 0;
        int least = 0;
        int most = 0;
        for (int index = 0; index < static_cast<int>(answers.size()); ++index) {
            const Quad quad = quad_of(index);
            const Answer& answer = answers[static_cast<std::size_t>(index)];
            const Answer wanted = trick_in_whole_numbers(quad, expected.derivative == PlainDerivative::Fine);
            INFO(fmt::format("splits {}", fmt::join(quad, " ")));
            CHECK(answer.least == wanted.least);
            CHECK(answer.most == wanted.most);
            if (mix_of(quad).kinds < 3) continue;
            ++quads;
            least += !agree(answer.least);
            most += !agree(answer.most);
        }
        CHECK(quads == 4096 - 8 - 28 * 14);
        CHECK(least == expected.least);
        CHECK(most == expected.most);
    }
}

TEST_CASE("a logarithm that is a little off does not move the trick: by 2^-10 the larger split, by 0.08 the smaller one",
          "[techniques][PSVSM]") {
    for (const float off : {-0x1p-10f, -0x1p-22f, 0x1p-22f, 0x1p-10f})
        for (int index = 0; index < 4096; ++index) {
            const Quad quad = quad_of(index);
            const InexactQuad f{.error = off};
            const Float split = lanes_of(quad);
            const Answer wanted = trick_in_whole_numbers(quad, true);
            INFO(fmt::format("splits {}, error {}", fmt::join(quad, " "), off));
            CHECK(first_quad(quad_min_split(f, split)) == wanted.least);
            CHECK(first_quad(quad_max_split(f, split)) == wanted.most);
        }
    // Of two splits alone; 2^2 - 2^0 = 3 has the logarithm 1.585, which rounds up from 1.5 on.
    for (const float off : {-0.08f, 0.08f}) {
        const Quad quad{0, 2, 0, 2};
        CHECK(first_quad(quad_min_split(InexactQuad{.error = off}, lanes_of(quad))) == Quad{2, 2, 2, 2});
    }
    CHECK(first_quad(quad_min_split(InexactQuad{.error = -0.09f}, lanes_of({0, 2, 0, 2}))) == Quad{1, 1, 1, 1});
    CHECK(first_quad(quad_max_split(InexactQuad{.error = -0.01f}, lanes_of({0, 1, 0, 1}))) == Quad{0, 0, 0, 0});
}

TEST_CASE("a broadcast of the top-left lane's split never fails", "[techniques][PSVSM]") {
    const std::vector<Answer> answers = run_trick(Profile{});
    for (int index = 0; index < static_cast<int>(answers.size()); ++index) {
        const int first = quad_of(index)[0];
        CHECK(answers[static_cast<std::size_t>(index)].broadcast == Quad{first, first, first, first});
    }
}

TEST_CASE("2^x and its logarithm are exact at whole numbers, and differences of powers keep clear of rounding",
          "[techniques][PSVSM]") {
    for (int a = 0; a < kSplits; ++a) {
        const Float power = exp2(Float(static_cast<float>(a)));
        CHECK(lane(power, 0) == static_cast<float>(1 << a));
        CHECK(lane(log2(power), 0) == static_cast<float>(a));
        for (int b = 0; b < a; ++b) {
            // Of two lanes: the logarithm lies between a - 1 and a and, unless they are neighbours, in its upper half.
            const float difference = lane(log2(Float(static_cast<float>((1 << a) - (1 << b)))), 0);
            CHECK(difference >= static_cast<float>(a - 1));
            CHECK(difference < static_cast<float>(a));
            if (a - b > 1) CHECK(difference > static_cast<float>(a) - 0.42f);
        }
    }
}
