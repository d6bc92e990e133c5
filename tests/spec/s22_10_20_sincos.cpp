// D3D11.3 22.10.20: sincos of pixel and compute functors is sin_cos of sim/math.h.
#include "sim/math.h"
#include "tests/unit/compute_calls.h"
#include "tests/unit/functor_calls.h"

#include <catch2/catch.hpp>

#include <cmath>
#include <set>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Angles from -100 pi to 100 pi over the target.
struct Turn {
    float per_pixel = 0;
    static constexpr auto fields() { return std::tuple{Field{"per_pixel", &Turn::per_pixel}}; }

    template <class Real>
    Real angle(const Vec2<Real>& at) const {
        return (at.x + Real(16.0f) * at.y - Real(136.0f)) * Real(per_pixel);
    }
    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const auto [sine, cosine] = f.sin_cos(angle(Vec2<Real>{f.position.x, f.position.y}));
        return Vec4<Real>{sine, cosine, Real(0.0f), Real(1.0f)};
    }
};

struct TurnThreads {
    static constexpr GroupSize kGroupSize{64, 1, 1};
    ReadBuffer<float> angles;
    RwBuffer<float> sines;
    RwBuffer<float> cosines;
    static constexpr auto fields() {
        using T = TurnThreads;
        return std::tuple{Field{"angles", &T::angles}, Field{"sines", &T::sines}, Field{"cosines", &T::cosines}};
    }
    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) {
            const auto [sine, cosine] = t.sin_cos(t.load(angles, t.id.x));
            t.store(sines, t.id.x, sine);
            t.store(cosines, t.id.x, cosine);
        });
    }
};

}  // namespace

TEST_CASE("functors turn as the lanes do, to 0.0008 of the truth", "[22.10.20]") {
    for (const char* profile : {"d3d11", "ideal"}) {
        Device device(load_profile(profile), 1);
        const Turn pixel{.per_pixel = 2.3f};  // 136 of them are 100 pi
        const FunctorResult drawn = run_functor(device, pixel);
        std::set<float> seen;
        with_arithmetic(device.profile(), [&]<class Real>(Real) {
            for_quads<Real>([&](const Vec2<Real>& at, const auto& pixels) {
                const Real angle = pixel.angle(at);
                const SinCosLanes<Real> both = sin_cos(angle);
                const auto sines = to_float(both.sin).lanes();
                const auto cosines = to_float(both.cos).lanes();
                for (std::size_t i = 0; i < pixels.size(); ++i) {
                    const auto x = static_cast<double>(lane(angle, static_cast<int>(i)));
                    CHECK(drawn.at(pixels[i], 0) == sines[i]);
                    CHECK(drawn.at(pixels[i], 1) == cosines[i]);
                    CHECK(std::fabs(static_cast<double>(drawn.at(pixels[i], 0)) - std::sin(x)) < 0.0008);
                    CHECK(std::fabs(static_cast<double>(drawn.at(pixels[i], 1)) - std::cos(x)) < 0.0008);
                    seen.insert(sines[i]);
                }
            });
        });
        CHECK(seen.size() > 200);
    }
}

TEST_CASE("threads turn as pixels do", "[22.10.20][compute]") {
    for (const char* profile : {"d3d11", "ideal"}) {
        Device device(load_profile(profile), 2);
        std::vector<float> angles(256);
        for (std::size_t i = 0; i < angles.size(); ++i) angles[i] = (static_cast<float>(i) - 128.0f) * 2.4f;
        const BufferId sines = device.create_zeroed_buffer("sines", angles.size() * 4);
        const BufferId cosines = device.create_zeroed_buffer("cosines", angles.size() * 4);
        dispatch(device, TurnThreads{{upload_words(device, angles)}, {sines}, {cosines}}, 4);
        with_arithmetic(device.profile(), [&]<class Real>(Real) {
            for (std::size_t i = 0; i < angles.size(); ++i) {
                const SinCosLanes<Real> both = sin_cos(Real(angles[i]));
                CHECK(words_of<float>(device, sines)[i] == lane(to_float(both.sin), 0));
                CHECK(words_of<float>(device, cosines)[i] == lane(to_float(both.cos), 0));
            }
        });
    }
}
