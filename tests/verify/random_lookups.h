// Random textures, samplers and requests, the same numbers for Gnomon and for the verifier.
#pragma once

#include "tests/oracle/random.h"
#include "tests/verify/lookup_verifier.h"
#include "texunit/texture.h"

#include <vector>

namespace verify {

struct TexturePair {
    gnomon::Texture texture;
    Image image;
};

/// A texture with all its mips of random texels; decoding is this file's own.
TexturePair random_texture(oracle::Random& random, gnomon::Format format, int width, int height);

/// Any filter and address mode; anisotropic one time in four.
gnomon::Sampler random_sampler(oracle::Random& random, int levels);

/// Coordinates inside, near edges, near texel boundaries and far outside; gradients of ratios to 24, some of them parallel;
/// binary32 numbers all.
gnomon::SampleRequest random_request(oracle::Random& random, const Image& image, bool compares);

/// Everything that a failing case consists of, in hexfloats.
std::string description(const gnomon::Sampler& sampler, const gnomon::SampleRequest& request, const Color& result);

}  // namespace verify
