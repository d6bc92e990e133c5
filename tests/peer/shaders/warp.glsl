// The positive and the negative exponential warp of a linear depth in [0, 1]: e^{c+ x} and -e^{-c- x} of x = 2 depth - 1, as
// powers of two. [Lauritzen08] section 4.2

vec2 warped_depth(float depth_ls) { return exp2(frame.warp_exponents * (2.0 * depth_ls - 1.0)) * vec2(1.0, -1.0); }
