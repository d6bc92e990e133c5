// What a dispatch refuses of the resources it names, wherever they stand in its functor, and of the barriers inside it.
#include "sim/error.h"
#include "tests/unit/compute_calls.h"

#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::testing;

namespace {

/// Resources of structs inside a functor.
struct Sources {
    ReadBuffer<float> values;
    ReadImage image;
    static constexpr auto fields() { return std::tuple{Field{"values", &Sources::values}, Field{"image", &Sources::image}}; }
};
struct Inputs {
    Sources sources;
    float scale = 2.0f;
    static constexpr auto fields() { return std::tuple{Field{"sources", &Inputs::sources}, Field{"scale", &Inputs::scale}}; }
};
struct Scale {
    static constexpr GroupSize kGroupSize{4, 1, 1};
    Inputs inputs;
    RwBuffer<float> to;
    static constexpr auto fields() { return std::tuple{Field{"inputs", &Scale::inputs}, Field{"to", &Scale::to}}; }

    template <class G>
    void operator()(G& g) const {
        using Real = typename G::Real;
        g.threads([&](const auto& t) {
            const Real value = t.load(inputs.sources.values, t.id.x);
            t.store(to, t.id.x, value * Real(inputs.scale) + t.load(inputs.sources.image, t.id.x, Int(0)).x);
        });
    }
};

/// Resources that are none of its constants.
template <bool kImage>
struct MakesUp {
    static constexpr GroupSize kGroupSize{4, 1, 1};
    RwBuffer<float> to;
    int id = 0;
    static constexpr auto fields() { return std::tuple{Field{"to", &MakesUp::to}, Field{"id", &MakesUp::id}}; }

    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) {
            if constexpr (kImage) {
                t.store(to, t.id.x, t.load(ReadImage{static_cast<TextureId>(id)}, t.id.x, Int(0)).x);
            } else {
                t.store(to, t.id.x, t.load(ReadBuffer<float>{static_cast<BufferId>(id)}, t.id.x));
            }
        });
    }
};

enum class Inside { Nothing, Threads, FewThreads, Shared };

/// A block of threads with something inside that belongs between blocks.
template <Inside kInside>
struct Nests {
    static constexpr GroupSize kGroupSize{8, 1, 1};
    RwBuffer<float> to;
    static constexpr auto fields() { return std::tuple{Field{"to", &Nests::to}}; }

    template <class G>
    void operator()(G& g) const {
        using Real = typename G::Real;
        g.threads([&](const auto& t) {
            if constexpr (kInside == Inside::Threads) g.threads([](const auto&) {});
            if constexpr (kInside == Inside::FewThreads) g.threads(0, [](const auto&) {});
            if constexpr (kInside == Inside::Shared) (void)g.shared_real(1);
            t.store(to, t.id.x, Real(1.0f));
        });
        g.threads([](const auto&) {});  // one after the other is what blocks are for
        (void)g.shared_real(1);
    }
};

template <class Functor>
std::string message_of(Device& device, const Functor& functor) {
    try {
        dispatch(device, functor);
    } catch (const Error& error) {
        return error.what();
    }
    return "";
}

}  // namespace

TEST_CASE("resources of structs inside a functor are checked as its own are", "[compute][errors]") {
    Device device(load_profile("d3d11"), 1);
    const BufferId from = upload_words(device, std::vector<float>{1, 2, 3, 4});
    const BufferId to = device.create_zeroed_buffer("to", 16);
    const TextureId image = device.create_texture("image", {.format = Format::R32Float, .width = 4, .height = 1});
    const TextureId several = device.create_texture("several", {.format = Format::R32Float, .width = 4, .samples = 4});
    device.execute(ClearColor{image, glm::vec4(0.5f)});
    const Scale good{.inputs = {.sources = {.values = {from}, .image = {image}}}, .to = {to}};
    const auto message = [&](const auto& change) {
        Scale bad = good;
        change(bad);
        return message_of(device, bad);
    };
    CHECK(message([](Scale& s) { s.inputs.sources.values = {}; }) == "dispatch 'test': inputs.sources.values: names no buffer");
    CHECK(message([](Scale& s) { s.inputs.sources.image = {}; }) == "dispatch 'test': inputs.sources.image: names no texture");
    CHECK(message([](Scale& s) { s.to = {}; }) == "dispatch 'test': to: names no buffer");
    CHECK(message([](Scale& s) { s.to = {static_cast<BufferId>(9)}; }) ==
          "dispatch 'test': to: buffer 9: no such buffer; 2 exist");
    CHECK(message([&](Scale& s) { s.inputs.sources.values = {to}; }).find("one resource") != std::string::npos);
    CHECK(message([&](Scale& s) { s.inputs.sources.image = {image, 1}; }).find("level 1") != std::string::npos);
    CHECK(message([&](Scale& s) { s.inputs.sources.image = {several}; }).find("4 samples per texel, expected one") !=
          std::string::npos);
    CHECK(words_of<float>(device, to) == std::vector<float>(4, 0.0f));
    CHECK(message([](Scale&) {}) == "");
    CHECK(words_of<float>(device, to) == std::vector<float>{2.5f, 4.5f, 6.5f, 8.5f});
}

TEST_CASE("a resource that a functor makes up is an error, not a crash", "[compute][errors]") {
    Device device(load_profile("d3d11"), 1);
    const BufferId to = device.create_zeroed_buffer("to", 16);
    for (const int id : {0, 2, 4711, -1}) {
        CHECK(message_of(device, MakesUp<false>{{to}, id}).find("dispatch 'test': the functor uses buffer") == 0);
        CHECK(message_of(device, MakesUp<true>{{to}, id}).find("dispatch 'test': the functor uses texture") == 0);
    }
    CHECK(message_of(device, MakesUp<false>{{to}, 1}) == "");
}

TEST_CASE("a barrier that threads do not reach together is refused", "[compute][errors][18.6.7]") {
    for (const int threads : {1, 2}) {
        Device device(load_profile("d3d11"), threads);
        const BufferId to = device.create_zeroed_buffer("to", 32);
        CHECK(message_of(device, Nests<Inside::Threads>{{to}}).find("dispatch 'test': threads inside a block of threads") == 0);
        CHECK(message_of(device, Nests<Inside::FewThreads>{{to}}).find("dispatch 'test': threads inside a block") == 0);
        CHECK(message_of(device, Nests<Inside::Shared>{{to}}).find("dispatch 'test': shared memory asked for inside a block") ==
              0);
        CHECK(words_of<float>(device, to) == std::vector<float>(8, 0.0f));
        CHECK(message_of(device, Nests<Inside::Nothing>{{to}}) == "");
        CHECK(words_of<float>(device, to) == std::vector<float>(8, 1.0f));
    }
}
