// Sequences of small frames: what must not flicker, and what must flicker less.
#include "sim/error.h"
#include "studies/sequence.h"

#include <catch2/catch.hpp>

using namespace gnomon;
using namespace gnomon::studies;

namespace {

SequenceRequest request_of(const std::string& technique, const std::string& path) {
    SequenceRequest request{.render = {}, .frames = 6, .path = path};
    request.render.scene = "fence";
    request.render.technique = technique;
    request.render.choices.map_size = 128;
    request.render.choices.cascades = 3;
    request.render.width = 160;
    request.render.height = 120;
    request.render.threads = 2;
    return request;
}

std::optional<Flicker> flicker_of(const SequenceRequest& request) {
    Sequence sequence(request);
    sequence.run({}, [](const SequenceRow&, const SequencePictures&) {});
    return sequence.flicker();
}

}  // namespace

TEST_CASE("under a camera that stands still nothing flickers at all", "[studies][sequence]") {
    for (const char* technique : {"vsm", "pcf"}) {
        SequenceRequest request = request_of(technique, "still");
        request.render.choices.map_size = 32;
        request.frames = 4;
        Sequence sequence(request);
        std::vector<float> first;
        sequence.run({}, [&](const SequenceRow& row, const SequencePictures& pictures) {
            if (row.frame == 0) first = pictures.visibility.values;
            CHECK(pictures.visibility.values == first);
        });
        const auto flicker = sequence.flicker();
        REQUIRE(flicker);
        CHECK(flicker->points > 100);  // there are errors, but always the same
        CHECK(flicker->pairs == 3 * flicker->points);
        CHECK(sequence.rows().front().metrics->rmse > 0.05);
        CHECK(flicker->visibility == Unsteadiness{});
        CHECK(flicker->truth == Unsteadiness{});
        CHECK(flicker->error == Unsteadiness{});
    }
}

TEST_CASE("snapped splits flicker less than those that follow the camera", "[studies][sequence]") {
    // Under a sun; the truth at the pixels' centres flickers as much with the one as with the other.
    for (const char* technique : {"vsm", "pcf"})
        for (const char* path : {"walk", "pan"}) {
            SequenceRequest request = request_of(technique, path);
            request.render.choices.set = {{"snap", "off"}};
            const auto loose = flicker_of(request);
            request.render.choices.set = {{"snap", "on"}};
            const auto snapped = flicker_of(request);
            REQUIRE(loose);
            REQUIRE(snapped);
            INFO(technique << " " << path << ": " << loose->visibility.mean << " to " << snapped->visibility.mean);
            CHECK(loose->points == snapped->points);
            CHECK(loose->truth == snapped->truth);
            CHECK(snapped->visibility.mean < 0.5 * loose->visibility.mean);
            CHECK(snapped->visibility.change < 0.5 * loose->visibility.change);
            CHECK(snapped->visibility.p95 < loose->visibility.p95);
            CHECK(snapped->error.mean < loose->error.mean);
        }
}

TEST_CASE("a sequence is the same for any number of threads", "[studies][sequence]") {
    std::vector<std::string> hashes;
    std::optional<Flicker> flicker;
    for (const int threads : {1, 2}) {
        SequenceRequest request = request_of("vsm", "orbit");
        request.render.threads = threads;
        Sequence sequence(request);
        sequence.run({}, [](const SequenceRow&, const SequencePictures&) {});
        std::vector<std::string> now;
        for (const SequenceRow& row : sequence.rows()) now.push_back(row.visibility);
        if (threads == 1) {
            hashes = now;
            flicker = sequence.flicker();
            CHECK(now[0] != now[1]);  // it moves
        }
        CHECK(now == hashes);
        CHECK(sequence.flicker() == flicker);
    }
}

TEST_CASE("a frame of a sequence is the frame of that camera", "[studies][sequence]") {
    SequenceRequest request = request_of("vsm", "walk");
    request.frames = 2;
    Sequence sequence(request);
    std::optional<SequencePictures> first;
    sequence.run({}, [&](const SequenceRow& row, const SequencePictures& pictures) {
        if (row.frame == 0) first = pictures;
    });
    Experiment experiment(request.render);
    const RenderResult alone = experiment.run(experiment.runs().front(), {});
    CHECK(first->visibility.values == alone.visibility.values);
    CHECK(first->color.values == alone.color.values);
    CHECK(first->truth->visibility == experiment.truth({})->visibility);
    CHECK(sequence.rows()[0].visibility == alone.hashes.visibility);
    CHECK(sequence.rows()[0].metrics == alone.metrics);
    CHECK(sequence.rows()[1].time == 0.5);
    CHECK(!sequence.flicker());  // two frames are too few
}

TEST_CASE("a frame that could not be kept is not in the table", "[studies][sequence]") {
    Sequence sequence(request_of("vsm", "walk"));
    CHECK_THROWS_AS(sequence.run({},
                                 [](const SequenceRow& row, const SequencePictures&) {
                                     if (row.frame == 2) fail("full");
                                 }),
                    Error);
    CHECK(sequence.rows().size() == 2);
}

TEST_CASE("sequences that cannot be are refused", "[studies][sequence][errors]") {
    SequenceRequest request = request_of("vsm", "walk");
    request.frames = 0;
    CHECK_THROWS_AS(Sequence(request), Error);
    request.frames = kMaxFrames + 1;
    CHECK_THROWS_AS(Sequence(request), Error);
    request = request_of("all", "walk");
    CHECK_THROWS_AS(Sequence(request), Error);
    request = request_of("vsm", "fly");
    CHECK_THROWS_AS(Sequence(request), Error);
}
