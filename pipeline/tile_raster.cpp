#include "pipeline/tile_raster.h"

#include "pipeline/depth.h"
#include "pipeline/line.h"
#include "pipeline/outline.h"
#include "pipeline/triangle_walk.h"

#include <optional>

namespace gnomon {

namespace {

std::uint64_t count(std::uint32_t lanes) { return static_cast<std::uint64_t>(std::popcount(lanes)); }

/// The samples whose bits an alpha sets. D3D11.3 17.18
template <class Real>
Int alpha_coverage(const Real& alpha, int samples, AlphaToCoverage rule) {
    const Real scaled = saturate(alpha) * Real(static_cast<float>(samples));
    const Int full(static_cast<std::int32_t>((1u << samples) - 1u));
    switch (rule) {
        case AlphaToCoverage::Rounded: {
            const Int set = truncate_to_int(scaled + Real(0.5f));
            return shift_left(Int(1), set) - Int(1) & full;
        }
        case AlphaToCoverage::Ramp: {
            Int mask(0);
            for (int s = 0; s < samples; ++s) mask = mask | select(scaled > Real(static_cast<float>(s)), Int(1 << s), Int(0));
            return mask;
        }
    }
    __builtin_unreachable();
}

/// Lanes whose mask has bit s.
std::uint32_t lanes_with_bit(Int masks, int s) { return ((masks & Int(1 << s)) != Int(0)).bits(); }

/// A tile of targets with several samples per pixel, or with one.
template <class Real, bool kMulti>
class TileRaster {
public:
    using Scalar = typename Real::Scalar;
    using Samples = LanesBySample<kMulti ? kMaxSamples : 1>;
    using SampleMasks = decltype(Samples::live);
    /// What all runs of the functor over a wave found, for the report.
    struct NotedDerivatives {
        std::uint32_t lanes = 0;  // with a sample that passed
        DerivativeCauses causes;
    };

    TileRaster(const TileState& state, int tile_x, int tile_y, Tally* tally)
        : state_(state),
          tile_{tile_x, tile_y, tile_x + kTileSize, tile_y + kTileSize},
          row_end_(std::min(tile_.x1, (state.width + kBlockSize - 1) & ~(kBlockSize - 1))),
          color_end_(std::min(tile_.x1, (state.width + 1) & ~1)),
          tally_(tally),
          samples_(state.pattern.count),
          functor_(state.program->shade_wave.template get<Real>()),
          job_{.pattern = state.pattern,
               .system = {.samples = sample_count(), .sample_mask = state.output.sample_mask},
               .depth_at = kPixelCentre,
               .environment = state.environment,
               .tally = tally} {
        for (const ColorTarget& target : state.color) {
            if (target.texture != nullptr) writers_[colors_] = color_writer<Real>(target, *state.environment.profile);
            color_[colors_++] = target;
        }
        const PixelTraits& traits = state.program->pixel;
        runs_simply_ = !traits.per_sample && !traits.discards && !traits.writes_coverage && !state.output.alpha_to_coverage &&
                       (state.depth_texture == nullptr || state.order == DepthOrder::Early) && tally == nullptr &&
                       state.derivative_report == nullptr;
        if (state.depth_texture == nullptr) return;
        const PixelRect limit = intersect(tile_, {0, 0, state.width, state.height});
        depth_.emplace(*state.depth_texture, state.depth_view, state.depth, state.stencil);
        hierarchy_.emplace(*depth_, tile_x, tile_y, limit, sample_count());
        tests_all_ = depth_->stencil().test || !depth_->depth().test || tally_ != nullptr;
        bounds_blocks_ = hierarchy_->usable() && state.order == DepthOrder::Early && depth_->depth().write;
        uses_hierarchy_ = hierarchy_->usable() && !(state.program->pixel.writes_depth && state.order != DepthOrder::Early);
    }

    void draw(const Primitive<Scalar>& primitive) {
        primitive_ = &primitive;
        job_.primitive = &primitive;
        job_.system.primitive_id = primitive.id;
        job_.system.layer = primitive.layer;
        job_.system.viewport = primitive.viewport;
        job_.system.front = primitive.front;
        if (primitive.layer != layer_) set_layer(primitive.layer);
        range_ = {static_cast<Scalar>(state_.viewports[primitive.viewport].viewport.min_depth),
                  static_cast<Scalar>(state_.viewports[primitive.viewport].viewport.max_depth)};
        switch (primitive.shape) {
            case PrimitiveShape::Triangle: draw_triangle(); break;
            case PrimitiveShape::AliasedLine: draw_line(); break;
            case PrimitiveShape::Outline: draw_outline(); break;
        }
        if (!packer_.empty()) shade(packer_.take());
    }

private:
    friend class TriangleWalk<Samples, TileRaster>;

    /// Per pixel; known to the compiler where it is one.
    [[nodiscard]] int sample_count() const { return kMulti ? samples_ : 1; }

    void set_layer(int layer) {
        layer_ = layer;
        for (std::size_t i = 0; i < colors_; ++i)
            if (color_[i].texture != nullptr) color_[i].set_layer(layer);
        if (!depth_) return;
        depth_->set_layer(layer);
        hierarchy_->forget_all();
    }

    void draw_triangle() {
        const WalkArea area{tile_, state_.viewports[primitive_->viewport].visible, row_end_};
        const bool touched =
            TriangleWalk<Samples, TileRaster>(state_.pattern, area, *this).walk(primitive_->edges, primitive_->bounds);
        if (touched && tally_ != nullptr) ++tally_->counters.tiles;
    }

    void draw_line() {
        const PixelRect area = intersect(primitive_->bounds, tile_);
        const TileBits bits = line_coverage(primitive_->line[0], primitive_->line[1], area, tile_.x0, tile_.y0);
        if (tally_ != nullptr) ++tally_->counters.tiles;
        add_bits(area, std::span(&bits, 1));  // every sample of the pixel. D3D11.3 15.14.1
    }

    void draw_outline() {
        const PixelRect area = intersect(primitive_->bounds, tile_);
        if (tally_ != nullptr) ++tally_->counters.tiles;
        std::array<TileBits, kMulti ? kMaxSamples : 1> bits;
        for (std::size_t s = 0; s < static_cast<std::size_t>(sample_count()); ++s)
            bits[s] = outline_coverage(*primitive_->outline, state_.pattern.at[s], area, tile_.x0, tile_.y0);
        add_bits(area, std::span(bits).first(static_cast<std::size_t>(sample_count())));
    }

    /// Pixels of a tile that are given by sample, or for all samples alike.
    void add_bits(const PixelRect& area, std::span<const TileBits> bits) {
        for (int y = area.y0 & ~(kWaveHeight - 1); y < area.y1; y += kWaveHeight) {
            for (int x = area.x0 & ~(kWaveWidth - 1); x < area.x1; x += kWaveWidth) {
                Samples samples;
                std::uint32_t covered = 0;
                for (std::size_t s = 0; s < static_cast<std::size_t>(sample_count()); ++s)
                    covered |= samples.covered[s] = bits[std::min(s, bits.size() - 1)].lanes(x - tile_.x0, y - tile_.y0);
                if (covered != 0) add({x, y}, covered, samples);
            }
        }
    }

    /// Hierarchical depth: the nearest depth of the primitive over blocks n, n + 1, ... against the farthest stored in them.
    std::uint32_t hidden(int n, std::uint32_t blocks) {
        if (!uses_hierarchy_) return 0;
        const CodesOfBlocks nearest = codes_of_blocks(n, hierarchy_->larger_is_far());
        const std::uint32_t rejected = hierarchy_->rejects(n, nearest.codes, blocks & nearest.known);
        if (tally_ == nullptr) return rejected;
        // Counters are of what is drawn, not of how: these blocks are gone through all the same.
        tally_->counters.blocks_rejected += count(rejected);
        return 0;
    }

    /// Depth codes of the primitive that bound those of all its samples in blocks n, n + 1, ... from one side.
    struct CodesOfBlocks {
        Int codes;
        std::uint32_t known;  // lanes of blocks; elsewhere planes give no numbers
    };
    CodesOfBlocks codes_of_blocks(int n, bool least) const {
        const PixelRect& extent = state_.depth_extent;
        const auto corner = [&](Scalar slope, int first, int last) {
            return Int((slope > 0) == least ? first : (kBlockSize - 1) * kSubpixels + last);
        };
        const Int block = Int(n) + lane_index();
        const PixelLanes first{Int(tile_.x0) + (block & Int(kBlocksPerTile - 1)) * Int(kBlockSize),
                               Int(tile_.y0) + shift_right_logical<kBlockRowBits>(block) * Int(kBlockSize)};
        const auto at =
            pixel_offset<Real>(first, corner(primitive_->z_dx, extent.x0, extent.x1),
                               corner(primitive_->z_dy, extent.y0, extent.y1), primitive_->z_origin.x, primitive_->z_origin.y);
        Real z = interpolate_depth(*primitive_, at, state_.plane_equations);
        if (primitive_->z_bias != Scalar(0)) z = z + Real(primitive_->z_bias);
        return {depth_code(z, range_, depth_->type(), state_.depth_rounding), (z - z == Real(Scalar(0))).bits()};
    }

    /// Before and after the rows of a block that is covered as a whole. Where all of it passed, the primitive's own farthest
    /// depth bounds what is stored now.
    void begin_whole_block() { all_passed_ = kAllLanes; }
    void end_whole_block(int block) {
        if (!bounds_blocks_ || all_passed_ != kAllLanes) return;
        const int n = block / kLanes * kLanes;
        const CodesOfBlocks farthest = codes_of_blocks(n, !hierarchy_->larger_is_far());
        if ((farthest.known >> (block - n) & 1u) != 0) hierarchy_->note_covered(block, lane(farthest.codes, block - n));
    }

    /// A row with covered lanes: the tests that come before the functor, then the functor for the quads that are left.
    void add(const QuadRow& row, std::uint32_t covered, Samples& samples) {
        samples.live = samples.covered;
        if (state_.output.sample_mask != ~0u) {
            covered = apply_sample_mask(samples.live);
            if (covered == 0) return;
        }
        std::uint32_t live = covered;
        if (depth_ && state_.order != DepthOrder::Late) {
            live = 0;
            for (int s = 0; s < sample_count(); ++s) {
                auto& mask = samples.live[static_cast<std::size_t>(s)];
                if (mask != 0) mask = test(row, mask, depth_of(row, s), s, state_.order == DepthOrder::Early);
                live |= mask;
                all_passed_ &= mask;
            }
        }
        if (tally_ != nullptr) count_covered(covered, live, samples);
        if (live == 0) return;
        if (functor_ == nullptr) {
            if (tally_ != nullptr) count_passed(samples.live);
            return;
        }
        // A row with few gaps is shaded as it stands: its results go to memory in one piece.
        const std::uint32_t quads = quad_any(live);
        if (quads == kAllLanes || (std::popcount(quads) >= 3 * kQuadsPerWave && row.x + kWaveWidth <= color_end_)) {
            shade(row_wave(row, covered, samples, sample_count()));
            return;
        }
        for (int q = 0; q < kQuadsPerWave; ++q) {
            if ((quads >> (4 * q) & 1u) == 0) continue;
            packer_.add(row, q, covered, samples, sample_count());
            if (packer_.full()) shade(packer_.take());
        }
    }
    /// Leaves the samples that the sample mask has; returns the lanes with any. D3D11.3 17.17
    std::uint32_t apply_sample_mask(SampleMasks& live) const {
        std::uint32_t any = 0;
        for (int s = 0; s < sample_count(); ++s) {
            auto& mask = live[static_cast<std::size_t>(s)];
            if ((state_.output.sample_mask >> s & 1u) == 0) mask = 0;
            any |= mask;
        }
        return any;
    }

    /// Where the depth of sample s is taken: at the pixel centre where there is one.
    [[nodiscard]] SamplePosition depth_position(int s) const {
        return kMulti ? state_.depth_pattern.at[static_cast<std::size_t>(s)] : kPixelCentre;
    }
    template <class Pixels>
    GNOMON_INLINE Real depth_of(const Pixels& pixels, int s) const {
        return fragment_depth<Real>(*primitive_, pixels, depth_position(s), state_.plane_equations);
    }

    void shade(const Wave& wave) {
        if (runs_simply_) {
            job_.wave = &wave;
            job_.counting = 0;
            for (int s = 0; s < sample_count(); ++s) job_.counting |= wave.samples.live[static_cast<std::size_t>(s)];
            functor_(state_.pixel_functor, job_, result_);
            write_colors(wave, wave.samples.live.data());
            return;
        }
        NotedDerivatives noted;
        if (state_.program->pixel.per_sample) {
            for (int s = 0; s < sample_count(); ++s)
                if (wave.samples.live[static_cast<std::size_t>(s)] != 0) run_functor(wave, s, noted);
        } else {
            run_functor(wave, -1, noted);
        }
        if (state_.derivative_report != nullptr) report_derivatives(wave, noted);
    }

    /// Runs the functor for the whole pixel (`sample` -1) or one sample, then the rest of the way.
    void run_functor(const Wave& wave, int sample, NotedDerivatives& noted) {
        SampleMasks live;
        std::uint32_t counting = 0;
        for (int s = 0; s < sample_count(); ++s) {
            auto& mask = live[static_cast<std::size_t>(s)];
            mask = sample < 0 || s == sample ? wave.samples.live[static_cast<std::size_t>(s)] : 0;
            counting |= mask;
        }
        const PixelTraits& traits = state_.program->pixel;
        job_.wave = &wave;
        job_.counting = counting;
        job_.system.sample = sample;
        job_.depth_at = sample < 0 ? kPixelCentre : depth_position(sample);
        const PixelResult<Real>& result = result_;
        functor_(state_.pixel_functor, job_, result_);
        if (tally_ != nullptr) count_shaded(counting, result);

        // What the functor and alpha leave of the coverage.
        if (result.killed != 0)
            for (int s = 0; s < sample_count(); ++s) live[static_cast<std::size_t>(s)] &= ~result.killed;
        if (traits.writes_coverage) {
            keep_covered(result.coverage, live);
        } else if (state_.output.alpha_to_coverage && traits.targets > 0) {
            keep_covered(alpha_coverage(result.colors[0].w, sample_count(), state_.environment.profile->alpha_to_coverage),
                         live);
        }
        if (depth_ && state_.order != DepthOrder::Early)
            finish_depth(wave, live, traits.writes_depth ? &result.depth : nullptr);
        if (tally_ != nullptr) count_passed(live);
        write_colors(wave, live.data());
        if (state_.derivative_report == nullptr) return;
        noted.causes |= result.causes;
        for (int s = 0; s < sample_count(); ++s) noted.lanes |= live[static_cast<std::size_t>(s)];
    }
    void keep_covered(const Int& coverage, SampleMasks& live) const {
        for (int s = 0; s < sample_count(); ++s) live[static_cast<std::size_t>(s)] &= lanes_with_bit(coverage, s);
    }

    /// The tests that were put off, and their writes.
    void finish_depth(const Wave& wave, SampleMasks& live, const Real* depth) {
        for (int s = 0; s < sample_count(); ++s) {
            auto& mask = live[static_cast<std::size_t>(s)];
            if (mask != 0) mask = test(wave, mask, depth != nullptr ? *depth : depth_of(wave.pixels, s), s, true);
        }
    }

    /// Depth and stencil of the lanes in `mask` at sample s: those that pass. D3D11.3 17.9 to 17.12
    template <class Place>
    GNOMON_INLINE std::uint32_t test(const Place& place, std::uint32_t mask, const Real& z, int s, bool writes) {
        if (tests_all_) return test_all(place, mask, z, s, writes);
        const Int code = depth_code(z, range_, depth_->type(), state_.depth_rounding);
        const Int stored = depth_->stored(place, s);
        const std::uint32_t passed = depth_->test(mask, code, stored);
        if (writes && passed != 0 && depth_->depth().write) {
            depth_->write(place, code, stored, passed, s);
            hierarchy_->note_write(place, passed);
        }
        return passed;
    }
    /// The same with stencil, without depth, or counted.
    template <class Place>
    std::uint32_t test_all(const Place& place, std::uint32_t mask, const Real& z, int s, bool writes) {
        const StencilState& stencil = depth_->stencil();
        // Where the writes were put off the samples were tested before: asking again is no second test.
        const bool counts = tally_ != nullptr && !(writes && state_.order == DepthOrder::EarlyTest);
        std::uint32_t passed = mask;
        if (stencil.test) {
            passed = depth_->test_stencil(place, mask, s, primitive_->front);
            if (counts) {
                tally_->counters.samples_stencil_tested += count(mask);
                tally_->read(state_.depth_view.texture, count(mask));
            }
        }
        const std::uint32_t stencil_passed = passed;
        if (depth_->depth().test && passed != 0) {
            const Int code = depth_code(z, range_, depth_->type(), state_.depth_rounding);
            const Int stored = depth_->stored(place, s);
            passed = depth_->test(passed, code, stored);
            const bool stores = writes && depth_->depth().write && passed != 0;
            if (stores) {
                depth_->write(place, code, stored, passed, s);
                hierarchy_->note_write(place, passed);
            }
            const std::uint64_t bytes = texel_bytes(state_.depth_texture->info());
            if (counts) {
                tally_->counters.samples_depth_tested += count(stencil_passed);
                tally_->read(state_.depth_view.texture, count(stencil_passed) * bytes);
            }
            if (tally_ != nullptr && stores) tally_->write(state_.depth_view.texture, count(passed) * bytes);
        }
        if (stencil.test && writes) {
            const StencilFace& face = primitive_->front ? stencil.front : stencil.back;
            update_stencil(place, mask & ~stencil_passed, s, face.fail);
            update_stencil(place, stencil_passed & ~passed, s, face.depth_fail);
            update_stencil(place, passed, s, face.pass);
        }
        return passed;
    }
    template <class Place>
    void update_stencil(const Place& place, std::uint32_t mask, int s, StencilOp op) {
        depth_->update_stencil(place, mask, s, op);
        if (tally_ != nullptr && op != StencilOp::Keep && depth_->stencil().write_mask != 0)
            tally_->write(state_.depth_view.texture, count(mask));
    }

    /// The colours of the last run, to the lanes of each sample.
    void write_colors(const Wave& wave, const std::uint32_t* live) {
        const std::span lanes(live, static_cast<std::size_t>(sample_count()));
        for (std::size_t i = 0; i < colors_; ++i) {
            const ColorTarget& target = color_[i];
            if (target.texture == nullptr || target.state.write_mask == 0) continue;
            const OutputColors<Real> colors{result_.colors[i], result_.colors[1], state_.output.blend_constant};
            writers_[i](target, wave, lanes, colors, *state_.environment.profile);
            if (tally_ == nullptr) continue;
            for (const std::uint32_t mask : lanes) count_written(target, mask);
        }
    }

    void report_derivatives(const Wave& wave, const NotedDerivatives& noted) {
        const DerivativeCauses& causes = noted.causes;
        for (std::uint32_t rest = noted.lanes; rest != 0; rest &= rest - 1) {
            const auto lane = static_cast<std::size_t>(std::countr_zero(rest));
            const std::uint32_t bit = 1u << lane;
            const std::uint32_t texel = ((causes.helper & bit) != 0 ? kFromHelper : 0u) |
                                        ((causes.killed & bit) != 0 ? kFromKilled : 0u) |
                                        ((causes.inactive & bit) != 0 ? kFromInactive : 0u);
            std::byte* row = state_.derivative_report->row(0, wave.pixel_y(lane));
            std::memcpy(row + wave.pixel_x(lane) * 4, &texel, 4);
        }
    }

    void count_covered(std::uint32_t covered, std::uint32_t live, const Samples& samples) {
        const std::uint64_t quads = count(quad_any(covered)) / 4;
        tally_->counters.quads_covered += quads;
        for (std::size_t s = 0; s < static_cast<std::size_t>(sample_count()); ++s)
            if ((state_.output.sample_mask >> s & 1u) != 0) tally_->counters.samples_covered += count(samples.covered[s]);
        if (depth_ && state_.order != DepthOrder::Late)
            tally_->counters.quads_early_killed += quads - count(quad_any(live)) / 4;
    }
    void count_passed(const SampleMasks& live) {
        for (std::size_t s = 0; s < static_cast<std::size_t>(sample_count()); ++s)
            tally_->counters.samples_passed += count(live[s]);
    }
    void count_shaded(std::uint32_t counting, const PixelResult<Real>& result) {
        Counters& c = tally_->counters;
        const std::uint64_t shaded = count(quad_any(counting));
        c.quads_shaded += shaded / 4;
        c.values_interpolated += shaded / 4 * static_cast<std::uint64_t>(state_.program->varyings);
        c.lanes_shaded += count(counting);
        c.lanes_helper += shaded - count(counting);
        c.lanes_discarded += count(counting & result.killed);
    }
    void count_written(const ColorTarget& target, std::uint32_t mask) {
        const std::uint64_t bytes = count(mask) * texel_bytes(target.texture->info());
        tally_->counters.samples_written += count(mask);
        tally_->write(target.view.texture, bytes);
        if (target.state.enable) {
            tally_->counters.samples_blended += count(mask);
            tally_->read(target.view.texture, bytes);
        }
    }

    const TileState& state_;
    PixelRect tile_;
    int row_end_;    // rows of quads end here: inside the padding, and inside the tile
    int color_end_;  // the same in colour targets, which are padded to quads only
    Tally* tally_;
    int samples_;
    int layer_ = 0;
    ShadeWave<Real> functor_;  // null: depth only
    bool tests_all_ = false;   // more than depth, or less, or counters
    bool uses_hierarchy_ = false;
    bool bounds_blocks_ = false;    // a block whose samples all pass has a new farthest depth
    std::uint32_t all_passed_ = 0;  // lanes that passed for all samples since the block began
    const Primitive<Scalar>* primitive_ = nullptr;
    DepthRange<Scalar> range_;
    std::array<ColorTarget, kMaxTargets> color_;
    std::array<ColorWriter<Real>, kMaxTargets> writers_;
    std::size_t colors_ = 0;
    std::optional<DepthTarget> depth_;
    std::optional<HierarchicalDepth> hierarchy_;
    QuadPacker packer_;
    bool runs_simply_ = false;  // one run a wave, all lanes of which are written, and nothing to count or report
    PixelJob<Real> job_;
    PixelResult<Real> result_;  // of the run at hand; kept, as clearing it costs more than many functors
};

}  // namespace

template <class Real>
void raster_tile(const TileState& state, const BinnedPrimitives<typename Real::Scalar>& binned, std::uint32_t tile, int tiles_x,
                 Tally* tally) {
    const int tile_x = static_cast<int>(tile) % tiles_x * kTileSize;
    const int tile_y = static_cast<int>(tile) / tiles_x * kTileSize;
    const auto draw_all = [&](auto& raster) {
        for (std::uint32_t r = binned.tile_start[tile]; r < binned.tile_start[tile + 1]; ++r)
            raster.draw(binned.chunks[binned.refs[r].chunk].pieces[binned.refs[r].index]);
    };
    if (state.pattern.count > 1) {
        TileRaster<Real, true> raster(state, tile_x, tile_y, tally);
        draw_all(raster);
    } else {
        TileRaster<Real, false> raster(state, tile_x, tile_y, tally);
        draw_all(raster);
    }
}

template void raster_tile<Float>(const TileState&, const BinnedPrimitives<float>&, std::uint32_t, int, Tally*);
template void raster_tile<Double>(const TileState&, const BinnedPrimitives<double>&, std::uint32_t, int, Tally*);

}  // namespace gnomon
