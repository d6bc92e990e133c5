// The passes of one shadow map, and those of a frame with one such map or with a cascade of them. [PSVSM] steps 2 to 7
#pragma once

#include "pipeline/program.h"
#include "techniques/common/cascade_setup.h"
#include "techniques/technique.h"

#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace gnomon::techniques {

/// One map: the passes that make it. A `Receiver` holds what the camera pass needs to know of it, and turns what it reads at a
/// position into visibility: `visibility(f, at)`, at a MapPosition or a GradientPosition.
template <class Receiver>
class MapPasses {
public:
    virtual ~MapPasses() = default;

    virtual void render(std::span<const SceneDraw> scene, const MapView& view, PassTimer& timer) = 0;
    /// Of the map as render() left it.
    [[nodiscard]] virtual const Receiver& receiver() const = 0;
    [[nodiscard]] virtual std::vector<TextureId> maps() const = 0;
};

/// The camera pass with a receiver for every split.
template <class Receiver>
struct CascadedReceiver {
    Lighting lighting{};
    Cascades cascades{};
    std::array<Receiver, kMaxCascades> receivers{};

    static constexpr auto fields() {
        using C = CascadedReceiver;
        return std::tuple{Field{"lighting", &C::lighting}, Field{"cascades", &C::cascades}, Field{"receivers", &C::receivers}};
    }

    template <class F>
    auto operator()(const F& f) const {
        const auto at = map_position(f);
        const auto visibility_in = [&](int split, const auto& in_map) {
            return receivers[static_cast<std::size_t>(split)].visibility(f, in_map);
        };
        return shade(f, lighting, at.inside, cascades.visibility(f, at, visibility_in));
    }
};

/// The programs of the camera pass.
struct ReceiverPrograms {
    Program one_map;
    Program cascaded;
};
template <class Receiver>
ReceiverPrograms make_receiver_programs(std::string_view one_map, std::string_view cascaded) {
    return {make_program<ReceiverVertex, ShadedReceiver<Receiver>>(one_map),
            make_program<ReceiverVertex, CascadedReceiver<Receiver>>(cascaded)};
}

/// One map of all that the light sees.
template <class Receiver>
class OneMapPasses final : public ShadowPasses {
public:
    OneMapPasses(const ReceiverPrograms& programs, std::unique_ptr<MapPasses<Receiver>> map)
        : programs_(programs), map_(std::move(map)) {
        shaded_.receiver = map_->receiver();
    }

    void render_maps(const FrameView& frame, PassTimer& timer) override {
        map_->render(frame.scene, {.light = frame.light}, timer);
        shaded_.receiver = map_->receiver();
    }
    [[nodiscard]] const Program& receiver_program() const override { return programs_.one_map; }
    std::span<const std::byte> receiver_constants(const Lighting& lighting) override {
        shaded_.lighting = lighting;
        return constants_of(shaded_);
    }
    [[nodiscard]] std::vector<TextureId> maps() const override { return map_->maps(); }
    [[nodiscard]] const Cascades* cascades() const override { return nullptr; }

private:
    const ReceiverPrograms& programs_;
    std::unique_ptr<MapPasses<Receiver>> map_;
    ShadedReceiver<Receiver> shaded_{};
};

/// A map for every split of the view frustum.
template <class Receiver>
class CascadedPasses final : public ShadowPasses {
public:
    CascadedPasses(const ReceiverPrograms& programs, CascadeSetup setup, std::vector<std::unique_ptr<MapPasses<Receiver>>> maps)
        : programs_(programs), setup_(std::move(setup)), maps_(std::move(maps)) {}

    void render_maps(const FrameView& frame, PassTimer& timer) override {
        setup_.update(frame, timer);
        for (std::size_t i = 0; i < maps_.size(); ++i) {
            maps_[i]->render(frame.scene, setup_.view(i, frame.light), timer);
            shaded_.receivers[i] = maps_[i]->receiver();
        }
        for (std::size_t i = maps_.size(); i < shaded_.receivers.size(); ++i)  // never read, but constants name what is there
            shaded_.receivers[i] = shaded_.receivers[0];
        shaded_.cascades = setup_.constants();
    }
    [[nodiscard]] const Program& receiver_program() const override { return programs_.cascaded; }
    std::span<const std::byte> receiver_constants(const Lighting& lighting) override {
        shaded_.lighting = lighting;
        return constants_of(shaded_);
    }
    [[nodiscard]] std::vector<TextureId> maps() const override {
        std::vector<TextureId> all;
        for (const auto& map : maps_) {
            const std::vector<TextureId> own = map->maps();
            all.insert(all.end(), own.begin(), own.end());
        }
        return all;
    }
    [[nodiscard]] const Cascades* cascades() const override { return &shaded_.cascades; }

private:
    const ReceiverPrograms& programs_;
    CascadeSetup setup_;
    std::vector<std::unique_ptr<MapPasses<Receiver>>> maps_;
    CascadedReceiver<Receiver> shaded_{};
};

/// The passes of a technique; `make_map(settings)` makes those of one map of settings.map_size texels. `programs` live on.
template <class Receiver, class MakeMap>
std::unique_ptr<ShadowPasses> make_shadow_passes(Device& device, const TechniqueSettings& settings,
                                                 const ReceiverPrograms& programs, const MakeMap& make_map) {
    std::vector<std::unique_ptr<MapPasses<Receiver>>> maps;
    for (const int size : map_sizes(settings)) {
        TechniqueSettings of_map = settings;
        of_map.map_size = size;
        maps.push_back(make_map(of_map));
    }
    if (settings.cascades == 0) return std::make_unique<OneMapPasses<Receiver>>(programs, std::move(maps.front()));
    return std::make_unique<CascadedPasses<Receiver>>(programs, CascadeSetup(device, settings), std::move(maps));
}

}  // namespace gnomon::techniques
