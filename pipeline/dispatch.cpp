// Buffers that change, and dispatches: what the device asks before it runs one. D3D11.3 18.6.2, 18.6.8.1
#include "pipeline/compute.h"

namespace gnomon {

namespace {

bool same_resource(const ComputeBinding& a, const ComputeBinding& b) {
    if (a.is_image != b.is_image) return false;
    return a.is_image ? a.texture == b.texture && a.level == b.level && a.layer == b.layer : a.buffer == b.buffer;
}

/// Throws Error unless the texture has this level and layer and a format that is read or written in this way.
void check_image(const Dispatch& dispatch, const ComputeBinding& binding, const Texture& texture) {
    const TextureDesc& desc = texture.desc();
    if (binding.level < 0 || binding.level >= desc.levels || binding.layer < 0 || binding.layer >= desc.layers)
        fail("dispatch '{}': {} is level {} of layer {}, but the texture has {} and {}", dispatch.label, binding.name,
             binding.level, binding.layer, desc.levels, desc.layers);
    if (desc.samples != 1)
        fail("dispatch '{}': {} has {} samples per texel, expected one", dispatch.label, binding.name, desc.samples);
    const FormatInfo& format = texture.info();
    if (binding.is_uint != format.is_integer())
        fail("dispatch '{}': {} has the format {}, expected one of {}", dispatch.label, binding.name, format.name,
             binding.is_uint ? "unsigned integers" : "numbers");
    if (binding.is_written && format.is_depth)
        fail("dispatch '{}': {} has the format {}, which only draws and clears write", dispatch.label, binding.name,
             format.name);
}

}  // namespace

BufferId Device::create_zeroed_buffer(std::string_view label, std::size_t bytes) {
    const auto id = static_cast<BufferId>(resources_.buffers() + 1);
    execute(CreateBuffer{id, label, {}, bytes});
    return id;
}

void Device::run(const WriteBuffer& command) {
    const std::size_t size = buffer(command.id).data.size();
    if (command.offset > size || command.data.size() > size - command.offset)
        fail("buffer {}: {} bytes written at {}, but it holds {}", static_cast<std::size_t>(command.id), command.data.size(),
             command.offset, size);
    std::ranges::copy(command.data, resources_.buffer(command.id).data.begin() + static_cast<std::ptrdiff_t>(command.offset));
}

void Device::run(const Dispatch& dispatch) {
    // Program and constants.
    if (dispatch.program == nullptr) fail("dispatch '{}': no program", dispatch.label);
    const ComputeProgram& program = *dispatch.program;
    if (dispatch.constants.size() != program.constants_size)
        fail("dispatch '{}': {} bytes of constants, program {} expects {}", dispatch.label, dispatch.constants.size(),
             program.name, program.constants_size);
    const std::uint32_t most = std::max({dispatch.groups_x, dispatch.groups_y, dispatch.groups_z});
    if (most > kMaxGroups)
        fail("dispatch '{}': {} x {} x {} groups, expected up to {} each", dispatch.label, dispatch.groups_x, dispatch.groups_y,
             dispatch.groups_z, kMaxGroups);

    // Resources: each exists and can be used in this way, and what is written is named once.
    const std::vector<ComputeBinding> bindings = program.bindings(dispatch.constants);
    for (std::size_t i = 0; i < bindings.size(); ++i) {
        const ComputeBinding& binding = bindings[i];
        const std::string what = fmt::format("dispatch '{}': {}", dispatch.label, binding.name);
        if (binding.is_image) {
            check_image(dispatch, binding, resources_.texture(binding.texture, what));
        } else {
            (void)resources_.buffer(binding.buffer, what);
        }
        for (std::size_t j = 0; j < i; ++j)
            if ((binding.is_written || bindings[j].is_written) && same_resource(binding, bindings[j]))
                fail("dispatch '{}': {} and {} are one resource, and the dispatch writes it", dispatch.label, bindings[j].name,
                     binding.name);
    }

    if (dispatch.groups_x == 0 || dispatch.groups_y == 0 || dispatch.groups_z == 0) return;
    program.run({.dispatch = dispatch,
                 .profile = profile_,
                 .workers = workers_,
                 .buffers = resources_.buffer_table(),
                 .textures = resources_.table(),
                 .tally = counting_ ? &tally_ : nullptr,
                 .stop = stop_,
                 .checks_races = checks_races_});
}

}  // namespace gnomon
