// Seams between the pages of a virtual texture: a quadtree of pages of one size in texels, anywhere in a cache. [Lefohn07]
#include "studies/seams/case_list.h"

namespace gnomon::studies {

namespace {

constexpr std::array<std::string_view, 4> kPagesCures{"none", "explicit-gradients", "derivative-of-position", "quad-broadcast"};

/// Looks up the page of a virtual coordinate in the page table, then samples the cache.
template <bool kProbes>
struct PagesPixel {
    enum Cure : int { kNone, kExplicitGradients, kDerivativeOfPosition, kQuadBroadcast };  // in the order of kPagesCures

    TextureId table = TextureId::None;  // a texel for each fine page: scale, offset of u, offset of v, page
    TextureId cache = TextureId::None;
    Sampler sampler;
    int cure = 0;  // of kPagesCures

    static constexpr auto fields() {
        using P = PagesPixel;
        return std::tuple{Field{"table", &P::table}, Field{"cache", &P::cache}, Field{"sampler", &P::sampler},
                          Field{"cure", &P::cure}};
    }

    /// Coordinates in the cache by an entry of the table.
    template <class Real>
    static Vec3<Real> coordinate_in(const Vec4<Real>& entry, const Real& u, const Real& v) {
        return flat_coordinate(u * entry.x + entry.y, v * entry.x + entry.z);
    }

    template <class F>
    auto operator()(const F& f) const {
        using Real = typename F::Real;
        const Real u = f.in.at.x;
        const Real v = f.in.at.y;
        const auto entry_of_lane = [](const Vec4<Real>& entry, const auto& of_lane) {
            return Vec4<Real>{of_lane(entry.x), of_lane(entry.y), of_lane(entry.z), of_lane(entry.w)};
        };
        const Vec4<Real> own = f.load(table, truncate_to_int(u), truncate_to_int(v));
        Vec4<Real> used = own;
        if (cure == kQuadBroadcast) used = entry_of_lane(own, [&](const Real& x) { return f.template quad_read<0>(x); });

        SeamLookup<Real> lookup{coordinate_in(used, u, v), cure == kExplicitGradients || cure == kDerivativeOfPosition};
        const auto gradients_in = [&](const Vec4<Real>& entry) {
            const Vec3<Real> at = coordinate_in(entry, u, v);
            return shader_gradients(f, at.x, at.y);
        };
        if (cure == kExplicitGradients)
            lookup.gradients = gradients_before_choice(
                f, used.w, [&](const auto& of_lane) { return gradients_in(entry_of_lane(used, of_lane)); });
        if (cure == kDerivativeOfPosition) lookup.gradients = scaled(shader_gradients(f, u, v), used.x);
        const Real value = look_up(f, cache, sampler, lookup);

        return seam_colors<kProbes>(f, value, [&] {
            const auto smooth = [&](const auto& of_lane) {
                const Vec4<Real> entry = entry_of_lane(used, of_lane);
                SeamLookup<Real> in_page{coordinate_in(entry, u, v), lookup.has_gradients};
                if (in_page.has_gradients) in_page.gradients = gradients_in(entry);
                return in_page;
            };
            const Gradients<Real> exact = scaled(plane_gradients<Real>(kPagesPlane), used.x);
            return SeamLanes<Real>{.own = own.w,
                                   .used = used.w,
                                   .sampled = level_of(f, cache, sampler, lookup),
                                   .smooth_lod = smooth_lod_of(f, cache, sampler, used.w, smooth),
                                   .exact_lod = f.lod(cache, sampler, exact).unclamped,
                                   .outside = used.w != own.w,
                                   .value = value};
        });
    }
};

/// The virtual texture at the resolution of each page, where the page lies in the cache.
TextureId make_cache(Device& device) {
    constexpr int kPageSide = kCacheSide / kCachePages;
    std::vector<float> texels(std::size_t{kCacheSide} * kCacheSide);
    const int octaves = full_level_count(kVirtualPages * kPageSide, 1) - 1;
    for (const SeamPage& page : seam_pages())
        for (int y = 0; y < kPageSide; ++y)
            for (int x = 0; x < kPageSide; ++x) {
                const double u = (page.left + page.side * (x + 0.5) / kPageSide) / kVirtualPages;
                const double v = (page.top + page.side * (y + 0.5) / kPageSide) / kVirtualPages;
                const int column = page.slot % kCachePages * kPageSide + x;
                const int row = page.slot / kCachePages * kPageSide + y;
                texels[static_cast<std::size_t>(row * kCacheSide + column)] = seam_noise(u, v, octaves, 0);
            }
    return seam_texture(device, kCacheSide, 1, texels);
}

TextureId make_table(Device& device) {
    std::array<glm::vec4, std::size_t{kVirtualPages} * kVirtualPages> entries{};
    const std::span pages = seam_pages();
    for (std::size_t i = 0; i < pages.size(); ++i) {
        const SeamPage& page = pages[i];
        const float scale = 1.0f / static_cast<float>(page.side * kCachePages);
        const auto offset = [&](int slot, int at) {
            return static_cast<float>(slot) / kCachePages - static_cast<float>(at) * scale;
        };
        const glm::vec4 entry{scale, offset(page.slot % kCachePages, page.left), offset(page.slot / kCachePages, page.top),
                              static_cast<float>(i)};
        for (int y = page.top; y < page.top + page.side; ++y)
            for (int x = page.left; x < page.left + page.side; ++x)
                entries[static_cast<std::size_t>(y * kVirtualPages + x)] = entry;
    }
    const TextureId table =
        device.create_texture("page table", {.format = Format::Rgba32Float, .width = kVirtualPages, .height = kVirtualPages});
    device.execute(WriteTexture{.id = table, .data = std::as_bytes(std::span(entries))});
    return table;
}

SeamImage draw_pages(Device& device, std::string_view cure) {
    const int chosen = seam_cure("pages", kPagesCures, cure);
    const TextureId table = make_table(device);
    const TextureId cache = make_cache(device);
    return draw_seam(device, "seam.pages", kPagesPlane, [&]<bool kProbes>(std::bool_constant<kProbes>) {
        return PagesPixel<kProbes>{.table = table, .cache = cache, .sampler = seam_sampler(AddressMode::Clamp), .cure = chosen};
    });
}

}  // namespace

std::span<const SeamPage, kCachedPages> seam_pages() {
    // Sixteen blocks of 4x4 fine pages, each resident at one level: 32 + 24 + 8 pages fill the cache. Its slots are dealt out
    // so that neighbours in the virtual texture are none in the cache.
    static constexpr std::array<SeamPage, kCachedPages> kPages = [] {
        constexpr std::array<int, 16> kLevels{0, 1, 2, 2, 1, 2, 0, 1, 2, 1, 2, 1, 2, 2, 1, 2};
        std::array<SeamPage, kCachedPages> pages{};
        std::size_t count = 0;
        for (int block = 0; block < 16; ++block) {
            const int side = 1 << kLevels[static_cast<std::size_t>(block)];
            for (int y = 0; y < 4; y += side)
                for (int x = 0; x < 4; x += side) {
                    const int slot = static_cast<int>(count * 27 + 11) % static_cast<int>(kCachedPages);
                    pages[count++] = {block % 4 * 4 + x, block / 4 * 4 + y, side, slot};
                }
        }
        return pages;
    }();
    return kPages;
}

SeamCase pages_seam() {
    return {.name = "pages",
            .summary = "pages of a virtual texture: each has a scale and a place in the cache of its own",
            .source = "virtual textures; adaptive and resolution-matched shadow maps [Lefohn07]",
            .expectation =
                "none: every pixel whose derivatives cross a border is bad; explicit-gradients, "
                "derivative-of-position: none is; quad-broadcast: none is, but lanes read past their page",
            .cures = {kPagesCures.begin(), kPagesCures.end()},
            .reference = "explicit-gradients",
            .draw = draw_pages};
}

}  // namespace gnomon::studies
