// Does not compile: a functor with a resource that fields() leaves out, so that nobody can check it. tests/CMakeLists.txt
#include "pipeline/compute.h"

namespace {

struct Copy {
    static constexpr gnomon::GroupSize kGroupSize{64, 1, 1};
    gnomon::ReadBuffer<float> from;
    gnomon::RwBuffer<float> to;
    static constexpr auto fields() { return std::tuple{gnomon::Field{"to", &Copy::to}}; }

    template <class G>
    void operator()(G& g) const {
        g.threads([&](const auto& t) { t.store(to, t.id.x, t.load(from, t.id.x)); });
    }
};

}  // namespace

const gnomon::ComputeProgram kProgram = gnomon::make_compute_program<Copy>("copies in secret");
